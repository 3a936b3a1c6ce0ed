//! The length of the link between two trucks.

use super::words::{either, percent};
use super::{About, ActsOn, Effect, Entry, LinkLaw};
use crate::drive::{DriveKind, DriveKinds, LinkReading, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;

/// The ratio of the true distance of the trucks to the one that the linear encoder shows.
pub struct LinkLength;

pub(super) static EFFECT: Entry = Entry::of::<LinkLength>().link::<LinkLength>();

impl Effect for LinkLength {
    const ABOUT: About = About {
        name: "link_length",
        title: "length of the link",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::ratio(
            "ratio",
            "link-length",
            2e-3,
            (0.5, 2.0),
            "true distance of the trucks' centres over the one that the linear encoder shows",
        )],
        equation: "shown length ← length / ratio",
        physics: "The distance between the two pivots was measured wrongly, or the linear encoder has more or fewer counts per \
                  millimetre than assumed.",
        signature: "In a corner the trucks drive round the middle of the link. If the link is longer than assumed, they turn it less: \
                    the sign is opposite in ccw and cw, as with E_b of a differential drive. Legs show nothing.",
        confused_with: &["scale", "rear_truck"],
        separated_by: "the length of one leg, by tape: it shows the scale and not the link",
        source: "kinematics of the corner; the paper (section 4.5) names errors of this kind and gives no size",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Clapper);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let word = either(p[0] - 1.0, "longer", "shorter");
        format!("The link is {} {word} than its encoder shows.", percent(p[0] - 1.0))
    }
}

impl LinkLaw for LinkLength {
    fn link<T: Real>(p: &[T], shown: &mut LinkReading<T>) {
        shown.length /= p[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, clapper_returned_with};
    use std::f64::consts::TAU;

    /// Oracle: an arc of so many metres turns a link that is longer by a share by that share less, in all by 2π (1/r - 1).
    #[test]
    fn a_longer_link_turns_less_in_every_corner_and_more_scale_makes_up_for_it() {
        for ratio in [1.004, 0.996] {
            for (direction, sign) in ccw_and_cw() {
                let turned = clapper_returned_with(&[("link_length", "ratio", ratio)], direction).heading;
                let expected = sign * TAU * (1.0 / ratio - 1.0);
                assert!((turned / expected - 1.0).abs() < 0.02, "{turned} {expected}");
                let both = [("link_length", "ratio", ratio), ("scale", "e_s", ratio)];
                assert!(clapper_returned_with(&both, direction).heading.abs() < 0.01 * expected.abs());
            }
        }
    }
}
