//! A heading that was measured by a gyro whose rate has a wrong scale.

use super::words::{deg, either};
use super::{About, ActsOn, Effect, Entry, Sight, SightLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::{Pose2, Real};
use crate::parameter::Parameter;

/// Share by which the measured heading turns further than the true one.
pub struct ReferenceHeadingScale;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceHeadingScale>().seen::<ReferenceHeadingScale>();

impl Effect for ReferenceHeadingScale {
    const ABOUT: About = About {
        name: "reference_heading_scale",
        title: "scale of the reference's heading",
        acts_on: ActsOn::Reference,
        parameters: &[Parameter::size(
            "share",
            "reference-heading-scale",
            "",
            5e-3,
            (-0.5, 0.5),
            "share by which the measured heading turns further than the true one",
        )],
        equation: "θ ← (1 + g) θ,  θ the heading since START",
        physics: "Positions come from a satellite receiver or from radio beacons, and the heading from a gyro: the scale of its rate is \
                  off. Positions stay correct.",
        signature: "Headings are off by a share of all that the robot has turned since START; the path is where it is predicted. With a \
                    wrong wheelbase the path is turned as well.",
        confused_with: &["reference_heading_drift"],
        separated_by: "ten turns on the spot, stopped by a mark on the floor: the heading must be what it was",
        source: "a gyro's scale factor; 0.5 % is assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "In a full turn the heading of the reference turns {} too {}.",
            deg(std::f64::consts::TAU * p[0]),
            either(p[0], "far", "little")
        )
    }
}

impl SightLaw for ReferenceHeadingScale {
    fn seen<T: Real>(p: &[T], _at: &Sight, pose: &mut Pose2<T>) {
        pose.heading *= p[0] + 1.0;
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn headings_are_off_by_a_share_of_what_was_turned_and_positions_stay() {
        for share in [0.01, -0.01] {
            for (direction, _) in ccw_and_cw() {
                let scaled = stops_with(&[("reference_heading_scale", "share", share)], direction);
                for (seen, plain) in scaled.iter().zip(&stops_with(&[], direction)) {
                    assert!((seen.heading - (1.0 + share) * plain.heading).abs() < 1e-12, "{seen:?} {plain:?}");
                    assert_eq!((seen.x, seen.y), (plain.x, plain.y));
                }
                assert!(scaled.last().unwrap().heading.abs() > 6.2);
            }
        }
    }
}
