//! The distance of the steered wheel.

use super::words::{deg, either, percent};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;
use umbmark_odometry::law::AxleDistance;

pub(super) static EFFECT: Entry = Entry::of::<AxleDistance>().body::<AxleDistance>();

impl Effect for AxleDistance {
    const ABOUT: About = About {
        name: "axle_distance",
        title: "distance of the steered wheel from the axle",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "axle-distance-ratio",
            5e-3,
            (0.2, 5.0),
            "true / nominal distance of the steered wheel from the axle",
        )],
        equation: "Δθ ← Δθ / r",
        physics: "The distance from the axle to the steered wheel was measured wrongly, or the wheel touches the floor in front of or \
                  behind its steering axis.",
        signature: "Every corner is too sharp or too blunt, with opposite signs in ccw and cw. If all corners have one radius, it \
                    cannot be distinguished from an error of the steering gain.",
        confused_with: &["steering_gain"],
        separated_by: "circles of two radii: an error of the steering gain grows faster than in proportion at large steering angles",
        source: "kinematics; Lee, Chung & Yoo (2010) calibrate cars by such a square",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Ackermann);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let off = p[0] - 1.0;
        format!(
            "The steered wheel acts as if it stood {} {} the axle than it is drawn: 90 degrees by odometry are {}.",
            percent(off),
            either(off, "farther from", "nearer to"),
            deg(FRAC_PI_2 / p[0])
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn a_longer_robot_turns_less_in_proportion() {
        for ratio in [1.01, 0.99] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("axle_distance", "ratio", ratio)], direction);
                assert!((stops[7].heading - sign * TAU / ratio).abs() < 1e-12);
            }
        }
    }
}
