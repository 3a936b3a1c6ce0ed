//! A driven front wheel that is not straight when its counter shows zero.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::FrontWheelZero;

pub(super) static EFFECT: Entry = Entry::of::<FrontWheelZero>().body::<FrontWheelZero>();

impl Effect for FrontWheelZero {
    const ABOUT: About = About {
        name: "front_wheel_zero",
        title: "zero of the driven front wheel",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "angle_rad",
            "front-wheel-zero",
            "rad",
            3e-3,
            (-0.5, 0.5),
            "angle of the driven front wheel to the left where straight ahead is believed",
        )],
        equation: "(forward, W Δθ) ← w (cos(δ + δ₀), sin(δ + δ₀)),  w (cos δ, sin δ) = believed (forward, W Δθ)",
        physics: "The steering encoder of the driven wheel was set to zero by eye, or the wheel is not mounted as drawn.",
        signature: "Legs bend the same way in ccw and cw, as with E_d of a differential drive. In a turn on the spot the robot also \
                    moves ahead or back, by W δ₀ per radian.",
        confused_with: &[],
        separated_by: "a straight leg, driven forward and backward",
        source: "kinematics; Kallasi et al. (2017) and Sousa et al. (2022) calibrate it on tricycles",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Tricycle);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("Where straight ahead is believed, the front wheel is steered {} to the {}.", deg(p[0]), side(p[0]))
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, stops_with};
    use std::f64::consts::{FRAC_PI_2, TAU};

    /// Oracle: 4 m of the front wheel, steered by the zero, 0.34 m before the axle.
    #[test]
    fn a_leg_bends_by_the_sine_and_a_corner_moves_ahead_by_it() {
        for zero in [0.003, -0.003_f64] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("front_wheel_zero", "angle_rad", zero)], direction);
                assert!((stops[0].heading - 4.0 * zero.sin() / 0.34).abs() < 1e-9, "{:?}", stops[0]);
                let turned = stops[1].heading - stops[0].heading;
                assert!((turned - sign * FRAC_PI_2 * zero.cos()).abs() < 1e-9, "{turned}");
                let chord = (stops[1].x - stops[0].x).hypot(stops[1].y - stops[0].y);
                // An arc of a quarter turn that is 0.34 m π/2 sin δ₀ long; its chord is 2√2/π of it.
                let expected = 0.34 * FRAC_PI_2 * zero.abs() * 2.0 * 2.0_f64.sqrt() / std::f64::consts::PI;
                assert!((chord / expected - 1.0).abs() < 1e-4, "{chord} {expected}");
                let ahead = (stops[1].x - stops[0].x) * stops[0].heading.cos();
                assert!(
                    ahead * sign * zero < 0.0,
                    "to the left, a wheel steered farther than a right angle rolls back"
                );
            }
        }
    }

    /// Oracle: a circle of 2 m steers atan(0.34/2), and the front wheel rolls 4π m times √(1 + 0.17²).
    #[test]
    fn a_circle_is_steered_by_the_sum_of_both_angles() {
        for zero in [0.003, -0.003] {
            for (direction, sign) in ccw_and_cw() {
                let end = circle_end_with(&[("front_wheel_zero", "angle_rad", zero)], direction);
                let way = 2.0 * TAU * 1.0_f64.hypot(0.17);
                let expected = way * (sign * 0.17_f64.atan() + zero).sin() / 0.34;
                assert!((end.heading - expected).abs() < 1e-6, "{end:?} {expected}");
            }
        }
    }
}
