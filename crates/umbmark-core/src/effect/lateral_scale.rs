//! Sideways ways of a base on wheels with rollers.

use super::words::mm;
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The ratio of true to believed ways to the side.
struct LateralScale;

pub(super) static EFFECT: Entry = Entry::of::<LateralScale>().body::<LateralScale>();

impl Effect for LateralScale {
    const ABOUT: About = About {
        name: "lateral_scale",
        title: "scale of ways to the side",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::ratio("ratio", "lateral-scale", 2e-2, (0.2, 5.0), "true / believed way to the side")],
        equation: "left ← k · left",
        physics: "Sideways, a mecanum wheel rolls on its rollers alone: they turn with friction and slip along their axes.",
        signature: "Sideways legs are too short (k < 1), legs ahead are not. A path without sideways motion shows nothing.",
        confused_with: &["rear_diameter_ratio", "omni_pair_ratio"],
        separated_by: "a leg ahead and a leg sideways, measured by tape",
        source: "kinematics; the lateral multiplier of mecanum drives in Road Runner",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Mecanum).and(DriveKind::Omni3).and(DriveKind::Omni4);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let short = if p[0] < 1.0 { "long" } else { "short" };
        format!("A metre to the side by odometry is {} too {short} on the floor.", mm(p[0] - 1.0))
    }
}

impl BodyLaw for LateralScale {
    #[inline(always)]
    fn body<T: Real>(p: &[T], _at: &Here<T>, motion: &mut Displacement2<T>) {
        motion.sideways *= p[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::{DriveKind, Robot};
    use crate::effect::{Model, tests::sideways_log};
    use crate::replay::Track;

    /// Oracle: the last leg goes 0.2 m to the left at a constant heading.
    #[test]
    fn only_the_way_to_the_side_is_scaled() {
        let robot = Robot { drive: DriveKind::Mecanum.usual(), ..Robot::labmate() };
        let log = sideways_log(&robot.drive, &robot);
        let track = Track::from_log(&log, &robot).unwrap();
        let mut model = Model::new(&robot);
        let poses = track.poses(&model.chain());
        model.set("lateral_scale", "ratio", 0.9).unwrap();
        let scaled = track.poses(&model.chain());
        let last = poses.len() - 1;
        let [leg, shorter] = [&poses, &scaled].map(|poses| poses[last - 10].between(&poses[last]));
        assert!((leg.y - 0.2).abs() < 1e-9 && leg.x.abs() < 1e-9, "{leg:?}");
        assert!((shorter.y - 0.18).abs() < 1e-9 && shorter.x.abs() < 1e-9, "{shorter:?}");
        let [ahead, same] = [&poses, &scaled].map(|poses| poses[0].between(&poses[10]));
        assert_eq!(ahead, same);
    }
}
