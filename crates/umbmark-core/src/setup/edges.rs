//! How far the measured motion between two poses is from that of the wheels, in standard deviations.

use super::PoseNoise;
use crate::geometry::{Pose2, wrap};
use crate::stats::robust::{median, quantile};

/// A difference of more standard deviations than this is a jump.
pub(super) const JUMP: f64 = 10.0;
/// Another run has the same disturbance if its difference exceeds this many standard deviations.
pub(super) const LARGE: f64 = 4.0;
/// The noise is estimated from edges over these numbers of poses.
const OVER: [usize; 4] = [1, 2, 4, 8];
/// About so many edges over each number of poses are enough for their medians.
const ENOUGH: usize = 300_000;
/// Poses are compared that are so many apart: enough for what a filter hides.
const APART: usize = 8;
/// The noise is estimated by the size of the motion, in this many parts of all edges.
const PARTS: usize = 10;
/// Minimum standard deviation \[m, rad\], and minimum in terms of the motion in this time \[s\]: smaller differences are treated as noise
/// here; the fit, which knows the sizes of the noise, judges them.
const LEAST: [f64; 2] = [1.5e-3, 3e-3];
const JITTER: f64 = 0.01;
/// The robot's sizes from the motion alone can be wrong by this share of distance and rotation.
const SIZES: f64 = 0.005;
/// Share of the changes from pose to pose up to the one that is taken for a step of rounding.
const SMALLEST: f64 = 0.1;

/// A pose of a run: by the wheels, and as measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sighting {
    /// Its stamp \[s\].
    pub time: f64,
    /// Distance by the wheels until then \[m\], and total rotation \[rad\], both unsigned.
    pub way: f64,
    pub turned: f64,
    /// Both together, the rotation as an arc at half the wheelbase \[m\].
    pub rolled: f64,
    /// Whether rows are missing before it during which the wheels rolled, so that it does not tell how the robot came there.
    pub after_gap: bool,
    pub expected: Pose2,
    /// The heading is `None` if it was not measured.
    pub measured: (f64, f64, Option<f64>),
}

/// How far the measured motion from one pose to another is from the expected one: along both coordinates of the robot \[m\] and,
/// where headings were measured, its rotation \[rad\].
pub(super) fn difference(from: &Sighting, to: &Sighting) -> ([f64; 2], Option<f64>) {
    let expected = from.expected.between(&to.expected);
    let (x, y) = (to.measured.0 - from.measured.0, to.measured.1 - from.measured.1);
    let (Some(before), Some(after)) = (from.measured.2, to.measured.2) else {
        // Without headings, only the direction of motion can align the two.
        return ([libm::hypot(x, y) - libm::hypot(expected.x, expected.y), 0.0], None);
    };
    let (sine, cosine) = libm::sincos(before);
    let moved = [cosine * x + sine * y - expected.x, cosine * y - sine * x - expected.y];
    (moved, Some(wrap(after - before - expected.heading)))
}

/// Variances of a coordinate \[m²\] and of a rotation \[rad²\], by how far the wheels rolled: a + b · rolled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    position: [f64; 2],
    heading: [f64; 2],
}

impl Spread {
    /// From all runs, with the noise of a single pose: half the variance between two poses at the same place. Neither is below what whole
    /// counts make, of which `counted` holds the variances of a pose \[m², rad²\]: most poses may be measured at rest, where the counts say
    /// the same.
    pub fn of(runs: &[Vec<Sighting>], counted: [f64; 2]) -> (Spread, PoseNoise) {
        let mut edges: Vec<(f64, f64, Option<f64>)> = Vec::new();
        let is_taken = taken(runs.iter().map(Vec::len).sum());
        for run in runs {
            for over in OVER {
                let windows = run.windows(over + 1).enumerate().filter(|(place, _)| is_taken(*place));
                edges.extend(windows.map(|(_, poses)| {
                    let (from, to) = (&poses[0], &poses[over]);
                    let ([x, y], turned) = difference(from, to);
                    // The median of chi-squared with two degrees of freedom, and with one.
                    let square = if turned.is_some() { (x * x + y * y) / 1.386 } else { x * x / 0.455 };
                    (to.rolled - from.rolled, square, turned.map(|t| t * t / 0.455))
                }));
            }
        }
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let part = edges.len().div_ceil(PARTS).max(1);
        let (mut positions, mut headings) = (Vec::new(), Vec::new());
        for part in edges.chunks(part) {
            let rolled = median(part.iter().map(|edge| edge.0));
            positions.push((rolled, median(part.iter().map(|edge| edge.1))));
            headings.push((rolled, median(part.iter().filter_map(|edge| edge.2))));
        }
        let least = |line: [f64; 2], least: f64| [line[0].max(least * least), line[1]];
        let [steps, turns] = rounded(runs);
        let [steps, turns] =
            [(steps, counted[0]), (turns, counted[1])].map(|(step, counted)| step.max((2.0 * counted).sqrt()));
        let (position, heading) = (least(rising(&positions), steps), least(rising(&headings), turns));
        let noise = PoseNoise { position: (0.5 * position[0]).sqrt(), heading: (0.5 * heading[0]).sqrt() };
        (Spread { position: least(position, LEAST[0]), heading: least(heading, LEAST[1]) }, noise)
    }

    /// How far two poses of a run differ, in standard deviations.
    pub fn deviations(&self, from: &Sighting, to: &Sighting) -> f64 {
        let ([x, y], turned) = difference(from, to);
        let rolled = to.rolled - from.rolled;
        let seconds = (to.time - from.time).max(JITTER);
        let variance = |line: &[f64; 2], moved: f64| {
            line[0] + line[1] * rolled + (JITTER * moved / seconds).powi(2) + (SIZES * moved).powi(2)
        };
        let turned = turned.map_or(0.0, |turned| turned * turned / variance(&self.heading, to.turned - from.turned));
        ((x * x + y * y) / variance(&self.position, to.way - from.way) + turned).sqrt()
    }

    /// Mean square of the standard deviations between poses of all runs, in which no pair counts more than a jump.
    pub fn misfit(&self, runs: &[Vec<Sighting>]) -> f64 {
        let squares = runs.iter().flat_map(|run| {
            run.windows(APART + 1).map(|poses| self.deviations(&poses[0], &poses[APART]).min(JUMP).powi(2))
        });
        let (sum, pairs) = squares.fold((0.0, 0), |(sum, pairs), square| (sum + square, pairs + 1));
        sum / f64::from(pairs.max(1))
    }
}

/// Which of so many edges are taken, by their place: all, or about [`ENOUGH`] of them, spread evenly by the golden ratio, so that no rhythm of a
/// recorder hides the others.
fn taken(all: usize) -> impl Fn(usize) -> bool {
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    let share = ENOUGH as f64 / all.max(1) as f64;
    let below = if share >= 1.0 { u64::MAX } else { (share * u64::MAX as f64) as u64 };
    move |place| (place as u64).wrapping_mul(GOLDEN) <= below
}

/// Standard deviation that rounding makes in the difference of two coordinates \[m\] and of two headings \[rad\]: a step over the root of 6
/// if most poses repeat the number of the one before, else 0.
fn rounded(runs: &[Vec<Sighting>]) -> [f64; 2] {
    let pairs = || runs.iter().flat_map(|run| run.windows(2)).map(|pair| (pair[0].measured, pair[1].measured));
    let positions = pairs().flat_map(|(a, b)| [b.0 - a.0, b.1 - a.1]).collect();
    let headings = pairs().filter_map(|(a, b)| Some(b.2? - a.2?)).collect();
    let of = |mut changes: Vec<f64>| {
        let all = changes.len();
        changes.retain(|change| *change != 0.0);
        let step = quantile(changes.iter().map(|change| change.abs()), SMALLEST);
        if 2 * changes.len() < all { step / 6f64.sqrt() } else { 0.0 }
    };
    [positions, headings].map(of)
}

/// a + b x through medians, neither of them negative.
fn rising(points: &[(f64, f64)]) -> [f64; 2] {
    let n = points.len().max(1) as f64;
    // The uncertainty of a variance is proportional to the variance.
    let weight = |y: f64| 1.0 / (y * y).max(1e-30);
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|(x, y)| weight(*y) * of(*x, *y)).sum::<f64>();
    let (w, x, y, xx, xy) = (sum(&|_, _| 1.0), sum(&|x, _| x), sum(&|_, y| y), sum(&|x, _| x * x), sum(&|x, y| x * y));
    let slope = (w * xy - x * y) / (w * xx - x * x);
    let base = (y - slope * x) / w;
    match (slope.is_finite() && slope > 0.0, base >= 0.0) {
        (true, true) => [base, slope],
        (true, false) => [0.0, xy / xx],
        _ => [points.iter().map(|(_, y)| y).sum::<f64>() / n, 0.0],
    }
}

/// From one kept pose to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub from: usize,
    pub to: usize,
    pub deviations: f64,
}

impl Edge {
    pub fn between(run: &[Sighting], from: usize, to: usize, spread: &Spread) -> Edge {
        Edge { from, to, deviations: spread.deviations(&run[from], &run[to]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_edges_enough_are_taken_evenly_and_in_every_rhythm_and_of_few_all() {
        assert!((0..ENOUGH).all(taken(ENOUGH)));
        for all in [ENOUGH + 1, 10 * ENOUGH, 24 * ENOUGH] {
            let is_taken = taken(all);
            for rhythm in [1, 2, 3, 5, 8, 10] {
                for beat in 0..rhythm {
                    let share = (beat..all).step_by(rhythm).filter(|place| is_taken(*place)).count();
                    let expected = ENOUGH as f64 / rhythm as f64;
                    assert!((share as f64 / expected - 1.0).abs() < 0.01, "{all} {rhythm} {beat}: {share}");
                }
            }
        }
    }
}
