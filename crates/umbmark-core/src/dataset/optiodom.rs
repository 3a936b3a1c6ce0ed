//! Folders of the OptiOdom project: `*_metadata.csv` and `*_run-NN.csv`.
//!
//! Rows of a run: time \[s\], x, y \[m\], theta \[rad\] of the tracked robot in the frame of START, then the ticks of this
//! cycle, right wheel before left. Metadata: `Li` wheelbase \[m\], `Di` right and left wheel diameter \[m\], `ngear` times
//! `encRes` ticks per revolution, `L` the side of the square \[m\] where the path is one. The authors compare the last row
//! of each run, so the return error is taken there and reproduces their published numbers.

use super::ReferencePose;
use super::columns::headless;
use super::error::DatasetError;
use super::recording::Recording;
use super::sheet::{Rows, split};
use crate::drive::{DifferentialDrive, Encoder, Robot};
use crate::path::{Path, SQUARE, SpeedProfile};

const METADATA: &str = "_metadata.csv";

/// Whether a file name is that of metadata, and of which set.
pub(super) fn set_of_metadata(name: &str) -> Option<&str> {
    name.strip_suffix(METADATA)
}

/// The number of a run file of a set.
pub(super) fn run_number(name: &str, set: &str) -> Option<u32> {
    name.strip_prefix(set)?.strip_prefix("_run-")?.strip_suffix(".csv")?.parse().ok()
}

/// The robot and the path of a metadata file; the encoder's rate is left open.
pub(super) fn parse_metadata(file: &str, set: &str, text: &str) -> Result<(Robot, Option<Path>), DatasetError> {
    let metadata = Metadata { file, text };
    if let Some((line, kind)) = metadata.find("type").filter(|(_, kind)| *kind != "diff") {
        let value = super::error::quoted(kind);
        let remedy = "only differential drives (\"diff\") are read so far".into();
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
    Ok((Robot { name: format!("OptiOdom {set}"), drive, encoder }, path))
}

struct Metadata<'a> {
    file: &'a str,
    text: &'a str,
}

impl<'a> Metadata<'a> {
    fn cells(&self, key: &str) -> Option<(usize, Vec<&'a str>)> {
        let mut cells = Vec::new();
        Rows::of(self.text).find_map(|(line, text)| {
            split(text, &mut cells);
            (cells[0] == key).then(|| (line, cells[1..].to_vec()))
        })
    }

    fn find(&self, key: &str) -> Option<(usize, &'a str)> {
        self.cells(key).map(|(line, cells)| (line, cells.first().copied().unwrap_or("")))
    }

    fn positive(&self, key: &str, place: usize) -> Result<f64, DatasetError> {
        let (line, cells) = self.cells(key).ok_or_else(|| self.missing(key, "the row as OptiOdom writes it"))?;
        let cell = cells.get(place).copied().unwrap_or("");
        let value = cell.parse().ok().filter(|value: &f64| *value > 0.0 && *value < 1e9);
        value.ok_or_else(|| DatasetError::Value {
            file: self.file.to_owned(),
            line,
            key: key.to_owned(),
            value: super::error::quoted(cell),
            allowed: "a positive number".into(),
            remedy: "".into(),
        })
    }

    fn missing(&self, key: &str, example: &str) -> DatasetError {
        DatasetError::MissingKey {
            file: self.file.to_owned(),
            line: 1,
            table: "the metadata".into(),
            key: key.to_owned(),
            example: example.to_owned(),
        }
    }
}

/// The rows of a run, ticks summed up.
pub(super) fn parse_run(file: &str, text: &str) -> Result<Recording, DatasetError> {
    let names = ["time (1st)", "x (2nd)", "y (3rd)", "theta (4th)", "odoR (5th)", "odoL (6th)"];
    let mut recording = Recording {
        file: file.to_owned(),
        columns: [names[0], names[5], names[4]].map(str::to_owned),
        ..Recording::default()
    };
    let (mut left, mut right) = (0.0, 0.0);
    headless(file, text, &names, |line, cells| {
        let [time, x, y, heading, right_step, left_step] = *cells;
        (left, right) = (left + left_step, right + right_step);
        let sample = recording.time.len();
        recording.lines.push(line);
        recording.time.push(time);
        recording.counts[0].push(left);
        recording.counts[1].push(right);
        recording.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
    })?;
    Ok(recording)
}
