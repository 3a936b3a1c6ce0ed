//! Diameters of the wheels of a mecanum drive on one diagonal beside those on the other.

use super::rollers::{Ways, share};
use super::words::{deg, side};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the diameters of front left and rear right to those of front right and rear left; the mean diameter stays.
struct DiagonalDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<DiagonalDiameterRatio>().body::<DiagonalDiameterRatio>();

impl Effect for DiagonalDiameterRatio {
    const ABOUT: About = About {
        name: "diagonal_diameter_ratio",
        title: "wheel diameters of both diagonals, mecanum",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "diagonal-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "diameters of front left and rear right / those of front right and rear left",
        )],
        equation: "ahead ← ahead - e · left,  left ← left - e · ahead,  round ← round - e · disagreement,  e = (r - 1)/(r + 1), round = Δθ D/2",
        physics: "Wheels of two makes, or rollers that are worn on one diagonal, which carries the load where the floor is uneven.",
        signature: "The course on a straight leg lies beside the heading, by the same angle in ccw and cw; on sideways legs it lies on the other \
                    side, which a turned marker does not do.",
        confused_with: &["crab", "marker_yaw"],
        separated_by: "a leg ahead and a leg sideways",
        source: "kinematics; Sousa et al. (2022) fit a diameter for each wheel",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Mecanum);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let off = -share(p[0]);
        format!("Where the base is told to go straight ahead, it goes {} to the {}.", deg(libm::atan(off)), side(off))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for DiagonalDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (e, ways) = (-share(p[0]), Ways::of(at, motion));
        Ways { ahead: e * ways.left, left: e * ways.ahead, round: e * at.aside.disagreement }.add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::MecanumDrive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_mecanum_drive_with_larger_wheels_on_one_diagonal_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let other = 2.0 * 0.15 / (1.0 + ratio);
            let truth = MecanumDrive::new(0.3, 0.3, [other * ratio, other, other, other * ratio]).unwrap();
            assert_rolls(truth.into(), &[("diagonal_diameter_ratio", "ratio", ratio)]);
        }
    }
}
