//! The numbers that shape a law, fitted: a period, a threshold, a place.
//!
//! Laws are tested on a grid of these numbers. Before laws are compared with each other, the numbers of each significant law are
//! fitted: its sizes are fitted out at every trial, together with the model's own columns, and the numbers follow by Gauss-Newton steps under
//! the same whitening, halved where they overshoot.
//!
//! Source: variable projection, Golub & Pereyra (1973).

use super::laws::Laws;
use super::pick::Pick;
use super::steps::TrackStep;
use crate::evidence::tracks::Projected;
use crate::likelihood::{Column, Noise, Observed, Whitened};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Maximum number of laws, of steps, and of halvings of a step.
const MAX_LAWS: usize = 10;
const ROUNDS: usize = 8;
const HALVINGS: usize = 4;
/// Steps end where they take off less than this more of the sum of squares, in units of the noise variance and as a share.
const LEAST: (f64, f64) = (0.5, 1e-3);
/// A number is changed by this share of it for a derivative, and of this where it is less \[m, s, rad, ...\].
const APART: (f64, f64) = (1e-3, 0.1);
/// No length, time or threshold falls below this share of what it began with, or grows beyond this multiple: neighbours on the grid are nearer.
/// No place or direction changes by more than this in a step \[m, rad\].
const RANGE: (f64, f64) = (0.4, 2.5);
const FAR: f64 = 0.5;

/// Fits the numbers that shape the most significant laws.
pub(super) fn shape(
    picks: &mut Vec<Pick>,
    (observed, noise, own): (&Observed, &Noise, &[Vec<Column>]),
    laws: &Laws,
    steps: &[Vec<TrackStep>],
) {
    let ground = Ground::new(observed, noise, own, laws, steps);
    let shaped = picks.par_iter_mut().take(MAX_LAWS).filter(|pick| !pick.shapes.is_empty());
    shaped.for_each(|pick| pick.shapes = ground.best(pick));
    // Several places on the grid may lead to one.
    let mut known: Vec<Pick> = Vec::new();
    for pick in std::mem::take(picks) {
        if !known.iter().any(|other| pick.is_same(other, laws)) {
            known.push(pick);
        }
    }
    *picks = known;
}

/// Numbers that differ by less than this share, or by less than this \[m, rad\], are one.
const ONE: (f64, f64) = (0.02, 0.02);

impl Pick {
    /// Whether it is another with nearly the same numbers.
    fn is_same(&self, other: &Pick, laws: &Laws) -> bool {
        let kind = |pick: &Pick| (laws.shape(pick.term), laws.terms[pick.term].per, pick.motion, pick.with_sense);
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= ONE.1.max(ONE.0 * a.abs());
        !self.shapes.is_empty() && kind(self) == kind(other) && self.shapes.iter().zip(&other.shapes).all(near)
    }
}

/// The model's own columns and the residual, whitened: laws are fitted beside them.
struct Ground<'a> {
    observed: &'a Observed,
    noise: &'a Noise,
    laws: &'a Laws,
    steps: &'a [Vec<TrackStep>],
    white: Vec<Whitened>,
    /// Products of these columns over all runs, the residual last.
    products: DMatrix<f64>,
}

impl<'a> Ground<'a> {
    fn new(
        observed: &'a Observed,
        noise: &'a Noise,
        own: &[Vec<Column>],
        laws: &'a Laws,
        steps: &'a [Vec<TrackStep>],
    ) -> Ground<'a> {
        let runs = observed.runs.par_iter().zip(own);
        let white: Vec<Whitened> =
            runs.map(|(run, own)| noise.whiten(run, &own.iter().map(Vec::as_slice).collect::<Vec<_>>())).collect();
        let width = own.first().map_or(0, Vec::len);
        let mut products = DMatrix::zeros(width, width);
        for row in white.iter().flat_map(Whitened::rows) {
            for i in 0..width {
                (0..=i).for_each(|j| products[(i, j)] += row[i] * row[j]);
            }
        }
        products.fill_upper_triangle_with_lower_triangle();
        Ground { observed, noise, laws, steps, white, products }
    }

    /// Products of the model's columns, those of a law for each of some numbers that shape it, and the residual.
    fn with(&self, pick: &Pick, shapes: &[&[f64]]) -> DMatrix<f64> {
        let own = self.products.ncols() - 1;
        let new = shapes.len() * self.laws.both(pick.term).count();
        let width = own + new + 1;
        let mut products = DMatrix::zeros(width, width);
        let place = |k: usize| if k < own { k } else { width - 1 };
        for i in 0..=own {
            (0..=own).for_each(|j| products[(place(i), place(j))] = self.products[(i, j)]);
        }
        for ((run, steps), ground) in self.observed.runs.iter().zip(self.steps).zip(&self.white) {
            let columns = pick.columns(shapes, run, self.laws, steps);
            let white = self.noise.whiten(run, &columns.iter().map(Vec::as_slice).collect::<Vec<_>>());
            for (row, known) in white.rows().zip(ground.rows()) {
                for i in 0..new {
                    (0..=i).for_each(|j| products[(own + i, own + j)] += row[i] * row[j]);
                    (0..=own).for_each(|k| products[(own + i, place(k))] += row[i] * known[k]);
                }
            }
        }
        for i in own..own + new {
            (0..i).for_each(|j| products[(j, i)] = products[(i, j)]);
            products[(width - 1, i)] = products[(i, width - 1)];
        }
        products
    }

    /// What a law with these numbers takes off the sum of squares, and its sizes.
    fn drop(&self, pick: &Pick, shapes: &[f64]) -> Option<(f64, Vec<f64>)> {
        let own: Vec<usize> = (0..self.products.ncols() - 1).collect();
        let products = self.with(pick, &[shapes]);
        let law: Vec<usize> = (own.len()..products.ncols() - 1).collect();
        let projected = Projected::new(&products, &own);
        if law.iter().any(|column| projected.absorbed(&products, *column)) {
            return None;
        }
        projected.drop(&law).map(|(drop, sizes, _)| (drop, sizes.as_slice().to_vec()))
    }

    /// The numbers with which a law takes off most, from those that it has.
    fn best(&self, pick: &Pick) -> Vec<f64> {
        let mut shapes = pick.shapes.clone();
        let (scales, most) = (self.laws.scales(pick.term), self.laws.most(pick.term));
        let Some((mut drop, mut sizes)) = self.drop(pick, &shapes) else { return shapes };
        for _ in 0..ROUNDS {
            let Some(step) = self.step(pick, &shapes, &sizes) else { break };
            let mut taken = None;
            for halving in 0..HALVINGS {
                let share = 0.5f64.powi(halving as i32);
                let moved = |which: usize| {
                    let (shape, step, first) = (shapes[which], share * step[which], pick.shapes[which]);
                    let range = (RANGE.0 * first, (RANGE.1 * first).min(most));
                    if scales[which] { (shape + step).clamp(range.0, range.1) } else { shape + step.clamp(-FAR, FAR) }
                };
                let next: Vec<f64> = (0..shapes.len()).map(moved).collect();
                if let Some((new, sizes)) = self.drop(pick, &next).filter(|(new, _)| *new > drop) {
                    taken = Some((next, new, sizes));
                    break;
                }
            }
            let Some((next, new, found)) = taken else { break };
            let gain = new - drop;
            (shapes, drop, sizes) = (next, new, found);
            if gain < LEAST.0.max(LEAST.1 * drop) {
                break;
            }
        }
        shapes
    }

    /// Gauss and Newton's step of the numbers, the sizes fitted along.
    fn step(&self, pick: &Pick, shapes: &[f64], sizes: &[f64]) -> Option<Vec<f64>> {
        let apart = |shape: f64| APART.0 * shape.abs().max(APART.1);
        let moved = |which: usize, sign: f64| -> Vec<f64> {
            let mut moved = shapes.to_vec();
            moved[which] += sign * apart(shapes[which]);
            moved
        };
        let all: Vec<Vec<f64>> = std::iter::once(shapes.to_vec())
            .chain((0..shapes.len()).flat_map(|which| [moved(which, 1.0), moved(which, -1.0)]))
            .collect();
        let products = self.with(pick, &all.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let own = self.products.ncols() - 1;
        let terms = sizes.len();
        // The model's columns, the law's, one derivative a number, and the residual, of those that there are.
        let mut mix = DMatrix::zeros(products.ncols(), own + terms + shapes.len() + 1);
        (0..own + terms).for_each(|k| mix[(k, k)] = 1.0);
        for (which, shape) in shapes.iter().enumerate() {
            for (term, size) in sizes.iter().enumerate() {
                let first = own + terms * (1 + 2 * which) + term;
                mix[(first, own + terms + which)] = size / (2.0 * apart(*shape));
                mix[(first + terms, own + terms + which)] = -size / (2.0 * apart(*shape));
            }
        }
        mix[(products.ncols() - 1, own + terms + shapes.len())] = 1.0;
        let products = mix.tr_mul(&(products * &mix));
        let projected = Projected::new(&products, &(0..own).collect::<Vec<_>>());
        let asked: Vec<usize> = (own..own + terms + shapes.len()).collect();
        let (_, values, _) = projected.drop(&asked)?;
        Some(values.as_slice()[terms..].to_vec())
    }
}
