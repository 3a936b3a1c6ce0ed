//! The mean diameter of wheels with rollers.

use super::words::mm;
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of the mean true wheel diameter to the nominal one.
struct RollerScale;

pub(super) static EFFECT: Entry = Entry::of::<RollerScale>().body::<RollerScale>();

impl Effect for RollerScale {
    const ABOUT: About = About {
        name: "roller_scale",
        title: "scale of wheels with rollers",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio("e_s", "roller-scale", 4e-3, (0.2, 5.0), "mean true / nominal wheel diameter")],
        equation: "(ahead, left, Δθ) ← E_s (ahead, left, Δθ)",
        physics: "The radius at which a wheel rolls lies between its rollers' outsides and their axes, and wears with them.",
        signature: "Every leg is too long (E_s > 1) or too short, ahead and sideways alike, and every turn too large or too small.",
        confused_with: &["wheelbase", "lost_cycles"],
        separated_by: "one straight leg measured by tape",
        source: "kinematics",
    };

    const DRIVES: DriveKinds =
        DriveKinds::of(DriveKind::Mecanum).and(DriveKind::Omni3).and(DriveKind::Omni4).and(DriveKind::DeadWheels);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let short = if p[0] < 1.0 { "long" } else { "short" };
        format!("A metre by odometry is {} too {short} on the floor.", mm(p[0] - 1.0))
    }
}

impl BodyLaw for RollerScale {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.forward *= p[0];
        motion.sideways *= p[0];
        motion.rotation *= p[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::{MecanumDrive, Omni3Drive};
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_base_with_other_wheels_throughout_is_where_the_scale_puts_it() {
        for scale in [1.03, 0.98] {
            let settings = [("roller_scale", "e_s", scale)];
            assert_rolls(MecanumDrive::new(0.3, 0.3, [0.15 * scale; 4]).unwrap().into(), &settings);
            assert_rolls(Omni3Drive::new(0.2, [0.1 * scale; 3]).unwrap().into(), &settings);
        }
    }

    #[test]
    fn a_base_whose_wheels_stand_farther_apart_is_where_the_wheelbase_puts_it() {
        for ratio in [1.03, 0.98] {
            let settings = [("wheelbase", "e_b", ratio)];
            assert_rolls(MecanumDrive::new(0.3 * ratio, 0.3 * ratio, [0.15; 4]).unwrap().into(), &settings);
            assert_rolls(Omni3Drive::new(0.2 * ratio, [0.1; 3]).unwrap().into(), &settings);
        }
    }
}
