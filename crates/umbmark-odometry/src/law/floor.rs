//! Laws of the floor.

use super::{BodyLaw, WheelLaw};
use crate::context::Here;
use crate::geometry::{Displacement2, Real};
use crate::travel::WheelTravel;

/// A drift in a fixed direction in the room, for any heading.
///
/// `(forward, sideways) ← (forward, sideways) + R(-h) ((g_x, g_y) · length + (c_x, c_y) · |rotation|),  h the mean heading`
pub struct FloorSlope;

impl BodyLaw for FloorSlope {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        drift(p, at, motion);
        let turned = (at.turn_rate * at.duration).abs();
        let (sine, cosine) = mean_heading(at, motion).sine_cosine();
        motion.forward += (cosine * p[2] + sine * p[3]) * turned;
        motion.sideways += (cosine * p[3] - sine * p[2]) * turned;
    }
}

/// Adds a drift that is fixed in the room, (p₀, p₁) per metre driven.
#[inline(always)]
pub(super) fn drift<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
    let (sine, cosine) = mean_heading(at, motion).sine_cosine();
    motion.forward += (cosine * p[0] + sine * p[1]) * at.length;
    motion.sideways += (cosine * p[1] - sine * p[0]) * at.length;
}

#[inline(always)]
fn mean_heading<T: Real>(at: &Here<T>, motion: &Displacement2<T>) -> T {
    at.heading + motion.rotation * 0.5
}

/// A turn per metre, and per radian turned, that depends on the heading in the room.
///
/// `Δθ ← Δθ + (c cos h + s sin h) · length + (p cos h + q sin h) · |rotation|,  h the mean heading in the room`
pub struct FloorSlopeYaw;

impl BodyLaw for FloorSlopeYaw {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (sine, cosine) = (at.heading + motion.rotation * 0.5).sine_cosine();
        let turned = (at.turn_rate * at.duration).abs();
        motion.rotation += (p[0] * cosine + p[1] * sine) * at.length + (p[2] * cosine + p[3] * sine) * turned;
    }
}

/// A drift along the pile, for any heading.
///
/// `(forward, sideways) ← (forward, sideways) + R(-h) (g_x, g_y) · length,  h the mean heading`
pub struct CarpetNap;

impl BodyLaw for CarpetNap {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        drift(p, at, motion);
    }
}

/// Bumps spread evenly over the first leg, under the wheel on the inside of the path: as single bumps only in simulated runs of the
/// extended test, or on average in every run that a model predicts.
///
/// `D lost per bump, or s_in ← (1 - l) s_in on the first leg.  edge: D = 2R(ψ - sin ψ), cos ψ = 1 - h/R;  cable: D = 2(R + h/2)(φ - sin φ), cos φ = (R - h/2)/(R + h/2)`
pub struct PlacedBumps;

impl WheelLaw for PlacedBumps {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        if at.last_turn != 0.0 || at.turns_on_the_spot() {
            return;
        }
        if at.direction > 0.0 {
            travel.left *= -p[4] + 1.0;
        } else if at.direction < 0.0 {
            travel.right *= -p[4] + 1.0;
        }
    }
}
