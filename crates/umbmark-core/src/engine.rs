//! What the encoders of a two-wheeled robot report: from the turning of the wheels to the computed pose.
//!
//! A *segment* is a piece of motion with a constant ratio of the two wheel speeds: in the plane of the two wheel angles
//! it is a straight [`WheelLine`], however the robot speeds up or slows down along it. A path is split into segments by
//! events (a corner, a bump, a slip), not by time, and the cost follows the events.
//!
//! Two kinds of odometry, both first-class:
//!
//! | kind | the counters are read | type | cost of a segment |
//! |---|---|---|---|
//! | tick-exact | at every tick | [`TickOdometry`] | O(log ticks) |
//! | sampled | at given instants | [`SampledOdometry`] | O(samples) |
//!
//! [`Integrator`] is either of them, or the slow [`oracle`] that both are held against. All of them give the same bits on
//! every machine, on every instruction set and for every order of the work: additions and multiplications only, never
//! fused, no trigonometry but the polynomials of [`geometry`](crate::geometry).
//!
//! [`RollerOdometry`] is that of three or four wheels with rollers, a move at once.
//!
//! [`Convoy`] is the odometry of two trucks that a link corrects, with the commands that follow from it.
//!
//! ```
//! use umbmark_core::engine::{Integrator, Method, Segment, TickGeometry, WheelLine};
//!
//! let metres_per_tick = std::f64::consts::PI * 0.15 / 2000.0;
//! let geometry = TickGeometry::new(metres_per_tick, metres_per_tick, 0.34)?;
//! let mut integrator = Integrator::new(geometry, Method::EveryTick);
//! // 10 000 ticks of the left wheel while the right one makes 10 010: a gentle arc to the left.
//! let line = WheelLine::from_ticks([0.0, 0.5], [10_000.0, 10_010.0])?;
//! let pose = integrator.motion(&Segment::every_tick(line)).pose;
//! assert!((pose.heading - 10.0 * metres_per_tick / 0.34).abs() < 1e-15);
//! # Ok::<(), umbmark_core::engine::EngineError>(())
//! ```

mod convoy;
mod digital_line;
#[cfg(test)]
mod double_double;
mod integrator;
mod lane;
mod mid_heading;
mod monoid;
mod motion;
pub mod oracle;
#[cfg(test)]
mod random_lines;
mod roller_odometry;
mod sampled;
mod tick_geometry;
mod tick_odometry;
mod trigonometry;
mod wheel_line;
mod word;

pub use crate::geometry::Instructions;
#[cfg(test)]
pub(crate) use convoy::tests as convoy_tests;
pub use convoy::{Convoy, ConvoyStep, Floor, Predicted, Trucks};
pub use integrator::{Integrator, Method, Segment};
pub use monoid::Monoid;
pub use motion::Motion;
pub use roller_odometry::{RollerLine, RollerOdometry};
pub use sampled::{CounterTrack, Profile, SampledOdometry, Update};
pub use tick_geometry::TickGeometry;
pub use tick_odometry::TickOdometry;
pub use wheel_line::{MAX_TICKS, UNITS_PER_TICK, WheelLine};
pub use word::{Letter, word_product};

use crate::drive::Wheel;

/// What the engine refuses to integrate.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError {
    /// A tick must be a distance.
    #[error("metres per tick of the {wheel} wheel must be positive and finite, got {value} m")]
    TickLength {
        /// The wheel in question.
        wheel: Wheel,
        /// \[m\]
        value: f64,
    },
    /// The wheelbase must be a distance, and not so small that the rotation of one tick overflows.
    #[error("wheelbase must be positive and finite, with a finite rotation per tick, got {value} m")]
    Wheelbase {
        /// \[m\]
        value: f64,
    },
    /// A start phase lies within one tick.
    #[error("start phase of the {wheel} wheel must be at least 0 and less than 1 tick, got {value} ticks")]
    Phase {
        /// The wheel in question.
        wheel: Wheel,
        /// \[ticks\]
        value: f64,
    },
    /// A segment is shorter than [`MAX_TICKS`] per wheel.
    #[error("travel of the {wheel} wheel must be within 2^30 ticks either way, got {value} ticks")]
    Travel {
        /// The wheel in question.
        wheel: Wheel,
        /// \[ticks\]
        value: f64,
    },
}
