//! Misplacement at START.

use super::words::{deg, either, mm, side};
use super::{About, ActsOn, Effect, Entry, StartLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;
use crate::random::Stream;

/// The difference between the robot's true pose and the pose that its odometry is set to.
pub struct StartPose;

const EITHER_WAY: (f64, f64) = (-10.0, 10.0);
const SCATTER: (f64, f64) = (0.0, 10.0);

pub(super) static EFFECT: Entry = Entry::of::<StartPose>().start::<StartPose>();

impl Effect for StartPose {
    const ABOUT: About = About {
        name: "start_pose",
        title: "START misplacement",
        acts_on: ActsOn::Start,
        parameters: &[
            Parameter::size("x_m", "start-x", "m", 2e-3, EITHER_WAY, "constant misplacement along the heading"),
            Parameter::size("y_m", "start-y", "m", 2e-3, EITHER_WAY, "constant misplacement to the left"),
            Parameter::size(
                "heading_rad",
                "start-heading",
                "rad",
                2e-3,
                EITHER_WAY,
                "constant misalignment, counter-clockwise",
            ),
            Parameter::scatter(
                "position_sd_m",
                "start-position-scatter",
                "m",
                2e-3,
                SCATTER,
                "scatter of each coordinate from run to run",
            ),
            Parameter::scatter(
                "heading_sd_rad",
                "start-heading-scatter",
                "rad",
                2e-3,
                SCATTER,
                "scatter of the heading from run to run",
            ),
        ],
        equation: "world_from_start ← world_from_start · (x, y, δ), with (x, y, δ) ~ N(bias, diag(sd²))",
        physics: "The robot is pushed by hand to a mark on the floor. Then its odometry is set to zero, although it never stands \
                  exactly on the mark.",
        signature: "A heading error δ rotates the whole path about START. At the end of a closed path only the heading shows it. A \
                    position error shifts the return point by the same amount.",
        confused_with: &["floor_slope", "carpet_nap", "placed_bumps", "rotary_zero_mean", "reference_noise"],
        separated_by: "measuring the start pose of every run",
        source: "Borenstein & Feng (1995), section 3.4, step 1",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "The robot stands {} {} and {} to the {} of where its odometry begins, turned {} to the {}.",
            mm(p[0]),
            either(p[0], "ahead", "behind"),
            mm(p[1]),
            side(p[1]),
            deg(p[2]),
            side(p[2])
        )
    }
}

impl StartLaw for StartPose {
    fn start<T: Real>(p: &[T]) -> Pose2<T> {
        Pose2::new(p[0], p[1], p[2])
    }

    fn start_scatter(p: &[f64], stream: &mut Stream) -> Pose2 {
        let mut scatter = |sd: f64| if sd > 0.0 { sd * stream.normal() } else { 0.0 };
        Pose2::new(scatter(p[3]), scatter(p[3]), scatter(p[4]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scatter_has_the_stated_size_about_the_bias() {
        assert_eq!(StartPose::start(&[0.1, 0.2, 0.3, 0.02, 0.0]), Pose2::new(0.1, 0.2, 0.3));
        let n = 20_000;
        let mut stream = Stream::new(5, 0, 0);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let d = StartPose::start_scatter(&[0.1, 0.0, 0.0, 0.02, 0.0], &mut stream);
            assert_eq!(d.heading, 0.0);
            sum += d.x;
            squares += d.y * d.y;
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 4.0 * 0.02 / n.sqrt());
        assert!(((squares / n).sqrt() / 0.02 - 1.0).abs() < 4.0 / (2.0 * n).sqrt());
    }
}
