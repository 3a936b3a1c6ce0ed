//! Diameters in front of a base on four omni wheels beside those behind.

use super::rollers::{Ways, share_of_omni_wheels};
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the diameters in front to those behind; the mean diameter stays.
struct OmniAxleRatio;

pub(super) static EFFECT: Entry = Entry::of::<OmniAxleRatio>().body::<OmniAxleRatio>();

impl Effect for OmniAxleRatio {
    const ABOUT: About = About {
        name: "omni_axle_ratio",
        title: "front over rear wheels, four omni wheels",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "omni-axle-ratio",
            3e-3,
            (0.5, 2.0),
            "front / rear wheel diameters; of wheels at odd angles, that of the two which stand farthest in front and behind",
        )],
        equation: "ahead ← ahead + e sin 2φ · disagreement,  left ← left + e (round - cos 2φ · disagreement),  round ← round + e · left/2,  e = (r - 1)/(r + 1) / max(|sin φ|, |cos φ|), round = Δθ L, φ the direction of the first wheel",
        physics: "Rollers wear, and a load that stands in front or behind presses them flat.",
        signature: "Sideways legs bend, and turns on the spot move the base sideways; legs ahead show nothing.",
        confused_with: &[],
        separated_by: "a leg sideways, driven both ways",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Omni4);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let larger = either(p[0] - 1.0, "larger", "smaller");
        format!("The wheels in front are {} {larger} than those behind.", percent(p[0] - 1.0))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for OmniAxleRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, [cosine, sine]) = (share_of_omni_wheels(p[0], at), at.wheel_layout);
        let (ways, apart) = (Ways::of(at, motion), at.aside.disagreement);
        Ways { ahead: e * (sine * apart), left: e * (ways.round - cosine * apart), round: e * ways.left * 0.5 }
            .add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::Omni4Drive;
    use crate::effect::tests::assert_rolls_as;
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn a_base_with_larger_wheels_in_front_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let [small, large] = [2.0 * 0.1 / (1.0 + ratio), 2.0 * 0.1 * ratio / (1.0 + ratio)];
            for (offset, diameters) in [
                (0.0, [large, 0.1, small, 0.1]),
                (FRAC_PI_4, [large, small, small, large]),
                (-FRAC_PI_4, [large, large, small, small]),
            ] {
                let nominal = Omni4Drive::new(0.2, offset, [0.1; 4]).unwrap();
                let truth = Omni4Drive::new(0.2, offset, diameters).unwrap();
                assert_rolls_as(nominal.into(), truth.into(), &[("omni_axle_ratio", "ratio", ratio)]);
            }
        }
    }
}
