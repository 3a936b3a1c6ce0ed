//! Places where a run is disturbed by more than its noise: bumps met by chance, and poses of the reference that are off.
//!
//! What a kick between two blocks, or a pose that is off, would add to all that is new behind it follows from the filter's own gains, and
//! one pass back along the run gathers the score of each:
//!
//! r ← Aᵀ v + Mᵀ r,  N ← Aᵀ A + Mᵀ N M,  A = L⁻¹ H,  M = I - Wᵀ A.
//!
//! A kick has the score rᵀ N⁻¹ r; a pose that is off has hᵀ (I + W N Wᵀ)⁻¹ h, h = v - W r with r and N of what lies behind it. Both are χ²
//! where there is noise alone.
//!
//! Source: auxiliary residuals, Harvey & Koopman (1992); de Jong & Penzer (1998).

use super::{NOT_MEASURED, Stage, States, add};
use crate::likelihood::{Column, Noise, ObservedRun};
use crate::stats::chi_squared_upper_tail;
use nalgebra::{Matrix3, Vector3};

/// Probability with which anything is named in a run in which there is noise alone.
const SIZE: f64 = 0.005;
/// Disturbances nearer to each other than this are one \[m\].
const NEAR: f64 = 0.15;
/// Blocks that are spent on START.
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
    /// Whether the robot was moved and stayed so; else the reference was off for a moment.
    pub lasts: bool,
    /// How far ahead \[m\], to the left \[m\], and how far to the left it turned \[rad\]; the last is 0 where headings were not measured.
    pub by: [f64; 3],
    /// In standard deviations.
    pub deviations: f64,
}

/// What stands out at a block.
struct Standing {
    block: usize,
    lasts: bool,
    by: Vector3<f64>,
    square: f64,
}

impl Noise {
    /// Where what is left of a run stands out of this noise.
    pub fn disturbances(&self, run: &ObservedRun, left: &Column, wheelbase: f64) -> Vec<Disturbance> {
        let mut all = self.scores(run, left);
        let rows: f64 = if run.blocks.iter().any(|block| block.headings > 0) { 3.0 } else { 2.0 };
        let mut squares: Vec<f64> = all.iter().map(|standing| standing.square).collect();
        squares.sort_by(f64::total_cmp);
        // The greater of two: the median of all is that of a χ² or above it, unless this run is noisier than the others.
        let usual = squares.get(squares.len() / 2).map_or(1.0, |middle| middle / MEDIAN).max(1.0);
        all.retain(|standing| chi_squared_upper_tail(standing.square / usual, rows) * run.blocks.len() as f64 <= SIZE);
        all.sort_by(|a, b| b.square.total_cmp(&a.square));
        let rolled = run.rolled(wheelbase);
        let mut named: Vec<Standing> = Vec::new();
        for standing in all {
            let is_near = |known: &Standing| {
                (rolled[known.block] - rolled[standing.block]).abs() <= NEAR
                    || known.block.abs_diff(standing.block) <= 1
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
                deviations: (standing.square / usual).sqrt(),
            }
        });
        told.collect()
    }

    /// Of each block the greater of two scores: that of a kick before it, and that of its pose being off.
    fn scores(&self, run: &ObservedRun, left: &Column) -> Vec<Standing> {
        let mut p = self.start(run.start_seen);
        let mut states = States::new(1);
        let mut passed = Vec::with_capacity(run.blocks.len());
        for (block, left) in run.blocks.iter().zip(left) {
            add(&mut p, &self.growth(&block.growth));
            if block.afresh {
                add(&mut p, &self.start(true));
            }
            let stage = Stage::new(block, &p, &self.measurement(block));
            if let Some(stage) = &stage {
                states.take_in(stage, std::iter::once(left));
                stage.take(&mut p);
            }
            passed.push(stage.map(|stage| (stage, states.new.each_ref().map(|new| new[0]))));
        }
        let (mut r, mut n) = (Vector3::zeros(), Matrix3::zeros());
        let mut standing = Vec::new();
        for (index, stage) in passed.iter().enumerate().rev() {
            let Some((stage, new)) = stage else { continue };
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

/// Median of the greater of two χ² of three degrees of freedom that are nearly one.
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
