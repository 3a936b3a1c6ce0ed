//! Ways that were reckoned from speeds over cycles that took longer than the log says.

use super::words::percent;
use super::{About, ActsOn, BodyLaw, Effect, Entry, Here, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// The share of the time missing from the log that is missing from its ways too.
struct LostCycles;

pub(super) static EFFECT: Entry = Entry::of::<LostCycles>().body::<LostCycles>();

impl Effect for LostCycles {
    const ABOUT: About = About {
        name: "lost_cycles",
        title: "cycles that the log lost",
        acts_on: ActsOn::Odometry,
        parameters: &[Parameter::size(
            "share",
            "lost-cycles",
            "",
            1.0,
            (-1.0, 3.0),
            "share of the time missing from the log that is missing from its ways: 0 where counters counted on, 1 where each row holds a speed",
        )],
        equation: "(ahead, left, Δθ) ← (1 + p (T/t - 1)) (ahead, left, Δθ),  T and t the duration of the move by the reference's clock and by the log's; of the run, \
                   where its moves do not show theirs",
        physics: "A row holds what the wheels did in a cycle of fixed length, from their speed. Where messages are lost, or cycles take longer, what \
                  the wheels did in the meantime stands nowhere.",
        signature: "Every way and every turn is too short by the share of the time missing from its log, which differs from run to run, from path to \
                    path and from move to move. Runs of one path hardly tell it from the size of the wheels where they lose time evenly.",
        confused_with: &["roller_scale"],
        separated_by: "runs of which the log lost different shares; the counts of a counter that counts on",
        source: "found in the logs of a mecanum robot of OptiOdom (Sousa et al., 2022)",
    };

    const DRIVES: DriveKinds =
        DriveKinds::of(DriveKind::Mecanum).and(DriveKind::Omni3).and(DriveKind::Omni4).and(DriveKind::DeadWheels);

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "Of the time that the reference's clock ran longer than the log's, {} is missing from the ways too.",
            percent(p[0])
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

impl BodyLaw for LostCycles {
    #[inline(always)]
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let whole = p[0] * at.clock_excess + 1.0;
        motion.forward *= whole;
        motion.sideways *= whole;
        motion.rotation *= whole;
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::{DriveKind, Robot};
    use crate::effect::{Model, tests::sideways_log};
    use crate::replay::Track;

    /// Oracle: the whole motion, of which a log that is 5 % too short holds a 1.05th.
    #[test]
    fn a_log_that_lost_a_share_of_its_cycles_gets_it_back() {
        let robot = Robot { drive: DriveKind::Omni3.usual(), ..Robot::labmate() };
        let mut log = sideways_log(&robot.drive, &robot);
        log.clock_excess = 0.05;
        for counts in log.rollers.iter_mut().chain([&mut log.left, &mut log.right]) {
            counts.iter_mut().for_each(|count| *count /= 1.05);
        }
        let track = Track::from_log(&log, &robot).unwrap();
        let mut model = Model::new(&robot);
        let last = log.reference.last().unwrap();
        let off = |model: &Model| {
            let end = track.end(&model.chain());
            (end.x - last.x).hypot(end.y - last.y) + (end.heading - last.heading.unwrap()).abs()
        };
        assert!(off(&model) > 0.02);
        model.set("lost_cycles", "share", 1.0).unwrap();
        assert!(off(&model) < 1e-9);
        log.clock_excess = 0.0;
        let track = Track::from_log(&log, &robot).unwrap();
        assert_eq!(track.end(&model.chain()), track.end(&Model::new(&robot).chain()));
    }
}
