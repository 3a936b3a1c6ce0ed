//! What can be wrong with measurements, and what to do about it.

use super::layout::messages::LogProblem;
use super::remedy::{Remedy, Words};
use std::fmt;
use umbmark_core::action::Action;
use umbmark_core::dataset::NoRobot;
use umbmark_core::remedy;

/// What makes a dataset, a robot file or a model file unusable.
///
/// Each message names the file, the line where there is one, the column or key, the value, what is allowed, and what to
/// do. `file` is the path as it was given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// A file or folder that the system does not let us read.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        reason: String,
    },
    /// What came through standard input or a named pipe, and cannot be used.
    #[error("{message}")]
    InPipe {
        /// What is wrong, as with a file.
        message: String,
    },
    /// A file or folder that the system does not let us write.
    #[error("{file}: cannot be written: {reason}")]
    Unwritable {
        /// The file.
        file: String,
        /// What the system says, or what cannot be expressed in the file.
        reason: String,
    },
    /// A file that would be overwritten.
    #[error("{file}: is there already; {}", .remedy.worded(&Words::PLAIN))]
    AlreadyThere {
        /// The file.
        file: String,
        /// What to do.
        remedy: Remedy,
    },
    /// A file or folder that is no dataset.
    #[error("{file}: is not a dataset: {found}; {}", .remedy.worded(&Words::PLAIN))]
    NotADataset {
        /// The file or folder.
        file: String,
        /// What is there.
        found: String,
        /// What to do.
        remedy: Remedy,
    },
    /// A dataset without the robot that the question needs.
    #[error(transparent)]
    NoRobot(#[from] NoRobot),
    /// A log of messages that cannot be used.
    #[error("{file}: {problem}")]
    Messages {
        /// The file.
        file: String,
        /// What is wrong with it.
        problem: Box<LogProblem>,
    },
    /// No rows.
    #[error("{file}: {found}; {remedy}")]
    NoRows {
        /// The file.
        file: String,
        /// What is there.
        found: &'static str,
        /// What to do.
        remedy: String,
    },
    /// Parameters of a controller that do not describe a robot.
    #[error("{file}: {problem}; {remedy}")]
    Controller {
        /// The file.
        file: String,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A place without a log that could be begun from.
    #[error("{file}: {found}; {}", .remedy.worded(&Words::PLAIN))]
    NoLogs {
        /// The place.
        file: String,
        /// What is there.
        found: String,
        /// What to do.
        remedy: Remedy,
    },
    /// A track with a clock of its own that the motion does not set.
    #[error("{file}: {reason}")]
    Clocks {
        /// The file of the track.
        file: String,
        /// Why, and what to do.
        reason: String,
    },
    /// No place was given to read.
    #[error("no dataset is named; give at least one folder or file")]
    NoPlace,
    /// A place that is given more than once.
    #[error("{file}: is given twice; its runs would count twice")]
    Twice {
        /// The place.
        file: String,
    },
    /// Datasets that cannot be read as one.
    #[error(transparent)]
    Joined(#[from] umbmark_core::joined::JoinError),
    /// A second track of a log.
    #[error("{file}: is a track of the same log as {first}; keep one of them")]
    TwoTracks {
        /// The file of the second one.
        file: String,
        /// That of the first.
        first: String,
    },
    /// A compressed file that cannot be unpacked.
    #[error("{file}: {reason}")]
    Packed {
        /// The file.
        file: String,
        /// Why, and what to do.
        reason: String,
    },
    /// Poses in the frame of the room that cannot be turned into the frame of START.
    #[error(
        "{file}: the track starts {distance} m from the origin and has no heading, so it cannot be turned into the frame of START; add theta_ref_rad, or write the poses as seen from START"
    )]
    NoStartHeading {
        /// The file.
        file: String,
        /// How far from the origin \[m\], rounded.
        distance: f64,
    },
    /// A line that cannot be what it is.
    #[error("{at}: {problem}")]
    Line {
        /// Where.
        at: At,
        /// What is wrong with it.
        problem: LineProblem,
    },
}

/// What is wrong with a line of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineProblem {
    /// Something that the format allows and this version does not do.
    #[error("{key} {value} is not supported yet; {remedy}")]
    NotYet {
        /// The key.
        key: String,
        /// What it was given, quoted.
        value: String,
        /// What can be done instead.
        remedy: String,
    },
    /// Bytes that are not UTF-8.
    #[error("{found}; save the file as UTF-8 text")]
    NotUtf8 {
        /// What it looks like.
        found: &'static str,
    },
    /// A cell whose bytes are not UTF-8.
    #[error("column {column}: {value} has bytes that are not UTF-8; save the file as UTF-8 text")]
    CellNotUtf8 {
        /// Name of the column, quoted, or its number from 1.
        column: String,
        /// What it holds, quoted, with a mark for each such byte.
        value: String,
    },
    /// The first line is not a header.
    #[error("the first row is data ({value}); put a header line with the column names above it, not behind a #")]
    NoHeader {
        /// Its first cell, quoted.
        value: String,
    },
    /// Cells that are not separated by commas.
    #[error(
        "the cells are separated by {found}; separate them by commas and write decimals with a point (0.123, not 0,123)"
    )]
    Separator {
        /// What separates them.
        found: &'static str,
    },
    /// A row with more or fewer cells than the header.
    #[error("{got} cells where the header has {expected}; {remedy}")]
    Ragged {
        /// Cells in the row.
        got: usize,
        /// Columns of the header.
        expected: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// A column that is needed and not there.
    #[error("there is no column {column}; {remedy}")]
    MissingColumn {
        /// The column, with its unit.
        column: String,
        /// What to do.
        remedy: String,
    },
    /// A column that nobody knows but that resembles one.
    #[error("unknown column {column}; did you mean \"{nearest}\"?")]
    UnknownColumn {
        /// The column, quoted.
        column: String,
        /// The most similar known name.
        nearest: String,
    },
    /// A column without a unit, or with one that nobody knows.
    #[error("column {column}: {found}; end its name in {allowed}")]
    Unit {
        /// The column, quoted.
        column: String,
        /// What is there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// Two units of the same quantity in one file.
    #[error(
        "column \"{first}\" and column \"{second}\" have different units; use one unit of {quantity} in the whole file"
    )]
    MixedUnits {
        /// A column.
        first: String,
        /// Another column.
        second: String,
        /// "length" or "angle".
        quantity: &'static str,
    },
    /// Two columns for the same thing.
    #[error("column \"{first}\" and column \"{second}\" say the same; keep one of them")]
    ColumnTwice {
        /// A column.
        first: String,
        /// Another column.
        second: String,
    },
    /// Two ways of saying the same return.
    #[error(
        "both end poses (\"{poses}\") and their errors (\"{errors}\") are given; keep the poses or the errors, not both"
    )]
    BothConventions {
        /// A column of a pose.
        poses: String,
        /// A column of an error.
        errors: String,
    },
    /// Columns of two references.
    #[error("there are columns of poses and of steps ({first} and {second}); keep those of one reference")]
    BothReferences {
        /// A column of poses.
        first: String,
        /// A column of steps.
        second: String,
    },
    /// A cell that cannot be what it is.
    #[error("column \"{column}\" must be {allowed}, got {value}{}", after(remedy))]
    Cell {
        /// The column.
        column: String,
        /// What it holds, quoted.
        value: String,
        /// What it may hold, with the unit.
        allowed: Box<str>,
        /// What to do; may be empty.
        remedy: Box<str>,
    },
    /// The same run twice.
    #[error("{run} stands twice, first in {first}; number the runs of each direction and test without repeating")]
    DuplicateRun {
        /// The run, in words.
        run: String,
        /// Where it stands already.
        first: String,
    },
    /// Time that does not go forward.
    #[error("column \"{column}\" must increase, got {after} s after {before} s; {remedy}")]
    Time {
        /// The column.
        column: String,
        /// Time of the row before \[s\].
        before: f64,
        /// Time of this row \[s\].
        after: f64,
        /// What to do.
        remedy: Box<str>,
    },
    /// A wheel that moved faster than a wheel can.
    #[error(
        "column \"{column}\" goes from {before} to {after} ticks in {seconds} s, {speed} m/s at the wheel where {limit} m/s is allowed; {remedy}"
    )]
    Jump {
        /// The column.
        column: String,
        /// Count of the row before.
        before: f64,
        /// Count of this row.
        after: f64,
        /// Time between them \[s\].
        seconds: f64,
        /// What that makes \[m/s\], rounded.
        speed: f64,
        /// What is allowed \[m/s\].
        limit: f64,
        /// What to do.
        remedy: Box<str>,
    },
    /// A count that jumps as a counter does that rolls over.
    #[error(
        "column \"{column}\" goes from {before} to {after} ticks, as a counter of {bits} bits does when it rolls over; say counter_bits = {bits} in robot.toml"
    )]
    RolledOver {
        /// The column.
        column: String,
        /// Count of the row before.
        before: f64,
        /// Count of this row.
        after: f64,
        /// The counter that it may be.
        bits: u32,
    },
    /// Not TOML.
    #[error("not valid TOML at character {column}: {reason}")]
    Syntax {
        /// The character in the line, from 1.
        column: usize,
        /// What the parser says.
        reason: String,
    },
    /// A key that nobody knows.
    #[error("unknown key {key} in {table}; {remedy}")]
    UnknownKey {
        /// The table, in brackets.
        table: String,
        /// The key, quoted.
        key: String,
        /// The nearest key, or all of them.
        remedy: String,
    },
    /// A key that is needed and not there.
    #[error("{table} has no {key}; add {example}")]
    MissingKey {
        /// The table, in brackets.
        table: String,
        /// The key.
        key: String,
        /// How it may look.
        example: String,
    },
    /// Two keys for the same thing.
    #[error("{second} says what {first} in line {first_line} says already; keep one of them")]
    KeyTwice {
        /// The second.
        second: String,
        /// The first.
        first: String,
        /// The line of the first.
        first_line: usize,
    },
    /// An effect that the catalogue does not have, nor one of a similar name.
    #[error("name must be the name of an effect, got {name}")]
    UnknownEffect {
        /// The name, quoted.
        name: String,
    },
    /// An effect without its name.
    #[error("[[effect]] has no name; add e.g. name = \"wheelbase\"")]
    NoEffectName,
    /// A value that cannot be.
    #[error("{key} must be {allowed}, got {value}{}", after(remedy))]
    Value {
        /// The key.
        key: String,
        /// What it was given.
        value: String,
        /// What it may be, with the unit.
        allowed: Box<str>,
        /// What to do; may be empty.
        remedy: Box<str>,
    },
}

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct At {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
}

impl At {
    pub(super) fn new(file: impl Into<String>, line: usize) -> At {
        At { file: file.into(), line }
    }

    pub(super) fn refuse(self, problem: LineProblem) -> DatasetError {
        DatasetError::Line { at: self, problem }
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

impl DatasetError {
    /// The line that the message begins with, where it does.
    pub fn at(&self) -> Option<&At> {
        match self {
            DatasetError::Line { at, .. } => Some(at),
            _ => None,
        }
    }

    /// The message, which names the arguments as an edge does.
    pub fn worded(&self, words: &Words) -> String {
        match self {
            DatasetError::AlreadyThere { file, remedy } => {
                format!("{file}: is there already; {}", remedy.worded(words))
            }
            DatasetError::NotADataset { file, found, remedy } => {
                format!("{file}: is not a dataset: {found}; {}", remedy.worded(words))
            }
            DatasetError::NoLogs { file, found, remedy } => format!("{file}: {found}; {}", remedy.worded(words)),
            DatasetError::NoRobot(error) => format!("{error}{}", words.behind(remedy::of(error))),
            DatasetError::Line { problem: LineProblem::UnknownEffect { .. } | LineProblem::NoEffectName, .. } => {
                format!("{self}{}", words.behind(Some(Action::ListEffects)))
            }
            DatasetError::Messages { file, problem } => format!("{file}: {}", problem.worded(words)),
            _ => self.to_string(),
        }
    }
}

fn after(remedy: &str) -> String {
    if remedy.is_empty() { String::new() } else { format!("; {remedy}") }
}

/// A piece of a file as it may be shown: quoted, without control characters, and not longer than a few words.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut shown: String = text.chars().take(LONGEST).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    format!("{shown:?}")
}

/// "did you mean ...?", where something is near.
pub(super) fn did_you_mean<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    umbmark_core::parameter::nearest(word, names).map(|name| format!("did you mean \"{name}\"?")).unwrap_or_default()
}
