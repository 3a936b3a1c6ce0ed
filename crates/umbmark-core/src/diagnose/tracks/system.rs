//! A model's residuals beside what its parameters, and the effects that it may be missing, would do to them: products of
//! whitened columns, summed run by run, from which every test and every fold of a cross-validation follows.

use crate::likelihood::{Column, Noise, Observed, gram};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// A part of a run that is taken as independent of the others.
#[derive(Clone, Debug)]
pub struct Unit {
    /// The run.
    pub run: usize,
    /// Products of whitened columns.
    pub white: DMatrix<f64>,
    /// Number of whitened rows.
    pub rows: usize,
}

/// Products of columns over all units. The last column is the residual.
#[derive(Clone, Debug)]
pub struct System {
    /// Quarters of runs.
    pub units: Vec<Unit>,
    /// Number of columns, the residual included.
    pub width: usize,
}

impl System {
    /// Whitens the columns of every run and sums their products by unit. `columns` holds, run by run, all columns and last
    /// the residual.
    pub fn new(observed: &Observed, noise: &Noise, columns: &[Vec<Column>]) -> System {
        let width = columns.first().map_or(0, Vec::len);
        let units = observed.runs.par_iter().zip(columns).enumerate().flat_map_iter(|(index, (run, columns))| {
            let columns: Vec<&[[f64; 3]]> = columns.iter().map(Vec::as_slice).collect();
            let white = noise.whiten(run, &columns);
            let mut quarters: Vec<Vec<f64>> = Vec::new();
            for (row, block) in white.rows().zip(&white.block) {
                let unit = run.blocks[*block].unit;
                quarters.resize_with(quarters.len().max(unit + 1), Vec::new);
                quarters[unit].extend_from_slice(row);
            }
            quarters.into_iter().filter(|values| !values.is_empty()).map(move |values| Unit {
                run: index,
                rows: values.len() / width,
                white: gram(&values, width),
            })
        });
        System { units: units.collect(), width }
    }

    /// The residual's column.
    pub fn residual(&self) -> usize {
        self.width - 1
    }

    /// Number of rows of the units that are `kept`.
    pub fn rows(&self, kept: impl Fn(&Unit) -> bool) -> usize {
        self.units.iter().filter(|u| kept(u)).map(|u| u.rows).sum()
    }

    /// Products of all columns over the units that are `kept`.
    pub fn sum(&self, kept: impl Fn(&Unit) -> bool) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(self.width, self.width);
        self.units.iter().filter(|unit| kept(unit)).for_each(|unit| sum += &unit.white);
        sum
    }
}

/// The columns of a system with some of them fitted out.
#[derive(Clone, Debug)]
pub struct Projected {
    /// Products of the rests.
    pub products: DMatrix<f64>,
    /// How much of each fitted column every column holds: coefficients, one row a fitted column.
    pub coefficients: DMatrix<f64>,
    /// The columns that were fitted out.
    pub base: Vec<usize>,
}

/// A column with less than this share of its square left is absorbed by the base: a collinearity index above 20, the rule of
/// Brun, Reichert & Künsch (2001, Water Resources Research 37).
const ABSORBED: f64 = 1.0 / 400.0;

impl Projected {
    /// Fits the columns `base` out of all columns.
    pub fn new(products: &DMatrix<f64>, base: &[usize]) -> Projected {
        let width = products.ncols();
        let of_base = |matrix: &DMatrix<f64>| DMatrix::from_fn(base.len(), matrix.ncols(), |i, j| matrix[(base[i], j)]);
        let cross = of_base(products);
        let coefficients = match scaled_cholesky(&DMatrix::from_fn(base.len(), base.len(), |i, j| cross[(i, base[j])]))
        {
            Some(solver) if !base.is_empty() => solver.solve(&cross),
            _ => DMatrix::zeros(base.len(), width),
        };
        let products = products - cross.transpose() * &coefficients;
        Projected { products, coefficients, base: base.to_vec() }
    }

    /// Whether a column has something left beside what it was in `whole`.
    pub fn absorbed(&self, whole: &DMatrix<f64>, column: usize) -> bool {
        self.products[(column, column)] <= ABSORBED * whole[(column, column)]
    }

    /// What fitting a group of columns, none of them absorbed, would take off the sum of squares, and their values.
    pub fn drop(&self, group: &[usize]) -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        let residual = self.products.ncols() - 1;
        let information = DMatrix::from_fn(group.len(), group.len(), |i, j| self.products[(group[i], group[j])]);
        let score = DVector::from_fn(group.len(), |i, _| self.products[(group[i], residual)]);
        let solver = scaled_cholesky(&information)?;
        let step = solver.solve(&DMatrix::from_column_slice(group.len(), 1, score.as_slice()));
        let inverse = solver.solve(&DMatrix::identity(group.len(), group.len()));
        let step = DVector::from_column_slice(step.as_slice());
        Some((score.dot(&step), step, inverse))
    }

    /// Values of some columns fitted together.
    pub fn fit(products: &DMatrix<f64>, columns: &[usize]) -> DVector<f64> {
        let residual = products.ncols() - 1;
        let projected = Projected::new(products, columns);
        DVector::from_fn(columns.len(), |i, _| projected.coefficients[(i, residual)])
    }

    /// Share of the response of `values` of the columns `from` that the columns `to` can make, as a cosine.
    pub fn likeness(&self, from: &[usize], values: &DVector<f64>, to: &[usize]) -> f64 {
        let response = |k: usize| from.iter().zip(values.iter()).map(|(j, v)| self.products[(k, *j)] * v).sum::<f64>();
        let whole: f64 = from.iter().zip(values.iter()).map(|(k, v)| response(*k) * v).sum();
        let information = DMatrix::from_fn(to.len(), to.len(), |i, j| self.products[(to[i], to[j])]);
        let cross = DMatrix::from_fn(to.len(), 1, |i, _| response(to[i]));
        match scaled_cholesky(&information) {
            Some(solver) if whole > 0.0 => (cross.dot(&solver.solve(&cross)) / whole).clamp(0.0, 1.0).sqrt(),
            _ => 0.0,
        }
    }

    /// Scores of a group in one unit, with the base fitted out: what the unit says for and against the group.
    pub fn score(&self, unit: &DMatrix<f64>, group: &[usize]) -> DVector<f64> {
        let residual = self.products.ncols() - 1;
        let rest = |a: usize, b: usize| {
            let mut value = unit[(a, b)];
            for (i, z) in self.base.iter().enumerate() {
                value -= self.coefficients[(i, a)] * unit[(*z, b)] + self.coefficients[(i, b)] * unit[(a, *z)];
                for (j, y) in self.base.iter().enumerate() {
                    value += self.coefficients[(i, a)] * self.coefficients[(j, b)] * unit[(*z, *y)];
                }
            }
            value
        };
        DVector::from_fn(group.len(), |i, _| rest(group[i], residual))
    }
}

/// A positive definite matrix with its rows and columns scaled to a unit diagonal, factored.
pub(super) struct ScaledCholesky {
    factor: Cholesky<f64, Dyn>,
    lengths: Vec<f64>,
}

impl ScaledCholesky {
    pub(super) fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled = DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| right[(i, j)] / self.lengths[i]);
        let solved = self.factor.solve(&scaled);
        DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| solved[(i, j)] / self.lengths[i])
    }
}

pub(super) fn scaled_cholesky(matrix: &DMatrix<f64>) -> Option<ScaledCholesky> {
    let n = matrix.nrows();
    let lengths: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
    if lengths.iter().any(|l| !(*l > 0.0 && l.is_finite())) {
        return None;
    }
    let mut scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (lengths[i] * lengths[j]));
    for i in 0..n {
        scaled[(i, i)] += 1e-12;
    }
    Some(ScaledCholesky { factor: scaled.cholesky()?, lengths })
}
