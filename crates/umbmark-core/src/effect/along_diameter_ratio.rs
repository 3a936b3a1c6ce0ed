//! Diameters of the two tracking wheels along the robot.

use super::rollers::{Ways, share};
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the right wheel's diameter to the left one's; their mean stays.
struct AlongDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<AlongDiameterRatio>().body::<AlongDiameterRatio>();

impl Effect for AlongDiameterRatio {
    const ABOUT: About = About {
        name: "along_diameter_ratio",
        title: "right over left tracking wheel",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "along-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "right / left diameter of the wheels along",
        )],
        equation: "ahead ← ahead + e · round,  round ← round + e · ahead,  left ← left - k e · ahead,  e = (r - 1)/(r + 1), round = Δθ W/2, k = x/(W/2)",
        physics: "Tracking wheels wear, and are pressed onto the floor by springs of different strength.",
        signature: "Legs ahead bend the same way in ccw and cw, as with E_d of a differential drive; legs to the side show nothing.",
        confused_with: &[],
        separated_by: "a straight leg, driven forward and backward",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::DeadWheels);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "The right wheel is {} {} than the left one.",
            percent(p[0] - 1.0),
            either(p[0] - 1.0, "larger", "smaller")
        )
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for AlongDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, ways, k) = (share(p[0]), Ways::of(at, motion), at.wheel_layout[0]);
        Ways { ahead: e * ways.round, left: -e * ways.ahead * k, round: e * ways.ahead }.add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::DeadWheelsDrive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_robot_with_a_larger_tracking_wheel_on_the_right_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let left = 2.0 * 0.05 / (1.0 + ratio);
            let truth = DeadWheelsDrive::new(0.3, -0.1, [left, left * ratio, 0.05]).unwrap();
            assert_rolls(truth.into(), &[("along_diameter_ratio", "ratio", ratio)]);
        }
    }
}
