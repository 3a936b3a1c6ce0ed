//! What makes the data suspicious although no fault is certain.

use super::counts_factor::CountsFactor;
use super::{Jump, Misread, OutlyingReturn};

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
    /// A sheet of return errors that another reading of it would explain.
    Misread(Misread),
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
    /// Way and rotations by the reference are twice those by the wheels, or half of them.
    Doubled(CountsFactor),
    /// The wheels roll much farther than the commanded path is long, or much less.
    OtherWay(CountsFactor),
    /// Headings, which are all that was measured, turn so many times as far as the wheels turn the robot.
    OtherTurns {
        /// So many times.
        ratio: f64,
    },
    /// One wheel rolls so many times as far as the other for the same counts.
    UnequalWheels {
        /// The right wheel over the left one.
        ratio: f64,
    },
    /// Wheels and reference agree so little that neither delay nor mounting nor jumps can be told.
    LittleAgreement {
        /// Share of the motion that disagrees.
        misfit: f64,
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
            Suspicion::Misread(misread) => misread.sentence(),
            Suspicion::JumpBeforeReturn { run, jump } => jump.notice(run),
            Suspicion::ManyJumps { count, poses } => format!(
                "{count} of {poses} poses are wrong or jump: look at the reference, and whether the counts are read as the drive makes them"
            ),
            Suspicion::Doubled(factor) => format!("{}; {}", factor.sentence(), factor.remedy()),
            Suspicion::OtherWay(factor) => format!(
                "by their counts the wheels roll {:.3} times the commanded path: ticks_per_revolution, the wheel diameter or [path] is wrong; if \
                 the path is right, {}",
                1.0 / factor.ratio,
                factor.remedy()
            ),
            Suspicion::OtherTurns { ratio } => format!(
                "the measured heading turns {ratio:.3} times as far as the wheels turn the robot: wheelbase_m, the wheel diameters or \
                 ticks_per_revolution is wrong, and headings do not say which: measure the wheelbase, and the way of some turns of a wheel, with \
                 a tape"
            ),
            Suspicion::UnequalWheels { ratio } => format!(
                "by the reference the right wheel rolls {ratio:.3} times as far as the left one for the same counts, beside the nominal diameters: \
                 check that both counters count the same edges and have the same gear; if the wheels do differ, write wheel_diameter_left_m \
                 and wheel_diameter_right_m as measured with a tape"
            ),
            Suspicion::LittleAgreement { misfit } => format!(
                "the reference hardly moves as the wheels roll ({:.0} % of the motion disagrees), so that neither its delay nor wrong poses nor \
                 jumps could be looked for: check whether each file has ticks and poses of the same drive",
                100.0 * misfit
            ),
        }
    }
}
