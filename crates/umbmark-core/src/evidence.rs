//! What was measured of a robot, ready for models to be fitted to it.
//!
//! There are two kinds of evidence. Return poses alone (`Ends`): a square driven in both directions shows six numbers, and exact
//! small-sample tests exist. Whole tracks ([`Observed`]): tick logs with absolute poses on the way, where almost every effect
//! leaves a trace of its own. [`Level::of`] says which kind a dataset holds. `AnyEvidence` is either of them, and the trait
//! `Evidence` says what both offer.

mod drives;
pub(crate) mod ends;
mod error;
mod fitted;
mod memory;
pub(crate) mod noise_shape;
mod ratio;
pub(crate) mod tracks;

use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::{Model, ModelError, TestKind};
use crate::likelihood::{Knowledge, Observed};
use crate::setup::{Fault, Setup};
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

pub(crate) use drives::{Drive, end_poses, predict, tracked};
pub(crate) use ends::Ends;
pub use error::FitError;
pub(crate) use fitted::correlations;
pub use fitted::{Estimate, Fit, KnownBefore, Leaves, fit, fit_knowing, fit_to_returns};
pub use memory::memory_of_tests;
pub(crate) use ratio::{FAR_FIT, STARTS, is_possible};

/// How much of the runs was observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Return poses only.
    Ends,
    /// Absolute poses on the way: at stops, or all along.
    Tracks,
}

impl Level {
    /// Tracks if every run of the regular test has a log with absolute poses at three or more places; return poses otherwise.
    pub fn of(data: &Dataset) -> Level {
        let mut runs = data.runs.iter().filter(|run| run.test == TestKind::Systematic).peekable();
        let observed = runs.peek().is_some() && runs.all(|run| places(run) >= 3);
        if observed { Level::Tracks } else { Level::Ends }
    }

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Level::Ends => "end_poses",
            Level::Tracks => "tracks",
        }
    }
}

/// Number of log samples at which the pose of a run was measured.
fn places(run: &Run) -> usize {
    let mut samples: Vec<usize> = run.log.iter().flat_map(|log| log.reference.iter().map(|r| r.sample)).collect();
    samples.dedup();
    samples.len()
}

/// Measured runs that a model can be fitted to.
pub(crate) trait Evidence {
    /// How much of the runs was observed.
    fn level(&self) -> Level;

    /// The nominal robot.
    fn robot(&self) -> &Robot;

    /// What was found of the experiment before any fit.
    fn setup(&self) -> &Arc<Setup>;

    /// Columns, units and frames that contradict their names. If there are any, the robot is not judged.
    fn faults(&self) -> Vec<Fault>;

    /// Refuses a model with a formula that is not finite at some point of the path.
    fn check(&self, model: &Model) -> Result<(), ModelError>;

    /// Takes what is known besides the runs, for fits from now on.
    fn know(&mut self, knowledge: Knowledge);

    /// Fits the free parameters of a model.
    fn fit(&self, model: &Model) -> Result<Fit, FitError>;

    /// Whether no column contradicts its name.
    fn is_sound(&self) -> bool {
        self.faults().is_empty()
    }

    /// Refuses data whose columns contradict their names.
    fn check_columns(&self) -> Result<(), FitError> {
        let faults = self.faults();
        if faults.is_empty() { Ok(()) } else { Err(FitError::Faulty { faults }) }
    }
}

/// Evidence of either kind.
pub(crate) enum AnyEvidence {
    /// Return poses.
    Ends(Ends),
    /// Whole tracks.
    Tracks(Observed),
}

impl AnyEvidence {
    /// The regular runs of a dataset, as evidence of the given level.
    pub fn of(data: &Dataset, level: Level) -> Result<AnyEvidence, FitError> {
        Ok(match level {
            Level::Ends => AnyEvidence::Ends(Ends::examined(data)?),
            Level::Tracks => AnyEvidence::Tracks(tracks::of(data)?),
        })
    }
}

impl Deref for AnyEvidence {
    type Target = dyn Evidence;

    fn deref(&self) -> &Self::Target {
        match self {
            AnyEvidence::Ends(ends) => ends,
            AnyEvidence::Tracks(tracks) => tracks,
        }
    }
}

impl DerefMut for AnyEvidence {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            AnyEvidence::Ends(ends) => ends,
            AnyEvidence::Tracks(tracks) => tracks,
        }
    }
}

/// The nominal robot of a dataset.
pub(crate) fn robot_of(data: &Dataset) -> Result<&Robot, FitError> {
    data.robot.as_ref().ok_or(FitError::NoRobot)
}
