//! What effects change: one trait a place where an effect can act. `p` are its numbers, in the order of
//! [`About::parameters`](super::About::parameters).
//!
//! An effect has the laws that its [`Entry`](super::Entry) lists; what is not listed is not called.

use super::{Bump, Context, Effect, Stretch, WheelVariance};
use crate::drive::{LinkReading, WheelTravel};
use crate::geometry::{Displacement2, Pose2, Real};
use crate::random::Stream;

/// A law of the wheels. It, and what it calls, is best marked `#[inline(always)]`: then derivatives are worked out in registers as
/// wide as the machine has.
pub trait WheelLaw: Effect {
    /// Changes believed into true wheel travel \[m\].
    fn wheels<T: Real>(p: &[T], at: &Context<T>, travel: &mut WheelTravel<T>);
}

/// A law of the body; what is said of [`WheelLaw`] holds for it too.
pub trait BodyLaw: Effect {
    /// Changes the body motion that true wheel travel makes.
    fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>);
}

/// A law of the link between two trucks.
pub trait LinkLaw: Effect {
    /// Changes what the link's encoders show of it.
    fn link<T: Real>(p: &[T], shown: &mut LinkReading<T>);
}

/// A law of the clock of absolute measurements.
pub trait ClockLaw: Effect {
    /// Adds by how much older than its stamp a measurement is that is stamped `time` after the run began \[s\].
    fn late<T: Real>(p: &[T], time: f64, late: &mut T);
}

/// A law of what is measured of a true pose, other than by chance.
pub trait SightLaw: Effect {
    /// Changes the pose that a measurement shows.
    fn seen<T: Real>(p: &[T], pose: &mut Pose2<T>);
}

/// A law of white noise on the wheels.
pub trait DiffusionLaw: Effect {
    /// Variance that it gathers over a true travel.
    fn diffusion(p: &[f64], travel: &WheelTravel) -> WheelVariance;
}

/// A law of bumps.
pub trait BumpLaw: Effect {
    /// Adds the bumps that the wheels meet in a stretch, in any order.
    fn bumps(p: &[f64], stretch: &Stretch, stream: &mut Stream, met: &mut Vec<Bump>);
}

/// A law of where the robot truly stands at START, seen from where it is believed to stand.
pub trait StartLaw: Effect {
    /// Where on average.
    fn start<T: Real>(p: &[T]) -> Pose2<T>;

    /// How far from there in one run.
    fn start_scatter(p: &[f64], stream: &mut Stream) -> Pose2;
}

/// A law of the noise of absolute measurements.
pub trait MeasurementLaw: Effect {
    /// Changes a true pose into the measured one.
    fn measured(p: &[f64], stream: &mut Stream, pose: &mut Pose2);
}
