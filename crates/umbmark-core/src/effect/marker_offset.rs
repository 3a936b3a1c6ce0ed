//! A marker that is not over the axle's centre.

use super::words::{either, mm, side};
use super::{About, ActsOn, Effect, Entry, Sight, SightLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;

/// The lever arm from the axle's centre to the tracked point.
pub struct MarkerOffset;

pub(super) static EFFECT: Entry = Entry::of::<MarkerOffset>().seen::<MarkerOffset>();

impl Effect for MarkerOffset {
    const ABOUT: About = About {
        name: "marker_offset",
        title: "lever arm of the marker",
        acts_on: ActsOn::Reference,
        parameters: &[
            Parameter::size(
                "forward_m",
                "marker-forward",
                "m",
                5e-3,
                (-10.0, 10.0),
                "how far the marker sits before the axle's centre",
            ),
            Parameter::size(
                "left_m",
                "marker-left",
                "m",
                5e-3,
                (-10.0, 10.0),
                "how far the marker sits to the left of the axle's centre",
            ),
        ],
        equation: "(x, y) ← (x, y) + R(θ) a - a,  a = (forward, left)",
        physics: "Motion capture tracks its marker and not the middle of the axle. The frame is aligned at START, so the offset does \
                  not show there.",
        signature: "In every turn the marker moves on a circle whose radius is the offset. It is back when the heading is that of \
                    START, so return poses do not show it; stops at the corners do.",
        confused_with: &["across_wheel_offset"],
        separated_by: "one turn on the spot: the marker's path is the circle",
        source: "rigid-body geometry; 5 mm is assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "The marker sits {} {} and {} to the {} of the middle of the axle.",
            mm(p[0]),
            either(p[0], "ahead", "behind"),
            mm(p[1]),
            side(p[1])
        )
    }
}

impl SightLaw for MarkerOffset {
    fn seen<T: Real>(p: &[T], _at: &Sight, pose: &mut Pose2<T>) {
        let (sine, cosine) = pose.heading.sine_cosine();
        pose.x += cosine * p[0] - sine * p[1] - p[0];
        pose.y += sine * p[0] + cosine * p[1] - p[1];
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn the_marker_swings_about_the_axle_in_turns_and_is_back_at_the_end() {
        for (forward, left) in [(0.01, 0.0), (-0.01, 0.0), (0.0, 0.01)] {
            for (direction, sign) in ccw_and_cw() {
                let model = [("marker_offset", "forward_m", forward), ("marker_offset", "left_m", left)];
                let stops = stops_with(&model, direction);
                assert!((stops[0].x - 4.0).abs() < 1e-12 && stops[0].y.abs() < 1e-12);
                // A quarter turn takes (forward, left) to (-left, forward) when it is to the left.
                let turned = (4.0 - sign * left - forward, sign * forward - left);
                assert!((stops[1].x - turned.0).abs() < 1e-12 && (stops[1].y - turned.1).abs() < 1e-12);
                assert!(stops[7].x.abs() < 1e-12 && stops[7].y.abs() < 1e-12);
            }
        }
    }
}
