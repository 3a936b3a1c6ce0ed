//! Crab: both wheels are misaligned to the same side.

use super::words::{deg, mm, side};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::Crab;

pub(super) static EFFECT: Entry = Entry::of::<Crab>().body::<Crab>();

impl Effect for Crab {
    const ABOUT: About = About {
        name: "crab",
        title: "crab, both wheels toed to the same side",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "angle_rad",
            "crab",
            "rad",
            5.2e-3,
            (-0.5, 0.5),
            "how far the course points to the left of the heading",
        )],
        equation: "(forward, sideways) ← R(τ) (forward, sideways)",
        physics: "The axle is not perpendicular to the robot's x axis, or both wheels have the same toe angle. The usual size is \
                  assumed as 0.3 degree; the public OptiOdom runs have 0.38 degree of it or of marker yaw.",
        signature: "The whole path is rotated about START by the angle and closes again, so return poses do not show it. Along the \
                    track, the direction of motion and the heading differ by a constant angle.",
        confused_with: &["marker_yaw", "encoder_skew", "diagonal_diameter_ratio"],
        separated_by: "from encoder skew: a second speed. From marker yaw: no drive separates them; inspect how the marker is mounted",
        source: "geometry; first-order theory of side-periodic errors on closed paths; size assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "The robot moves {} to the {} of where it faces: {} aside on each metre.",
            deg(p[0]),
            side(p[0]),
            mm(libm::tan(p[0]))
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn the_square_is_turned_about_start_by_the_angle_and_closes() {
        for angle in [0.02, -0.02] {
            let model = [("crab", "angle_rad", angle)];
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&model, direction);
                let corner = stops[3];
                let (x, y) = (4.0 - sign * angle * 4.0, sign * 4.0 + angle * 4.0);
                assert!((corner.x - x).abs() < 2e-3 && (corner.y - y).abs() < 2e-3, "{corner:?}");
                let end = stops[7];
                assert!(end.x.abs() < 1e-9 && end.y.abs() < 1e-9, "{end:?}");
            }
        }
    }
}
