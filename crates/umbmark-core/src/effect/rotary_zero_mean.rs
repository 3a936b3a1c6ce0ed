//! Equal zero errors of a link's two rotary encoders.

use super::words::{deg, side};
use super::{About, ActsOn, Effect, Entry, LinkLaw};
use crate::drive::{DriveKind, DriveKinds, LinkReading, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;

/// Reading of both angles when trucks and link are in line.
pub struct RotaryZeroMean;

pub(super) static EFFECT: Entry = Entry::of::<RotaryZeroMean>().link::<RotaryZeroMean>();

impl Effect for RotaryZeroMean {
    const ABOUT: About = About {
        name: "rotary_zero_mean",
        title: "mean of the rotary encoders' zeros",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::size(
            "angle_rad",
            "rotary-zero-mean",
            "rad",
            2e-3,
            (-0.5, 0.5),
            "what both angles show where trucks and link are in line",
        )],
        equation: "shown angle ← angle + a, of both trucks",
        physics: "The link is bent, or both encoders are rotated in their mounts by the same angle.",
        signature: "The heading of both trucks is a to the left of what the odometry assumes. The whole path is rotated about START and \
                    closes: only the return heading is off, by a, equally in ccw and cw.",
        confused_with: &["start_pose"],
        separated_by: "comparing the heading after the first leg with the direction of that leg; rotating START by hand does not change \
                       this error",
        source: "kinematics of two trucks; the paper (section 4.5) names errors of this kind and gives no size",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Clapper);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("Both trucks head {} to the {} of where they believe.", deg(p[0]), side(p[0]))
    }
}

impl LinkLaw for RotaryZeroMean {
    fn link<T: Real>(p: &[T], shown: &mut LinkReading<T>) {
        shown.angles.iter_mut().for_each(|angle| *angle += p[0]);
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, clapper_returned_with};

    #[test]
    fn the_return_heading_is_off_by_it_and_the_place_by_hardly_anything() {
        for zero in [3e-3, -3e-3] {
            for (direction, _) in ccw_and_cw() {
                let returned = clapper_returned_with(&[("rotary_zero_mean", "angle_rad", zero)], direction);
                assert!((returned.heading / zero - 1.0).abs() < 0.15, "{returned:?}");
                assert!(returned.x.hypot(returned.y) < 1.0 * zero.abs(), "{returned:?}");
            }
        }
    }
}
