//! Folders of the OptiOdom project: `*_metadata.csv` and `*_run-NN.csv`, or what these were made of: `*_run-NN_odo.csv` of the
//! wheel counters and `*_run-NN_opti.csv` of the tracking system, each with its own clock.
//!
//! Rows of a run: time \[s\], x, y \[m\], theta \[rad\] of the tracked robot in the frame of START, then the ticks of this
//! cycle, right wheel before left. Metadata: `Li` wheelbase \[m\], `Di` right and left wheel diameter \[m\], `ngear` times
//! `encRes` ticks per revolution, `L` the side of the square \[m\] where the path is one. The authors compare the last row
//! of each run, so the return error is taken there and reproduces their published numbers.
//!
//! Of a tricycle (`tricyc`), whose front wheel is driven and steered: `Li` the distance of that wheel from the rear axle \[m\], `Di` its
//! diameter \[m\], `Thi` what is added to its angle \[rad\]; rows end with its ticks of this cycle and its angle \[rad\]. An
//! [`AckermannDrive`] counts on the rear axle, so a row's ticks n count as n cos δ there. Its track width stands nowhere and is taken to be
//! `Li`: nothing but the size of wheel noise depends on it.

use super::columns::headless;
use super::error::DatasetError;
use super::recording::Recording;
use super::sheet::Rows;
use super::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use umbmark_core::dataset::ReferencePose;
use umbmark_core::drive::{AckermannDrive, DifferentialDrive, Encoder, Robot};
use umbmark_core::geometry::wrap;
use umbmark_core::path::{Path, SQUARE, SpeedProfile};

const METADATA: &str = "_metadata.csv";
const TRICYCLE: &str = "tricyc";
/// Counts a revolution in which steering angles, radians in the files, are kept.
const STEERING: f64 = 1e6;

/// Whether a file name is that of metadata, and of which set.
pub(super) fn set_of_metadata(name: &str) -> Option<&str> {
    name.strip_suffix(METADATA)
}

/// The set that a file belongs to by its name.
pub(super) fn set_of(name: &str) -> Option<&str> {
    set_of_metadata(name).or_else(|| name.rsplit_once("_run-").map(|(set, _)| set))
}

/// The files of a run: the authors' synchronised one, or those of the wheel counters and of the tracking system.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunFiles {
    pub number: u32,
    pub ticks: String,
    pub track: Option<String>,
}

/// The runs of a set among the names of a folder, in order; a synchronised file goes before the two that it was made of.
pub(super) fn runs(names: &[String], set: &str) -> Vec<RunFiles> {
    let part = |name: &str| {
        let rest = name.strip_suffix(".gz").unwrap_or(name).strip_suffix(".csv")?;
        let (number, kind) = rest.strip_prefix(set)?.strip_prefix("_run-")?.split_at_checked(2)?;
        Some((number.parse::<u32>().ok()?, kind.to_owned()))
    };
    let mut found: BTreeMap<(u32, String), String> = BTreeMap::new();
    for name in names {
        found.extend(part(name).map(|key| (key, name.clone())));
    }
    let numbers: BTreeSet<u32> = found.keys().map(|(number, _)| *number).collect();
    let of = |number: u32, kind: &str| found.get(&(number, kind.to_owned())).cloned();
    let files = |number: u32| match (of(number, ""), of(number, "_odo"), of(number, "_opti")) {
        (Some(ticks), ..) => Some(RunFiles { number, ticks, track: None }),
        (None, Some(ticks), Some(track)) => Some(RunFiles { number, ticks, track: Some(track) }),
        _ => None,
    };
    numbers.into_iter().filter_map(files).collect()
}

/// The robot and the path of a metadata file; the encoder's rate is left open.
pub(super) fn parse_metadata(set: &str, source: Source) -> Result<(Robot, Option<Path>), DatasetError> {
    let metadata = Metadata::read(source)?;
    let file = &metadata.file;
    let kind = metadata.find("type");
    if kind.is_some_and(|(_, kind)| kind == TRICYCLE) {
        return Ok((tricycle(&metadata, set)?, None));
    }
    if let Some((line, kind)) = kind.filter(|(_, kind)| *kind != "diff") {
        let value = super::error::quoted(kind);
        let remedy = "only differential drives (\"diff\") and tricycles (\"tricyc\") are read so far".into();
        return Err(DatasetError::NotYet { file: file.to_owned(), line, key: "type".into(), value, remedy });
    }
    let ticks = metadata.positive("ngear", 0)? * metadata.positive("encRes", 0)?;
    let (wheelbase, right, left) =
        (metadata.positive("Li", 0)?, metadata.positive("Di", 0)?, metadata.positive("Di", 1)?);
    let impossible = |error: &dyn std::fmt::Display| metadata.missing("robot", &error.to_string());
    let drive = DifferentialDrive::new(wheelbase, left, right).map_err(|error| impossible(&error))?;
    let encoder = Encoder::new(ticks, None, None).map_err(|error| impossible(&error))?;
    let path = match metadata.find("L") {
        Some((_, side)) if !side.is_empty() => {
            let path = Path::new(&SQUARE, &[metadata.positive("L", 0)?], SpeedProfile::default());
            Some(path.map_err(|error| impossible(&error))?)
        }
        _ => None,
    };
    Ok((Robot { name: format!("OptiOdom {set}"), drive: drive.into(), encoder }, path))
}

/// The tricycle of a metadata file.
fn tricycle(metadata: &Metadata, set: &str) -> Result<Robot, DatasetError> {
    let ticks = metadata.positive("ngear", 0)? * metadata.positive("encRes", 0)?;
    let (distance, diameter) = (metadata.positive("Li", 0)?, metadata.positive("Di", 0)?);
    let zero = metadata.number_or("Thi", 0.0)?;
    let impossible = |error: &dyn std::fmt::Display| metadata.missing("robot", &error.to_string());
    let drive =
        AckermannDrive::new(distance, distance, diameter, STEERING, zero).map_err(|error| impossible(&error))?;
    let encoder = Encoder::new(ticks, None, None).map_err(|error| impossible(&error))?;
    Ok(Robot { name: format!("OptiOdom {set}"), drive: drive.into(), encoder })
}

struct Metadata {
    file: String,
    rows: Vec<(usize, Vec<String>)>,
}

impl Metadata {
    fn read(source: Source) -> Result<Metadata, DatasetError> {
        let mut lines = Rows::of(source);
        let mut rows = Vec::new();
        while let Some(row) = lines.next()? {
            rows.push((row.line, row.cells().map(str::to_owned).collect()));
        }
        Ok(Metadata { file: lines.file().to_owned(), rows })
    }

    /// The line of a key, and what stands behind it.
    fn cells(&self, key: &str) -> Option<(usize, &[String])> {
        self.rows.iter().find(|(_, cells)| cells[0] == key).map(|(line, cells)| (*line, &cells[1..]))
    }

    fn find(&self, key: &str) -> Option<(usize, &str)> {
        self.cells(key).map(|(line, cells)| (line, cells.first().map_or("", String::as_str)))
    }

    fn positive(&self, key: &str, place: usize) -> Result<f64, DatasetError> {
        let (line, cells) = self.cells(key).ok_or_else(|| self.missing(key, "the row as OptiOdom writes it"))?;
        let cell = cells.get(place).map_or("", String::as_str);
        let value = cell.parse().ok().filter(|value: &f64| *value > 0.0 && *value < 1e9);
        value.ok_or_else(|| DatasetError::Value {
            file: self.file.clone(),
            line,
            key: key.to_owned(),
            value: super::error::quoted(cell),
            allowed: "a positive number".into(),
            remedy: "".into(),
        })
    }

    /// A number, where a cell has one.
    fn number_or(&self, key: &str, otherwise: f64) -> Result<f64, DatasetError> {
        let Some((line, cell)) = self.find(key).filter(|(_, cell)| !cell.is_empty()) else { return Ok(otherwise) };
        cell.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| DatasetError::Value {
            file: self.file.clone(),
            line,
            key: key.to_owned(),
            value: super::error::quoted(cell),
            allowed: "a number, or nothing".into(),
            remedy: "".into(),
        })
    }

    fn missing(&self, key: &str, example: &str) -> DatasetError {
        DatasetError::MissingKey {
            file: self.file.clone(),
            line: 1,
            table: "the metadata".into(),
            key: key.to_owned(),
            example: example.to_owned(),
        }
    }
}

/// The rows of the wheel counters alone: time \[s\] and the ticks of this cycle, left wheel before right.
pub(super) fn parse_odometry(source: Source) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "odoL (2nd)", "odoR (3rd)"];
    let columns = names.map(str::to_owned);
    let mut recording = Recording { file: source.file.clone(), columns, per_cycle: true, ..Recording::default() };
    headless(source, &names, |line, [time, left, right]| {
        recording.lines.push(line);
        recording.time.push(*time);
        recording.counts[0].push(*left);
        recording.counts[1].push(*right);
    })?;
    Ok(recording)
}

/// The rows of a run.
pub(super) fn parse_run(source: Source) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odoR (5th)", "odoL (6th)"];
    let mut recording = Recording {
        file: source.file.clone(),
        columns: [names[0], names[5], names[4]].map(str::to_owned),
        per_cycle: true,
        ..Recording::default()
    };
    headless(source, &names, |line, cells| {
        let [time, x, y, heading, right, left] = *cells;
        let sample = recording.time.len();
        recording.lines.push(line);
        recording.time.push(time);
        recording.counts[0].push(left);
        recording.counts[1].push(right);
        recording.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
    })?;
    Ok(recording)
}

/// The rows of a tricycle's run.
pub(super) fn parse_tricycle_run(source: Source, robot: &Robot) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odoWh (5th)", "ThWh (6th)"];
    let mut recording = Recording {
        file: source.file.clone(),
        columns: [names[0], names[4], names[5]].map(str::to_owned),
        ..Recording::default()
    };
    let zero = robot.drive.number("steering_zero_rad").unwrap_or(0.0);
    let mut driven = 0.0;
    headless(source, &names, |line, cells| {
        let [time, x, y, heading, ticks, angle] = *cells;
        let sample = recording.time.len();
        driven += ticks * libm::cos(angle + zero);
        recording.lines.push(line);
        recording.time.push(time);
        recording.counts[0].push(driven);
        recording.counts[1].push(wrap(angle) * STEERING / std::f64::consts::TAU);
        recording.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
    })?;
    Ok(recording)
}
