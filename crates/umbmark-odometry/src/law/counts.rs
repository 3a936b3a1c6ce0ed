//! Laws of the encoders.

use super::grip::turn_course;
use super::{BodyLaw, WheelLaw};
use crate::context::Context;
use crate::geometry::{Displacement2, Real};
use crate::travel::WheelTravel;

/// The share of its counts that each wheel misses above a speed.
///
/// `s_w ← (1 + k_w max(0, |v_w| - v₀)) s_w`
pub struct MissedCounts;

impl WheelLaw for MissedCounts {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Context<T>, travel: &mut WheelTravel<T>) {
        travel.left *= p[0] * above(at.wheel_speed[0], p[2]) + 1.0;
        travel.right *= p[1] * above(at.wheel_speed[1], p[2]) + 1.0;
    }
}

/// Excess of a wheel's speed over the threshold \[m/s\].
#[inline(always)]
fn above<T: Real>(speed: f64, threshold: T) -> T {
    let over = -threshold + speed.abs();
    if over.value() > 0.0 { over } else { T::from(0.0) }
}

/// How much later the right counter is read than the left.
///
/// `s_R ← s_R - τ Δv_R`
pub struct EncoderSkew;

impl WheelLaw for EncoderSkew {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Context<T>, travel: &mut WheelTravel<T>) {
        travel.right -= p[0] * at.speed_change[1];
    }
}

/// Euler steps of the robot's own odometry, if its pose is not recomputed from its counts.
///
/// `(forward, sideways) ← R(ω T/2) (forward, sideways),  not where the ticks were recorded`
pub struct EncoderSampling;

impl BodyLaw for EncoderSampling {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>) {
        if !at.recorded {
            turn_course(motion, p[0] * (0.5 * at.turn_rate));
        }
    }
}
