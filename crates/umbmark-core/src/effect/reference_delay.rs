//! A reference whose clock is behind.

use super::words::{either, mm, size};
use super::{About, ActsOn, ClockLaw, Effect, Entry};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;

/// Age of a measured pose at its time stamp.
pub struct ReferenceDelay;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceDelay>().late::<ReferenceDelay>();

impl Effect for ReferenceDelay {
    const ABOUT: About = About {
        name: "reference_delay",
        title: "delay of the reference",
        acts_on: ActsOn::Reference,
        parameters: &[Parameter::size(
            "delay_s",
            "reference-delay",
            "s",
            0.02,
            (-10.0, 10.0),
            "how much older the measured pose is than its time stamp says",
        )],
        equation: "seen(t) = true(t - τ)",
        physics: "A camera needs time to expose, compute and send before its pose gets a time stamp, usually 10 to 100 ms. At 1 m/s, 10 \
                  ms are 10 mm.",
        signature: "The measured pose is late by v τ along the course and by ω τ in turns. At rest it is correct, so return poses do \
                    not show it.",
        confused_with: &["acceleration_slip", "reference_filter", "reference_clock_rate", "wheel_lag"],
        separated_by: "a dense track; determine the delay before you judge any physical effect",
        source: "delays that makers and users of motion capture state",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "The reference shows where the robot {} {} ms {}: at 0.5 m/s that is {}.",
            either(p[0], "was", "will be"),
            size(1e3 * p[0]),
            either(p[0], "before", "later"),
            mm(0.5 * p[0])
        )
    }
}

impl ClockLaw for ReferenceDelay {
    fn late<T: Real>(p: &[T], _time: f64, late: &mut T) {
        *late += p[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{along_with, ccw_and_cw, circle, stops_with, watched_with};

    #[test]
    fn a_circle_is_seen_where_the_robot_was() {
        for delay in [0.5, -0.5] {
            for (direction, sign) in ccw_and_cw() {
                let (track, seen) = watched_with(&[("reference_delay", "delay_s", delay)], &circle(), direction);
                let (_, truth) = watched_with(&[], &circle(), direction);
                let middle = seen.len() / 2;
                let sight = track.sights()[middle];
                // On the circle about (0, ±2) the delayed pose is that of an earlier angle.
                let angle = truth[middle].heading - delay * sight.turn_rate;
                let (x, y) = (2.0 * libm::sin(sign * angle), sign * 2.0 * (1.0 - libm::cos(angle)));
                assert!((seen[middle].x - x).abs() < 1e-9 && (seen[middle].y - y).abs() < 1e-9, "{:?}", seen[middle]);
                assert!((seen[middle].heading - angle).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_robot_is_late_by_speed_times_delay_and_on_time_at_rest() {
        for (direction, _) in ccw_and_cw() {
            let model = [("reference_delay", "delay_s", 0.05)];
            assert!((along_with(&model, direction, 2.0).forward + 0.01).abs() < 1e-9);
            let end = stops_with(&model, direction)[7];
            assert!(end.x.hypot(end.y) < 1e-9);
        }
    }
}
