//! Diameters of the two front wheels of a base on three omni wheels.

use super::rollers::{self, Ways, share};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the front left wheel's diameter to the front right one's; their mean stays.
struct FrontDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<FrontDiameterRatio>().body::<FrontDiameterRatio>();

/// 1/√3.
const THIRD_ROOT: f64 = 0.577_350_269_189_625_8;

impl Effect for FrontDiameterRatio {
    const ABOUT: About = About {
        name: "front_diameter_ratio",
        title: "left over right front wheel, omni wheels",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "front-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "front left / front right wheel diameter",
        )],
        equation: "ahead ← ahead - e (left + 2 round)/√3,  left ← left - e · ahead/√3,  round ← round - e · ahead/√3,  \
                   e = (r - 1)/(r + 1), round = Δθ L",
        physics: "Rollers wear, and wheels differ from one another as they are made.",
        signature: "Legs ahead bend the same way in ccw and cw, and their course lies beside the heading; turns on the spot move the base ahead \
                    or back.",
        confused_with: &[],
        separated_by: "a straight leg, driven forward and backward",
        source: "kinematics; Sousa et al. (2022) fit a diameter for each wheel",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Omni3);

    fn means(p: &[f64], robot: &Robot) -> String {
        rollers::differ("front left wheel is", "front right one", p[0], robot)
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for FrontDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, ways) = (-share(p[0]) * THIRD_ROOT, Ways::of(at, motion));
        Ways { ahead: e * (ways.left + ways.round * 2.0), left: e * ways.ahead, round: e * ways.ahead }
            .add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::Omni3Drive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_base_with_a_larger_front_left_wheel_is_where_the_ratio_puts_it() {
        assert!((super::THIRD_ROOT - 1.0 / 3.0_f64.sqrt()).abs() < 1e-15);
        for ratio in [1.03, 0.98] {
            let right = 2.0 * 0.1 / (1.0 + ratio);
            let truth = Omni3Drive::new(0.2, [right, right * ratio, 0.1]).unwrap();
            assert_rolls(truth.into(), &[("front_diameter_ratio", "ratio", ratio)]);
        }
    }
}
