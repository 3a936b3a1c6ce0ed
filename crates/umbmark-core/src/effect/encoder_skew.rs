//! Encoders that are not read at the same moment.

use super::words::{deg, either, size};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::EncoderSkew;

pub(super) static EFFECT: Entry = Entry::of::<EncoderSkew>().wheels::<EncoderSkew>();

impl Effect for EncoderSkew {
    const ABOUT: About = About {
        name: "encoder_skew",
        title: "time skew between the encoders",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::size(
            "delay_right_s",
            "encoder-skew",
            "s",
            0.01,
            (-10.0, 10.0),
            "how much later the right counter is read than the left",
        )],
        equation: "s_R ← s_R - τ Δv_R",
        physics: "The two encoders are read one after the other, or by two controllers with separate clocks. The one that is read later \
                  is ahead by its speed times the delay.",
        signature: "The heading is off by v τ/b while the robot drives and correct when it stands still, so return poses hardly show \
                    it. Along the track it looks like a crab angle.",
        confused_with: &["crab", "marker_yaw"],
        separated_by: "a second speed; the heading just before and just after a stop",
        source: "kinematics: 10 ms at 0.2 m/s is 0.34 degree with b = 0.34 m",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        format!(
            "The right counter is read {} ms {} than the left: at 0.5 m/s the heading by odometry is {} off while the robot moves.",
            size(1e3 * p[0]),
            either(p[0], "later", "sooner"),
            deg(0.5 * p[0] / robot.drive.wheelbase())
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{along_with, ccw_and_cw, circle_speeds, halfway_round_with, stops_with};

    #[test]
    fn the_heading_is_off_by_speed_times_delay_over_wheelbase_only_while_the_robot_drives() {
        for delay in [0.01, -0.01] {
            let model = [("encoder_skew", "delay_right_s", delay)];
            for (direction, sign) in ccw_and_cw() {
                let cruising = along_with(&model, direction, 2.0).rotation;
                assert!((cruising + delay * 0.2 / 0.34).abs() < 1e-12, "{cruising}");
                let stops = stops_with(&model, direction);
                assert!((stops[7].heading - sign * std::f64::consts::TAU).abs() < 1e-12);
            }
        }
    }
    #[test]
    fn on_a_circle_it_is_the_speed_of_the_right_wheel_that_counts() {
        for (direction, _) in ccw_and_cw() {
            let expected = -0.01 * circle_speeds(direction)[1] / 0.34;
            let error = halfway_round_with(&[("encoder_skew", "delay_right_s", 0.01)], direction);
            assert!((error - expected).abs() < 1e-12, "{error} {expected}");
        }
    }
}
