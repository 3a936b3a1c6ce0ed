//! Measured (or simulated) robots: what a dataset folder holds, in memory, and its files.
//!
//! [`Dataset::load`] takes a folder (`robot.toml`, `returns.csv`, `runs/*.csv`, `runs/*.mcap`; or one of OptiOdom) or one
//! file of it. Inside, one file per layout reads rows (`returns`, `tick_log`, `optiodom`, `motive`, `tum`, `mcap`), a
//! `Recording` mends rows and counts, `synchronise` sets the clock of a track by the motion, `place` puts its poses into the
//! log, `start_frame` moves them into the frame of START, and an `Assembly` matches returns with logs.
//!
//! ```no_run
//! use umbmark_core::dataset::Dataset;
//! let data = Dataset::load("my_robot")?;
//! println!("{} runs of {}", data.runs.len(), data.nominal_robot()?.name);
//! # Ok::<(), umbmark_core::dataset::DatasetError>(())
//! ```

mod assembly;
mod columns;
mod dead_reckoning;
mod decimal;
mod distribution_table;
mod document;
mod error;
mod folder;
mod inspect;
mod label;
mod layout;
mod lines;
mod mcap;
mod model_file;
mod model_text;
mod motive;
#[cfg(test)]
mod mutated_input;
mod optiodom;
mod packed;
mod parameter_file;
mod place;
mod recording;
mod reference_file;
mod reference_track;
mod returns;
mod robot_file;
mod robot_text;
mod save;
mod sheet;
mod sheets;
mod stale;
mod start_frame;
mod synchronise;
mod template;
mod text;
mod tick_log;
mod tum;

pub use error::DatasetError;
pub use inspect::{
    Check, Coverage, Determined, Group, Inspection, LogFacts, MovesFound, ReferenceFacts, Wheels, WheelsFound,
};
pub(crate) use inspect::{Done, MoveDone, moves_of};
pub use layout::{LAYOUTS, Layout};
pub use mcap::{McapProblem, Topics};
pub use model_file::{parse_model, read_model};
pub use model_text::{model_text, model_text_with};
pub use parameter_file::{Grade, ParameterFile, Varied, parse_parameters, read_parameters};
pub use reference_track::ReferenceTrack;
pub use returns::HEADER as RETURNS_COLUMNS;
pub use robot_file::{parse_robot, read_robot};
pub use robot_text::robot_text;
pub use save::Existing;
pub use synchronise::{Alignment, BLOCKS, Measured, SynchroniseError, synchronise};
pub use template::{template, write_template};

use crate::drive::Robot;
use crate::effect::TestKind;
use crate::path::{Direction, Path};
use serde::{Deserialize, Serialize};

/// The error of one return to START: absolute minus computed end pose (Eq. 1 of the paper), in the frame of START.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReturnError {
    /// ε_x \[m\], along the START heading.
    pub x: f64,
    /// ε_y \[m\], to the left.
    pub y: f64,
    /// ε_θ \[rad\] in (-π, π], where the heading was measured.
    pub heading: Option<f64>,
}

/// A row of an array: x, y \[m\] and heading \[rad\], NaN where it was not measured.
impl From<[f64; 3]> for ReturnError {
    fn from([x, y, heading]: [f64; 3]) -> ReturnError {
        ReturnError { x, y, heading: Some(heading).filter(|heading| !heading.is_nan()) }
    }
}

/// An absolute pose of the robot, in the frame of START.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferencePose {
    /// Index of the tick sample it belongs to.
    pub sample: usize,
    /// \[m\]
    pub x: f64,
    /// \[m\]
    pub y: f64,
    /// \[rad\], where the heading was measured.
    pub heading: Option<f64>,
}

/// The recorded wheel angles of one run, with the absolute poses measured on the way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TickLog {
    /// Time of each sample \[s\], increasing.
    pub time: Vec<f64>,
    /// Left wheel angle \[ticks\], cumulative from START, roll-overs undone.
    pub left: Vec<f64>,
    /// Right wheel angle \[ticks\], cumulative from START, roll-overs undone.
    pub right: Vec<f64>,
    /// Absolute poses in the order of their samples: many, few, or none.
    pub reference: Vec<ReferencePose>,
    /// What was mended while it was read.
    pub mended: Mended,
    /// Where on the floor a wheel met a bump, seen from START \[m\]; known of simulated runs alone.
    #[serde(default)]
    pub bumps: Vec<[f64; 2]>,
}

/// What was mended in a log while it was read, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mended {
    /// Roll-overs of either counter that were undone.
    pub roll_overs: usize,
    /// Rows before which a counter was set back to zero.
    pub resets: usize,
    /// Rows out of order that were put where their time stamps say.
    pub late: usize,
    /// Rows that repeat a time stamp and were left out.
    pub repeated: usize,
    /// Poses that repeat the one before while the wheels turn and were left out.
    pub stale: usize,
}

/// One drive round the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// What it is called: file stem or row.
    pub name: String,
    /// Its number, unique within its direction and test.
    pub number: u32,
    /// Sense of driving; `None` for paths that have none.
    pub direction: Option<Direction>,
    /// Which test it belongs to.
    pub test: TestKind,
    /// Its ticks, where they were recorded.
    pub log: Option<TickLog>,
    /// Its return error, where one was measured or follows from the log.
    pub returned: Option<ReturnError>,
}

/// How the clock of a track ran against that of a run's ticks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunClock {
    /// The run's name.
    pub run: String,
    /// The file of the track.
    pub track: String,
    /// What the motion says.
    pub alignment: Alignment,
}

/// Where the log of a run was found in an MCAP file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunTopics {
    /// The run's name.
    pub run: String,
    /// Topic of the wheels.
    pub wheels: String,
    /// Topic of the absolute poses, where there were some.
    pub reference: Option<String>,
}

/// A robot and its runs.
#[derive(Clone, Debug, Default)]
pub struct Dataset {
    /// The nominal robot; `None` where a return sheet was given without one, which is enough for scores.
    pub robot: Option<Robot>,
    /// The path that it was told to drive, where that is known.
    pub path: Option<Path>,
    /// Its runs.
    pub runs: Vec<Run>,
    /// The clocks that were set while reading: one for each log whose poses came from a track with its own clock.
    pub clocks: Vec<RunClock>,
    /// The topics that were read: those of each MCAP log.
    pub topics: Vec<RunTopics>,
    /// What the reader noticed and mended, one sentence each.
    pub warnings: Vec<String>,
}

impl Dataset {
    /// Reads a dataset folder, an OptiOdom folder, or one file of either. Never touches what it reads.
    ///
    /// A single file is taken with the `robot.toml` beside it, if there is one.
    pub fn load(path: impl AsRef<std::path::Path>) -> Result<Dataset, DatasetError> {
        Dataset::load_with(path, &Topics::default())
    }

    /// Reads a dataset whose MCAP logs hold wheels and reference on the given topics.
    pub fn load_with(path: impl AsRef<std::path::Path>, topics: &Topics) -> Result<Dataset, DatasetError> {
        folder::load(path.as_ref(), topics)
    }

    /// The nominal robot, for questions that need one.
    pub fn nominal_robot(&self) -> Result<&Robot, DatasetError> {
        self.robot.as_ref().ok_or(DatasetError::NoRobot)
    }

    /// The known return errors of one test and direction, in the order of the runs.
    pub fn returns(&self, test: TestKind, direction: Direction) -> impl Iterator<Item = ReturnError> + '_ {
        let fits = move |run: &&Run| run.test == test && run.direction == Some(direction);
        self.runs.iter().filter(fits).filter_map(|run| run.returned)
    }
}
