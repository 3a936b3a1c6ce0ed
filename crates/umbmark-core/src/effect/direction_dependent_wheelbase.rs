//! A wheelbase that is not the same for left and right turns.

use super::words::mm;
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::DirectionDependentWheelbase;

pub(super) static EFFECT: Entry = Entry::of::<DirectionDependentWheelbase>().body::<DirectionDependentWheelbase>();

impl Effect for DirectionDependentWheelbase {
    const ABOUT: About = About {
        name: "direction_dependent_wheelbase",
        title: "wheelbase that depends on the sense of the turn",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "difference",
            "wheelbase-difference",
            "",
            4e-3,
            (-1.0, 1.0),
            "wheelbase in left turns less that in right turns, as a share of their mean",
        )],
        equation: "Δθ ← Δθ / (1 + sgn(ω) δ/2)",
        physics: "Coned or worn tyres, or a caster or cable that drags on one side. The contact points of the wheels move outward in \
                  turns one way and inward in turns the other way.",
        signature: "Left turns are too small and right turns too large, so the heading is off to the right in both driving directions. \
                    Return poses cannot distinguish this from E_d.",
        confused_with: &["wheel_diameter_ratio", "leg_kick"],
        separated_by: "turns on the spot in both directions; the heading before and after the turn at each corner",
        source: "first-order theory of side-periodic errors; 0.4 % is assumed",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        let b = robot.drive.wheelbase();
        format!(
            "The robot turns left as if its wheels stood {} apart, and right as if they stood {} apart.",
            mm(b * (1.0 + 0.5 * p[0])),
            mm(b * (1.0 - 0.5 * p[0]))
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use crate::path::Direction;
    use std::f64::consts::TAU;

    #[test]
    fn left_and_right_turns_err_in_the_same_sense_and_legs_not_at_all() {
        for d in [0.01, -0.01] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("direction_dependent_wheelbase", "difference", d)], direction);
                let error = stops[7].heading - sign * TAU;
                assert!((error + TAU * 0.5 * d).abs() < 2.0 * d * d, "{error}");
                assert_eq!((stops[0].y, stops[0].heading), (0.0, 0.0));
                assert_eq!(stops[1].heading, stops[2].heading);
            }
        }
    }

    #[test]
    fn a_leg_that_unequal_wheels_bend_is_no_turn() {
        let bent = [("wheel_diameter_ratio", "e_d", 1.01)];
        let both = [bent[0], ("direction_dependent_wheelbase", "difference", 0.1)];
        assert_eq!(stops_with(&both, Direction::Ccw)[0], stops_with(&bent, Direction::Ccw)[0]);
    }
}
