//! Scrub in turns on the spot.

use super::words::{deg, either};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::TurnSlip;

pub(super) static EFFECT: Entry = Entry::of::<TurnSlip>().body::<TurnSlip>();

impl Effect for TurnSlip {
    const ABOUT: About = About {
        name: "turn_slip",
        title: "slip in turns on the spot",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "share",
            "turn-slip",
            "",
            5e-3,
            (-1.0, 1.0),
            "share of the rotation that turns on the spot lose",
        )],
        equation: "Δθ ← (1 - k) Δθ  where |v_R - v_L| > |v|: a turn about a point within a wheelbase",
        physics: "Tyres that turn about the middle of their contact area scrub sideways and slip. Two wheels with casters lose up to 1 \
                  % of a turn; skid-steered robots lose a quarter to a half.",
        signature: "Every turn falls short by the same share. On a square this cannot be distinguished from E_b. Only arcs show the \
                    difference, because this slip does not change them.",
        confused_with: &["wheelbase", "scale", "turn_slip_rate", "speed_slip"],
        separated_by: "another surface or load; comparing wide arcs with turns on the spot",
        source: "Borenstein & Feng (1995), section 2 (up to 1 %); factors 1.5 to 1.9 that users set for skid-steer robots",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "90 degrees on the spot by odometry come out {} too {}.",
            deg(std::f64::consts::FRAC_PI_2 * p[0]),
            either(p[0], "small", "large")
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, stops_with};
    use crate::path::Direction;
    use std::f64::consts::{FRAC_PI_2, TAU};

    #[test]
    fn each_turn_of_the_square_falls_short_by_the_share_and_a_wide_circle_does_not() {
        for share in [0.01, -0.01] {
            let model = [("turn_slip", "share", share)];
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&model, direction);
                for (turns, stop) in stops.iter().skip(1).step_by(2).enumerate() {
                    let expected = sign * FRAC_PI_2 * (turns as f64 + 1.0) * (1.0 - share);
                    assert!((stop.heading - expected).abs() < 1e-12, "{stop:?}");
                }
            }
            assert!((circle_end_with(&model, Direction::Ccw).heading - TAU).abs() < 1e-12);
        }
    }
}
