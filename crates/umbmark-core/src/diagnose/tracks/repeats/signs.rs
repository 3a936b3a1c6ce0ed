//! The test itself: sums over units of every law's column, and the greatest of them as signs are flipped.

use super::laws::Laws;
use super::steps::TrackStep;
use crate::diagnose::tracks::smooth::Motion;
use crate::likelihood::{Column, Noise, ObservedRun, ScaledCholesky, scaled_cholesky};
use crate::random::Stream;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// A column is not tested where less than this share of it is left beside the model.
const LEFT: f64 = 1.0 / 400.0;
/// Number of laws that are whitened together, and of columns that are flipped together.
const CHUNK: usize = 64;
/// Flips, the signs as they are among them.
const FLIPS: usize = 512;
/// Fewer runs are flipped by quarters; so is a column that fewer runs carry.
const ENOUGH_RUNS: usize = 10;
const ENOUGH_CARRYING: f64 = 6.0;
/// Purpose of the stream of random flips.
const PURPOSE: u64 = 0x7265_7065;
/// Share of a sum's variance that is left of it at least, however the signs fall.
const LEAST: f64 = 1e-3;

/// Sums over a unit, for each column: of its square, of its products with the residual and with the model's own columns.
pub(super) struct Sums {
    /// The run.
    pub run: usize,
    pub squares: Vec<f64>,
    pub scores: Vec<f64>,
    /// One a model's column.
    pub shared: Vec<Vec<f64>>,
    /// Products of the model's columns, and of these with the residual.
    pub own: DMatrix<f64>,
    pub own_scores: DVector<f64>,
}

/// The sums of the units of a run.
pub(super) fn of_run(
    index: usize,
    run: &ObservedRun,
    own: &[Column],
    laws: &Laws,
    steps: &[TrackStep],
    noise: &Noise,
) -> Vec<Sums> {
    let all: Vec<usize> = (0..laws.terms.len()).collect();
    let count = Motion::ALL.len() * all.len();
    let width = own.len() - 1;
    let units = run.blocks.chunk_by(|a, b| a.unit == b.unit).count();
    let mut sums: Vec<Sums> = (0..units)
        .map(|_| Sums {
            run: index,
            squares: Vec::with_capacity(count),
            scores: Vec::with_capacity(count),
            shared: vec![Vec::with_capacity(count); width],
            own: DMatrix::zeros(width, width),
            own_scores: DVector::zeros(width),
        })
        .collect();
    let mut unit_of = vec![0; run.blocks.len()];
    for k in 1..run.blocks.len() {
        unit_of[k] = unit_of[k - 1] + usize::from(run.blocks[k].unit != run.blocks[k - 1].unit);
    }
    for (number, terms) in all.chunks(CHUNK).enumerate() {
        let chunk = laws.columns(terms, run, steps);
        let refs: Vec<&[[f64; 3]]> = own.iter().chain(&chunk).map(Vec::as_slice).collect();
        let white = noise.whiten(run, &refs);
        let first = sums.first().map_or(0, |unit| unit.squares.len());
        for unit in &mut sums {
            let whole = first + chunk.len();
            unit.squares.resize(whole, 0.0);
            unit.scores.resize(whole, 0.0);
            unit.shared.iter_mut().for_each(|shared| shared.resize(whole, 0.0));
        }
        for (row, block) in white.rows().zip(&white.block) {
            let unit = &mut sums[unit_of[*block]];
            let (own, values) = row.split_at(width + 1);
            let add = |to: &mut [f64], by: f64| to.iter_mut().zip(values).for_each(|(to, value)| *to += by * value);
            unit.squares[first..].iter_mut().zip(values).for_each(|(to, value)| *to += value * value);
            add(&mut unit.scores[first..], own[width]);
            for (shared, by) in unit.shared.iter_mut().zip(own) {
                add(&mut shared[first..], *by);
            }
            if number == 0 {
                for i in 0..width {
                    unit.own_scores[i] += own[i] * own[width];
                    for j in 0..width {
                        unit.own[(i, j)] += own[i] * own[j];
                    }
                }
            }
        }
    }
    sums
}

/// All columns beside the model's: of each unit what it says, and how much of the model's columns, made orthonormal, it holds.
pub(super) struct Asked {
    /// The run of each unit.
    runs: Vec<usize>,
    /// Units by columns.
    scores: DMatrix<f64>,
    /// The same, one of each of the model's columns.
    held: Vec<DMatrix<f64>>,
    /// Squares of what is left of each column; 0 where that is too little.
    left: Vec<f64>,
    /// How many runs carry it.
    carrying: Vec<f64>,
}

impl Asked {
    /// `senses`: what the columns of each unit are multiplied by.
    pub fn new(sums: &[Sums], senses: &[f64]) -> Option<Asked> {
        let first = sums.first()?;
        let (columns, width) = (first.squares.len(), first.own.nrows());
        let whole = sums.iter().fold(DMatrix::zeros(width, width), |sum, unit| sum + &unit.own);
        let scores = sums.iter().fold(DVector::zeros(width), |sum, unit| sum + &unit.own_scores);
        let solver: Option<ScaledCholesky> = if width > 0 { Some(scaled_cholesky(&whole)?) } else { None };
        let solve = |right: &DMatrix<f64>| solver.as_ref().map_or_else(|| right.clone(), |s| s.solve(right));
        let half = |right: &DMatrix<f64>| solver.as_ref().map_or_else(|| right.clone(), |s| s.half(right));
        let shared = DMatrix::from_fn(width, columns, |i, k| {
            sums.iter().zip(senses).map(|(unit, sense)| sense * unit.shared[i][k]).sum()
        });
        let values = solve(&shared);
        let fitted = solve(&DMatrix::from_column_slice(width, 1, scores.as_slice()));
        let square =
            |k: usize| -> f64 { sums.iter().zip(senses).map(|(unit, sense)| sense * sense * unit.squares[k]).sum() };
        let left = (0..columns).map(|k| {
            let (whole, gone) = (square(k), values.column(k).dot(&shared.column(k)));
            if whole > 0.0 && whole - gone > LEFT * whole { whole - gone } else { 0.0 }
        });
        let left: Vec<f64> = left.collect();
        let mut weights = vec![vec![0.0; columns]; sums.iter().map(|s| s.run + 1).max()?];
        let mut all = DMatrix::zeros(sums.len(), columns);
        let mut held = vec![DMatrix::zeros(sums.len(), columns); width];
        for (index, (unit, sense)) in sums.iter().zip(senses).enumerate() {
            let own_values = &unit.own * &values;
            let residual_scores = &unit.own_scores - &unit.own * &fitted;
            for k in 0..columns {
                let own: f64 = (0..width).map(|i| unit.shared[i][k] * fitted[(i, 0)]).sum();
                all[(index, k)] = sense * (unit.scores[k] - own) - values.column(k).dot(&residual_scores);
                let cross: f64 = (0..width).map(|i| sense * unit.shared[i][k] * values[(i, k)]).sum();
                let own = values.column(k).dot(&own_values.column(k));
                weights[unit.run][k] += sense * sense * unit.squares[k] - 2.0 * cross + own;
            }
            let rest = DMatrix::from_fn(width, columns, |i, k| sense * unit.shared[i][k] - own_values[(i, k)]);
            let orthonormal = half(&rest);
            held.iter_mut().enumerate().for_each(|(i, held)| held.set_row(index, &orthonormal.row(i)));
        }
        let carrying = |k: usize| {
            let (sum, squares) = weights.iter().fold((0.0, 0.0), |(s, q), w| (s + w[k], q + w[k] * w[k]));
            if squares > 0.0 { sum * sum / squares } else { 0.0 }
        };
        let carrying = (0..columns).map(carrying).collect();
        Some(Asked { runs: sums.iter().map(|unit| unit.run).collect(), scores: all, held, left, carrying })
    }

    /// How many columns the data could show.
    pub fn shown(&self) -> usize {
        self.left.iter().filter(|left| **left > 0.0).count()
    }

    /// Square of the score of a column in standard deviations; 0 where the data could not show it.
    pub fn square(&self, column: usize) -> f64 {
        let left = self.left[column];
        if left > 0.0 { self.scores.column(column).sum().powi(2) / left } else { 0.0 }
    }

    /// The columns that are flipped by whole runs, or by quarters of runs, units of a run together where they are flipped together.
    fn family(&self, by_run: bool) -> Family {
        let runs = self.runs.iter().max().map_or(0, |last| last + 1);
        let few = runs < ENOUGH_RUNS;
        let own = |k: &usize| self.left[*k] > 0.0 && by_run == (!few && self.carrying[*k] >= ENOUGH_CARRYING);
        let columns: Vec<usize> = (0..self.left.len()).filter(own).collect();
        let units = if by_run { runs } else { self.runs.len() };
        let together = |all: &DMatrix<f64>| {
            let mut sum = DMatrix::zeros(units, columns.len());
            for (unit, run) in self.runs.iter().enumerate() {
                let row = if by_run { *run } else { unit };
                columns.iter().enumerate().for_each(|(place, k)| sum[(row, place)] += all[(unit, *k)]);
            }
            sum
        };
        Family {
            scores: together(&self.scores),
            held: self.held.iter().map(together).collect(),
            left: columns.iter().map(|k| self.left[*k]).collect(),
        }
    }
}

/// Columns that are flipped by the same units.
struct Family {
    scores: DMatrix<f64>,
    held: Vec<DMatrix<f64>>,
    left: Vec<f64>,
}

impl Family {
    /// The greatest square of all columns under each row of signs.
    fn greatest(&self, signs: &DMatrix<f64>) -> Vec<f64> {
        let of_chunk = |first: usize| {
            let count = CHUNK.min(self.left.len() - first);
            let scores = signs * self.scores.columns(first, count);
            let mut variance = DMatrix::from_fn(signs.nrows(), count, |_, k| (1.0 + LEAST) * self.left[first + k]);
            for held in &self.held {
                let held = signs * held.columns(first, count);
                variance.zip_apply(&held, |variance, held| *variance -= held * held);
            }
            let quotient =
                |row: usize, k: usize| scores[(row, k)].powi(2) / variance[(row, k)].max(LEAST * self.left[first + k]);
            (0..signs.nrows()).map(|row| (0..count).map(|k| quotient(row, k)).fold(0.0, f64::max)).collect()
        };
        let chunks: Vec<usize> = (0..self.left.len()).step_by(CHUNK).collect();
        let greatest: Vec<Vec<f64>> = chunks.into_par_iter().map(of_chunk).collect();
        (0..signs.nrows()).map(|row| greatest.iter().map(|chunk| chunk[row]).fold(0.0, f64::max)).collect()
    }
}

/// p of all columns together: flips the signs of runs, and of their quarters where few runs carry a column.
pub(super) fn p_of_all(asked: &[&Asked], seed: u64) -> Option<f64> {
    let mut families = 0.0;
    let mut least: Option<f64> = None;
    for by_run in [true, false] {
        let own: Vec<Family> = asked.iter().map(|asked| asked.family(by_run)).collect();
        let Some(units) = own.iter().find(|family| !family.left.is_empty()).map(|family| family.scores.nrows()) else {
            continue;
        };
        families += 1.0;
        let signs = signs(units, seed);
        let greatest = own.iter().map(|family| family.greatest(&signs));
        let greatest = greatest.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| f64::max(*a, *b)).collect())?;
        let beyond = greatest.iter().filter(|other| **other >= greatest[0] * (1.0 - 1e-9)).count();
        let p = beyond as f64 / FLIPS as f64;
        least = Some(least.map_or(p, |least| least.min(p)));
    }
    least.map(|p| (families * p).min(1.0))
}

/// Signs of some units, a row a flip; as they are in the first.
fn signs(units: usize, seed: u64) -> DMatrix<f64> {
    let mut signs = DMatrix::from_element(FLIPS, units, 1.0);
    for flip in 1..FLIPS {
        let mut stream = Stream::new(seed, PURPOSE, flip as u64);
        (0..units).for_each(|unit| signs[(flip, unit)] = if stream.uniform() < 0.5 { -1.0 } else { 1.0 });
    }
    signs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of ten runs of four quarters, of whose columns and residuals nothing is known but that signs of runs are chance: the residual of
    /// a run is one value with t4 tails.
    fn sums(stream: &mut Stream, columns: usize, shift: f64) -> Vec<Sums> {
        let width = 4;
        (0..10)
            .flat_map(|run| {
                let size: f64 = (0..4).map(|_| stream.normal().powi(2)).sum();
                let residual = stream.normal() / (size / 4.0).sqrt();
                let quarters: Vec<Sums> = (0..4)
                    .map(|_| {
                        let own: Vec<f64> = (0..width).map(|_| stream.normal()).collect();
                        let asked: Vec<f64> = (0..columns).map(|_| stream.normal()).collect();
                        let residual = residual + shift * asked[0];
                        Sums {
                            run,
                            squares: asked.iter().map(|value| value * value).collect(),
                            scores: asked.iter().map(|value| value * residual).collect(),
                            shared: own.iter().map(|own| asked.iter().map(|value| own * value).collect()).collect(),
                            own: DMatrix::from_fn(width, width, |i, j| own[i] * own[j]),
                            own_scores: DVector::from_iterator(width, own.iter().map(|own| own * residual)),
                        }
                    })
                    .collect();
                quarters
            })
            .collect()
    }

    /// 300 cases of 40 laws beside 4 columns, seed 8.
    #[test]
    fn the_size_of_one_p_for_all_is_held_where_runs_are_as_likely_to_either_side() {
        let p = |stream: &mut Stream, shift: f64| {
            let asked = Asked::new(&sums(stream, 40, shift), &[1.0; 40]).unwrap();
            let best = (0..40).max_by(|a, b| asked.square(*a).total_cmp(&asked.square(*b))).unwrap();
            (p_of_all(&[&asked], 1).unwrap(), best)
        };
        let mut stream = Stream::new(8, 0, 0);
        let accused = (0..300).filter(|_| p(&mut stream, 0.0).0 <= 0.05).count();
        assert!(accused <= 25, "{accused} of 300");
        let found = (0..50).filter(|_| matches!(p(&mut stream, 4.0), (p, 0) if p <= 0.01)).count();
        assert!(found >= 45, "{found} of 50");
    }
}
