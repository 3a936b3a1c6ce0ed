//! The scale of a synchro drive's steering.

use super::words::deg;
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;
use umbmark_odometry::law::SteerScale;

pub(super) static EFFECT: Entry = Entry::of::<SteerScale>().body::<SteerScale>();

impl Effect for SteerScale {
    const ABOUT: About = About {
        name: "steer_scale",
        title: "scale of the steering",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio("ratio", "steer-scale", 3e-3, (0.2, 5.0), "true / believed turn of the course")],
        equation: "Δθ ← r Δθ",
        physics: "The steering has other counts per revolution than assumed, or its belts slip.",
        signature: "Every corner is too sharp or too blunt. The return headings have opposite signs in ccw and cw, as with E_b of a \
                    differential drive (r = 1/E_b).",
        confused_with: &[],
        separated_by: "ten full turns of the steering on the spot",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Synchro);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("Where the steering counts 90 degrees the course turns by {}.", deg(p[0] * FRAC_PI_2))
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn four_corners_turn_by_the_ratio_and_legs_are_straight() {
        for ratio in [1.01, 0.99] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("steer_scale", "ratio", ratio)], direction);
                assert!(stops[0].heading == 0.0 && (stops[7].heading - sign * TAU * ratio).abs() < 1e-12);
            }
        }
    }
}
