//! Slip of both wheels that grows with their speed.

use super::slip_powers::OF_WHEELS;
use super::words::{either, percent};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::SpeedSlip;

pub(super) static EFFECT: Entry = Entry::of::<SpeedSlip>().wheels::<SpeedSlip>();

impl Effect for SpeedSlip {
    const ABOUT: About = About {
        name: "speed_slip",
        title: "slip that grows with speed, both wheels",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "speed-slip",
            meaning: "share of its travel that each wheel loses per m/s of its speed",
            ..PER_SPEED
        }],
        equation: "s_w ← (1 - k |v_w|) s_w  for both wheels, v_w the speed of its rim",
        physics: CREEP,
        signature: "Legs and turns fall short by the share k v. At a single speed this is E_s, so on a square it looks like E_b.",
        confused_with: &[
            "scale",
            "wheelbase",
            "body_speed_slip",
            "forward_slip",
            "squared_speed_slip",
            "turn_slip",
            "turn_slip_rate",
        ],
        separated_by: "one straight leg at each of two speeds, measured by tape",
        source: "linear creep of a rolling tyre; 1.5 % per m/s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        creeps(p[0], "both wheels get")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &OF_WHEELS
    }
}

pub(super) const CREEP: &str = "A tyre transmits force only if it creeps, and rolling resistance grows with speed: the faster the \
     robot, the further the wheel turns beyond what it moves forward.";

/// Meaning of creep in proportion to speed for the robot.
pub(super) fn creeps(k: f64, who: &str) -> String {
    format!("At 0.5 m/s {who} {} {} than counted.", percent(0.5 * k), either(k, "less far", "farther"))
}

pub(super) const PER_SPEED: Parameter = Parameter::size("s_per_m", "", "s/m", 0.015, (-1.0, 1.0), "");

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, circle_speeds, stops_with};

    /// A leg of 4 m, ramps of 1 s to 0.2 m/s: the integral of v² is 0.04 (cruise 19 s + 2/3 of a second).
    const SQUARED: f64 = 0.04 * (19.0 + 2.0 / 3.0);

    #[test]
    fn both_wheels_shorten_the_leg_and_one_wheel_bends_it_towards_itself() {
        for k in [0.01, -0.01] {
            for (direction, _) in ccw_and_cw() {
                let leg = |name| stops_with(&[(name, "s_per_m", k)], direction)[0];
                let lost = k * SQUARED;
                assert!((4.0 - leg("speed_slip").x - lost).abs() < 1e-3 * lost.abs());
                for (name, sign) in [("speed_slip_left", 1.0), ("speed_slip_right", -1.0)] {
                    let stop = leg(name);
                    assert!((stop.heading - sign * lost / 0.34).abs() < 1e-3 * lost.abs(), "{stop:?}");
                }
            }
        }
    }

    /// Wheels that are 5 % larger roll 5 % faster than they count.
    #[test]
    fn the_speed_is_that_of_the_rim() {
        for (direction, _) in ccw_and_cw() {
            let stops = stops_with(&[("scale", "e_s", 1.05), ("speed_slip", "s_per_m", 0.01)], direction);
            let lost = 0.01 * 1.05 * 1.05 * SQUARED;
            assert!((4.2 - stops[0].x - lost).abs() < 1e-3 * lost, "{:?}", stops[0]);
        }
    }

    #[test]
    fn each_wheel_slips_at_its_own_speed_on_a_circle() {
        // The outer wheel goes 2.17 m times a full turn at 0.2 m/s with ramps of 1 s.
        let duration = std::f64::consts::TAU * 2.17 / 0.2 - 1.0 + 2.0 / 3.0;
        for (direction, sign) in ccw_and_cw() {
            let [left, right] = circle_speeds(direction).map(|v| 0.01 * v * v * duration / 0.34);
            for (name, error) in [("speed_slip", left - right), ("speed_slip_left", left), ("speed_slip_right", -right)]
            {
                let turned = circle_end_with(&[(name, "s_per_m", 0.01)], direction).heading;
                let off = turned - sign * std::f64::consts::TAU - error;
                assert!(off.abs() < 1e-3 * error.abs(), "{name} {direction:?}: {off}");
            }
        }
    }
}
