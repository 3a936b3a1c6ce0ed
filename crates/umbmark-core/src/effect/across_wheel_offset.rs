//! Place of the tracking wheel across the robot.

use super::words::mm;
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// How far the wheel across truly stands ahead of where it is believed to.
struct AcrossWheelOffset;

pub(super) static EFFECT: Entry = Entry::of::<AcrossWheelOffset>().body::<AcrossWheelOffset>();

impl Effect for AcrossWheelOffset {
    const ABOUT: About = About {
        name: "across_wheel_offset",
        title: "place of the tracking wheel across",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "ahead_m",
            "across-wheel-offset",
            "m",
            3e-3,
            (-10.0, 10.0),
            "how far the wheel across stands ahead of where it is believed to",
        )],
        equation: "left ← left - δ · Δθ",
        physics: "Where the wheel touches the floor, and where the middle of the other two is, is known to some millimetres.",
        signature: "Turns on the spot move the robot to the side by δ for each radian, to the left in one sense and to the right in the other; legs show nothing.",
        confused_with: &["marker_offset"],
        separated_by: "turns on the spot by known angles; no path tells it from a tracked point that stands elsewhere on the robot by as much",
        source: "kinematics",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::DeadWheels);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let ahead = if p[0] < 0.0 { "behind" } else { "ahead of" };
        format!("The wheel across stands {} {ahead} where it is believed to.", mm(p[0].abs()))
    }
}

impl BodyLaw for AcrossWheelOffset {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.sideways += -p[0] * motion.rotation;
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::DeadWheelsDrive;
    use crate::effect::tests::assert_rolls;

    #[test]
    fn a_robot_whose_tracking_wheel_stands_elsewhere_is_where_the_offset_puts_it() {
        for ahead in [0.01, -0.02] {
            let truth = DeadWheelsDrive::new(0.3, -0.1 + ahead, [0.05; 3]).unwrap();
            assert_rolls(truth.into(), &[("across_wheel_offset", "ahead_m", ahead)]);
        }
    }
}
