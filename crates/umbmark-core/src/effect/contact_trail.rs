//! Distance that the robot moves while it turns, and that is not counted.

use super::words::{either, mm};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;
use umbmark_odometry::law::ContactTrail;

pub(super) static EFFECT: Entry = Entry::of::<ContactTrail>().body::<ContactTrail>();

impl Effect for ContactTrail {
    const ABOUT: About = About {
        name: "contact_trail",
        title: "way made in turns and not counted",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "trail_m",
            "contact-trail",
            "m",
            5e-3,
            (-10.0, 10.0),
            "way per radian of turn to the left that no encoder counts",
        )],
        equation: "forward ← forward + t · Δθ",
        physics: "The wheels of a synchro drive touch the floor behind their steering axes, so they roll while they are steered. The \
                  encoder of an Ackermann drive counts a wheel at t to the left of the axle's middle, which is the inner wheel in left \
                  turns.",
        signature: "Each corner shifts the path by the same amount in the robot's own frame. On a closed path these shifts cancel, so \
                    return poses do not show them.",
        confused_with: &[],
        separated_by: "tracking the robot's centre while it steers on the spot; measuring its pose at a stop",
        source: "kinematics; first-order theory of side-periodic errors on closed paths",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Synchro).and(DriveKind::Ackermann);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let way = mm(p[0] * FRAC_PI_2);
        format!(
            "A quarter turn to the left carries the robot {way} {} that no encoder counts.",
            either(p[0], "ahead", "back")
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_corner_is_rolled_round_and_the_square_closes() {
        for trail in [0.01, -0.01] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("contact_trail", "trail_m", trail)], direction);
                // A quarter turn along an arc of radius t: ahead by t and to its side by t.
                assert!((stops[1].x - 4.0 - sign * trail * 1.0).abs() < 1e-9, "{:?}", stops[1]);
                assert!((stops[1].y - trail).abs() < 1e-9 && (stops[1].heading.abs() - FRAC_PI_2).abs() < 1e-12);
                assert!(stops[7].x.abs() < 1e-9 && stops[7].y.abs() < 1e-9);
            }
        }
    }
}
