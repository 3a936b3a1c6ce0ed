//! Diameters of the right wheels of a mecanum drive beside those of the left ones.

use super::rollers::{self, Ways, share};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the right wheels' diameters to the left ones'; the mean diameter stays.
struct SideDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<SideDiameterRatio>().body::<SideDiameterRatio>();

impl Effect for SideDiameterRatio {
    const ABOUT: About = About {
        name: "side_diameter_ratio",
        title: "right over left wheel diameters, mecanum",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "side-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "right / left wheel diameters, front and rear alike",
        )],
        equation: "ahead ← ahead + e · round,  round ← round + e · ahead,  left ← left + e · disagreement,  e = (r - 1)/(r + 1), round = Δθ D/2",
        physics: "Rollers wear, and a load that stands on one side presses them flat.",
        signature: "Legs bend the same way in ccw and cw, as with E_d of a differential drive; turns on the spot move the base ahead or back.",
        confused_with: &[],
        separated_by: "a straight leg, driven forward and backward",
        source: "kinematics; Sousa et al. (2022) fit a diameter for each wheel",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Mecanum);

    fn means(p: &[f64], robot: &Robot) -> String {
        rollers::differ("right wheels are", "left ones", p[0], robot)
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for SideDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, ways) = (share(p[0]), Ways::of(at, motion));
        Ways { ahead: e * ways.round, left: e * at.aside.disagreement, round: e * ways.ahead }.add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::MecanumDrive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_mecanum_drive_with_larger_wheels_on_one_side_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let left = 2.0 * 0.15 / (1.0 + ratio);
            let truth = MecanumDrive::new(0.3, 0.3, [left, left * ratio, left, left * ratio]).unwrap();
            assert_rolls(truth.into(), &[("side_diameter_ratio", "ratio", ratio)]);
        }
    }
}
