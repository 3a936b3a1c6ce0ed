//! A steered wheel that is not straight when its counter shows zero.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::SteeringZero;

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
