//! Laws of the contact with the floor.

use super::{BodyLaw, WheelLaw, size};
use crate::context::Here;
use crate::geometry::{Displacement2, Real};
use crate::travel::WheelTravel;

/// The angle between the course of the robot and its heading.
///
/// `(forward, sideways) ← R(τ) (forward, sideways)`
pub struct Crab;

impl BodyLaw for Crab {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        turn_course(motion, p[0]);
    }
}

/// Turns the course of a motion to the left, the rotation unchanged.
#[inline(always)]
pub(super) fn turn_course<T: Real>(motion: &mut Displacement2<T>, angle: T) {
    let (sine, cosine) = angle.sine_cosine();
    let Displacement2 { forward, sideways, .. } = *motion;
    motion.forward = cosine * forward - sine * sideways;
    motion.sideways = sine * forward + cosine * sideways;
}

/// The share of travel that each wheel loses per speed.
///
/// `s_w ← (1 - k |v_w|) s_w  for both wheels, v_w the speed of its rim`
pub struct SpeedSlip;

impl WheelLaw for SpeedSlip {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        slip(&mut travel.left, p[0], at, 0);
        slip(&mut travel.right, p[0], at, 1);
    }
}

/// Takes k |v| of what a wheel rolls, v the speed of its rim.
#[inline(always)]
fn slip<T: Real>(rolled: &mut T, k: T, at: &Here<T>, wheel: usize) {
    *rolled *= -k * size(*rolled, at, wheel) * at.wheel_speed[wheel].abs() + 1.0;
}

/// The share of travel that each wheel loses per square of its speed.
///
/// `s_w ← (1 - k v_w²) s_w  for both wheels, v_w the speed of its rim`
pub struct SquaredSpeedSlip;

impl WheelLaw for SquaredSpeedSlip {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        for (wheel, rolled) in [&mut travel.left, &mut travel.right].into_iter().enumerate() {
            let speed = size(*rolled, at, wheel) * at.wheel_speed[wheel];
            *rolled *= -p[0] * speed * speed + 1.0;
        }
    }
}

/// The share of travel that the left wheel loses per speed.
///
/// `s_L ← (1 - k |v_L|) s_L,  v_L the speed of its rim`
pub struct SpeedSlipLeft;

impl WheelLaw for SpeedSlipLeft {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        slip(&mut travel.left, p[0], at, 0);
    }
}

/// The share of travel that the right wheel loses per speed.
///
/// `s_R ← (1 - k |v_R|) s_R,  v_R the speed of its rim`
pub struct SpeedSlipRight;

impl WheelLaw for SpeedSlipRight {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        slip(&mut travel.right, p[0], at, 1);
    }
}

/// The share of travel that both wheels lose per speed of the body.
///
/// `s_w ← (1 - k |v|) s_w  for both wheels, v the mean speed of their rims`
pub struct BodySpeedSlip;

impl WheelLaw for BodySpeedSlip {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let kept = -p[0] * body_speed(travel, at) + 1.0;
        travel.left *= kept;
        travel.right *= kept;
    }
}

/// The share of the way ahead that is lost per speed of the body, the rotation unchanged.
///
/// `s_w ← s_w - k |v| (s_L + s_R)/2  for both wheels, v the mean speed of their rims`
pub struct ForwardSlip;

impl WheelLaw for ForwardSlip {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let lost = p[0] * body_speed(travel, at) * (travel.left + travel.right) * 0.5;
        travel.left -= lost;
        travel.right -= lost;
    }
}

/// The share of the way ahead that is lost per square of the speed of the body, the rotation unchanged.
///
/// `s_w ← s_w - k v² (s_L + s_R)/2  for both wheels, v the mean speed of their rims`
pub struct SquaredForwardSlip;

impl WheelLaw for SquaredForwardSlip {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        let speed = body_speed(travel, at);
        let lost = p[0] * speed * speed * (travel.left + travel.right) * 0.5;
        travel.left -= lost;
        travel.right -= lost;
    }
}

/// Size of the mean speed of the rims \[m/s\].
#[inline(always)]
fn body_speed<T: Real>(travel: &WheelTravel<T>, at: &Here<T>) -> T {
    let rim = |rolled: T, wheel: usize| size(rolled, at, wheel) * at.wheel_speed[wheel];
    let speed = (rim(travel.left, 0) + rim(travel.right, 1)) * 0.5;
    if speed.value() < 0.0 { -speed } else { speed }
}

/// The share of travel that each wheel loses per acceleration, and gains per deceleration.
///
/// `s_w ← (1 - k d|v_w|/dt) s_w`
pub struct AccelerationSlip;

impl WheelLaw for AccelerationSlip {
    #[inline(always)]
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>) {
        travel.left *= -p[0] * gain(at, 0) + 1.0;
        travel.right *= -p[0] * gain(at, 1) + 1.0;
    }
}

/// Rate of change of the size of a wheel's speed \[m/s²\].
fn gain<T>(at: &Here<T>, wheel: usize) -> f64 {
    if at.duration > 0.0 { at.speed_change[wheel] * at.wheel_speed[wheel].signum() / at.duration } else { 0.0 }
}

/// The share of rotation that turns on the spot lose.
///
/// `Δθ ← (1 - k) Δθ  where |v_R - v_L| > |v|: a turn about a point within a wheelbase`
pub struct TurnSlip;

impl BodyLaw for TurnSlip {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if at.turns_on_the_spot() {
            motion.rotation *= -p[0] + 1.0;
        }
    }
}

/// The share of rotation that is lost per rate of turn.
///
/// `Δθ ← (1 - k |ω|) Δθ`
pub struct TurnSlipRate;

impl BodyLaw for TurnSlipRate {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation *= -p[0] * at.turn_rate.abs() + 1.0;
    }
}

/// How much longer the effective wheelbase is in left turns than in right turns.
///
/// `Δθ ← Δθ / (1 + sgn(ω) δ/2)`
pub struct DirectionDependentWheelbase;

impl BodyLaw for DirectionDependentWheelbase {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if at.turn_rate != 0.0 {
            motion.rotation /= p[0] * (0.5 * at.turn_rate.signum()) + 1.0;
        }
    }
}

/// A change of heading over the first way after each turn, in the sense of that turn.
///
/// `Δθ ← Δθ + κ · (sense of the last turn) · (e^(-d₀/λ) - e^(-d₁/λ)),  d the way since that turn`
pub struct CasterKick;

impl BodyLaw for CasterKick {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation += p[0] * faded(at.since_turn, at.length, p[1]) * at.last_turn;
    }
}

/// The share of a kick within a piece of this length that begins so far behind the kick: e^(-d₀/λ) - e^(-d₁/λ).
#[inline(always)]
pub(super) fn faded<T: Real>(since: f64, length: f64, trail: T) -> T {
    let rate = -trail.recip();
    (rate * since).exponential() - (rate * (since + length)).exponential()
}

/// A change of heading over the first way after the robot drives off, one ahead and another back.
///
/// `Δθ ← Δθ + κ (e^(-d₀/λ) - e^(-d₁/λ)),  d the way since the last turn on the spot, stop or START`
pub struct LegKick;

impl BodyLaw for LegKick {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        // Counts that tremble in a turn on the spot are no way.
        if at.turn_rate.abs() * at.wheelbase > at.speed.abs() {
            return;
        }
        let kick = if at.speed < 0.0 { p[1] } else { p[0] };
        motion.rotation += kick * faded(at.since_stop, at.length, p[2]);
    }
}
