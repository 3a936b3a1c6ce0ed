//! Measured (or simulated) robots in memory: runs, and how measured poses are counted.
//!
//! Files are read and written by the crate `umbmark-io`.

mod reference_frame;
pub(crate) mod stated;

pub use reference_frame::ReferenceFrame;
pub use stated::Levels;

pub use crate::run::{Mended, ReferencePose, ReturnError, Run, TickLog};

use crate::drive::Robot;
use crate::effect::TestKind;
use crate::path::{Direction, Path};
use crate::synchronise::Alignment;
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

/// Where the log of a run was found in an MCAP file or a bag.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunTopics {
    /// The run's name.
    pub run: String,
    /// Topic of the wheels.
    pub wheels: String,
    /// Topic of the absolute poses, where there were some.
    pub reference: Option<String>,
}

/// Runs that were driven one after the other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Session {
    /// Its name.
    pub name: String,
    /// Its first run, by its place among all runs; it lasts until the next session begins.
    pub first: usize,
    /// Whether it is known to drive another path than the first session.
    pub other_path: bool,
}

/// What is stated of a condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Stated {
    /// In words: one of several levels.
    Word(String),
    /// By a number, in the unit of the condition's name.
    Number(f64),
}

impl Stated {
    /// As it stands in files.
    pub fn word(&self) -> String {
        match self {
            Stated::Word(word) => word.clone(),
            Stated::Number(number) => number.to_string(),
        }
    }
}

/// Under which conditions a run was driven: session, floor, load, temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunConditions {
    /// The run's name.
    pub run: String,
    /// What is stated, each condition by its name.
    pub stated: Vec<(String, Stated)>,
}

/// A column that goes by another name than its usual one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ColumnName {
    /// Its usual name, with its unit.
    pub name: String,
    /// What stands above it in the tables.
    pub header: String,
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
    /// Names that columns have in its tables in place of the usual ones.
    pub columns: Vec<ColumnName>,
    /// Its runs.
    pub runs: Vec<Run>,
    /// The sessions of its runs, in order; empty for a single one.
    pub sessions: Vec<Session>,
    /// The conditions of its runs, where some are stated.
    pub conditions: Vec<RunConditions>,
    /// The clocks that were set while reading: one for each log whose poses came from a track with its own clock.
    pub clocks: Vec<RunClock>,
    /// The topics that were read: those of each MCAP file and bag.
    pub topics: Vec<RunTopics>,
    /// What the reader noticed and mended, one sentence each.
    pub warnings: Vec<String>,
}

/// A dataset without the robot that the question needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the nominal robot is not known: no robot.toml beside the data")]
pub struct NoRobot;

/// The columns of a return sheet: what is measured at the end of each run.
pub const RETURNS_COLUMNS: &str = "direction,run,x_abs_m,y_abs_m,theta_abs_rad,x_calc_m,y_calc_m,theta_calc_rad";

impl Dataset {
    /// The nominal robot, for questions that need one.
    pub fn nominal_robot(&self) -> Result<&Robot, NoRobot> {
        self.robot.as_ref().ok_or(NoRobot)
    }

    /// Whether a session begins with the run at this place.
    pub fn begins_session(&self, run: usize) -> bool {
        run == 0 || self.sessions.iter().any(|session| session.first == run)
    }

    /// Whether its sessions are known to drive different paths.
    pub fn drives_other_paths(&self) -> bool {
        self.sessions.iter().any(|session| session.other_path)
    }

    /// The known return errors of one test and direction, in the order of the runs.
    pub fn returns(&self, test: TestKind, direction: Direction) -> impl Iterator<Item = ReturnError> + '_ {
        let fits = move |run: &&Run| run.test == test && run.direction == Some(direction);
        self.runs.iter().filter(fits).filter_map(|run| run.returned)
    }
}
