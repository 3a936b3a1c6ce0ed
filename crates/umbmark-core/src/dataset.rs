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
mod reference_frame;
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
pub use inspect::{Check, Coverage, Determined, Group, Inspection, LogFacts, MovesFound, ReferenceFacts, Wheels};
pub(crate) use inspect::{Done, MoveDone, moves_of};
pub use layout::{LAYOUTS, Layout};
pub use mcap::{McapProblem, Topics};
pub use model_file::ModelFile;
pub use model_text::effects_text;
pub use parameter_file::{Grade, ParameterFile, Varied, parse_parameters, read_parameters};
pub use reference_frame::ReferenceFrame;
pub use reference_track::ReferenceTrack;
pub use returns::HEADER as RETURNS_COLUMNS;
pub use robot_file::RobotFile;
pub use save::Existing;
pub use synchronise::{Alignment, BLOCKS, Measured, SynchroniseError, synchronise};
pub use template::{template, write_template};

pub use crate::run::{Mended, ReferencePose, ReturnError, Run, TickLog};

use crate::drive::Robot;
use crate::effect::TestKind;
use crate::path::{Direction, Path};
use serde::{Deserialize, Serialize};

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
    /// How the measured poses are counted in its files; those of `runs` are as they are meant to be.
    pub reference_frame: ReferenceFrame,
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

    /// What a `robot.toml` beside the same logs has to say, with `robot` in the place of the nominal one.
    pub fn robot_file(&self, robot: Robot) -> RobotFile {
        RobotFile { robot, path: self.path.clone(), reference: self.reference_frame }
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
