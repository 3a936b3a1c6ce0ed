//! Different zero errors of a link's two rotary encoders.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, LinkLaw};
use crate::drive::{DriveKind, DriveKinds, LinkReading, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;

/// Difference between the front and the rear angle when trucks and link are in line.
pub struct RotaryZeroDifference;

pub(super) static EFFECT: Entry = Entry::of::<RotaryZeroDifference>().link::<RotaryZeroDifference>();

impl Effect for RotaryZeroDifference {
    const ABOUT: About = About {
        name: "rotary_zero_difference",
        title: "difference of the rotary encoders' zeros",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::size(
            "angle_rad",
            "rotary-zero-difference",
            "rad",
            2e-4,
            (-0.5, 0.5),
            "what the front angle shows more than the rear one where trucks and link are in line",
        )],
        equation: "shown front ← angle + d/2,  shown rear ← angle - d/2",
        physics: "The encoders were set to zero by eye, or an axle is not perpendicular to its truck. Each reading sets a heading, so \
                  the headings of the trucks differ by d where the odometry takes them as aligned.",
        signature: "On each metre, the line through both trucks turns by d over its length. Legs bend the same way in ccw and cw, as \
                    with E_d of a differential drive. A tenth of a milliradian causes an error as large as the published one on a 7 x 4 \
                    m rectangle.",
        confused_with: &["rear_truck"],
        separated_by: "a straight leg with the correction on and off; sighting along both trucks while they stand in line",
        source: "kinematics of two trucks; the paper (section 4.5) names errors of this kind and gives no size",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Clapper);

    fn means(p: &[f64], robot: &Robot) -> String {
        let link = robot.drive.trucks().map_or(1.0, |trucks| trucks.link());
        format!("Each metre ahead turns the line of trucks by {} to the {}.", deg(p[0] / link), side(p[0]))
    }
}

impl LinkLaw for RotaryZeroDifference {
    fn link<T: Real>(p: &[T], shown: &mut LinkReading<T>) {
        let half = p[0] * 0.5;
        shown.angles[0] += half;
        shown.angles[1] -= half;
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, clapper_returned_with};

    /// Oracle: d over the link's length, 1 m, for each metre of leg; in corners the trucks stand across and neither turns it.
    #[test]
    fn legs_bend_the_same_way_in_both_directions_by_the_difference_over_the_link() {
        for difference in [5e-4, -5e-4] {
            for (direction, _) in ccw_and_cw() {
                let turned = clapper_returned_with(&[("rotary_zero_difference", "angle_rad", difference)], direction);
                assert!((turned.heading / (22.0 * difference) - 1.0).abs() < 0.05, "{turned:?}");
            }
        }
    }
}
