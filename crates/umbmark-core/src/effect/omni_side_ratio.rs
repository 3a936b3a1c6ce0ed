//! Diameters on the right of a base on four omni wheels beside those on its left.

use super::rollers::{Ways, share_of_omni_wheels};
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the diameters on the right to those on the left; the mean diameter stays.
struct OmniSideRatio;

pub(super) static EFFECT: Entry = Entry::of::<OmniSideRatio>().body::<OmniSideRatio>();

impl Effect for OmniSideRatio {
    const ABOUT: About = About {
        name: "omni_side_ratio",
        title: "right over left wheels, four omni wheels",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "omni-side-ratio",
            3e-3,
            (0.5, 2.0),
            "right / left wheel diameters; of wheels at odd angles, that of the two which stand farthest to the sides",
        )],
        equation: "ahead ← ahead + e (round + cos 2φ · disagreement),  left ← left + e sin 2φ · disagreement,  round ← round + e · ahead/2,  e = (r - 1)/(r + 1) / max(|sin φ|, |cos φ|), round = Δθ L, φ the direction of the first wheel",
        physics: "Rollers wear, and a load that stands on one side presses them flat.",
        signature: "Legs ahead bend the same way in ccw and cw; turns on the spot move the base ahead or back; legs sideways show nothing.",
        confused_with: &[],
        separated_by: "a straight leg, driven forward and backward",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Omni4);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let larger = either(p[0] - 1.0, "larger", "smaller");
        format!("The wheels on the right are {} {larger} than those on the left.", percent(p[0] - 1.0))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for OmniSideRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, [cosine, sine]) = (share_of_omni_wheels(p[0], at), at.wheel_layout);
        let (ways, apart) = (Ways::of(at, motion), at.aside.disagreement);
        Ways { ahead: e * (ways.round + cosine * apart), left: e * (sine * apart), round: e * ways.ahead * 0.5 }
            .add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::Omni4Drive;
    use crate::effect::tests::assert_rolls_as;
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn a_base_with_larger_wheels_on_the_right_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let [small, large] = [2.0 * 0.1 / (1.0 + ratio), 2.0 * 0.1 * ratio / (1.0 + ratio)];
            for (offset, diameters) in [
                (0.0, [0.1, small, 0.1, large]),
                (FRAC_PI_4, [small, small, large, large]),
                (-FRAC_PI_4, [large, small, small, large]),
            ] {
                let nominal = Omni4Drive::new(0.2, offset, [0.1; 4]).unwrap();
                let truth = Omni4Drive::new(0.2, offset, diameters).unwrap();
                assert_rolls_as(nominal.into(), truth.into(), &[("omni_side_ratio", "ratio", ratio)]);
            }
        }
    }
}
