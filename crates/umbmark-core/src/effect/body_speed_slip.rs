//! Slip of both wheels that grows with the speed of the body.

use super::slip_powers::OF_BODY;
use super::speed_slip::{CREEP, PER_SPEED, creeps};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::BodySpeedSlip;

pub(super) static EFFECT: Entry = Entry::of::<BodySpeedSlip>().wheels::<BodySpeedSlip>();

impl Effect for BodySpeedSlip {
    const ABOUT: About = About {
        name: "body_speed_slip",
        title: "slip that grows with the body's speed, both wheels alike",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "body-speed-slip",
            meaning: "share of their travel that both wheels lose per m/s of the body's speed",
            ..PER_SPEED
        }],
        equation: "s_w ← (1 - k |v|) s_w  for both wheels, v the mean speed of their rims",
        physics: CREEP,
        signature: "Legs and arcs fall short by the share k v, and turns on the spot do not. At a single speed this is E_s. In arcs the \
                    heading loses half of what it loses where each wheel slips by its own speed.",
        confused_with: &["speed_slip", "forward_slip", "scale", "wheelbase"],
        separated_by: "an arc at each of two speeds, with its heading measured at the end",
        source: "linear creep of a rolling tyre, with the load of the whole robot on both wheels alike; 1.5 % per m/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        creeps(p[0], "the body gets")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &OF_BODY
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, circle_speeds, stops_with};

    /// A leg of 4 m, ramps of 1 s to 0.2 m/s: the integral of v² is 0.04 (cruise 19 s + 2/3 of a second).
    const SQUARED: f64 = 0.04 * (19.0 + 2.0 / 3.0);

    #[test]
    fn a_leg_is_short_as_by_slip_of_each_wheel() {
        for (name, k) in [("body_speed_slip", 0.01), ("body_speed_slip", -0.01), ("forward_slip", 0.01)] {
            for (direction, _) in ccw_and_cw() {
                let stop = stops_with(&[(name, "s_per_m", k)], direction)[0];
                let lost = k * SQUARED;
                assert!((4.0 - stop.x - lost).abs() < 1e-3 * lost.abs(), "{name} {stop:?}");
                assert!(stop.heading.abs() < 1e-9, "{name} {stop:?}");
            }
        }
    }

    /// A full turn at a mean speed v loses the share k v of it, the ramps less.
    #[test]
    fn on_a_circle_both_wheels_lose_the_same_share() {
        let duration = std::f64::consts::TAU * 2.17 / 0.2 - 1.0 + 2.0 / 3.0;
        for (direction, sign) in ccw_and_cw() {
            let [left, right] = circle_speeds(direction);
            let error = 0.01 * 0.5 * (left + right) * (left - right) * duration / 0.34;
            let end = |name| circle_end_with(&[(name, "s_per_m", 0.01)], direction).heading;
            let off = end("body_speed_slip") - sign * std::f64::consts::TAU - error;
            assert!(off.abs() < 1e-3 * error.abs(), "{direction:?}: {off}");
            let off = end("forward_slip") - sign * std::f64::consts::TAU;
            assert!(off.abs() < 1e-9, "{direction:?}: {off}");
        }
    }
}
