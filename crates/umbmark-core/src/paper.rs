//! The experiments of Borenstein & Feng (1995), simulated, beside their numbers.
//!
//! The tables are Monte Carlo of the robots in [`preset`](crate::preset); the figures are exact kinematics without noise. Results are
//! written down (serde) under the keys of the command's `--json`.

mod figures;
mod tables;

use schemars::JsonSchema;
use serde::Serialize;

use crate::effect::ModelError;
use crate::monte_carlo::StudyError;
use crate::path::PathError;
use crate::preset::Preset;
use crate::simulate::SimulateError;
use crate::watch::Watch;

pub use figures::{
    BothWays, BumpPlace, Cluster, Hidden, Masking, Rectangle, bump_places, clusters, figure_eight, masking, rectangle,
};
pub use tables::{
    From, LinkError, PublishedNumber, RobotOfTableOne, RobotOfTableTwo, TableOne, TableTwo, table_one, table_two,
};

/// An experiment that cannot be repeated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PaperError {
    /// A study of a robot is refused.
    #[error("{robot}: {error}")]
    Study {
        /// The robot, by the name of its preset.
        robot: &'static str,
        /// Why.
        error: StudyError,
    },
    /// A model is refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A path is refused.
    #[error(transparent)]
    Path(#[from] PathError),
    /// A run cannot be driven.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// There is no such robot.
    #[error("there is no robot \"{0}\"")]
    Robot(&'static str),
    /// It was stopped.
    #[error("it was stopped before it was done")]
    Stopped,
}

/// How the tables are simulated.
#[derive(Clone, Copy)]
pub struct Bench<'a> {
    /// Simulated tests of each robot.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Who watches.
    pub watch: &'a Watch<'a>,
}

fn preset(name: &'static str) -> Result<&'static Preset, PaperError> {
    Preset::find(name).map_err(|_| PaperError::Robot(name))
}

/// Return errors of one run each way: x and y in m, heading in rad.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Returns {
    /// Counter-clockwise.
    pub ccw: [f64; 3],
    /// Clockwise.
    pub cw: [f64; 3],
}
