//! Measured (or simulated) robots: what a dataset folder holds, in memory.

use crate::drive::Robot;
use crate::effect::TestKind;
use crate::path::{Direction, Path};

/// The error of one return to START: absolute minus computed end pose (Eq. 1 of the paper), in the frame of START.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReturnError {
    /// ε_x \[m\], along the START heading.
    pub x: f64,
    /// ε_y \[m\], to the left.
    pub y: f64,
    /// ε_θ \[rad\] in (-π, π], where the heading was measured.
    pub heading: Option<f64>,
}

/// An absolute pose of the robot, in the frame of START.
#[derive(Clone, Copy, Debug, PartialEq)]
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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TickLog {
    /// Time of each sample \[s\], increasing.
    pub time: Vec<f64>,
    /// Left wheel angle \[ticks\], cumulative from START, roll-overs undone.
    pub left: Vec<f64>,
    /// Right wheel angle \[ticks\], cumulative from START, roll-overs undone.
    pub right: Vec<f64>,
    /// Absolute poses in the order of their samples: many, few, or none.
    pub reference: Vec<ReferencePose>,
}

/// One drive round the path.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What it is called: file stem or row.
    pub name: String,
    /// Its number within its direction and test, from 1.
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

/// A robot and its runs.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The nominal robot.
    pub robot: Robot,
    /// The path that it was told to drive, where that is known.
    pub path: Option<Path>,
    /// Its runs.
    pub runs: Vec<Run>,
    /// What the reader noticed and mended, one sentence each.
    pub warnings: Vec<String>,
}
