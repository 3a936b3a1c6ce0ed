//! Diameter of the tracking wheel across the robot.

use super::rollers::Ways;
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of its diameter to those of the wheels along, which stay.
struct AcrossDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<AcrossDiameterRatio>().body::<AcrossDiameterRatio>();

impl Effect for AcrossDiameterRatio {
    const ABOUT: About = About {
        name: "across_diameter_ratio",
        title: "tracking wheel across over those along",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "across-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "diameter of the wheel across / mean of those along, where nominal ones are alike",
        )],
        equation: "left ← left + (r - 1) (left + k · round),  round = Δθ W/2, k = x/(W/2)",
        physics: "Tracking wheels wear, and are pressed onto the floor by springs of different strength.",
        signature: "Legs to the side have another scale than legs ahead; turns on the spot move the robot to the side where the wheel does not stand beside the others.",
        confused_with: &[],
        separated_by: "a leg ahead and a leg to the side, measured by tape",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::DeadWheels);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let larger = either(p[0] - 1.0, "larger", "smaller");
        format!("The wheel across is {} {larger} than believed beside those along.", percent(p[0] - 1.0))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for AcrossDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (more, ways, k) = (p[0] - 1.0, Ways::of(at, motion), at.wheel_layout[0]);
        motion.sideways += more * (ways.left + ways.round * k);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::DeadWheelsDrive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_robot_with_a_larger_tracking_wheel_across_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let truth = DeadWheelsDrive::new(0.3, -0.1, [0.05, 0.05, 0.05 * ratio]).unwrap();
            assert_rolls(truth.into(), &[("across_diameter_ratio", "ratio", ratio)]);
        }
    }
}
