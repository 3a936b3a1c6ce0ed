//! The kick of casters that swing round after a turn.

use super::words::{deg, either, mm};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::CasterKick;

pub(super) static EFFECT: Entry = Entry::of::<CasterKick>().body::<CasterKick>();

impl Effect for CasterKick {
    const ABOUT: About = About {
        name: "caster_kick",
        title: "kick of casters after a turn",
        acts_on: ActsOn::Body,
        parameters: &[
            Parameter::size(
                "kick_rad",
                "caster-kick",
                "rad",
                3.5e-3,
                (-1.0, 1.0),
                "change of heading after a left turn, once the casters trail",
            ),
            Parameter {
                flag: "caster-trail",
                meaning: "way after which all but 1/e of the casters' kick is made",
                ..TRAIL
            },
        ],
        equation: "Δθ ← Δθ + κ · (sense of the last turn) · (e^(-d₀/λ) - e^(-d₁/λ)),  d the way since that turn",
        physics: "After a turn on the spot the casters point across the new course. When the robot drives off they swing round, and \
                  pull its rear aside until they trail again.",
        signature: "The heading steps in the first decimetres of legs 2 to 4, with opposite signs in ccw and cw, so most of the error \
                    looks like E_b. Leg 1 has no step, which leaves a closure error of -κ.",
        confused_with: &["backlash", "wheelbase"],
        separated_by: "a track; tests with and without 0.3 m of straight driving before each turn; ball casters in place of swivel \
                       casters",
        source: "users' reports of drift after a change of direction; 0.2 degree and 5 cm are assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Differential);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "After each turn the casters push the robot {} {}, most of it within {}.",
            deg(p[0]),
            either(p[0], "further round", "back"),
            mm(p[1])
        )
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 0.0
    }
}

pub(super) const TRAIL: Parameter = Parameter::shape("trail_m", "", "m", 0.05, (1e-3, 100.0), "");

#[cfg(test)]
mod tests {
    use crate::effect::tests::{along_with, ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn three_legs_are_kicked_in_the_sense_of_the_turn_before_them() {
        for kick in [0.004, -0.004] {
            let model = [("caster_kick", "kick_rad", kick), ("caster_kick", "trail_m", 0.1)];
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&model, direction);
                assert_eq!(stops[0].heading, 0.0);
                assert!((stops[7].heading - sign * (TAU + 3.0 * kick)).abs() < 1e-12, "{:?}", stops[7]);
                let inside = along_with(&model, direction, 4.2).rotation;
                let expected = sign * kick * (1.0 - libm::exp(-2.0));
                assert!((inside - expected).abs() < 0.02 * kick.abs(), "{inside} {expected}");
            }
        }
    }
}
