//! A steered wheel that is not straight when its counter shows zero.

use super::words::{deg, side};
use super::{About, ActsOn, BodyLaw, Context, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The true steering angle when the odometry takes it as zero.
pub struct SteeringZero;

pub(super) static EFFECT: Entry = Entry::of::<SteeringZero>().body::<SteeringZero>();

impl Effect for SteeringZero {
    const ABOUT: About = About {
        name: "steering_zero",
        title: "zero of the steering",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "angle_rad",
            "steering-zero",
            "rad",
            3e-3,
            (-0.5, 0.5),
            "steering angle to the left where straight ahead is believed",
        )],
        equation: "Δθ = forward · tan(δ + δ₀)/W,  tan δ = W · believed Δθ/forward",
        physics: "The steering encoder was set to zero by eye, or the axle is not perpendicular to the robot's x axis.",
        signature: "Legs and corners bend the same way in ccw and cw, as with E_d of a differential drive.",
        confused_with: &[],
        separated_by: "a straight leg, driven forward and backward",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Ackermann);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("Where straight ahead is believed, the wheel is steered {} to the {}.", deg(p[0]), side(p[0]))
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl BodyLaw for SteeringZero {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>) {
        if let Some(tangent) = steered(at, motion) {
            steer_on(at, motion, tangent, p[0]);
        }
    }
}

/// Maximum tangent of a steering angle, tan of 1.4 rad: turns on the spot have no steering angle.
const MAX_TANGENT: f64 = 5.8;

/// The tangent of the steering angle of a motion; `None` for turns on the spot, and if the steering is unknown.
#[inline(always)]
pub(super) fn steered<T: Real>(at: &Context<T>, motion: &Displacement2<T>) -> Option<T> {
    let across = motion.rotation * at.axle_distance;
    let drives = at.axle_distance > 0.0 && across.value().abs() < MAX_TANGENT * motion.forward.value().abs();
    drives.then(|| across / motion.forward)
}

/// Turns the wheel, steered by an angle of this tangent, farther to the left: tan(δ + ε) = t + (1 + t²) tan ε/(1 - t tan ε).
#[inline(always)]
pub(super) fn steer_on<T: Real>(at: &Context<T>, motion: &mut Displacement2<T>, tangent: T, farther: T) {
    let (sine, cosine) = farther.sine_cosine();
    let added = (tangent * tangent + 1.0) * sine / (cosine - tangent * sine);
    motion.rotation += motion.forward * added / at.axle_distance;
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn a_leg_bends_by_the_tangent_over_the_axle_distance() {
        for zero in [0.003, -0.003_f64] {
            for (direction, _) in ccw_and_cw() {
                let stops = stops_with(&[("steering_zero", "angle_rad", zero)], direction);
                assert!((stops[0].heading - 4.0 * zero.tan() / 0.34).abs() < 1e-9, "{:?}", stops[0]);
            }
        }
    }

    /// Oracle: a circle of 2 m steers atan(0.34/2) and is 4π m long.
    #[test]
    fn a_circle_is_steered_by_the_sum_of_both_angles() {
        for zero in [0.003, -0.003] {
            for (direction, sign) in ccw_and_cw() {
                let end = circle_end_with(&[("steering_zero", "angle_rad", zero)], direction);
                let expected = 2.0 * TAU * (sign * (0.34_f64 / 2.0).atan() + zero).tan() / 0.34;
                assert!((end.heading - expected).abs() < 1e-6, "{end:?} {expected}");
            }
        }
    }
}
