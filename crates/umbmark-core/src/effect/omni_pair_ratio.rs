//! Diameters of two opposite omni wheels of four beside those of the other two.

use super::rollers::{Ways, share};
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the first and third wheel's diameters to those of the second and fourth; the mean diameter stays.
struct OmniPairRatio;

pub(super) static EFFECT: Entry = Entry::of::<OmniPairRatio>().body::<OmniPairRatio>();

impl Effect for OmniPairRatio {
    const ABOUT: About = About {
        name: "omni_pair_ratio",
        title: "one pair over the other, four omni wheels",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "omni-pair-ratio",
            3e-3,
            (0.5, 2.0),
            "diameters of wheels 1 and 3 / of wheels 2 and 4",
        )],
        equation: "ahead ← ahead - e (cos 2φ · ahead + sin 2φ · left),  left ← left + e (cos 2φ · left - sin 2φ · ahead),  round ← round - e · disagreement,  e = (r - 1)/(r + 1), round = Δθ L, φ the direction of the first wheel",
        physics: "Rollers wear, and wheels of two batches differ as they are made.",
        signature: "With wheels in front, behind and on both sides, legs ahead and legs sideways have different scales. With wheels at the corners, the course of a leg \
                    ahead lies beside the heading, that of a leg sideways on the other side of it, and turns are right.",
        confused_with: &["lateral_scale"],
        separated_by: "legs at 45 degrees to the heading, one to the left and one to the right",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Omni4);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let larger = either(p[0] - 1.0, "larger", "smaller");
        format!("Wheels 1 and 3 are {} {larger} than wheels 2 and 4.", percent(p[0] - 1.0))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for OmniPairRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, [cosine, sine], ways) = (share(p[0]), at.wheel_layout, Ways::of(at, motion));
        Ways {
            ahead: -e * (ways.ahead * cosine + ways.left * sine),
            left: e * (ways.left * cosine - ways.ahead * sine),
            round: -e * at.aside.disagreement,
        }
        .add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::Omni4Drive;
    use crate::effect::tests::assert_rolls_as;
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn a_base_whose_pairs_of_wheels_differ_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let [small, large] = [2.0 * 0.1 / (1.0 + ratio), 2.0 * 0.1 * ratio / (1.0 + ratio)];
            for (offset, diameters) in [
                (0.0, [large, small, large, small]),
                (FRAC_PI_4, [large, small, large, small]),
                (0.3, [large, small, large, small]),
            ] {
                let nominal = Omni4Drive::new(0.2, offset, [0.1; 4]).unwrap();
                let truth = Omni4Drive::new(0.2, offset, diameters).unwrap();
                assert_rolls_as(nominal.into(), truth.into(), &[("omni_pair_ratio", "ratio", ratio)]);
            }
        }
    }
}
