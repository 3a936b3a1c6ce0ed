//! What effects change: one trait for each place where an effect can act. `p` are its numbers, in the order of
//! [`About::parameters`](super::About::parameters).
//!
//! An effect has the laws that its [`Entry`](super::Entry) lists; other laws are not called.

use super::{Bump, Effect, Filter, Sight, Stretch, WheelVariance};
use crate::drive::{LinkReading, WheelTravel};
use crate::geometry::{Pose2, Real};
use crate::random::Stream;

pub use umbmark_odometry::law::{BodyLaw, WheelLaw};

/// A law of the link between two trucks.
pub trait LinkLaw: Effect {
    /// Changes the reading of the link's encoders.
    fn link<T: Real>(p: &[T], shown: &mut LinkReading<T>);
}

/// A law of the clock of absolute measurements.
pub trait ClockLaw: Effect {
    /// Adds the age \[s\] of a measurement whose time stamp is `time` after the run began.
    fn late<T: Real>(p: &[T], time: f64, late: &mut T);
}

/// A law of a filter of absolute measurements.
pub trait FilterLaw: Effect {
    /// Sets the filter that poses go through.
    fn filter<T: Real>(p: &[T], filter: &mut Filter<T>);
}

/// A law of the deterministic error of a measurement.
pub trait SightLaw: Effect {
    /// Changes the pose that a measurement shows.
    fn seen<T: Real>(p: &[T], at: &Sight, pose: &mut Pose2<T>);
}

/// A law of white noise on the wheels.
pub trait DiffusionLaw: Effect {
    /// Variance that accumulates over a true travel.
    fn diffusion(p: &[f64], travel: &WheelTravel) -> WheelVariance;
}

/// A law of bumps.
pub trait BumpLaw: Effect {
    /// Adds the bumps that the wheels meet in a stretch, in any order.
    fn bumps(p: &[f64], stretch: &Stretch, stream: &mut Stream, met: &mut Vec<Bump>);
}

/// A law of the true pose at START, relative to the believed one.
pub trait StartLaw: Effect {
    /// Mean pose.
    fn start<T: Real>(p: &[T]) -> Pose2<T>;

    /// Deviation from the mean in one run.
    fn start_scatter(p: &[f64], stream: &mut Stream) -> Pose2;
}

/// A law of the noise of absolute measurements.
pub trait MeasurementLaw: Effect {
    /// Changes a true pose into the measured one.
    fn measured(p: &[f64], stream: &mut Stream, pose: &mut Pose2);
}
