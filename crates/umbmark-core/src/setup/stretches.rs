//! Stretches of a few seconds in which robot and wheels disagree: a wheel spins, or the robot is pushed aside or carried.
//!
//! From pose to pose the difference can be as small as noise; over the whole stretch it is not. Windows of 2, 4, 8, ... poses are tested as
//! edges are, and one that is far beyond the others of its length is an accident. A physical effect of the robot shows in more windows, or
//! at the same place of other runs.

use super::edges::{Edge, JUMP, LARGE, Sighting, Spread};
use super::shared::Shared;
use crate::stats::robust::quantile;

/// Maximum duration of a stretch \[s\].
const LONGEST: f64 = 3.0;
/// A stretch looks longer by up to this factor, because windows overlap it on both sides.
const SEEMING: f64 = 2.0;
/// Jumps with less time than this between them belong to one stretch \[s\].
const TOGETHER: f64 = 0.5;
/// A stretch exceeds this multiple of this quantile of all windows of its length.
const BEYOND: (f64, f64) = (4.0, 0.9);
/// It must also exceed this many standard deviations: there are many windows, and the noise of their sums is less certain than that of
/// single edges.
const LEAST: f64 = 1.5 * JUMP;
/// It begins and ends where windows fall below this share of its maximum.
const ENDS: f64 = 0.4;
/// Disturbances that fill more than this share of all poses are no accidents.
const ACCIDENTS: f64 = 0.1;

/// Jumps of each run, merged where they belong together, and the stretches. `kept`: the poses of each run that are not wrong.
pub(super) fn search(
    runs: &[Vec<Sighting>],
    kept: &[Vec<usize>],
    jumps: Vec<Vec<Edge>>,
    spread: &Spread,
) -> Vec<Vec<Edge>> {
    let join = |found: Vec<Vec<Edge>>| -> Vec<Vec<Edge>> {
        runs.iter().zip(found).map(|(run, found)| joined(run, found, TOGETHER, spread)).collect()
    };
    let mut found = join(jumps);
    let poses: usize = kept.iter().map(Vec::len).sum();
    let longest = kept.iter().map(Vec::len).max().unwrap_or(0);
    for length in std::iter::successors(Some(2), |length| Some(2 * length)).take_while(|length| *length < longest) {
        let of_run = |((run, kept), found): ((&Vec<Sighting>, &Vec<usize>), &Vec<Edge>)| {
            windows(run, kept, found, length, spread)
        };
        let windows: Vec<Vec<Edge>> = runs.iter().zip(kept).zip(&found).map(of_run).collect();
        let all = windows.iter().flatten().map(|window| window.deviations);
        let beyond = LEAST.max(BEYOND.0 * quantile(all, BEYOND.1));
        let of_size = |index: usize, size: f64| {
            let windows = windows[index].iter().filter(move |window| window.deviations > size).copied();
            joined(&runs[index], windows, 0.0, spread)
        };
        let peak = |index: usize, s: &Edge| {
            let within = windows[index].iter().filter(|window| s.from <= window.from && window.to <= s.to);
            within.map(|window| window.deviations).fold(0.0, f64::max)
        };
        let middle = |index: usize, s: &Edge| runs[index][(s.from + s.to) / 2].rolled;
        let large = |index| of_size(index, LARGE).iter().map(|stretch| middle(index, stretch)).collect();
        let shared = Shared::new(runs, (0..runs.len()).map(large).collect());
        let of_run = |index: usize| {
            let seconds = |s: &Edge| runs[index][s.to].time - runs[index][s.from].time;
            let own = |s: &Edge| {
                let is_brief = seconds(s) <= SEEMING * LONGEST;
                is_brief && peak(index, s) > beyond && !shared.stands_elsewhere(index, middle(index, s))
            };
            of_size(index, ENDS * beyond).into_iter().filter(own).collect()
        };
        let new: Vec<Vec<Edge>> = (0..runs.len()).map(of_run).collect();
        let filled: usize = new.iter().flatten().map(|stretch| stretch.to - stretch.from).sum();
        if filled as f64 <= ACCIDENTS * poses as f64 {
            for (found, new) in found.iter_mut().zip(new) {
                found.extend(new);
                found.sort_by_key(|stretch| stretch.from);
            }
        }
    }
    join(found)
}

/// Merges steps that overlap or follow each other within this time \[s\].
fn joined(run: &[Sighting], steps: impl IntoIterator<Item = Edge>, seconds: f64, spread: &Spread) -> Vec<Edge> {
    let mut joined: Vec<Edge> = Vec::new();
    for step in steps {
        match joined.last_mut() {
            Some(last) if run[step.from].time - run[last.to].time < seconds => {
                *last = Edge::between(run, last.from, step.to, spread);
            }
            _ => joined.push(step),
        }
    }
    joined
}

/// All windows over a number of poses of a run that contain no accident and last no longer than a stretch.
fn windows(run: &[Sighting], kept: &[usize], found: &[Edge], length: usize, spread: &Spread) -> Vec<Edge> {
    let is_clear = |from: usize, to: usize| {
        let next = found.partition_point(|stretch| stretch.to <= from);
        found.get(next).is_none_or(|stretch| stretch.from >= to)
    };
    let pairs = kept.iter().zip(kept.iter().skip(length)).map(|(from, to)| (*from, *to));
    let brief = pairs.filter(|(from, to)| run[*to].time - run[*from].time <= LONGEST && is_clear(*from, *to));
    brief.map(|(from, to)| Edge::between(run, from, to, spread)).collect()
}
