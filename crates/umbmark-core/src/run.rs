//! One drive of a robot: its wheel counts, the absolute poses measured on the way, and its return error.

mod aside;
pub mod dead_reckoning;
mod gyro;
mod lost_time;
mod place;
mod reference_track;
pub mod resolution;

pub use gyro::{Bias, headings_of};
pub use place::{PoseRow, place};
pub use reference_track::ReferenceTrack;

use crate::effect::TestKind;
use crate::geometry::Pose2;
use crate::path::Direction;
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
    /// Of wheels with rollers, the angle of each \[ticks\], cumulative from START: what the two above were made of. Empty of other drives.
    #[serde(default)]
    pub rollers: Vec<Vec<f64>>,
    /// Absolute poses in the order of their samples: many, few, or none.
    pub reference: Vec<ReferencePose>,
    /// Whether these poses tell only how the robot moved from each to the next: those of scan matching or of visual odometry, whose errors add
    /// up.
    #[serde(default)]
    pub relative: bool,
    /// Whether these poses tell headings only; their positions are then those of the counted way along the headings.
    #[serde(default)]
    pub headings_only: bool,
    /// Defects that were corrected while it was read.
    pub mended: Mended,
    /// The recorder's clock at time 0 \[ns\], where that is of a calendar; else 0.
    #[serde(default)]
    pub begin_ns: i64,
    /// By which share the run took longer by the reference's clock than by that of the rows, where both wrote down when it began and ended; else 0.
    #[serde(default)]
    pub clock_excess: f64,
    /// That share in the step before each row, where the motion shows that time was lost unevenly; else empty.
    #[serde(default)]
    pub clock_excess_along: Vec<f64>,
    /// Where START was found.
    #[serde(default)]
    pub start: Start,
    /// Places where a wheel met a bump, relative to START \[m\]; known only for simulated runs.
    #[serde(default)]
    pub bumps: Vec<[f64; 2]>,
}

/// The START of a log in the frame of its measured poses, and how it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// START in the frame of the poses in the file: x, y \[m\] and heading \[rad\].
    pub x: f64,
    /// \[m\]
    pub y: f64,
    /// \[rad\]
    pub heading: f64,
    /// How it is known.
    pub known: StartKnown,
}

/// How START is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum StartKnown {
    /// The poses are given in the frame of START.
    #[default]
    Given,
    /// The robot was measured where it rested before it moved.
    AtRest,
    /// It was not measured: it follows from the first poses on the way and the counts until then.
    OnTheWay,
}

impl Start {
    /// As a pose.
    pub fn pose(&self) -> Pose2 {
        Pose2::new(self.x, self.y, self.heading)
    }
}

/// Number of defects of a log that were corrected while it was read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mended {
    /// Roll-overs of either counter that were undone.
    pub roll_overs: usize,
    /// Rows before which a counter was set back to zero.
    pub resets: usize,
    /// Rows out of order that were sorted by time stamp.
    pub late: usize,
    /// Rows that repeat a time stamp and were left out.
    pub repeated: usize,
    /// Poses that repeat the one before while the wheels turn and were left out.
    pub stale: usize,
    /// Poses that were filled in between measured ones and were left out.
    pub filled_in: usize,
}

/// One drive round the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Its name: file stem or row.
    pub name: String,
    /// Its number, unique within its direction and test.
    pub number: u32,
    /// Sense of driving; `None` for paths that have none.
    pub direction: Option<Direction>,
    /// Which test it belongs to.
    pub test: TestKind,
    /// Its ticks, if they were recorded.
    pub log: Option<TickLog>,
    /// Its return error, if one was measured or follows from the log.
    pub returned: Option<ReturnError>,
}
