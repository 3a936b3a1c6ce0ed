//! Turning that is lost while a base on rollers drives to the side.

use super::words::{deg, either};
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The share of a turn that is lost where the base moves to the side.
struct SidewaysTurnSlip;

pub(super) static EFFECT: Entry = Entry::of::<SidewaysTurnSlip>().body::<SidewaysTurnSlip>();

impl Effect for SidewaysTurnSlip {
    const ABOUT: About = About {
        name: "sideways_turn_slip",
        title: "turning lost while driving to the side",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "share",
            "sideways-turn-slip",
            "",
            1.5e-2,
            (-1.0, 1.0),
            "share of the turn that is lost where it is slow beside the way to the side",
        )],
        equation: "Δθ ← (1 - s |v_left| / (|v_left| + |ω| D/2)) Δθ,  D the distance of the axle's wheels",
        physics: "On the way to the side rollers turn under load and creep. Those of the wheels that turn faster creep more, and what they lose is \
                  turning.",
        signature: "Circles that are driven to the side turn less than circles ahead and than turns on the spot. Paths that turn only on the spot show \
                    nothing.",
        confused_with: &["wheelbase"],
        separated_by: "turns on the spot, together with a circle driven to the side",
        source: "found in the logs of a mecanum robot of OptiOdom (Sousa et al., 2022)",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Mecanum).and(DriveKind::Omni3).and(DriveKind::Omni4);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "A turn of 90 degrees by odometry on a long way to the side comes out {} too {}.",
            deg(std::f64::consts::FRAC_PI_2 * p[0]),
            either(p[0], "small", "large")
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl BodyLaw for SidewaysTurnSlip {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let left = at.aside.speed.abs();
        let all = left + at.turn_rate.abs() * (0.5 * at.wheelbase);
        if all > 0.0 {
            motion.rotation *= -p[0] * (left / all) + 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::{DriveKind, Robot};
    use crate::effect::{Model, tests::sideways_log};
    use crate::geometry::Pose2;
    use crate::replay::Track;

    /// Oracle: the fourth leg of the log goes 0.25 m to the left while it turns by half a radian, the others do not turn or do not go to the side.
    #[test]
    fn a_turn_on_the_way_to_the_side_is_less_by_the_share_and_other_turns_are_not() {
        for kind in [DriveKind::Mecanum, DriveKind::Omni4] {
            let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
            let track = Track::from_log(&sideways_log(&robot.drive, &robot), &robot).unwrap();
            let plain = track.poses(&Model::new(&robot).chain());
            for share in [0.04, -0.03] {
                let mut model = Model::new(&robot);
                model.set("sideways_turn_slip", "share", share).unwrap();
                let lossy = track.poses(&model.chain());
                // Speeds are means over a window, which takes in a step of the other legs at both ends.
                assert_eq!(plain[29], lossy[29]);
                let turned = |poses: &[Pose2]| poses[41].heading - poses[29].heading;
                let lost = turned(&plain) - turned(&lossy);
                let expected = 0.5 * share * 0.25 / (0.25 + 0.5 * 0.5 * robot.drive.wheelbase());
                assert!((lost - expected).abs() < 0.25 * expected.abs(), "{kind:?}: {lost} {expected}");
            }
        }
    }
}
