//! Diameter of the rear wheel of a base on three omni wheels.

use super::rollers::Ways;
use super::words::{either, percent};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the rear wheel's diameter to the front ones'; the mean of the three stays.
struct RearDiameterRatio;

pub(super) static EFFECT: Entry = Entry::of::<RearDiameterRatio>().body::<RearDiameterRatio>();

impl Effect for RearDiameterRatio {
    const ABOUT: About = About {
        name: "rear_diameter_ratio",
        title: "rear over front wheel, omni wheels",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio(
            "ratio",
            "rear-diameter-ratio",
            3e-3,
            (0.5, 2.0),
            "rear / front wheel diameter, both front wheels alike",
        )],
        equation: "ahead ← ahead + a · ahead,  left ← left + a (left + 2 round)/3 + 2 b (left - round)/3,  \
                   round ← round + a (left + 2 round)/3 - b (left - round)/3,  a = (1 - r)/(2 + r), b = 2 (r - 1)/(2 + r), round = Δθ L",
        physics: "Rollers wear, and a load that stands in front or behind presses them flat.",
        signature: "Legs ahead are longer or shorter than sideways ones, which bend; turns on the spot move the base sideways.",
        confused_with: &["lateral_scale"],
        separated_by: "a leg ahead and a leg sideways, driven both ways",
        source: "kinematics; Sousa et al. (2022) fit a diameter for each wheel",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Omni3);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let larger = either(p[0] - 1.0, "larger", "smaller");
        format!("The rear wheel is {} {larger} than the front ones.", percent(p[0] - 1.0))
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 1.0
    }
}

impl BodyLaw for RearDiameterRatio {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let ways = Ways::of(at, motion);
        let more = (p[0] - 1.0) / (p[0] + 2.0);
        let (fronts, rear) = (-more, more * 2.0);
        let fronts_round = fronts * (ways.left + ways.round * 2.0) * (1.0 / 3.0);
        let rear_round = rear * (ways.left - ways.round) * (1.0 / 3.0);
        Ways { ahead: fronts * ways.ahead, left: fronts_round + rear_round * 2.0, round: fronts_round - rear_round }
            .add_to(at, motion);
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::Omni3Drive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_base_with_a_larger_rear_wheel_is_where_the_ratio_puts_it() {
        for ratio in [1.03, 0.98] {
            let front = 3.0 * 0.1 / (2.0 + ratio);
            let truth = Omni3Drive::new(0.2, [front, front, front * ratio]).unwrap();
            assert_rolls(truth.into(), &[("rear_diameter_ratio", "ratio", ratio)]);
        }
    }
}
