//! Means and scatter of residuals: the tests use nothing else.
//!
//! A return pose has at most three coordinates, and thousands of null tests are drawn for each robot: all matrices have three, on the stack.
//! Coordinates beyond those that are tested have means of zero and a scatter of one beside no other, and change nothing.

use crate::random::Stream;
use nalgebra::{Matrix3, SVector, Vector3};

/// A shift of the means, clockwise and counter-clockwise.
pub(crate) type Shift = [Vector3<f64>; 2];

/// Both directions one below the other.
pub(crate) type Both = SVector<f64, 6>;

/// Sufficient statistics of residuals in both directions, in the mirrored frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moments {
    /// Number of runs, clockwise and counter-clockwise.
    pub counts: [usize; 2],
    pub means: Shift,
    /// Σ (z - z̄)(z - z̄)ᵀ over both directions.
    pub scatter: Matrix3<f64>,
    /// Number of coordinates that are tested.
    pub size: usize,
}

impl Moments {
    /// Of residuals of `size` coordinates with their group, 0 for clockwise and 1 for counter-clockwise.
    pub fn of(runs: &[(usize, Vector3<f64>)], size: usize) -> Moments {
        let mut counts = [0; 2];
        let mut means = [Vector3::zeros(); 2];
        for (group, z) in runs {
            counts[*group] += 1;
            means[*group] += z;
        }
        for (mean, count) in means.iter_mut().zip(counts) {
            *mean /= f64::from(count.max(1) as u32);
        }
        let mut scatter = Matrix3::zeros();
        for (group, z) in runs {
            let from_mean = z - means[*group];
            scatter += from_mean * from_mean.transpose();
        }
        Moments { counts, means, scatter: alone(scatter, size), size }
    }

    /// Moments of as many simulated runs without any effect, where the observed ones have scatter ν I.
    ///
    /// Their covariance is drawn too, with the uncertainty that the observed runs leave: the inverse of a Wishart matrix. Exact tests do
    /// not depend on the covariance; other tests would have too many false alarms if the estimate were used as the true covariance.
    pub fn draw(counts: [usize; 2], size: usize, stream: &mut Stream) -> Moments {
        let freedom = freedom_of(counts);
        let precision = alone(wishart(freedom, size, stream) / freedom as f64, size);
        let root = precision.cholesky().and_then(|c| c.l().transpose().try_inverse());
        let root = root.unwrap_or_else(Matrix3::identity);
        Moments::about(counts, [Vector3::zeros(); 2], (&root, size), stream)
    }

    /// Moments of as many simulated runs whose covariance is known, `root` times its transpose, about these means.
    pub fn about(
        counts: [usize; 2],
        mut means: Shift,
        (root, size): (&Matrix3<f64>, usize),
        stream: &mut Stream,
    ) -> Moments {
        for (mean, count) in means.iter_mut().zip(counts) {
            *mean += root * normal(size, stream) / f64::from(count as u32).sqrt();
        }
        let scatter = root * wishart(freedom_of(counts), size, stream) * root.transpose();
        Moments { counts, means, scatter: alone(scatter, size), size }
    }

    /// Degrees of freedom of the scatter.
    pub fn freedom(&self) -> f64 {
        freedom_of(self.counts) as f64
    }

    /// n of a direction.
    pub fn count(&self, group: usize) -> f64 {
        f64::from(self.counts[group] as u32)
    }

    /// Scatter about zero in place of the means.
    pub fn about_zero(&self) -> Matrix3<f64> {
        let of = |group: usize| self.means[group] * self.means[group].transpose() * self.count(group);
        self.scatter + of(0) + of(1)
    }
}

/// A matrix of the coordinates that are tested, the others beside it.
fn alone(mut matrix: Matrix3<f64>, size: usize) -> Matrix3<f64> {
    (size..3).for_each(|other| matrix[(other, other)] = 1.0);
    matrix
}

/// Degrees of freedom of the scatter of so many runs about the means of their directions; 0 for a single run.
fn freedom_of(counts: [usize; 2]) -> usize {
    (counts[0] + counts[1]).saturating_sub(2)
}

fn normal(size: usize, stream: &mut Stream) -> Vector3<f64> {
    let mut z = Vector3::zeros();
    z.iter_mut().take(size).for_each(|own| *own = stream.normal());
    z
}

/// With more degrees of freedom than these, a matrix is drawn by its factor.
const DRAWN_ONE_BY_ONE: usize = 200;

/// Σ z zᵀ over as many standard normal vectors as there are degrees of freedom; of many, by the factor of Bartlett (1933): normals below the
/// diagonal, roots of χ² with ν, ν - 1, ... degrees of freedom on it.
fn wishart(freedom: usize, size: usize, stream: &mut Stream) -> Matrix3<f64> {
    if freedom > DRAWN_ONE_BY_ONE {
        let mut factor = Matrix3::zeros();
        for row in 0..size {
            (0..row).for_each(|column| factor[(row, column)] = stream.normal());
            factor[(row, row)] = stream.chi_squared((freedom - row) as f64).sqrt();
        }
        return factor * factor.transpose();
    }
    (0..freedom).fold(Matrix3::zeros(), |sum, _| {
        let z = normal(size, stream);
        sum + z * z.transpose()
    })
}

/// Least squares in units of the pooled scatter S = E/ν: means as one vector of unit variances, with a base projected out.
pub(crate) struct Whitened {
    inverse_factor: Matrix3<f64>,
    root_counts: [f64; 2],
    /// Orthonormal columns that span the base.
    base: Vec<Both>,
    /// The means.
    pub means: Both,
}

impl Whitened {
    /// `None` if the scatter has no inverse.
    pub fn new(moments: &Moments, base: &[Shift]) -> Option<Whitened> {
        let factor = (moments.scatter / moments.freedom()).cholesky()?.l();
        let inverse_factor = factor.solve_lower_triangular(&Matrix3::identity())?;
        let root_counts = [moments.count(0).sqrt(), moments.count(1).sqrt()];
        let mut whitened = Whitened { inverse_factor, root_counts, base: Vec::new(), means: Both::zeros() };
        for shift in base {
            let column = whitened.whole(shift);
            // Once more, so that rounding leaves nothing of the others.
            let left = whitened.beside(&whitened.beside(&column));
            if left.norm() > DEPENDENT * column.norm() {
                whitened.base.push(left.normalize());
            }
        }
        whitened.means = whitened.column(&moments.means);
        Some(whitened)
    }

    /// A shift of both directions, whitened.
    fn whole(&self, shift: &Shift) -> Both {
        let [cw, ccw] = [0, 1].map(|group| self.inverse_factor * shift[group] * self.root_counts[group]);
        Both::new(cw.x, cw.y, cw.z, ccw.x, ccw.y, ccw.z)
    }

    /// A whitened shift with the base projected out.
    fn beside(&self, column: &Both) -> Both {
        self.base.iter().fold(*column, |left, own| left - own * own.dot(&left))
    }

    /// A shift of both directions, whitened, with the base projected out.
    pub fn column(&self, shift: &Shift) -> Both {
        self.beside(&self.whole(shift))
    }
}

/// A column of the base of which the others leave less than this share is one of them.
const DEPENDENT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    /// Seed 3, 2 000 draws of each: mean ν I, variance 2ν on the diagonal and ν beside it, each within 5 standard errors.
    #[test]
    fn a_wishart_matrix_has_its_moments_however_it_is_drawn() {
        for freedom in [DRAWN_ONE_BY_ONE, DRAWN_ONE_BY_ONE + 1] {
            let mut stream = Stream::new(3, 0, 0);
            let (n, nu) = (2000.0, freedom as f64);
            let draws: Vec<Matrix3<f64>> = (0..2000).map(|_| wishart(freedom, 3, &mut stream)).collect();
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
