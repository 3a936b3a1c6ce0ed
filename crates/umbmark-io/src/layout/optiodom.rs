//! Folders of the OptiOdom project: `*_metadata.csv` and `*_run-NN.csv`, or what these were made of: `*_run-NN_odo.csv` of the
//! wheel counters and `*_run-NN_opti.csv` of the tracking system, each with its own clock.
//!
//! Rows of a run: time \[s\], x, y \[m\], theta \[rad\] of the tracked robot in the frame of START, then the ticks of this
//! cycle, right wheel before left. Metadata: `Li` wheelbase \[m\], `Di` right and left wheel diameter \[m\], `ngear` times
//! `encRes` ticks per revolution, `L` the side of the square \[m\] where the path is one. The authors compare the last row
//! of each run, so the return error is taken there and reproduces their published numbers.
//!
//! Of bases that move sideways, rows end with the ticks of this cycle of each wheel. Mecanum (`omni4`, front left, front right, rear left, rear
//! right, those on the right counting up when they roll back): `Li` the distances of front and rear wheels and of left and right ones \[m\],
//! `Di` four diameters. Three omni wheels (`omni3`, front right, front left, rear): `Li` their distance from the centre, `Di` three diameters.
//!
//! Of a tricycle (`tricyc`), whose front wheel is driven and steered: `Li` the distance of that wheel from the rear axle \[m\], `Di` its
//! diameter \[m\], `Thi` what is added to its angle \[rad\]; rows end with its ticks of this cycle and its angle in it \[rad\]: a
//! [`TricycleDrive`]. Its track width stands nowhere and is taken to be `Li`: nothing but the size of wheel noise depends on it.

use super::Layout;
use super::csv::not_a_dataset;
use super::messages::Topics;
use crate::RobotFile;
use crate::assembly::Assembly;
use crate::columns::headless;
use crate::csv_text::CsvText;
use crate::error::{At, DatasetError, LineProblem};
use crate::label::Named;
use crate::probe::{Probe, name_of, stem};
use crate::recording::{CLOCK_EXCESS, Recording};
use crate::save::{Existing, put};
use crate::sheet::Rows;
use crate::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use umbmark_core::dataset::{Dataset, ReferencePose, TickLog};
use umbmark_core::drive::{
    DifferentialDrive, Drive, DriveError, Encoder, MecanumDrive, Omni3Drive, Robot, TricycleDrive,
};
use umbmark_core::effect::TestKind;
use umbmark_core::geometry::wrap;
use umbmark_core::path::{Path as DrivenPath, SQUARE, SpeedProfile};
use umbmark_core::prose::counted;
use umbmark_core::run::dead_reckoning::EndPose;

pub(super) const LAYOUT: Layout = Layout::new("optiodom", "a set of OptiOdom: *_metadata.csv and *_run-NN.csv")
    .reads_data((is_set, read))
    .writes(write);

const METADATA: &str = "_metadata.csv";
const TRICYCLE: &str = "tricyc";
const MECANUM: &str = "omni4";
const THREE_WHEELS: &str = "omni3";
/// Whether each wheel of a mecanum base counts down ahead.
const BACKWARD: [bool; 4] = [false, true, false, true];
/// Counts a revolution in which steering angles, radians in the files, are kept.
const STEERING: f64 = 1e6;

/// A folder with metadata, or a file that metadata stand beside.
fn is_set(probe: &Probe) -> bool {
    if probe.is_folder {
        return probe.names.iter().any(|name| set_of_metadata(name).is_some());
    }
    set_of(&name_of(&probe.path)).is_some_and(|set| probe.has(&format!("{set}{METADATA}")))
}

/// All of a set, or one run of it.
fn read(probe: &Probe, _: &Topics) -> Result<Dataset, DatasetError> {
    let (folder, names, name) = (&probe.folder, &probe.names, name_of(&probe.path));
    if probe.is_folder {
        let sets: Vec<&str> = names.iter().filter_map(|name| set_of_metadata(name)).collect();
        let [set] = sets[..] else {
            return Err(DatasetError::NotADataset {
                file: folder.display().to_string(),
                found: format!("it has {} OptiOdom sets ({})", sets.len(), sets.join(", ")),
                remedy: "give the metadata file of one of them".into(),
            });
        };
        return read_set(folder, set, names);
    }
    let set = set_of(&name).unwrap_or_default();
    if set_of_metadata(&name).is_some() {
        return read_set(folder, set, names);
    }
    let mut assembly = assembly_of(folder, set)?;
    match runs(names, set).iter().find(|run| run.ticks == name || run.track.as_ref() == Some(&name)) {
        Some(run) => add_run(&mut assembly, folder, run)?,
        None => return Err(not_a_dataset(&probe.path, "it is no run of the OptiOdom set beside it".into())),
    }
    assembly.finish()
}

fn read_set(folder: &Path, set: &str, names: &[String]) -> Result<Dataset, DatasetError> {
    let mut assembly = assembly_of(folder, set)?;
    let runs = runs(names, set);
    if runs.is_empty() {
        let found = format!("it has OptiOdom metadata and neither {set}_run-01.csv nor {set}_run-01_odo.csv");
        return Err(not_a_dataset(folder, found));
    }
    let clocks = Metadata::read(Source::open(&folder.join(format!("{set}{METADATA}")))?)?;
    let excesses: Vec<f64> = runs.iter().filter_map(|run| clocks.clock_excess(run.number)).collect();
    let most = excesses.iter().fold(0.0_f64, |most, excess| if excess.abs() > most.abs() { *excess } else { most });
    if most.abs() > CLOCK_EXCESS {
        assembly.warnings.push(format!(
            "{}: by its metadata, runs took up to {:.1} % {} by the tracking system's clock than by that of the rows: cycles were lost or took \
             longer than the rows say. Speeds are off by that share, and so are ways where the rows hold speeds and no counts",
            clocks.file,
            100.0 * most.abs(),
            if most < 0.0 { "less" } else { "longer" }
        ));
    }
    for run in runs {
        add_run(&mut assembly, folder, &run)?;
    }
    assembly.columns.check()?;
    assembly.finish()
}

fn assembly_of(folder: &Path, set: &str) -> Result<Assembly, DatasetError> {
    let metadata = folder.join(format!("{set}_metadata.csv"));
    let (robot, path) = parse_metadata(set, Source::open(&metadata)?)?;
    Ok(Assembly::new(Some(RobotFile::new(robot, path))))
}

fn add_run(assembly: &mut Assembly, folder: &Path, run: &RunFiles) -> Result<(), DatasetError> {
    let file = folder.join(&run.ticks);
    let source = Source::open(&file)?;
    let named = Named { number: Some(run.number), ..Named::default() };
    let kind = assembly.robot().map(|robot| robot.drive.kind()).unwrap_or_default();
    let Some(track) = &run.track else {
        let recording = match kind {
            _ if kind.steers() => parse_tricycle_run(source)?,
            _ if kind.moves_sideways() => {
                let set = set_of(&run.ticks).unwrap_or_default();
                let clocks = Metadata::read(Source::open(&folder.join(format!("{set}{METADATA}")))?)?;
                let clock_excess = clocks.clock_excess(run.number).unwrap_or(0.0);
                Recording { clock_excess, ..parse_rollers_run(source, kind.columns().len())? }
            }
            _ => parse_run(source)?,
        };
        return assembly.add_recording(recording, None, &stem(&file), named, EndPose::Last);
    };
    if !kind.has_axle_wheels() {
        let (key, value) = ("type".into(), format!("\"{}\"", kind.name()));
        let remedy = "of this drive, runs are read whose two clocks were brought together (*_run-NN.csv)".into();
        return Err(At::new(source.file, 1).refuse(LineProblem::NotYet { key, value, remedy }));
    }
    let recording = parse_odometry(source)?;
    let tracked = super::read_track(&folder.join(track), &assembly.columns, &mut assembly.warnings)?;
    assembly.add_recording(recording, Some(tracked), &stem(&file), named, EndPose::Last)
}

/// Whether a file name is that of metadata, and of which set.
fn set_of_metadata(name: &str) -> Option<&str> {
    name.strip_suffix(METADATA)
}

/// The set that a file belongs to by its name.
fn set_of(name: &str) -> Option<&str> {
    set_of_metadata(name).or_else(|| name.rsplit_once("_run-").map(|(set, _)| set))
}

/// The files of a run: the authors' synchronised one, or those of the wheel counters and of the tracking system.
#[derive(Clone, Debug, PartialEq)]
struct RunFiles {
    pub number: u32,
    pub ticks: String,
    pub track: Option<String>,
}

/// The runs of a set among the names of a folder, in order; a synchronised file goes before the two that it was made of.
fn runs(names: &[String], set: &str) -> Vec<RunFiles> {
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
pub(crate) fn parse_metadata(set: &str, source: Source) -> Result<(Robot, Option<DrivenPath>), DatasetError> {
    let metadata = Metadata::read(source)?;
    let file = &metadata.file;
    let kind = metadata.find("type");
    if kind.is_some_and(|(_, kind)| kind == TRICYCLE) {
        return Ok((tricycle(&metadata, set)?, None));
    }
    if kind.is_some_and(|(_, kind)| kind == MECANUM) {
        let drive = MecanumDrive::new(metadata.positive("Li", 0)?, metadata.positive("Li", 1)?, metadata.diameters()?);
        return Ok((metadata.robot(set, drive)?, None));
    }
    if kind.is_some_and(|(_, kind)| kind == THREE_WHEELS) {
        let drive = Omni3Drive::new(metadata.positive("Li", 0)?, metadata.diameters()?);
        return Ok((metadata.robot(set, drive)?, None));
    }
    if let Some((line, kind)) = kind.filter(|(_, kind)| *kind != "diff") {
        let value = crate::error::quoted(kind);
        let remedy = "robots of type \"diff\", \"tricyc\", \"omni4\" (mecanum) and \"omni3\" are read".into();
        return Err(At::new(file, line).refuse(LineProblem::NotYet { key: "type".into(), value, remedy }));
    }
    let ticks = metadata.positive("ngear", 0)? * metadata.positive("encRes", 0)?;
    let (wheelbase, right, left) =
        (metadata.positive("Li", 0)?, metadata.positive("Di", 0)?, metadata.positive("Di", 1)?);
    let impossible = |error: &dyn std::fmt::Display| metadata.missing("robot", &error.to_string());
    let drive = DifferentialDrive::new(wheelbase, left, right).map_err(|error| impossible(&error))?;
    let encoder = Encoder::new(ticks, None, None).map_err(|error| impossible(&error))?;
    let path = match metadata.find("L") {
        Some((_, side)) if !side.is_empty() => {
            let path = DrivenPath::new(&SQUARE, &[metadata.positive("L", 0)?], SpeedProfile::default());
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
    let drive = TricycleDrive::new(distance, distance, diameter, STEERING, zero).map_err(|error| impossible(&error))?;
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
        value.ok_or_else(|| {
            At::new(self.file.clone(), line).refuse(LineProblem::Value {
                key: key.to_owned(),
                value: crate::error::quoted(cell),
                allowed: "a positive number".into(),
                remedy: "".into(),
            })
        })
    }

    /// By which share a run took longer by the tracking system's clock than by that of its rows, where the file says when it began and ended by
    /// both.
    fn clock_excess(&self, number: u32) -> Option<f64> {
        let place = usize::try_from(number).ok()?.checked_sub(1)?;
        let time = |key: &str| self.cells(key)?.1.get(place)?.parse::<f64>().ok().filter(|time| time.is_finite());
        let [tracked, rows] =
            [(time("gt_ti"), time("gt_tf")), (time("odo_ti"), time("odo_tf"))].map(|(from, to)| Some(to? - from?));
        let excess = tracked? / rows? - 1.0;
        (excess.abs() < 0.5).then_some(excess)
    }

    /// The diameters of so many wheels.
    fn diameters<const N: usize>(&self) -> Result<[f64; N], DatasetError> {
        let mut diameters = [0.0; N];
        for (place, diameter) in diameters.iter_mut().enumerate() {
            *diameter = self.positive("Di", place)?;
        }
        Ok(diameters)
    }

    /// The robot with a drive, where that is possible.
    fn robot<D: Into<Drive>>(&self, set: &str, drive: Result<D, DriveError>) -> Result<Robot, DatasetError> {
        let impossible = |error: &dyn std::fmt::Display| self.missing("robot", &error.to_string());
        let ticks = self.positive("ngear", 0)? * self.positive("encRes", 0)?;
        let drive = drive.map_err(|error| impossible(&error))?.into();
        let encoder = Encoder::new(ticks, None, None).map_err(|error| impossible(&error))?;
        Ok(Robot { name: format!("OptiOdom {set}"), drive, encoder })
    }

    /// A number, where a cell has one.
    fn number_or(&self, key: &str, otherwise: f64) -> Result<f64, DatasetError> {
        let Some((line, cell)) = self.find(key).filter(|(_, cell)| !cell.is_empty()) else { return Ok(otherwise) };
        cell.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            At::new(self.file.clone(), line).refuse(LineProblem::Value {
                key: key.to_owned(),
                value: crate::error::quoted(cell),
                allowed: "a number, or nothing".into(),
                remedy: "".into(),
            })
        })
    }

    fn missing(&self, key: &str, example: &str) -> DatasetError {
        At::new(self.file.clone(), 1).refuse(LineProblem::MissingKey {
            table: "the metadata".into(),
            key: key.to_owned(),
            example: example.to_owned(),
        })
    }
}

/// The rows of the wheel counters alone: time \[s\] and the ticks of this cycle, left wheel before right.
pub(crate) fn parse_odometry(source: Source) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "odoL (2nd)", "odoR (3rd)"];
    let columns = names.map(str::to_owned).to_vec();
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
pub(crate) fn parse_run(source: Source) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odoR (5th)", "odoL (6th)"];
    let mut recording = Recording {
        file: source.file.clone(),
        columns: [names[0], names[5], names[4]].map(str::to_owned).to_vec(),
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
pub(crate) fn parse_tricycle_run(source: Source) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odoWh (5th)", "ThWh (6th)"];
    let mut recording = Recording {
        file: source.file.clone(),
        columns: [names[0], names[4], names[5]].map(str::to_owned).to_vec(),
        angle_of_row: true,
        ..Recording::default()
    };
    let mut driven = 0.0;
    headless(source, &names, |line, cells| {
        let [time, x, y, heading, ticks, angle] = *cells;
        let sample = recording.time.len();
        driven += ticks;
        recording.lines.push(line);
        recording.time.push(time);
        recording.counts[0].push(driven);
        recording.counts[1].push(wrap(angle) * STEERING / std::f64::consts::TAU);
        recording.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
    })?;
    Ok(recording)
}

/// The rows of a run of a base on three or four wheels with rollers.
pub(crate) fn parse_rollers_run(source: Source, wheels: usize) -> Result<Recording, DatasetError> {
    if wheels == 3 {
        let names = ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odo1 (5th)", "odo2 (6th)", "odo3 (7th)"];
        return rollers_of(source, &names, |count, _| count);
    }
    let names =
        ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odo1 (5th)", "odo2 (6th)", "odo3 (7th)", "odo4 (8th)"];
    rollers_of(source, &names, |count, wheel| if BACKWARD[wheel] { -count } else { count })
}

/// The same, with each count as it is ahead.
fn rollers_of<const N: usize>(
    source: Source,
    names: &[&str; N],
    ahead: fn(f64, usize) -> f64,
) -> Result<Recording, DatasetError> {
    const WHEELS_FROM: usize = 4;
    let mut recording = Recording {
        file: source.file.clone(),
        columns: std::iter::once(names[0]).chain(names[WHEELS_FROM..].iter().copied()).map(str::to_owned).collect(),
        counts: vec![Vec::new(); N - WHEELS_FROM],
        per_cycle: true,
        ..Recording::default()
    };
    headless(source, names, |line, cells| {
        let sample = recording.time.len();
        recording.lines.push(line);
        recording.time.push(cells[0]);
        for (wheel, (counts, count)) in recording.counts.iter_mut().zip(&cells[WHEELS_FROM..]).enumerate() {
            counts.push(ahead(*count, wheel));
        }
        recording.reference.push(ReferencePose { sample, x: cells[1], y: cells[2], heading: Some(cells[3]) });
    })?;
    Ok(recording)
}

/// Writes a set: a pose with heading in every row, and the ticks since the row before.
fn write(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let robot = data.nominal_robot()?;
    let kind = robot.drive.kind();
    if !kind.has_axle_wheels() {
        let reason = format!("a robot with drive = \"{}\" is not written as a set of OptiOdom", kind.name());
        return Err(DatasetError::Unwritable { file: folder.display().to_string(), reason });
    }
    let set = set_name(&robot.name, folder);
    let (numbers, renumbered) = numbers(data);
    let mut files = BTreeMap::new();
    let mut lost = Lost::default();
    for ((_, log), number) in super::logs(data).zip(numbers) {
        if let Some(text) = run_text(log, &mut lost) {
            files.insert(PathBuf::from(format!("{set}_run-{number:02}.csv")), text);
        }
    }
    if files.is_empty() {
        let reason = "no log has measured poses with headings, and OptiOdom has one in every row".into();
        return Err(DatasetError::Unwritable { file: folder.display().to_string(), reason });
    }
    let runs = files.len();
    files.insert(PathBuf::from(format!("{set}_metadata.csv")), metadata_text(robot, data.path.as_ref(), runs));
    put(folder, &files, existing, |written| {
        let unreadable = |reason: String| DatasetError::Unwritable { file: folder.display().to_string(), reason };
        let read = crate::load(written).map_err(|error| unreadable(format!("it would not be read back: {error}")))?;
        let whole = read.runs.len() == runs;
        whole.then_some(()).ok_or_else(|| unreadable("it would be read back with other runs".into()))
    })?;
    lost.renumbered = renumbered;
    lost.left_out = data.runs.len() - runs;
    Ok(lost.sentences(data))
}

/// What the layout could not hold.
#[derive(Default)]
struct Lost {
    left_out: usize,
    renumbered: bool,
    /// Rows without a pose, whose ticks went into the next row with one.
    merged: usize,
    /// Ticks after the last pose.
    trailing: f64,
}

impl Lost {
    fn sentences(&self, data: &Dataset) -> Vec<String> {
        let mut said = Vec::new();
        let mut say = |is: bool, text: String| said.extend(is.then_some(text));
        say(self.left_out > 0, format!("{} without measured poses with headings", counted(self.left_out, "run")));
        say(self.merged > 0, format!("{} rows without a pose: their ticks are in the next row with one", self.merged));
        say(self.trailing > 0.0, format!("{} ticks after the last poses", self.trailing));
        say(self.renumbered, "the numbers of the runs: they are counted through both directions".into());
        let other_path = data.path.as_ref().is_some_and(|path| path.shape().name != SQUARE.name);
        say(other_path, "the path: only the side of a square has a place".into());
        let bumps = data.runs.iter().any(|run| run.test == TestKind::Bumps);
        say(bumps, "which runs are of the test with bumps".into());
        let encoder = data.robot.as_ref().map(|robot| &robot.encoder);
        let more = encoder.is_some_and(|encoder| encoder.rate().is_some() || encoder.counter_bits().is_some());
        say(more, "encoder rate and counter width".into());
        said.push("return errors: they follow from the last row of each log".into());
        said
    }
}

/// The rows of a run, where there are any.
fn run_text(log: &TickLog, lost: &mut Lost) -> Option<Vec<u8>> {
    let mut text = CsvText::behind("");
    let (mut left, mut right, mut rows) = (0.0, 0.0, 0);
    for pose in &log.reference {
        let Some(heading) = pose.heading else { continue };
        let (time, l, r) = (log.time[pose.sample], log.left[pose.sample], log.right[pose.sample]);
        [time, pose.x, pose.y, heading].into_iter().for_each(|value| text.decimal(value));
        text.cell(r - right);
        text.cell(l - left);
        text.end();
        (left, right, rows) = (l, r, rows + 1);
    }
    if rows == 0 {
        return None;
    }
    lost.merged += log.time.len().saturating_sub(rows);
    let rest = |ticks: &[f64], at: f64| ticks.last().map_or(0.0, |last| (last - at).abs());
    lost.trailing += rest(&log.left, left) + rest(&log.right, right);
    Some(text.finish())
}

fn metadata_text(robot: &Robot, path: Option<&DrivenPath>, runs: usize) -> Vec<u8> {
    let side = path.filter(|path| path.shape().name == SQUARE.name).map(|path| path.values()[0].to_string());
    let side = side.unwrap_or_default();
    let (drive, ticks) = (&robot.drive, robot.encoder.ticks_per_revolution());
    let (right, left) = (drive.wheel_diameter_right(), drive.wheel_diameter_left());
    let [ticks, wheelbase, right, left] = [ticks, drive.wheelbase(), right, left].map(|value| value.to_string());
    let runs = runs.to_string();
    let mut text = CsvText::behind("");
    text.row(["type", "diff"]);
    text.row(["ngear", "1"]);
    text.row(["encRes", &ticks]);
    text.row(["Li", &wheelbase]);
    text.row(["Di", &right, &left]);
    text.row(["Thi", ""]);
    text.row(["N", &runs]);
    text.row(["L", &side]);
    text.finish()
}

/// One number for each run with a log; whether they are not the runs' own, because these are not unique.
fn numbers(data: &Dataset) -> (Vec<u32>, bool) {
    let own: Vec<u32> = super::logs(data).map(|(run, _)| run.number).collect();
    let unique = own.iter().collect::<BTreeSet<_>>().len() == own.len() && own.iter().all(|number| *number < 100);
    if unique { (own, false) } else { ((1..=own.len() as u32).collect(), true) }
}

/// The set's own name where the robot still has it, else that of the folder.
fn set_name(robot: &str, folder: &Path) -> String {
    let folder = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let name = robot.strip_prefix("OptiOdom ").unwrap_or(&folder);
    let clean: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    if clean.is_empty() { "set".into() } else { clean }
}
