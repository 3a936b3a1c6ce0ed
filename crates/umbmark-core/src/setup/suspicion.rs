//! What makes the data suspicious although no fault is certain.

use super::{Jump, OutlyingReturn};

/// One suspicion.
#[derive(Clone, Debug, PartialEq)]
pub enum Suspicion {
    /// The headings of the reference are half a turn from the direction of driving, which has two possible causes.
    TailFirst {
        /// Heading of the tracked body less that of the robot, as the columns are read \[rad\].
        yaw: f64,
    },
    /// The return error of a run is far from those of the other runs of its direction.
    OutlyingReturn(OutlyingReturn),
    /// The track of a run jumps, so that its return error is not the robot's.
    JumpBeforeReturn {
        /// The run's name.
        run: String,
        /// Its first jump.
        jump: Jump,
    },
    /// The poses jump so often that the reference, or the way the counts are read, is in doubt.
    ManyJumps {
        /// Number of jumps and wrong poses.
        count: usize,
        /// Number of all poses.
        poses: usize,
    },
}

impl Suspicion {
    /// Whether a model that was fitted to such data must not be written.
    pub fn forbids_writing(&self) -> bool {
        !matches!(self, Suspicion::ManyJumps { .. })
    }

    /// In a sentence, without a full stop.
    pub fn sentence(&self) -> String {
        match self {
            Suspicion::TailFirst { yaw } => format!(
                "the measured heading is {:.1} deg from the way the robot drives: either the tracked body faces backward (write heading_backward = \
                 true under [reference] in robot.toml), or left and right are exchanged and both count backward (write wheels_exchanged, \
                 left_counts_backward and right_counts_backward = true under [robot]); E_d of the one is one over E_d of the other",
                yaw.to_degrees()
            ),
            Suspicion::OutlyingReturn(run) => format!("{}; {}", run.sentence(), run.remedy()),
            Suspicion::JumpBeforeReturn { run, jump } => jump.notice(run),
            Suspicion::ManyJumps { count, poses } => format!(
                "{count} of {poses} poses are wrong or jump: look at the reference, and whether the counts are read as the drive makes them"
            ),
        }
    }
}
