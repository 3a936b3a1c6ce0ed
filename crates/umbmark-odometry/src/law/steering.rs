//! Laws of steered wheels.

use super::BodyLaw;
use crate::context::Here;
use crate::gearing::front_wheel;
use crate::geometry::{Displacement2, Real};

/// The true angle of a tricycle's driven wheel when the odometry takes it as zero.
///
/// `(forward, W Δθ) ← w (cos(δ + δ₀), sin(δ + δ₀)),  w (cos δ, sin δ) = believed (forward, W Δθ)`
pub struct FrontWheelZero;

impl BodyLaw for FrontWheelZero {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        steer_farther(at, motion, p[0]);
    }
}

/// Turns the driven front wheel farther to the left in a motion of the axle that it makes.
#[inline(always)]
pub(super) fn steer_farther<T: Real>(at: &Here<T>, motion: &mut Displacement2<T>, farther: T) {
    // A context without a robot has no front wheel.
    if at.axle_distance > 0.0 {
        let (ahead, across) = (motion.forward, motion.rotation * at.axle_distance);
        let (sine, cosine) = farther.sine_cosine();
        // In this form, an angle of 0 leaves every bit.
        let less = T::from(1.0) - cosine;
        motion.forward -= less * ahead + sine * across;
        motion.rotation += (sine * ahead - less * across) / at.axle_distance;
    }
}

/// Relative excess of the true steering angle of a tricycle's driven wheel.
///
/// `(forward, W Δθ) ← w (cos((1 + g) δ), sin((1 + g) δ)),  w (cos δ, sin δ) = believed (forward, W Δθ)`
pub struct FrontWheelGain;

impl BodyLaw for FrontWheelGain {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (ahead, across) = (motion.forward, motion.rotation * at.axle_distance);
        let (f, a) = (ahead.value(), across.value());
        if f != 0.0 || a != 0.0 {
            let slope = 1.0 / (f * f + a * a);
            let turned = (across * f - ahead * a) * slope;
            // `turned` is 0, and its derivative that of the angle.
            steer_farther(at, motion, p[0] * (turned + front_wheel(f, a).1));
        }
    }
}

/// The ratio of true to nominal distance between the steered wheel and the axle.
///
/// `Δθ ← Δθ / r`
pub struct AxleDistance;

impl BodyLaw for AxleDistance {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.rotation /= p[0];
    }
}

/// The true steering angle when the odometry takes it as zero.
///
/// `Δθ = forward · tan(δ + δ₀)/W,  tan δ = W · believed Δθ/forward`
pub struct SteeringZero;

impl BodyLaw for SteeringZero {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if let Some(tangent) = steered(at, motion) {
            steer_on(at, motion, tangent, p[0]);
        }
    }
}

/// Maximum tangent of a steering angle, tan of 1.4 rad: turns on the spot have no steering angle.
const MAX_TANGENT: f64 = 5.8;

/// The tangent of the steering angle of a motion; `None` for turns on the spot, and if the steering is unknown.
#[inline(always)]
pub(super) fn steered<T: Real>(at: &Here<T>, motion: &Displacement2<T>) -> Option<T> {
    let across = motion.rotation * at.axle_distance;
    let drives = at.axle_distance > 0.0 && across.value().abs() < MAX_TANGENT * motion.forward.value().abs();
    drives.then(|| across / motion.forward)
}

/// Turns the wheel, steered by an angle of this tangent, farther to the left: tan(δ + ε) = t + (1 + t²) tan ε/(1 - t tan ε).
#[inline(always)]
pub(super) fn steer_on<T: Real>(at: &Here<T>, motion: &mut Displacement2<T>, tangent: T, farther: T) {
    let (sine, cosine) = farther.sine_cosine();
    let added = (tangent * tangent + 1.0) * sine / (cosine - tangent * sine);
    motion.rotation += motion.forward * added / at.axle_distance;
}

/// Relative excess of the true steering angle.
///
/// `Δθ = forward · tan((1 + g) δ)/W,  tan δ = W · believed Δθ/forward`
pub struct SteeringGain;

impl BodyLaw for SteeringGain {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if let Some(tangent) = steered(at, motion) {
            let t = tangent.value();
            let angle = tangent.mapped(libm::atan(t), 1.0 / (1.0 + t * t));
            steer_on(at, motion, tangent, p[0] * angle);
        }
    }
}

/// Steering lost per lateral acceleration.
///
/// `Δθ = forward · tan(δ - K v² κ)/W,  κ = believed Δθ/forward,  tan δ = W κ`
pub struct Understeer;

impl BodyLaw for Understeer {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        if let Some(tangent) = steered(at, motion) {
            let acceleration = tangent * (at.speed * at.speed / at.axle_distance);
            steer_on(at, motion, tangent, -p[0] * acceleration);
        }
    }
}
