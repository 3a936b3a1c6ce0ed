//! Slip that grows with the rate of turn.

use super::slip_powers::IN_TURNS;
use super::words::{deg, either};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::TurnSlipRate;

pub(super) static EFFECT: Entry = Entry::of::<TurnSlipRate>().body::<TurnSlipRate>();

impl Effect for TurnSlipRate {
    const ABOUT: About = About {
        name: "turn_slip_rate",
        title: "slip that grows with the rate of turn",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "s_per_rad",
            "turn-slip-rate",
            "s/rad",
            8e-3,
            (-1.0, 1.0),
            "share of the rotation that is lost per rad/s",
        )],
        equation: "Δθ ← (1 - k |ω|) Δθ",
        physics: "The faster a robot turns, the larger the side force on its tyres, and the more they creep.",
        signature: "At a single rate of turn it looks like E_b. A turn loses less while it starts and stops than in its middle, which a \
                    dense track shows.",
        confused_with: &["wheelbase", "scale", "turn_slip", "speed_slip"],
        separated_by: "turns on the spot at two rates",
        source: "linear creep of a rolling tyre; 0.8 % per rad/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "At 1 rad/s a turn of 90 degrees by odometry comes out {} too {}, and in proportion at other rates.",
            deg(std::f64::consts::FRAC_PI_2 * p[0]),
            either(p[0], "small", "large")
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &IN_TURNS
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_quarter_turn_loses_the_mean_rate_of_its_trapezoid() {
        // Wheels at 0.2 m/s over 0.34 m: top rate w; ramps of 1 s at 0.2 m/s². The integral of w² over the turn is
        // w² (cruise + 2/3 ramp), cruise and ramp from the wheel's way of 0.267 m = 0.2 (cruise + ramp). Pieces of a
        // centimetre take the ramps in coarse steps.
        let top: f64 = 0.4 / 0.34;
        let way = 0.17 * FRAC_PI_2;
        let (ramp, cruise) = (1.0, way / 0.2 - 1.0);
        let integral = top * top * (cruise + 2.0 * ramp / 3.0);
        for k in [0.01, -0.01] {
            for (direction, sign) in ccw_and_cw() {
                let turned = stops_with(&[("turn_slip_rate", "s_per_rad", k)], direction)[1].heading;
                let expected = sign * (FRAC_PI_2 - k * integral);
                assert!((turned - expected).abs() < 0.01 * k.abs(), "{turned} {expected}");
            }
        }
    }
}
