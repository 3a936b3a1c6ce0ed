//! A marker that is mounted with a yaw error.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, Sight, SightLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;

/// The angle between the measured and the true heading.
pub struct MarkerYaw;

pub(super) static EFFECT: Entry = Entry::of::<MarkerYaw>().seen::<MarkerYaw>();

impl Effect for MarkerYaw {
    const ABOUT: About = About {
        name: "marker_yaw",
        title: "yaw of the marker",
        acts_on: ActsOn::Reference,
        parameters: &[Parameter::size(
            "yaw_rad",
            "marker-yaw",
            "rad",
            6.6e-3,
            (-4.0, 4.0),
            "how far the measured heading is counter-clockwise of the true one",
        )],
        equation: "θ ← θ + ψ",
        physics: "The marker's axes were not aligned with the robot's. Every measured heading is off by the same angle, and every \
                  position is correct.",
        signature: "The direction of motion and the measured heading differ by a constant angle, at rest as well as in motion. A crab \
                    angle looks the same, except that it rotates the whole path about START.",
        confused_with: &["crab", "encoder_skew", "diagonal_diameter_ratio"],
        separated_by: "from encoder skew: a second speed. From a crab angle: no drive separates them; inspect how the marker is mounted",
        source: "a gauge freedom of the reference frame; 0.38 degree of it, or of crab, is in the public OptiOdom runs",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("The marker faces {} to the {} of where the robot does.", deg(p[0]), side(p[0]))
    }
}

impl SightLaw for MarkerYaw {
    fn seen<T: Real>(p: &[T], _at: &Sight, pose: &mut Pose2<T>) {
        pose.heading += p[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn with_start_turned_back_it_is_crab_wherever_the_robot_stands() {
        for yaw in [0.02, -0.02] {
            for (direction, _) in ccw_and_cw() {
                let turned = [("marker_yaw", "yaw_rad", -yaw), ("start_pose", "heading_rad", yaw)];
                let crab = [("crab", "angle_rad", yaw)];
                for (a, b) in stops_with(&turned, direction).iter().zip(stops_with(&crab, direction)) {
                    assert!((a.x - b.x).abs() < 1e-12 && (a.y - b.y).abs() < 1e-12, "{a:?} {b:?}");
                    assert!((a.heading - b.heading).abs() < 1e-12);
                }
            }
        }
    }
}
