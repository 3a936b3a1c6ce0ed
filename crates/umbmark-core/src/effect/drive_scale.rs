//! The scale of a synchro drive's way.

use super::words::{either, mm};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::DriveScale;

pub(super) static EFFECT: Entry = Entry::of::<DriveScale>().body::<DriveScale>();

impl Effect for DriveScale {
    const ABOUT: About = About {
        name: "drive_scale",
        title: "scale of the drive, E_s of a synchro drive",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "e_s",
            "drive-scale",
            4e-3,
            (0.2, 5.0),
            "true / nominal way per count of the drive",
        )],
        equation: "forward ← E_s forward",
        physics: "The wheel diameter differs from the nominal one. One shaft drives all wheels and another steers them, so turns stay \
                  correct.",
        signature: "Legs are longer than the odometry says. A closed path still closes, so return poses do not show it.",
        confused_with: &[],
        separated_by: "the length of one straight leg, by tape; the pose at a stop",
        source: "kinematics; Martinelli (2002) has the same error per way",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Synchro);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let off = p[0] - 1.0;
        format!("A metre by odometry is {} too {} on the floor.", mm(off), either(off, "long", "short"))
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn legs_are_longer_and_turns_are_right() {
        for ratio in [1.01, 0.99] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("drive_scale", "e_s", ratio)], direction);
                assert!((stops[2].x - 4.0 * ratio).abs() < 1e-12 && (stops[2].y - sign * 4.0 * ratio).abs() < 1e-12);
                assert!(stops[7].x.abs() < 1e-12 && stops[7].y.abs() < 1e-12);
            }
        }
    }
}
