//! The gain of a driven front wheel's steering.

use super::words::{deg, either, percent};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::FrontWheelGain;

/// A usual angle of steering \[rad\].
const TWENTY: f64 = 0.349;

pub(super) static EFFECT: Entry = Entry::of::<FrontWheelGain>().body::<FrontWheelGain>();

impl Effect for FrontWheelGain {
    const ABOUT: About = About {
        name: "front_wheel_gain",
        title: "gain of the driven front wheel's steering",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "share",
            "front-wheel-gain",
            "",
            5e-3,
            (-0.5, 0.5),
            "how much farther than believed the driven front wheel is steered, as a share of the angle",
        )],
        equation: "(forward, W Δθ) ← w (cos((1 + g) δ), sin((1 + g) δ)),  w (cos δ, sin δ) = believed (forward, W Δθ)",
        physics: "The steering of the driven wheel has other counts per revolution than assumed.",
        signature: "Curves are too sharp or too blunt. In a turn on the spot the robot also moves ahead or back, the same way in ccw \
                    and cw: a wheel steered too far rolls back.",
        confused_with: &[],
        separated_by: "turns on the spot, tracked: the size of the turn hardly changes, but the place does; a protractor at the front \
                       wheel",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Tricycle);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let more = either(p[0], "more", "less");
        format!(
            "The front wheel is steered {} {more} than is counted: 20 degrees are {}.",
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
    use std::f64::consts::{FRAC_PI_2, TAU};

    #[test]
    fn a_circle_is_steered_by_the_share_more_and_a_leg_is_straight() {
        for share in [0.01, -0.01] {
            let model = [("front_wheel_gain", "share", share)];
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&model, direction);
                assert_eq!(stops[0].heading, 0.0);
                // Steered by (1 + g) times a right angle, the wheel rolls 0.34 m π/2 and the axle moves back by its part.
                let turned = stops[1].heading;
                assert!((turned - sign * FRAC_PI_2 * (share * FRAC_PI_2).cos()).abs() < 1e-9, "{turned}");
                let back = stops[1].x - 4.0;
                assert!(back * share < 0.0, "{back}");
                let way = 2.0 * TAU * 1.0_f64.hypot(0.17);
                let expected = sign * way * ((1.0 + share) * 0.17_f64.atan()).sin() / 0.34;
                let end = circle_end_with(&model, direction);
                assert!((end.heading - expected).abs() < 1e-6, "{end:?} {expected}");
            }
        }
    }
}
