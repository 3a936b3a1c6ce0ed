//! Wheels with rollers whose columns are exchanged, or one of which is counted backward; and a reference that is mirrored, which such wheels tell from
//! exchanged sides no more than an axle does.

use super::agreement::{Agreement, Reading};
use super::{Fault, Seen, clock, faults};
use crate::drive::{Robot, Rollers};
use crate::geometry::Displacement2;
use crate::run::TickLog;

/// Corrected ways may differ from those of the reference by this factor.
const OTHER_WAY: f64 = 1.4;

/// How columns of wheels have to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// With the other sign, by what it is called after "ticks_".
    Backward(&'static str),
    /// Each as the other.
    Exchanged([&'static str; 2]),
}

/// The fault with which the wheels move as the reference does, if they do not as they are read: of all that make them agree, the best.
pub(super) fn found(seen: &[Seen], robot: &Robot) -> Option<Fault> {
    let rollers = robot.drive.rollers()?;
    let names = robot.drive.kind().columns();
    if seen.iter().any(|seen| seen.log.rollers.len() != names.len()) {
        return None;
    }
    let backward = (0..names.len()).map(|k| (Fault::OneWheel(Column::Backward(names[k])), Change::Backward(k)));
    let pairs = (0..names.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    let exchanged =
        pairs.map(|pair| (Fault::OneWheel(Column::Exchanged(pair.map(|k| names[k]))), Change::Exchanged(pair)));
    let changes = backward.chain(exchanged).chain([(Fault::ReferenceMirrored, Change::Mirrored)]);
    let read = |logs: &[TickLog]| {
        let beside = clock::reread(seen, logs, robot);
        Agreement::without_drift(&beside, Reading::default(), robot.drive.wheelbase())
    };
    let agrees = |found: &Agreement| {
        let is_way = (1.0 / OTHER_WAY..OTHER_WAY).contains(&found.scale());
        let is_same_sense = found.turn[0] > 0.0;
        found.shown == [true; 2] && is_way && is_same_sense && found.misfits.iter().all(|m| *m < faults::DOUBTFUL)
    };
    let as_given: Vec<TickLog> = seen.iter().map(|seen| seen.log.clone()).collect();
    if agrees(&read(&as_given)) {
        return None;
    }
    let tried = changes.filter_map(|(fault, change)| {
        let logs: Option<Vec<TickLog>> = seen.iter().map(|seen| change.of(seen.log, robot, &rollers)).collect();
        Some((read(&logs?), fault))
    });
    let best = tried.filter(|(found, _)| agrees(found)).min_by(|a, b| a.0.misfit.total_cmp(&b.0.misfit));
    best.map(|(_, fault)| fault)
}

/// What may have happened to the columns.
#[derive(Clone, Copy)]
enum Change {
    Backward(usize),
    Exchanged([usize; 2]),
    Mirrored,
}

impl Change {
    /// The log without it.
    fn of(self, log: &TickLog, robot: &Robot, rollers: &Rollers) -> Option<TickLog> {
        let mut counts = log.rollers.clone();
        match self {
            Change::Backward(k) => counts[k].iter_mut().for_each(|count| *count = -*count),
            Change::Exchanged([a, b]) => counts.swap(a, b),
            Change::Mirrored => mirror(&mut counts, robot, rollers),
        }
        let [left, right] = robot.axle_ticks_of_rollers(&counts)?;
        Some(TickLog { left, right, rollers: counts, ..log.clone() })
    }
}

/// What the wheels would have counted on the mirrored way.
fn mirror(counts: &mut [Vec<f64>], robot: &Robot, rollers: &Rollers) {
    let per_count = rollers.metres_per_count(robot.encoder.ticks_per_revolution());
    for sample in 0..counts.iter().map(Vec::len).min().unwrap_or(0) {
        let ways: Vec<f64> = counts.iter().zip(&per_count).map(|(own, per_count)| own[sample] * per_count).collect();
        let motion = rollers.motion(&ways);
        let mirrored = Displacement2 { sideways: -motion.sideways, rotation: -motion.rotation, ..motion };
        for ((own, way), per_count) in counts.iter_mut().zip(rollers.ways_of(&mirrored)).zip(&per_count) {
            own[sample] = way / per_count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::effect::TestKind;
    use crate::geometry::{Pose2, wrap};
    use crate::random::Stream;
    use crate::run::{ReferencePose, Run};
    use crate::setup::Setup;

    /// A minute of ways ahead, aside and aslant, bends and turns on the spot, one after the other as they are drawn, with a pose ten times a second.
    fn drive(robot: &Robot, seed: u64) -> TickLog {
        let rollers = robot.drive.rollers().unwrap();
        let per_count = rollers.metres_per_count(robot.encoder.ticks_per_revolution());
        let mut stream = Stream::new(seed, 0, 0);
        let mut log = TickLog { rollers: vec![Vec::new(); per_count.len()], ..TickLog::default() };
        let (mut pose, mut ways) = (Pose2::IDENTITY, vec![0.0; per_count.len()]);
        let mut step = Displacement2 { forward: 0.0, sideways: 0.0, rotation: 0.0 };
        for sample in 0..600_usize {
            if sample.is_multiple_of(20) {
                let [ahead, left, turn] = [0; 3].map(|_: i32| 2.0 * stream.uniform() - 1.0);
                step = Displacement2 { forward: 0.05 * ahead, sideways: 0.04 * left, rotation: 0.1 * turn };
            }
            log.time.push(0.1 * sample as f64);
            for ((counts, way), per_count) in log.rollers.iter_mut().zip(&ways).zip(&per_count) {
                counts.push((way / per_count).floor());
            }
            let noise = [2e-3; 3].map(|sd| sd * stream.normal());
            let (x, y, heading) = (pose.x + noise[0], pose.y + noise[1], wrap(pose.heading + noise[2]));
            log.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
            pose.advance(&step);
            ways.iter_mut().zip(rollers.ways_of(&step)).for_each(|(way, more)| *way += more);
        }
        [log.left, log.right] = robot.axle_ticks_of_rollers(&log.rollers).unwrap();
        log
    }

    /// Two drives with what a change makes of the counts.
    fn found(robot: &Robot, change: Option<Change>) -> Vec<Fault> {
        let rollers = robot.drive.rollers().unwrap();
        let run = |number: u32| {
            let log = drive(robot, u64::from(number));
            let log = change.map_or(log.clone(), |change| change.of(&log, robot, &rollers).unwrap());
            let name = format!("run_{number}");
            Run { name, number, direction: None, test: TestKind::Systematic, log: Some(log), returned: None }
        };
        Setup::of_tracks(&[run(1), run(2)], robot).faults
    }

    #[test]
    fn each_wheel_that_counts_backward_and_each_pair_that_is_exchanged_is_named() {
        for kind in DriveKind::ALL.iter().filter(|kind| kind.moves_sideways()) {
            let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
            assert_eq!(found(&robot, None), [], "{}", kind.name());
            let names = kind.columns();
            for (k, name) in names.iter().enumerate() {
                let told = found(&robot, Some(Change::Backward(k)));
                assert_eq!(told, [Fault::OneWheel(Column::Backward(name))], "{} {name}: {told:?}", kind.name());
            }
            for pair in (0..names.len()).flat_map(|b| (0..b).map(move |a| [a, b])) {
                let told = found(&robot, Some(Change::Exchanged(pair)));
                assert_eq!(told, [Fault::OneWheel(Column::Exchanged(pair.map(|k| names[k])))], "{}", kind.name());
            }
            assert_eq!(found(&robot, Some(Change::Mirrored)), [Fault::ReferenceMirrored], "{}", kind.name());
        }
    }
}
