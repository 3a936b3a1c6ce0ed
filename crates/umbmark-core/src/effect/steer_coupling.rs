//! A course that turns as the robot drives.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::SteerCoupling;

pub(super) static EFFECT: Entry = Entry::of::<SteerCoupling>().body::<SteerCoupling>();

impl Effect for SteerCoupling {
    const ABOUT: About = About {
        name: "steer_coupling",
        title: "coupling of the drive into the steering",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "rad_per_m",
            "steer-coupling",
            "rad/m",
            1.5e-3,
            (-10.0, 10.0),
            "turn of the course per metre driven",
        )],
        equation: "Δθ ← Δθ + e · forward",
        physics: "The shafts for driving and steering are concentric, and the bevel gears of one carry the other along a little. Or the \
                  wheel radii differ, which turns the base and the wheels with it.",
        signature: "Every leg bends the same way in ccw and cw, as with E_d of a differential drive (e = (E_d - 1)/b).",
        confused_with: &[],
        separated_by: "a long straight leg; steering on the spot does not show it",
        source: "kinematics; unequal radii turn the base at a mean rate, and with it the course",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Synchro);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("Each metre ahead turns the course by {} to the {}, whatever is steered.", deg(p[0]), side(p[0]))
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn sixteen_metres_turn_the_course_the_same_way_in_both_directions() {
        for coupling in [2e-3, -2e-3] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("steer_coupling", "rad_per_m", coupling)], direction);
                assert!((stops[7].heading - sign * TAU - 16.0 * coupling).abs() < 1e-12);
            }
        }
    }
}
