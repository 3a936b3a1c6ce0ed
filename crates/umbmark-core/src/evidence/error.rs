//! Why a model cannot be fitted.

use crate::effect::ModelError;
use crate::likelihood::KnowledgeError;
use crate::replay::ReplayError;
use crate::setup::Fault;

/// Why a model cannot be fitted to, or compared with, the runs of a dataset.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// No nominal robot.
    #[error("the nominal robot is not known: no robot.toml beside the data")]
    NoRobot,
    /// A path that no robot of the drive can drive.
    #[error(
        "a robot with drive = \"{drive}\" cannot drive the path, shape = \"{shape}\": it makes legs and turns on the spot, no arcs"
    )]
    Path {
        /// The kind of the drive.
        drive: &'static str,
        /// The shape of the path.
        shape: &'static str,
    },
    /// A path with moves to the side, of a drive that cannot make them.
    #[error("a robot with drive = \"{drive}\" cannot drive the path, shape = \"{shape}\": it does not move sideways")]
    Sideways {
        /// The kind of the drive.
        drive: &'static str,
        /// The shape of the path.
        shape: &'static str,
    },
    /// No run with an observation that can be predicted.
    #[error(
        "none of {runs} runs can be predicted: each needs a return error and a path in robot.toml, \
         or ticks with absolute poses"
    )]
    NothingObserved {
        /// How many runs there are.
        runs: usize,
    },
    /// The log of a run that cannot be replayed.
    #[error("run {run}: {source}")]
    Log {
        /// Name of the run.
        run: String,
        /// What is wrong.
        source: ReplayError,
    },
    /// A log that cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A model that the catalogue or its bounds refuse.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Columns, units or frames that contradict their names.
    #[error("{}", Fault::refusal(.faults))]
    Faulty {
        /// Which.
        faults: Vec<Fault>,
    },
    /// Bounds or earlier measurements that mean nothing for the model.
    #[error(transparent)]
    Knowledge(#[from] KnowledgeError),
    /// A fit that did not converge.
    #[error("the fit of the model {how}; fix some of its parameters (free = false)")]
    NotConverged {
        /// How it ended.
        how: &'static str,
    },
    /// A fit that left the possible range.
    #[error("the fit of the model ran out of bounds ({source}); are signs, units and directions right?")]
    OutOfBounds {
        /// Which parameter.
        source: ModelError,
    },
}
