//! Means and scatter of residuals: the tests use nothing else.

use crate::random::Stream;
use nalgebra::{DMatrix, DVector};

/// Sufficient statistics of residuals in both directions, in the mirrored frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moments {
    /// Number of runs, clockwise and counter-clockwise.
    pub counts: [usize; 2],
    pub means: [DVector<f64>; 2],
    /// Σ (z - z̄)(z - z̄)ᵀ over both directions.
    pub scatter: DMatrix<f64>,
}

impl Moments {
    /// Of residuals with their group, 0 for clockwise and 1 for counter-clockwise.
    pub fn of(runs: &[(usize, DVector<f64>)]) -> Moments {
        let size = runs.first().map_or(0, |(_, z)| z.len());
        let mut counts = [0; 2];
        let mut means = [DVector::zeros(size), DVector::zeros(size)];
        for (group, z) in runs {
            counts[*group] += 1;
            means[*group] += z;
        }
        for (mean, count) in means.iter_mut().zip(counts) {
            *mean /= f64::from(count.max(1) as u32);
        }
        let mut scatter = DMatrix::zeros(size, size);
        for (group, z) in runs {
            let from_mean = z - &means[*group];
            scatter.ger(1.0, &from_mean, &from_mean, 1.0);
        }
        Moments { counts, means, scatter }
    }

    /// Moments of as many simulated runs without any effect, where the observed ones have scatter ν I.
    ///
    /// Their covariance is drawn too, with the uncertainty that the observed runs leave: the inverse of a Wishart matrix. Exact tests do
    /// not depend on the covariance; other tests would have too many false alarms if the estimate were used as the true covariance.
    pub fn draw(counts: [usize; 2], size: usize, stream: &mut Stream) -> Moments {
        let freedom = freedom_of(counts);
        let precision = wishart(freedom, size, stream) / freedom as f64;
        let root = precision.cholesky().and_then(|c| c.l().transpose().try_inverse());
        let root = root.unwrap_or_else(|| DMatrix::identity(size, size));
        let means = counts.map(|count| &root * normal(size, stream) / f64::from(count as u32).sqrt());
        let scatter = &root * wishart(freedom, size, stream) * root.transpose();
        Moments { counts, means, scatter }
    }

    /// Moments of as many simulated runs whose covariance is known, `root` times its transpose, about these means.
    pub fn about(counts: [usize; 2], means: [DVector<f64>; 2], root: &DMatrix<f64>, stream: &mut Stream) -> Moments {
        let size = root.nrows();
        let mut means = means;
        for (mean, count) in means.iter_mut().zip(counts) {
            *mean += root * normal(size, stream) / f64::from(count as u32).sqrt();
        }
        let scatter = root * wishart(freedom_of(counts), size, stream) * root.transpose();
        Moments { counts, means, scatter }
    }

    /// Degrees of freedom of the scatter.
    pub fn freedom(&self) -> f64 {
        freedom_of(self.counts) as f64
    }

    /// Number of coordinates.
    pub fn size(&self) -> usize {
        self.scatter.nrows()
    }

    /// n of a direction.
    pub fn count(&self, group: usize) -> f64 {
        f64::from(self.counts[group] as u32)
    }
}

/// Degrees of freedom of the scatter of so many runs about the means of their directions; 0 for a single run.
fn freedom_of(counts: [usize; 2]) -> usize {
    (counts[0] + counts[1]).saturating_sub(2)
}

fn normal(size: usize, stream: &mut Stream) -> DVector<f64> {
    DVector::from_fn(size, |_, _| stream.normal())
}

/// With more degrees of freedom than these, a matrix is drawn by its factor.
const DRAWN_ONE_BY_ONE: usize = 200;

/// Σ z zᵀ over as many standard normal vectors as there are degrees of freedom; of many, by the factor of Bartlett (1933): normals below the
/// diagonal, roots of χ² with ν, ν - 1, ... degrees of freedom on it.
fn wishart(freedom: usize, size: usize, stream: &mut Stream) -> DMatrix<f64> {
    if freedom > DRAWN_ONE_BY_ONE.max(size) {
        let mut factor = DMatrix::zeros(size, size);
        for row in 0..size {
            (0..row).for_each(|column| factor[(row, column)] = stream.normal());
            factor[(row, row)] = stream.chi_squared((freedom - row) as f64).sqrt();
        }
        return &factor * factor.transpose();
    }
    (0..freedom).fold(DMatrix::zeros(size, size), |mut sum, _| {
        let z = normal(size, stream);
        sum.ger(1.0, &z, &z, 1.0);
        sum
    })
}

/// Least squares in units of the pooled scatter S = E/ν: means as one vector of unit variances, with a base projected out.
pub(crate) struct Whitened {
    inverse_factor: DMatrix<f64>,
    root_counts: [f64; 2],
    /// Orthonormal columns that span the base.
    base: Option<DMatrix<f64>>,
    /// The means.
    pub means: DVector<f64>,
}

impl Whitened {
    /// `None` if the scatter has no inverse.
    pub fn new(moments: &Moments, base: &[[DVector<f64>; 2]]) -> Option<Whitened> {
        let factor = (&moments.scatter / moments.freedom()).cholesky()?.l();
        let size = moments.size();
        let inverse_factor = factor.solve_lower_triangular(&DMatrix::identity(size, size))?;
        let root_counts = [moments.count(0).sqrt(), moments.count(1).sqrt()];
        let mut whitened = Whitened { inverse_factor, root_counts, base: None, means: DVector::zeros(0) };
        if !base.is_empty() {
            let columns: Vec<DVector<f64>> = base.iter().map(|column| whitened.whole(column)).collect();
            whitened.base = Some(span(&DMatrix::from_columns(&columns)));
        }
        whitened.means = whitened.column(&moments.means);
        Some(whitened)
    }

    /// A pattern of both directions, whitened.
    fn whole(&self, pattern: &[DVector<f64>; 2]) -> DVector<f64> {
        let size = self.inverse_factor.nrows();
        let mut column = DVector::zeros(2 * size);
        for (group, (shift, root)) in pattern.iter().zip(self.root_counts).enumerate() {
            column.rows_mut(group * size, size).copy_from(&(&self.inverse_factor * shift * root));
        }
        column
    }

    /// A pattern of both directions, whitened, with the base projected out.
    pub fn column(&self, pattern: &[DVector<f64>; 2]) -> DVector<f64> {
        let column = self.whole(pattern);
        match &self.base {
            Some(base) => &column - base * (base.transpose() * &column),
            None => column,
        }
    }
}

/// Orthonormal columns with the span of `columns`; directions of rounding are left out.
fn span(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let svd = columns.clone().svd(true, false);
    let limit = 1e-9 * svd.singular_values.max();
    let Some(u) = svd.u else { return DMatrix::zeros(columns.nrows(), 0) };
    let kept: Vec<_> = (0..u.ncols()).filter(|i| svd.singular_values[*i] > limit).map(|i| u.column(i)).collect();
    if kept.is_empty() { DMatrix::zeros(columns.nrows(), 0) } else { DMatrix::from_columns(&kept) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seed 3, 2 000 draws of each: mean ν I, variance 2ν on the diagonal and ν beside it, each within 5 standard errors.
    #[test]
    fn a_wishart_matrix_has_its_moments_however_it_is_drawn() {
        for freedom in [DRAWN_ONE_BY_ONE, DRAWN_ONE_BY_ONE + 1] {
            let mut stream = Stream::new(3, 0, 0);
            let (n, nu) = (2000.0, freedom as f64);
            let draws: Vec<DMatrix<f64>> = (0..2000).map(|_| wishart(freedom, 3, &mut stream)).collect();
            for (row, column) in [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)] {
                let values: Vec<f64> = draws.iter().map(|draw| draw[(row, column)]).collect();
                let mean = values.iter().sum::<f64>() / n;
                let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
                let (expected, spread) = if row == column { (nu, 2.0 * nu) } else { (0.0, nu) };
                assert!((mean - expected).abs() < 5.0 * (spread / n).sqrt(), "{freedom} {row} {column}: {mean}");
                assert!(
                    (variance / spread - 1.0).abs() < 5.0 * (2.0 / n).sqrt(),
                    "{freedom} {row} {column}: {variance}"
                );
            }
        }
    }
}
