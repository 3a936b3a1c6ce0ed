//! The gain of a link's two rotary encoders.

use super::words::{deg, either, percent};
use super::{About, ActsOn, Effect, Entry, LinkLaw};
use crate::drive::{DriveKind, DriveKinds, LinkReading, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;

/// Relative excess of both measured angles.
pub struct RotaryGain;

pub(super) static EFFECT: Entry = Entry::of::<RotaryGain>().link::<RotaryGain>();

impl Effect for RotaryGain {
    const ABOUT: About = About {
        name: "rotary_gain",
        title: "gain of the rotary encoders",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::size(
            "share",
            "rotary-gain",
            "",
            2e-3,
            (-0.5, 0.5),
            "how much more than there is both angles show, as a share",
        )],
        equation: "shown angle ← (1 + g) angle, of both trucks",
        physics: "A gear or belt between pivot and encoder has another ratio than assumed.",
        signature: "Legs show nothing, because there the angles are zero. In corners the trucks do not stand exactly across the link, \
                    so both creep along it while they turn it. The error is the same at every corner, and a closed path hides it.",
        confused_with: &[],
        separated_by: "the pose after one corner",
        source: "kinematics of the corner",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Clapper);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let more = either(p[0], "more", "less");
        format!(
            "Angles of the link show {} {more} than there is: a truck across it is {} off.",
            percent(p[0]),
            deg(p[0] * FRAC_PI_2)
        )
    }
}

impl LinkLaw for RotaryGain {
    fn link<T: Real>(p: &[T], shown: &mut LinkReading<T>) {
        let factor = p[0] + 1.0;
        shown.angles.iter_mut().for_each(|angle| *angle *= factor);
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, clapper_returned_with, clapper_stops_with};
    use std::f64::consts::FRAC_PI_2;

    /// Oracle: a truck that is g π/2 short of standing across creeps so much for each metre of the quarter circle, π/4 m.
    #[test]
    fn trucks_creep_in_corners_and_a_closed_path_hides_it() {
        for gain in [4e-3, -4e-3] {
            for (direction, _) in ccw_and_cw() {
                let returned = clapper_returned_with(&[("rotary_gain", "share", gain)], direction);
                assert!(returned.x.hypot(returned.y) < 0.3 * gain.abs() && returned.heading.abs() < 0.05 * gain.abs());
                let stops = clapper_stops_with(&[("rotary_gain", "share", gain)], direction);
                let crept = stops[1].x.hypot(stops[1].y);
                let expected = gain.abs() * FRAC_PI_2 * FRAC_PI_2 * 0.5;
                assert!(crept > 0.3 * expected && crept < 1.5 * expected, "{crept} {expected}");
            }
        }
    }
}
