//! Places where a run is disturbed by more than its noise: accidental bumps, and wrong poses of the reference.
//!
//! The filter's gains determine how a kick between two blocks, or a wrong pose, would change all later innovations. One backward pass along
//! the run computes the score of each:
//!
//! r ← Aᵀ v + Mᵀ r,  N ← Aᵀ A + Mᵀ N M,  A = L⁻¹ H,  M = I - Wᵀ A.
//!
//! A kick has the score rᵀ N⁻¹ r; a wrong pose has hᵀ (I + W N Wᵀ)⁻¹ h, h = v - W r with r and N of what lies behind it. Both are χ² if
//! there is only noise.
//!
//! Source: auxiliary residuals, Harvey & Koopman (1992); de Jong & Penzer (1998).

use super::{NOT_MEASURED, Stage, States, add, diagonal};
use crate::likelihood::outliers::beyond_tails;
use crate::likelihood::{Column, Noise, ObservedRun};
use crate::stats::chi_squared_upper_tail;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// False-alarm rate per run that contains only noise.
const SIZE: f64 = 0.005;
/// Probability that, by the tails of the residuals, any block at all reaches a named disturbance.
const LEVEL: f64 = 0.05;
/// Disturbances closer to each other than this are the same one \[m\].
const NEAR: f64 = 0.15;
/// Blocks that determine START.
const SPENT: usize = 2;

/// A place where a run is disturbed.
#[derive(Clone, Debug, PartialEq)]
pub struct Disturbance {
    /// The run.
    pub run: String,
    /// Time since START \[s\].
    pub time: f64,
    /// How far the wheels have rolled by then \[m\].
    pub rolled: f64,
    /// Whether the robot was displaced for good; otherwise the reference was wrong for a moment.
    pub lasts: bool,
    /// How far ahead \[m\], to the left \[m\], and how far to the left it turned \[rad\]; the last is 0 where headings were not measured.
    pub by: [f64; 3],
    /// In standard deviations.
    pub deviations: f64,
}

/// The most significant disturbance at a block.
struct Standing {
    block: usize,
    lasts: bool,
    by: Vector3<f64>,
    square: f64,
}

impl Noise {
    /// Places where the residuals of some runs exceed this noise, and the tails of the residuals themselves.
    pub fn disturbances(&self, runs: &[ObservedRun], left: &[Column], wheelbase: f64) -> Vec<Disturbance> {
        let scores: Vec<Vec<Standing>> =
            runs.par_iter().zip(left).map(|(run, left)| less_usual(self.scores(run, left))).collect();
        let deviations = |own: &Vec<Standing>| own.iter().map(|standing| standing.square.sqrt()).collect();
        let tails = beyond_tails(&scores.iter().map(deviations).collect::<Vec<_>>(), LEVEL);
        let of_run = |(run, scores)| named(run, scores, tails, wheelbase);
        runs.iter().zip(scores).flat_map(of_run).collect()
    }

    /// For each block the larger of two scores: that of a kick before it and that of a wrong pose.
    fn scores(&self, run: &ObservedRun, left: &Column) -> Vec<Standing> {
        let mut p = self.start(run.start_seen);
        let mut states = States::new(1);
        let mut passed = Vec::with_capacity(run.blocks.len());
        for (index, (block, left)) in run.blocks.iter().zip(left).enumerate() {
            if run.relative {
                if !run.has_step(index) {
                    passed.push(None);
                    continue;
                }
                p = diagonal([0.0; 3]);
                states.forget();
            }
            if block.afresh {
                add(&mut p, &self.start(true));
            }
            let stage = Stage::new(block, &mut p, self);
            if let Some(stage) = &stage {
                states.take_in(stage, std::iter::once(left));
            }
            passed.push(stage.map(|stage| (stage, states.new.each_ref().map(|new| new[0]))));
        }
        let (mut r, mut n) = (Vector3::zeros(), Matrix3::zeros());
        let mut standing = Vec::new();
        for (index, stage) in passed.iter().enumerate().rev() {
            let Some((stage, new)) = stage else { continue };
            if run.relative {
                (r, n) = (Vector3::zeros(), Matrix3::zeros());
            }
            let (w, v) = (Matrix3::from_fn(|i, j| stage.w[i][j]), Vector3::from(*new));
            let sighted = Matrix3::new(1.0, 0.0, -stage.y, 0.0, 1.0, stage.x, 0.0, 0.0, 1.0);
            let column = |j: usize| Vector3::from(stage.solved([sighted[(0, j)], sighted[(1, j)], sighted[(2, j)]]));
            let a = Matrix3::from_columns(&[column(0), column(1), column(2)]);
            let off = v - w * r;
            let glance = (Matrix3::identity() + w * n * w.transpose()).cholesky();
            let kept = Matrix3::identity() - w.transpose() * a;
            r = a.transpose() * v + kept.transpose() * r;
            n = a.transpose() * a + kept.transpose() * n * kept;
            if index < SPENT || run.blocks[index].afresh {
                continue;
            }
            let kick = scaled(&n).map(|(inverse, scale)| {
                let by = (inverse * r.component_mul(&scale)).component_mul(&scale);
                Standing { block: index, lasts: true, by: sighted * by, square: by.dot(&r) }
            });
            let glance = glance.map(|glance| {
                let by = glance.solve(&off);
                Standing { block: index, lasts: false, by: stage.spread(&by), square: by.dot(&off) }
            });
            standing.extend([kick, glance].into_iter().flatten().max_by(|a, b| a.square.total_cmp(&b.square)));
        }
        standing
    }
}

/// Scores scaled to the usual size in their run, if that exceeds the noise: their median is then that of a χ².
fn less_usual(mut scores: Vec<Standing>) -> Vec<Standing> {
    let mut squares: Vec<f64> = scores.iter().map(|standing| standing.square).collect();
    squares.sort_by(f64::total_cmp);
    let usual = squares.get(squares.len() / 2).map_or(1.0, |middle| middle / MEDIAN).max(1.0);
    scores.iter_mut().for_each(|standing| standing.square /= usual);
    scores
}

/// Disturbances of a run that exceed the noise and its `tails`; only the most significant one of neighbours.
fn named(run: &ObservedRun, mut scores: Vec<Standing>, tails: f64, wheelbase: f64) -> Vec<Disturbance> {
    let rows: f64 = if run.blocks.iter().any(|block| block.headings > 0) { 3.0 } else { 2.0 };
    let blocks = run.blocks.len() as f64;
    scores.retain(|standing| {
        standing.square > tails * tails && chi_squared_upper_tail(standing.square, rows) * blocks <= SIZE
    });
    scores.sort_by(|a, b| b.square.total_cmp(&a.square));
    let rolled = run.rolled(wheelbase);
    let mut named: Vec<Standing> = Vec::new();
    for standing in scores {
        let is_near = |known: &Standing| {
            (rolled[known.block] - rolled[standing.block]).abs() <= NEAR || known.block.abs_diff(standing.block) <= 1
        };
        if !named.iter().any(is_near) {
            named.push(standing);
        }
    }
    named.sort_by_key(|standing| standing.block);
    let told = named.into_iter().map(|standing| {
        let block = &run.blocks[standing.block];
        let (sine, cosine) = libm::sincos(block.place.heading);
        let [x, y, turned] = [standing.by[0], standing.by[1], standing.by[2]];
        Disturbance {
            run: run.name.clone(),
            time: run.track.sights()[block.first].time,
            rolled: rolled[standing.block],
            lasts: standing.lasts,
            by: [cosine * x + sine * y, cosine * y - sine * x, if block.headings > 0 { turned } else { 0.0 }],
            deviations: standing.square.sqrt(),
        }
    });
    told.collect()
}

/// Median of the larger of two strongly correlated χ² of three degrees of freedom.
const MEDIAN: f64 = 2.37;

/// The inverse of S N S, S what makes its diagonal ones; `None` where it has none.
fn scaled(n: &Matrix3<f64>) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    let scale = Vector3::from_fn(|k, _| if n[(k, k)] > NOT_MEASURED.powi(-2) { 1.0 / n[(k, k)].sqrt() } else { 0.0 });
    let mut unit = Matrix3::from_fn(|i, j| n[(i, j)] * scale[i] * scale[j]);
    (0..3).filter(|k| scale[*k] == 0.0).for_each(|k| unit[(k, k)] = 1.0);
    Some((unit.cholesky()?.inverse(), scale))
}

impl Stage<f64> {
    /// L v.
    fn spread(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let ([d0, d1, d2], [l10, l20, l21]) = (self.diagonal, self.below);
        Vector3::new(d0 * v[0], l10 * v[0] + d1 * v[1], l20 * v[0] + l21 * v[1] + d2 * v[2])
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{noise, run};
    use super::*;
    use crate::dataset::Dataset;
    use crate::diagnose::first_model;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::geometry::wrap;
    use crate::likelihood::watched::watched;
    use crate::likelihood::{Fitted, Observed};
    use crate::random::Stream;

    /// Oracle: the columns of a kick and of a wrong pose, whitened like any others.
    #[test]
    fn scores_are_those_of_whitened_columns() {
        let (run, noise) = (run(true), Noise { reference_delay: 0.0, ..noise() });
        let mut stream = Stream::new(3, 0, 0);
        let left: Column = run.blocks.iter().map(|_| std::array::from_fn(|_| 0.01 * stream.normal())).collect();
        let kick = |at: usize, state: [f64; 3]| -> Column {
            let moved = |(index, block): (usize, &crate::likelihood::Block)| {
                let [x, y, turn] = if index < at { [0.0; 3] } else { state };
                [x - block.place.y * turn, y + block.place.x * turn, turn]
            };
            run.blocks.iter().enumerate().map(moved).collect()
        };
        let glance = |at: usize, by: [f64; 3]| -> Column {
            (0..run.blocks.len()).map(|index| if index == at { by } else { [0.0; 3] }).collect()
        };
        let unit = |k: usize| std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 });
        for standing in noise.scores(&run, &left) {
            let seen = if run.blocks[standing.block].headings > 0 { 3 } else { 2 };
            let square = |columns: Vec<Column>| {
                let all: Vec<&[[f64; 3]]> = columns.iter().map(Vec::as_slice).chain([left.as_slice()]).collect();
                let white = noise.whiten(&run, &all);
                let mut products = nalgebra::DMatrix::<f64>::zeros(columns.len(), columns.len());
                let mut score = nalgebra::DVector::<f64>::zeros(columns.len());
                for row in white.rows() {
                    for i in 0..columns.len() {
                        score[i] += row[i] * row[columns.len()];
                        (0..columns.len()).for_each(|j| products[(i, j)] += row[i] * row[j]);
                    }
                }
                score.dot(&products.cholesky().unwrap().solve(&score))
            };
            let kicked = square((0..3).map(|k| kick(standing.block, unit(k))).collect());
            let off = square((0..seen).map(|k| glance(standing.block, unit(k))).collect());
            let (most, lasts) = if kicked > off { (kicked, true) } else { (off, false) };
            assert!((standing.square - most).abs() < 1e-6 * most, "{} {kicked} {off}", standing.square);
            // At the last block, a kick and a wrong pose are equivalent.
            assert!(standing.lasts == lasts || (kicked - off).abs() < 1e-6 * most);
        }
    }

    fn robot() -> Model {
        let mut model = Model::new(&Robot::labmate());
        for (effect, parameter, value) in [
            ("wheel_noise", "k_sqrt_m", 4e-4),
            ("reference_noise", "position_sd_m", 8e-4),
            ("reference_noise", "heading_sd_rad", 8e-4),
        ] {
            model.set(effect, parameter, value).unwrap();
        }
        model
    }

    fn fitted(data: &Dataset) -> Fitted {
        let observed = Observed::new(data, &Robot::labmate()).unwrap();
        let fitted = observed.fit(&first_model(data).unwrap(), &Noise::default(), &[]).unwrap();
        assert_eq!(fitted.outliers, []);
        fitted
    }

    /// Disturbances found in the runs of a fit after one block of the first run is displaced by this.
    fn disturbances(fitted: &Fitted, off: [f64; 3]) -> Vec<Disturbance> {
        let chain = fitted.model.chain();
        let mut left: Vec<Column> = fitted.observed.runs.iter().map(|run| run.residuals_along(&chain)).collect();
        (0..3).for_each(|k| left[0][40][k] += off[k]);
        fitted.noise.disturbances(&fitted.observed.runs, &left, 0.34)
    }

    #[test]
    fn a_bump_and_a_pose_that_is_off_are_told_apart_and_noise_is_neither() {
        let mut data = watched(&robot(), 3, 5);
        let plain = fitted(&data);
        assert_eq!(disturbances(&plain, [0.0; 3]), []);
        let found = disturbances(&plain, [0.008, -0.004, 0.0]);
        let [off] = &found[..] else { panic!("{found:?}") };
        assert!(off.run == data.runs[0].name && !off.lasts, "{off:?}");
        assert!((off.by[0].hypot(off.by[1]) - 0.009).abs() < 0.003, "{off:?}");
        // All that follows a bump is turned by a third of a degree about its place.
        let name = data.runs[1].name.clone();
        let log = data.runs[1].log.as_mut().unwrap();
        let (at, (sine, cosine)) = (log.reference[150], libm::sincos(0.006));
        for pose in &mut log.reference[151..] {
            let (dx, dy) = (pose.x - at.x, pose.y - at.y);
            (pose.x, pose.y) = (at.x + cosine * dx - sine * dy, at.y + sine * dx + cosine * dy);
            pose.heading = pose.heading.map(|heading| wrap(heading + 0.006));
        }
        let bumped_at = log.time[at.sample] - log.time[0];
        let found = disturbances(&fitted(&data), [0.0; 3]);
        let [bump] = &found[..] else { panic!("{found:?}") };
        assert!(bump.run == name && bump.lasts && (bump.time - bumped_at).abs() < 0.2, "{bump:?} {bumped_at}");
        assert!((bump.by[2] - 0.006).abs() < 0.002, "{bump:?}");
    }
}
