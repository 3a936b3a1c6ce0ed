//! A base that turns as its wheels pull unevenly.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::BaseYaw;

pub(super) static EFFECT: Entry = Entry::of::<BaseYaw>().body::<BaseYaw>();

impl Effect for BaseYaw {
    const ABOUT: About = About {
        name: "base_yaw",
        title: "yaw of a synchro drive's base",
        acts_on: ActsOn::Body,
        parameters: &[
            Parameter::size(
                "cosine_rad_per_m",
                "base-yaw-cosine",
                "rad/m",
                1e-3,
                (-1.0, 1.0),
                "turn per metre with the wheels as at START; opposite on the way back",
            ),
            Parameter::size(
                "sine_rad_per_m",
                "base-yaw-sine",
                "rad/m",
                1e-3,
                (-1.0, 1.0),
                "turn per metre with the wheels a quarter turn to the left of that; opposite on the way back",
            ),
        ],
        equation: "Δθ ← Δθ + (c cos σ + s sin σ) · forward,  σ the steering since START",
        physics: "One wheel is larger than the others or is misaligned. As the wheels steer, it is now in front of the centre and now \
                  beside it, so it turns the base to one side or the other, and the wheels with the base. The odometry measures the \
                  steering angle but not the angle of the base.",
        signature: "Opposite sides of the square bend in opposite directions, so the heading error cancels and the position error does \
                    not. Return heading and return position no longer fit together, as for the paper's K2A.",
        confused_with: &["floor_slope_yaw"],
        separated_by: "starting the square with the base turned by 90 degrees; tracking a mark on the base",
        source: "kinematics of three wheels on a circle; 1 mrad per metre is assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Synchro);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let angle = libm::atan2(p[1], p[0]);
        format!(
            "The base turns by up to {} a metre, most to the left with the wheels steered {} to the {} of their place at START.",
            deg(p[0].hypot(p[1])),
            deg(angle),
            side(angle)
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn each_leg_turns_by_the_steering_and_the_sum_is_nothing() {
        for k in [1e-4, -1e-4] {
            for (direction, sign) in ccw_and_cw() {
                let cosine = stops_with(&[("base_yaw", "cosine_rad_per_m", k)], direction);
                let sine = stops_with(&[("base_yaw", "sine_rad_per_m", k)], direction);
                assert!((cosine[0].heading - 4.0 * k).abs() < 1e-12 && sine[0].heading.abs() < 1e-12);
                let corner = sign * TAU / 4.0;
                assert!((sine[2].heading - corner - sign * 4.0 * k).abs() < 1e-9, "{:?}", sine[2]);
                for end in [cosine[7], sine[7]] {
                    assert!((end.heading - sign * TAU).abs() < 1e-9 && libm::hypot(end.x, end.y) > 1e-4, "{end:?}");
                }
            }
        }
    }
}
