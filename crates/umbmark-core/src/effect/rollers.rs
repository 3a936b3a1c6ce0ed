//! What laws of wheels with rollers have in common: the motion of the base as ways of its wheels.

use super::Here;
use super::words::{either, mm, percent};
use crate::drive::Robot;
use crate::geometry::{Displacement2, Real};

/// A motion in metres: ahead, to the left, and along the circle on which the axle's wheels stand.
pub(super) struct Ways<T> {
    pub ahead: T,
    pub left: T,
    pub round: T,
}

impl<T: Real> Ways<T> {
    #[inline(always)]
    pub fn of(at: &Here<T>, motion: &Displacement2<T>) -> Ways<T> {
        Ways { ahead: motion.forward, left: motion.sideways, round: motion.rotation * (0.5 * at.wheelbase) }
    }

    /// Adds these ways to a motion.
    #[inline(always)]
    pub fn add_to(self, at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.forward += self.ahead;
        motion.sideways += self.left;
        // Where nothing is known of the robot, nothing turns it.
        if at.wheelbase > 0.0 {
            motion.rotation += self.round / (0.5 * at.wheelbase);
        }
    }
}

/// How much two sizes of this ratio differ from their mean, as a share of it: (r - 1)/(r + 1).
#[inline(always)]
pub(super) fn share<T: Real>(ratio: T) -> T {
    (ratio - 1.0) / (ratio + 1.0)
}

/// How much the sizes of four omni wheels differ across the base: that of the two wheels of this ratio, which stand farthest apart, over the sine or cosine
/// of their direction.
#[inline(always)]
pub(super) fn share_of_omni_wheels<T: Real>(ratio: T, at: &Here<T>) -> T {
    share(ratio) * (1.0 / libm::sqrt(0.5 + 0.5 * libm::fabs(at.wheel_layout[0])))
}

/// That some wheels of this ratio to others are larger or smaller, and both diameters.
pub(super) fn differ(whose: &str, than: &str, ratio: f64, robot: &Robot) -> String {
    let (off, mean) = (share(ratio), robot.drive.wheel_diameter_left());
    format!(
        "The {whose} {} {} than the {than}: {} and {} in diameter.",
        percent(ratio - 1.0),
        either(ratio - 1.0, "larger", "smaller"),
        mm(mean * (1.0 + off)),
        mm(mean * (1.0 - off))
    )
}
