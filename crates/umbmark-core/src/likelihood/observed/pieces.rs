//! Long runs cut into pieces that count as runs.
//!
//! Noise differs from run to run, a physical cause does not. A drive of ten minutes shows this as well as ten drives of a minute, if each
//! piece has its own START: its pose there is measured, and the error accumulated before is discarded.

use super::{FEWEST, ObservedRun, Seen};
use crate::drive::Robot;
use crate::effect::Model;
use crate::geometry::Pose2;
use std::ops::Range;
use std::sync::Arc;

/// If there are fewer runs than this, long ones are cut, into this many pieces in total.
const FEW: usize = 6;
const ENOUGH: usize = 10;
/// Duration from which a run counts as long \[s\]; the second value is for a single run.
const LONG: [f64; 2] = [150.0, 60.0];
/// Minimum duration of a piece \[s\], and minimum number of its blocks.
const SHORTEST: f64 = 20.0;
const LEAST_BLOCKS: usize = 30;
/// Motion within this time before and after a piece may influence its observations \[s\].
const MARGIN: f64 = 2.0;

/// The runs; if there are few, long ones in pieces.
pub(super) fn cut(runs: Vec<ObservedRun>, robot: &Robot) -> Vec<ObservedRun> {
    let long = LONG[usize::from(runs.len() == 1)];
    if runs.len() >= FEW || runs.iter().all(|run| duration(run) < long) {
        return runs;
    }
    let whole: f64 = runs.iter().map(duration).sum();
    let of_run = |run: ObservedRun| {
        let share = (ENOUGH as f64 * duration(&run) / whole).round();
        let most = (duration(&run) / SHORTEST).min((run.blocks.len() / LEAST_BLOCKS) as f64).floor();
        let count = if duration(&run) < long { 1.0 } else { share.min(most).max(1.0) };
        if count > 1.0 { in_pieces(&run, count as usize, robot) } else { vec![run] }
    };
    runs.into_iter().flat_map(of_run).collect()
}

/// A run in pieces of about so many seconds; whole, if it has too few blocks for that.
pub(super) fn of_about(run: &ObservedRun, seconds: f64, robot: &Robot) -> Vec<ObservedRun> {
    let count = (duration(run) / seconds).min((run.blocks.len() / LEAST_BLOCKS) as f64).floor();
    if count > 1.0 { in_pieces(run, count as usize, robot) } else { vec![run.clone()] }
}

/// From the first measurement to the last \[s\].
pub(super) fn duration(run: &ObservedRun) -> f64 {
    let sights = run.track.sights();
    sights.last().zip(sights.first()).map_or(0.0, |(last, first)| last.time - first.time)
}

/// Pieces of about the same time, cut between blocks.
fn in_pieces(run: &ObservedRun, count: usize, robot: &Robot) -> Vec<ObservedRun> {
    let sights = run.track.sights();
    let begins = sights[0].time;
    let length = duration(run) / count as f64;
    let edge = |k: usize| {
        let time = begins + k as f64 * length;
        let after = run.blocks.iter().find(|block| sights[block.first].time >= time - 1e-9);
        after.map_or(sights.len(), |block| block.first)
    };
    let edges: Vec<usize> = (0..count).map(edge).chain([sights.len()]).collect();
    edges.windows(2).filter_map(|pair| piece(run, pair[0]..pair[1], robot)).collect()
}

/// Some observations of a run as a separate run that begins at the first of them.
fn piece(run: &ObservedRun, own: Range<usize>, robot: &Robot) -> Option<ObservedRun> {
    if own.is_empty() {
        return None;
    }
    let measured = &run.measured[own.clone()];
    let track = run.track.part(own.clone(), MARGIN);
    // The pose by the counts, relative to where the piece begins.
    let model = Model::new(robot);
    let poses = track.clone().beginning_at(Pose2::IDENTITY).poses(&model.chain());
    let (x, y, heading) = measured[0];
    let turned = heading.map(|heading| heading - poses[0].heading).or_else(|| {
        super::laid::turn_onto(poses.iter().zip(measured).map(|(pose, (x, y, _))| ([pose.x, pose.y], [*x, *y])))
    });
    let there = Pose2::new(0.0, 0.0, turned?).compose(&poses[0]);
    let begins = if own.start == 0 { None } else { Some(Pose2::new(x - there.x, y - there.y, turned?)) };
    let track = match begins {
        Some(origin) => track.beginning_at(origin),
        None => track,
    };
    let jumps: Vec<usize> = run
        .blocks
        .iter()
        .filter(|b| b.jumped && own.contains(&b.first) && b.first > own.start)
        .map(|b| b.first - own.start)
        .collect();
    let sights = run.track.sights();
    let (from, to) = (sights[own.start].time, sights[own.end - 1].time);
    let start_seen = begins.is_some() || run.start_seen;
    let of_blocks = run.blocks.iter().filter(|block| run.relative && own.contains(&block.first));
    let added = of_blocks.map(|block| block.steps).collect();
    let seen = Seen {
        measured: measured.into(),
        jumps: &jumps,
        start_seen,
        added,
        headings_only: run.headings_only,
        gyro: run.gyro,
        counts: run.counts,
        readings: Arc::clone(&run.readings),
    };
    let mut piece = ObservedRun::laid(&run.log, run.direction, track, seen, &model);
    piece.name = format!("{}, {from:.0} to {to:.0} s", run.log);
    (piece.blocks.len() >= FEWEST).then_some(piece)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched_on;
    use crate::path::Path;

    #[test]
    fn a_single_long_run_is_judged_in_pieces_whose_duration_is_known() {
        let robot = Robot::labmate();
        let mut data = watched_on(&Path::umbmark(), &Model::new(&robot), 1, 3);
        assert_eq!(Observed::new(&data, &robot).unwrap().piece(), None);
        data.runs.truncate(1);
        let observed = Observed::new(&data, &robot).unwrap();
        let times = &data.runs[0].log.as_ref().unwrap().time;
        let whole = times[times.len() - 1] - times[0];
        let piece = observed.piece().unwrap();
        assert!(observed.runs.len() > 1 && whole > LONG[1], "{} {whole}", observed.runs.len());
        assert!(
            (piece * observed.runs.len() as f64 - whole).abs() < 0.1 * whole && piece >= SHORTEST,
            "{piece} {whole}"
        );
    }
}
