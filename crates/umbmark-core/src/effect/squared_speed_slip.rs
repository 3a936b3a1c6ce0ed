//! Slip of both wheels that grows with the square of their speed.

use super::slip_powers::OF_WHEELS;
use super::words::{either, percent};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::SquaredSpeedSlip;

pub(super) static EFFECT: Entry = Entry::of::<SquaredSpeedSlip>().wheels::<SquaredSpeedSlip>();

impl Effect for SquaredSpeedSlip {
    const ABOUT: About = About {
        name: "squared_speed_slip",
        title: "slip that grows with the square of the speed, both wheels",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter {
            flag: "squared-speed-slip",
            meaning: "share of its travel that each wheel loses at a speed of 1 m/s",
            ..PER_SQUARE
        }],
        equation: "s_w ← (1 - k v_w²) s_w  for both wheels, v_w the speed of its rim",
        physics: "A tyre creeps in proportion to the force that it transmits. The rolling resistance of tyres is the sum of a constant \
                  part and a part that grows with the square of the speed.",
        signature: "Legs and turns fall short by the share k v². At a single speed this is E_s, so on a square it looks like E_b. Between two \
                    speeds it looks like slip in proportion to speed with a larger E_s.",
        confused_with: &["speed_slip", "squared_forward_slip", "scale", "wheelbase"],
        separated_by: "one straight leg at each of three speeds, the lowest one slow, measured by tape",
        source: "rolling resistance of tyres as in T. D. Gillespie, Fundamentals of Vehicle Dynamics, 1992, chapter 4; 3 % at 1 m/s is \
                 assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        loses(p[0], "both wheels get")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn powers() -> &'static [&'static Entry] {
        &OF_WHEELS
    }
}

/// Meaning of creep in proportion to the square of the speed for the robot.
pub(super) fn loses(k: f64, who: &str) -> String {
    format!("At 0.5 m/s {who} {} {} than counted.", percent(0.25 * k), either(k, "less far", "farther"))
}

pub(super) const PER_SQUARE: Parameter = Parameter::size("s2_per_m2", "", "s^2/m^2", 0.03, (-1.0, 1.0), "");

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, circle_speeds, stops_with};

    /// A leg of 4 m, ramps of 1 s to 0.2 m/s: the integral of v³ is 0.008 (cruise 19 s + half a second).
    const CUBED: f64 = 0.008 * 19.5;

    #[test]
    fn a_leg_is_short_by_the_integral_of_the_cube_of_its_speed() {
        for name in ["squared_speed_slip", "squared_forward_slip"] {
            for k in [0.05, -0.05] {
                for (direction, _) in ccw_and_cw() {
                    let stop = stops_with(&[(name, "s2_per_m2", k)], direction)[0];
                    let lost = k * CUBED;
                    assert!((4.0 - stop.x - lost).abs() < 2e-3 * lost.abs(), "{name} {stop:?}");
                    assert!(stop.heading.abs() < 1e-9, "{name} {stop:?}");
                }
            }
        }
    }

    /// Wheels that are 5 % larger roll 5 % faster than they count.
    #[test]
    fn the_speed_is_that_of_the_rim() {
        for name in ["squared_speed_slip", "squared_forward_slip"] {
            for (direction, _) in ccw_and_cw() {
                let stops = stops_with(&[("scale", "e_s", 1.05), (name, "s2_per_m2", 0.05)], direction);
                let lost = 0.05 * 1.05_f64.powi(3) * CUBED;
                assert!((4.2 - stops[0].x - lost).abs() < 2e-3 * lost, "{name} {:?}", stops[0]);
            }
        }
    }

    #[test]
    fn on_a_circle_each_wheel_slips_at_its_own_speed_or_the_heading_is_kept() {
        // The outer wheel goes 2.17 m times a full turn at 0.2 m/s with ramps of 1 s.
        let duration = std::f64::consts::TAU * 2.17 / 0.2 - 1.0 + 0.5;
        for (direction, sign) in ccw_and_cw() {
            let [left, right] = circle_speeds(direction).map(|v| 0.05 * v.powi(3) * duration / 0.34);
            for (name, error) in [("squared_speed_slip", left - right), ("squared_forward_slip", 0.0)] {
                let turned = circle_end_with(&[(name, "s2_per_m2", 0.05)], direction).heading;
                let off = turned - sign * std::f64::consts::TAU - error;
                assert!(off.abs() < 2e-3 * error.abs() + 1e-9, "{name} {direction:?}: {off}");
            }
        }
    }
}
