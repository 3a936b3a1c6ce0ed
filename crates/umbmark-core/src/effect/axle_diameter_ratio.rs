//! Diameters of the front wheels of a mecanum drive beside those of the rear ones.

use super::rollers::{Ways, share};
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the front wheels' diameters to the rear ones'; the mean diameter stays.
struct AxleDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<AxleDiameterRatio>().body::<AxleDiameterRatio>();

impl Effect for AxleDiameterRatio {
    const ABOUT: About = About {
        name: "axle_diameter_ratio",
        title: "front over rear wheel diameters, mecanum",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "axle-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "front / rear wheel diameters, left and right alike",
        )],
        equation: "left ← left + e · round,  round ← round + e · left,  ahead ← ahead + e · disagreement,  e = (r - 1)/(r + 1), round = Δθ D/2",
        physics: "A load that stands in front or behind presses the rollers there flat, and they wear sooner.",
        signature: "Sideways legs bend, and turns on the spot move the base sideways; legs ahead show nothing.",
        confused_with: &[],
        separated_by: "a leg sideways, driven both ways",
        source: "kinematics; Sousa et al. (2022) fit a diameter for each wheel",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Mecanum);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let larger = either(p[0] - 1.0, "larger", "smaller");
        format!("The front wheels are {} {larger} than the rear ones.", percent(p[0] - 1.0))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for AxleDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, ways) = (share(p[0]), Ways::of(at, motion));
        Ways { ahead: e * at.aside.disagreement, left: e * ways.round, round: e * ways.left }.add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::MecanumDrive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_mecanum_drive_with_larger_wheels_in_front_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let rear = 2.0 * 0.15 / (1.0 + ratio);
            let truth = MecanumDrive::new(0.3, 0.3, [rear * ratio, rear * ratio, rear, rear]).unwrap();
            assert_rolls(truth.into(), &[("axle_diameter_ratio", "ratio", ratio)]);
        }
    }
}
