//! A heading that was measured by a gyro with a bias.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, Sight, SightLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;

/// Rate at which the measured heading leaves the true one.
pub struct ReferenceHeadingDrift;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceHeadingDrift>().seen::<ReferenceHeadingDrift>();

impl Effect for ReferenceHeadingDrift {
    const ABOUT: About = About {
        name: "reference_heading_drift",
        title: "drift of the reference's heading",
        acts_on: ActsOn::Reference,
        parameters: &[Parameter::size(
            "rate_rad_s",
            "reference-heading-drift",
            "rad/s",
            5e-4,
            (-1.0, 1.0),
            "rate at which the measured heading turns counter-clockwise from the true one",
        )],
        equation: "θ ← θ + d t",
        physics: "Positions come from a satellite receiver or from radio beacons, and the heading from a gyro: its bias adds up. \
                  Positions stay correct.",
        signature: "Headings are off by d t since the run began, also while the robot stands; the path is where it is predicted. A robot \
                    that turns by itself bends its path as well.",
        confused_with: &["marker_yaw", "wheel_diameter_ratio", "reference_heading_scale"],
        separated_by: "a minute at rest: the heading must not move",
        source: "gyros of a few euros: 0.01 to 1 degree per second before their bias is taken off; 1.7 degrees a minute are assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("In a minute the heading of the reference drifts by {} to the {}.", deg(60.0 * p[0]), side(p[0]))
    }
}

impl SightLaw for ReferenceHeadingDrift {
    fn seen<T: Real>(p: &[T], at: &Sight, pose: &mut Pose2<T>) {
        pose.heading += p[0] * at.time;
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn headings_drift_with_time_and_positions_stay() {
        // A leg of 4 m at 0.2 m/s, with a ramp of 1 s at either end, and after a second of rest a turn of a right angle.
        let turn = 0.17 * std::f64::consts::FRAC_PI_2 / 0.2 + 1.0;
        for rate in [1e-3, -1e-3] {
            for (direction, _) in ccw_and_cw() {
                let drifted = stops_with(&[("reference_heading_drift", "rate_rad_s", rate)], direction);
                let plain = stops_with(&[], direction);
                let off = |stop: usize| drifted[stop].heading - plain[stop].heading;
                assert!((off(0) / rate - 21.0).abs() < 1e-6, "{}", off(0) / rate);
                let second = (off(2) - off(0)) / rate;
                assert!((second - (1.0 + turn + 1.0 + 21.0)).abs() < 1e-6, "{second}");
                for (a, b) in drifted.iter().zip(&plain) {
                    assert_eq!((a.x, a.y), (b.x, b.y));
                }
            }
        }
    }
}
