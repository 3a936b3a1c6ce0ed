//! A kick whenever the robot drives off.

use super::caster_kick::TRAIL;
use super::words::{deg, mm, side};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::LegKick;

pub(super) static EFFECT: Entry = Entry::of::<LegKick>().body::<LegKick>();

impl Effect for LegKick {
    const ABOUT: About = About {
        name: "leg_kick",
        title: "kick at the start of each leg",
        acts_on: ActsOn::Body,
        parameters: &[
            Parameter::size(
                "kick_rad",
                "leg-kick",
                "rad",
                3.5e-3,
                (-1.0, 1.0),
                "change of heading at the start of each leg ahead, counter-clockwise",
            ),
            Parameter::size(
                "back_rad",
                "leg-kick-back",
                "rad",
                3.5e-3,
                (-1.0, 1.0),
                "the same of each leg that is driven back",
            ),
            Parameter {
                flag: "leg-kick-trail",
                meaning: "way after which all but 1/e of the kick of a leg is made",
                ..TRAIL
            },
        ],
        equation: "Δθ ← Δθ + κ (e^(-d₀/λ) - e^(-d₁/λ)),  d the way since the last turn on the spot, stop or START, made while b |ω| ≤ |v|",
        physics: "One motor responds sooner than the other, one clutch engages later, or one caster is not aligned. The robot jerks to \
                  the same side whenever it drives off: after a turn on the spot, and after a stop on the way.",
        signature: "The heading steps at the start of each of the four legs, with the same sign in ccw and cw. In return poses it looks \
                    like E_d, but it does not grow along the leg.",
        confused_with: &["wheel_diameter_ratio", "direction_dependent_wheelbase"],
        separated_by: "a heading in the middle of a leg and at its end; sides of another length",
        source: "first-order theory of side-periodic errors; 0.2 degree and 5 cm are assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        let kick = |way: &str, kick: f64| (kick != 0.0).then(|| format!("{} to the {}{way}", deg(kick), side(kick)));
        let kicks = match p[1] == 0.0 {
            true => vec![kick("", p[0])],
            false => vec![kick(" driving ahead", p[0]), kick(" driving back", p[1])],
        };
        let kicks: Vec<String> = kicks.into_iter().flatten().collect();
        format!("Whenever it drives off the robot turns {}, most of it within {}.", kicks.join(" and "), mm(p[2]))
    }

    fn varies(p: &[f64]) -> bool {
        at_work(&p[..2])
    }
}

#[cfg(test)]
mod tests {
    use super::LegKick;
    use crate::drive::Robot;
    use crate::effect::Effect;
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn four_legs_are_kicked_in_one_sense_whatever_the_turns() {
        for kick in [0.004, -0.004] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("leg_kick", "kick_rad", kick)], direction);
                assert!((stops[0].heading - kick).abs() < 1e-12);
                assert!((stops[7].heading - sign * TAU - 4.0 * kick).abs() < 1e-12, "{:?}", stops[7]);
            }
        }
    }

    #[test]
    fn it_says_only_the_kicks_that_are_there() {
        let said = |ahead, back| LegKick::means(&[ahead, back, 0.05], &Robot::labmate());
        let kick = 1f64.to_radians();
        let whole = |kicks: &str| format!("Whenever it drives off the robot turns {kicks}, most of it within 50.0 mm.");
        assert_eq!(said(kick, 0.0), whole("1.00 deg to the left"));
        assert_eq!(said(0.0, -kick), whole("1.00 deg to the right driving back"));
        assert_eq!(
            said(kick, -kick),
            whole("1.00 deg to the left driving ahead and 1.00 deg to the right driving back")
        );
    }
}
