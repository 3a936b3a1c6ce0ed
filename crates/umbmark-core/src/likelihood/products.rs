//! Products of whitened columns, and what follows from them.

use crate::geometry::{Instructions, by_width};
use nalgebra::{Cholesky, DMatrix, Dyn};

/// A column is absorbed by the base if less than this share of its square remains: a collinearity index above 50. The rule of Brun, Reichert &
/// Künsch (2001, Water Resources Research 37) is 20; but of slip in proportion to the speed, of a robot that drives at one speed, ramps leave
/// a thirtieth, which thousands of poses show.
pub(crate) const ABSORBED: f64 = 1.0 / 2500.0;

/// Number of rows that are processed at once; the sums are read and written once for all of them.
const TOGETHER: usize = 8;

/// XᵀX of a matrix stored row by row, with the same bits on all instruction sets.
pub(crate) fn gram(values: &[f64], columns: usize) -> DMatrix<f64> {
    by_width!(Instructions::best(), |values: &[f64], columns: usize| -> DMatrix<f64> { gram_of(values, columns) })
}

#[inline(always)]
fn gram_of(values: &[f64], columns: usize) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(columns, columns);
    let columns = columns.max(1);
    let whole = values.chunks_exact(TOGETHER * columns);
    let rest = whole.remainder();
    for rows in whole {
        let rows: [&[f64]; TOGETHER] = std::array::from_fn(|k| &rows[k * columns..(k + 1) * columns]);
        for (j, mut own) in sum.column_iter_mut().enumerate() {
            // Computes whole registers; entries below the diagonal are overwritten at the end.
            let end = (j + TOGETHER - j % TOGETHER).min(columns);
            let own = &mut own.as_mut_slice()[..end];
            let weights = rows.map(|row| row[j]);
            let rows = rows.map(|row| &row[..end]);
            for i in 0..end {
                let mut added = 0.0;
                for k in 0..TOGETHER {
                    added += weights[k] * rows[k][i];
                }
                own[i] += added;
            }
        }
    }
    for row in rest.chunks_exact(columns) {
        for j in 0..columns {
            for i in 0..=j {
                sum[(i, j)] += row[i] * row[j];
            }
        }
    }
    sum.fill_lower_triangle_with_upper_triangle();
    sum
}

/// Share of the square of a column that remains after it is projected on others.
pub(crate) fn share_left(products: &DMatrix<f64>, base: &[usize], column: usize) -> f64 {
    let cross = DMatrix::from_fn(base.len(), 1, |i, _| products[(base[i], column)]);
    let whole = products[(column, column)];
    let explained = solver(products, base).map_or(0.0, |solver| cross.dot(&solver.solve(&cross)));
    if whole > 0.0 { 1.0 - explained / whole } else { 0.0 }
}

/// Factorisation that solves for the values of some columns.
pub(crate) fn solver(products: &DMatrix<f64>, columns: &[usize]) -> Option<ScaledCholesky> {
    let of = |i: usize, j: usize| products[(columns[i], columns[j])];
    scaled_cholesky(&DMatrix::from_fn(columns.len(), columns.len(), of)).filter(|_| !columns.is_empty())
}

/// A positive definite matrix with its rows and columns scaled to a unit diagonal, factored.
#[derive(Clone, Debug)]
pub(crate) struct ScaledCholesky {
    factor: Cholesky<f64, Dyn>,
    lengths: Vec<f64>,
}

impl ScaledCholesky {
    pub(crate) fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled = DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| right[(i, j)] / self.lengths[i]);
        let solved = self.factor.solve(&scaled);
        DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| solved[(i, j)] / self.lengths[i])
    }

    /// The logarithm of the matrix's determinant.
    pub(crate) fn log_determinant(&self) -> f64 {
        let roots = self.lengths.iter().enumerate().map(|(i, length)| length * self.factor.l_dirty()[(i, i)]);
        2.0 * roots.map(libm::log).sum::<f64>()
    }

    /// L⁻¹ of some columns, with L Lᵀ the matrix.
    pub(crate) fn half(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let mut scaled = DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| right[(i, j)] / self.lengths[i]);
        self.factor.l_dirty().solve_lower_triangular_mut(&mut scaled);
        scaled
    }
}

pub(crate) fn scaled_cholesky(matrix: &DMatrix<f64>) -> Option<ScaledCholesky> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn products_are_the_same_bits_with_and_without_wide_registers() {
        let mut stream = Stream::new(6, 0, 0);
        for (rows, columns) in [(0, 3), (7, 1), (8, 13), (53, 29)] {
            let values: Vec<f64> = (0..rows * columns).map(|_| stream.normal()).collect();
            let plain = gram_of(&values, columns);
            assert_eq!(gram(&values, columns), plain);
            let matrix = DMatrix::from_row_slice(rows, columns, &values);
            assert!((plain - matrix.tr_mul(&matrix)).amax() < 1e-12);
        }
    }
}
