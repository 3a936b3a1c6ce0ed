//! The gain of a steered wheel.

use super::words::{deg, either, percent};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::SteeringGain;

/// A usual angle of steering \[rad\].
const TWENTY: f64 = 0.349;

pub(super) static EFFECT: Entry = Entry::of::<SteeringGain>().body::<SteeringGain>();

impl Effect for SteeringGain {
    const ABOUT: About = About {
        name: "steering_gain",
        title: "gain of the steering",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "share",
            "steering-gain",
            "",
            5e-3,
            (-0.5, 0.5),
            "how much farther than believed the wheel is steered, as a share of the angle",
        )],
        equation: "Δθ = forward · tan((1 + g) δ)/W,  tan δ = W · believed Δθ/forward",
        physics: "The steering has other counts per revolution than assumed, or its linkage has another ratio than in the drawing.",
        signature: "Every corner is too sharp or too blunt, with opposite signs in ccw and cw, as with E_b of a differential drive.",
        confused_with: &["axle_distance", "understeer"],
        separated_by: "circles of two radii; a protractor at the steered wheel",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Ackermann);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let more = either(p[0], "more", "less");
        format!(
            "The wheel is steered {} {more} than is counted: 20 degrees are {}.",
            percent(p[0]),
            deg((1.0 + p[0]) * TWENTY)
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn a_circle_is_steered_by_the_share_more_and_a_leg_is_straight() {
        for share in [0.01, -0.01] {
            let model = [("steering_gain", "share", share)];
            for (direction, sign) in ccw_and_cw() {
                assert_eq!(stops_with(&model, direction)[0].heading, 0.0);
                let expected = sign * 2.0 * TAU * ((1.0 + share) * (0.34_f64 / 2.0).atan()).tan() / 0.34;
                let end = circle_end_with(&model, direction);
                assert!((end.heading - expected).abs() < 1e-6, "{end:?} {expected}");
            }
        }
    }
}
