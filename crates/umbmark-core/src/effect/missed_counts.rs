//! Encoders that are too slow for the wheel.

use super::words::{either, percent, size};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::MissedCounts;

/// Of a wheel that misses counts, the other may seem to count this share of it twice; and of one that counts twice, the other this share.
const OTHER: f64 = 0.3;

pub(super) static EFFECT: Entry = Entry::of::<MissedCounts>().wheels::<MissedCounts>();

impl Effect for MissedCounts {
    const ABOUT: About = About {
        name: "missed_counts",
        title: "counts missed at speed",
        acts_on: ActsOn::Odometry,
        parameters: &[
            Parameter::size(
                "left_s_per_m",
                "missed-left",
                "s/m",
                0.01,
                (-1.0, 1.0),
                "travel that the left counter misses per m/s above the threshold, as a share",
            ),
            Parameter::size(
                "right_s_per_m",
                "missed-right",
                "s/m",
                0.01,
                (-1.0, 1.0),
                "travel that the right counter misses per m/s above the threshold, as a share",
            ),
            Parameter::shape(
                "threshold_m_s",
                "missed-threshold",
                "m/s",
                0.1,
                (0.0, 100.0),
                "wheel speed up to which every count is kept",
            ),
        ],
        equation: "s_w ← (1 + k_w max(0, |v_w| - v₀)) s_w",
        physics: "Counts arrive faster than an interrupt routine or an input filter can take them, and some are lost: the wheel rolls \
                  further than was counted. A negative share means that edges are counted twice.",
        signature: "Fast legs curve away from the wheel that misses counts, as with E_d. If both wheels miss counts equally, it looks \
                    like E_s. Below the threshold speed nothing shows.",
        confused_with: &["wheel_diameter_ratio", "speed_slip_left", "speed_slip_right"],
        separated_by: "lifting the robot and turning each wheel ten times, by hand or by motor, and reading its count",
        source: "reports of users of small controllers; sizes are assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        let more = |k: f64| format!("{} {}", percent(0.1 * k), either(k, "more", "less"));
        format!(
            "0.1 m/s above {} m/s the left wheel rolls {} than is counted, the right wheel {}.",
            size(p[2]),
            more(p[0]),
            more(p[1])
        )
    }

    /// Where one wheel misses about as much as the other counts twice, it is no counter that fails but a law of the yaw. Where both count
    /// twice about alike, these are wheels that slip, by another law of the speed than those of slip: fewer metres than counts.
    fn is_credible(p: &[f64]) -> bool {
        let [less, more] = if p[0].abs() < p[1].abs() { [p[0], p[1]] } else { [p[1], p[0]] };
        less >= 0.0 && more >= 0.0 || less.abs() < OTHER * more.abs()
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 0.0 || p[1] != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::MissedCounts;
    use crate::effect::Effect;
    use crate::effect::tests::{ccw_and_cw, circle_speeds, halfway_round_with, stops_with};

    #[test]
    fn a_leg_counts_short_in_cruise_and_in_the_upper_half_of_its_ramps_only() {
        // Integral of (v - 0.1) v: 0.1 * 0.2 * 19 s of cruise, and twice that of (v - 0.1) v dv / 0.2 from 0.1 to 0.2.
        let ramp = ((0.008 - 0.001) / 3.0 - 0.1 * (0.04 - 0.01) / 2.0) / 0.2;
        let integral = 0.1 * 0.2 * 19.0 + 2.0 * ramp;
        for k in [0.01, -0.01] {
            for (direction, _) in ccw_and_cw() {
                for (name, sign) in [("left_s_per_m", -1.0), ("right_s_per_m", 1.0)] {
                    let leg = stops_with(&[("missed_counts", name, k)], direction)[0];
                    let expected = sign * k * integral / 0.34;
                    assert!((leg.heading - expected).abs() < 2e-3 * expected.abs(), "{leg:?} {expected}");
                }
                let slow = [("missed_counts", "left_s_per_m", k), ("missed_counts", "threshold_m_s", 0.2)];
                assert_eq!(stops_with(&slow, direction)[0].heading, 0.0);
            }
        }
    }

    #[test]
    fn a_wheel_that_counts_twice_what_the_other_misses_or_counts_twice_is_no_fault_of_counters() {
        let credible = |left: f64, right: f64| MissedCounts::is_credible(&[left, right, 0.1]);
        assert!(credible(0.01, 0.0) && credible(0.01, 0.02) && credible(-0.002, -0.02) && credible(0.01, -0.002));
        assert!(!credible(0.01, -0.01) && !credible(-0.005, 0.004) && !credible(-0.01, -0.02));
    }

    #[test]
    fn on_a_circle_only_the_wheel_above_the_threshold_counts_short() {
        for (direction, _) in ccw_and_cw() {
            for (name, wheel, sign) in [("left_s_per_m", 0, -1.0), ("right_s_per_m", 1, 1.0)] {
                let model = [("missed_counts", name, 0.01), ("missed_counts", "threshold_m_s", 0.18)];
                let error = sign * halfway_round_with(&model, direction);
                let outer = circle_speeds(direction)[wheel] > 0.18;
                assert!(if outer { error > 0.0 } else { error == 0.0 }, "{name} {direction:?}: {error}");
            }
        }
    }
}
