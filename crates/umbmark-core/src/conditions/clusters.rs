//! Least squares whose errors are tested cluster by cluster, whatever their covariance within a cluster is.
//!
//! With rows X_i, y_i of cluster i, M = (ΣX_iᵀX_i)⁻¹ and residuals e_i, the covariance of the coefficients is
//!
//! ```text
//! V = M Σ X_iᵀ A_i e_i e_iᵀ A_i X_i M,    A_i = (I - X_i M X_iᵀ)^(-1/2)
//! ```
//!
//! which has no bias where all rows have unit variance (CR2, Bell & McCaffrey). A hypothesis C β = 0 of q rows is tested by
//! Hotelling's T² with the η of the Wishart distribution that has the variance of C V Cᵀ:
//!
//! ```text
//! F = (η - q + 1)/(η q) (Cβ)ᵀ (C V Cᵀ)⁻¹ Cβ ~ F(q, η - q + 1)
//! ```
//!
//! For two groups of runs this is Welch's test.
//!
//! Sources: Bell & McCaffrey (2002), Survey Methodology 28, 169; Tipton & Pustejovsky (2015), Journal of Educational and Behavioral
//! Statistics 40, 604; Pustejovsky & Tipton (2018), Journal of Business & Economic Statistics 36, 672.

use crate::stats::{f_upper_tail, student_t_quantile};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// A direction of which less than this share is left has no residual.
const NOTHING_LEFT: f64 = 1e-8;
/// A column that keeps less than this share of its square beside the others is determined by them.
const DETERMINED: f64 = 1e-7;
/// Eigenvalues are found in a few steps each.
const STEPS: usize = 10_000;
/// With fewer degrees of freedom, Student's t is no approximation.
const FEWEST_FREEDOM: f64 = 1.0;

/// Rows that are independent of those of other clusters.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    pub rows: DMatrix<f64>,
    pub right: DVector<f64>,
}

/// Coefficients, and what is needed to test them.
pub(super) struct Regression {
    /// The columns that are determined, in their order.
    kept: Vec<usize>,
    /// Their coefficients, of columns of unit length.
    values: DVector<f64>,
    lengths: Vec<f64>,
    inverse: DMatrix<f64>,
    /// X_iᵀ A_i, and X_i, of each cluster.
    weighted: Vec<(DMatrix<f64>, DMatrix<f64>)>,
    /// X_iᵀ A_i e_i.
    scores: Vec<DVector<f64>>,
}

/// Some linear combinations of coefficients.
#[derive(Clone, Debug)]
pub(super) struct Combined {
    pub values: DVector<f64>,
    pub covariance: DMatrix<f64>,
    /// η.
    pub freedom: f64,
}

impl Cluster {
    /// The same in as few rows: an orthogonal transformation changes nothing.
    fn packed(&self) -> Cluster {
        let width = self.rows.ncols();
        if self.rows.nrows() <= width + 1 {
            return self.clone();
        }
        let both = DMatrix::from_fn(self.rows.nrows(), width + 1, |row, column| {
            if column < width { self.rows[(row, column)] } else { self.right[row] }
        });
        let packed = both.qr().r();
        Cluster { rows: packed.columns(0, width).into_owned(), right: packed.column(width).into_owned() }
    }
}

impl Regression {
    /// Fits all columns that those before them do not determine; `None` where none is.
    pub fn new(clusters: &[Cluster]) -> Option<Regression> {
        let width = clusters.first()?.rows.ncols();
        let products = |of: &dyn Fn(&Cluster) -> DMatrix<f64>| clusters.iter().map(of).sum::<DMatrix<f64>>();
        let gram = products(&|cluster| cluster.rows.tr_mul(&cluster.rows));
        let kept = independent(&gram);
        if kept.is_empty() || width == 0 {
            return None;
        }
        let lengths: Vec<f64> = kept.iter().map(|column| gram[(*column, *column)].sqrt()).collect();
        let scaled = |cluster: &Cluster| {
            let rows =
                DMatrix::from_fn(cluster.rows.nrows(), kept.len(), |row, k| cluster.rows[(row, kept[k])] / lengths[k]);
            Cluster { rows, right: cluster.right.clone() }.packed()
        };
        let clusters: Vec<Cluster> = clusters.iter().map(scaled).collect();
        let gram: DMatrix<f64> = clusters.iter().map(|cluster| cluster.rows.tr_mul(&cluster.rows)).sum();
        let right: DVector<f64> = clusters.iter().map(|cluster| cluster.rows.tr_mul(&cluster.right)).sum();
        let inverse = gram.cholesky()?.inverse();
        let values = &inverse * right;
        let weigh = |Cluster { rows, right }: &Cluster| {
            let left = DMatrix::identity(rows.nrows(), rows.nrows()) - rows * &inverse * rows.transpose();
            let adjusted = rows.tr_mul(&inverse_root(left, NOTHING_LEFT)?);
            let score = &adjusted * (right - rows * &values);
            Some(((adjusted, rows.clone()), score))
        };
        let (weighted, scores) = clusters.iter().map(weigh).collect::<Option<Vec<_>>>()?.into_iter().unzip();
        Some(Regression { kept, values, lengths, inverse, weighted, scores })
    }

    /// Whether a column is determined.
    pub fn has(&self, column: usize) -> bool {
        self.kept.contains(&column)
    }

    /// Linear combinations of coefficients, a row each of (column, factor); `None` where one of them is not determined, or where the clusters do not
    /// show how it scatters.
    pub fn combined(&self, combinations: &[Vec<(usize, f64)>]) -> Option<Combined> {
        let mut c = DMatrix::zeros(combinations.len(), self.kept.len());
        for (row, combination) in combinations.iter().enumerate() {
            for (column, factor) in combination {
                let at = self.kept.iter().position(|kept| kept == column)?;
                c[(row, at)] += factor / self.lengths[at];
            }
        }
        let to = &c * &self.inverse;
        let working = &to * c.transpose();
        let mut covariance = DMatrix::zeros(c.nrows(), c.nrows());
        for score in &self.scores {
            let own = &to * score;
            covariance += &own * own.transpose();
        }
        let largest = working.diagonal().max();
        let root = inverse_root(working, NOTHING_LEFT * largest)?;
        let standard = root * &to;
        let q = c.nrows() as f64;
        let spread = self.spread(&standard);
        let freedom = q * (q + 1.0) / spread;
        let is_known = covariance.iter().all(|value| value.is_finite())
            && freedom.is_finite()
            && freedom >= FEWEST_FREEDOM
            && (0..c.nrows()).all(|k| covariance[(k, k)] > 0.0);
        is_known.then(|| Combined { values: &c * &self.values, covariance, freedom })
    }

    /// The sum of the variances of all elements of the standardised covariance, where all rows have unit variance.
    fn spread(&self, standard: &DMatrix<f64>) -> f64 {
        let half = self.inverse.clone().cholesky().map(|factor| factor.l());
        let Some(half) = half else { return f64::NAN };
        let parts: Vec<(DMatrix<f64>, DMatrix<f64>)> = self
            .weighted
            .iter()
            .map(|(adjusted, rows)| {
                let own = standard * adjusted;
                let shared = &own * rows * &half;
                (own, shared)
            })
            .collect();
        let mut sum = 0.0;
        for (i, (own, shared)) in parts.iter().enumerate() {
            for (j, (_, other)) in parts.iter().enumerate().skip(i) {
                let mut between = -(shared * other.transpose());
                if i == j {
                    between += own * own.transpose();
                }
                let trace = between.trace();
                let twice = if i == j { 1.0 } else { 2.0 };
                sum += twice * (trace * trace + (&between * &between).trace());
            }
        }
        sum
    }
}

impl Combined {
    /// p of all of them being zero; `None` where the clusters are too few for that.
    pub fn p(&self) -> Option<f64> {
        let q = self.values.len() as f64;
        let below = self.freedom - q + 1.0;
        if below <= 0.0 {
            return None;
        }
        let solved = self.covariance.clone().cholesky()?.solve(&self.values);
        let f = below / (self.freedom * q) * self.values.dot(&solved);
        Some(f_upper_tail(f, [q, below])).filter(|p| !p.is_nan())
    }

    /// Standard error of the first.
    pub fn standard_error(&self) -> f64 {
        self.covariance[(0, 0)].sqrt()
    }

    /// Half of an interval of the first that holds with this probability.
    pub fn half_width(&self, level: f64) -> f64 {
        student_t_quantile(0.5 + 0.5 * level, self.freedom) * self.standard_error()
    }
}

/// Columns that those before them do not determine, by the products of all.
fn independent(gram: &DMatrix<f64>) -> Vec<usize> {
    let mut left = gram.clone();
    let mut kept = Vec::new();
    for column in 0..gram.ncols() {
        let (own, whole) = (left[(column, column)], gram[(column, column)]);
        if !(whole > 0.0 && own > DETERMINED * whole) {
            continue;
        }
        kept.push(column);
        let direction = left.column(column).into_owned();
        left -= &direction * direction.transpose() / own;
    }
    kept
}

/// A^(-1/2) of a symmetric matrix whose eigenvalues are at least zero; zero in directions with an eigenvalue of less than `least`. `None` of a
/// matrix that is not finite.
fn inverse_root(matrix: DMatrix<f64>, least: f64) -> Option<DMatrix<f64>> {
    if matrix.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::try_new(matrix, f64::EPSILON, STEPS)?;
    let root = eigen.eigenvalues.map(|value| if value > least { 1.0 / value.sqrt() } else { 0.0 });
    Some(&eigen.eigenvectors * DMatrix::from_diagonal(&root) * eigen.eigenvectors.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn cluster(rows: &[&[f64]], right: &[f64]) -> Cluster {
        let width = rows[0].len();
        Cluster {
            rows: DMatrix::from_fn(rows.len(), width, |row, column| rows[row][column]),
            right: DVector::from_column_slice(right),
        }
    }

    /// Each value a cluster, an intercept and an indicator of the second group.
    fn two(a: &[f64], b: &[f64]) -> Regression {
        let of = |second: f64| move |value: &f64| cluster(&[&[1.0, second]], &[*value]);
        let clusters: Vec<Cluster> = a.iter().map(of(0.0)).chain(b.iter().map(of(1.0))).collect();
        Regression::new(&clusters).unwrap()
    }

    /// Oracle: Welch's t = Δ/√(s²_a/n_a + s²_b/n_b); with clusters of unit variance his ν is that of the sizes alone.
    #[test]
    fn two_groups_of_single_values_are_compared_as_by_welch() {
        let (a, b) = ([1.0, 2.0, 4.0, 3.5], [7.0, 6.0, 9.0, 8.0, 6.5]);
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let square = |v: &[f64]| v.iter().map(|x| (x - mean(v)).powi(2)).sum::<f64>() / (v.len() as f64 - 1.0);
        let found = two(&a, &b).combined(&[vec![(1, 1.0)]]).unwrap();
        assert!((found.values[0] - (mean(&b) - mean(&a))).abs() < 1e-12);
        let error = (square(&a) / 4.0 + square(&b) / 5.0).sqrt();
        assert!((found.standard_error() / error - 1.0).abs() < 1e-10, "{} {error}", found.standard_error());
        // Satterthwaite with equal variances: (1/4 + 1/5)² / (1/4²/3 + 1/5²/4).
        let freedom = 0.45_f64.powi(2) / (1.0 / 48.0 + 1.0 / 100.0);
        assert!((found.freedom / freedom - 1.0).abs() < 1e-9, "{} {freedom}", found.freedom);
    }

    /// Oracle: the F test of three groups of equal sizes, 100 times over; p is uniform, and more so than F, which needs equal variances.
    #[test]
    fn three_groups_that_do_not_differ_are_said_to_in_one_set_of_twenty_whatever_their_variances() {
        let mut stream = Stream::new(7, 0, 0);
        let trials = 600;
        let mut alarms = 0;
        for _ in 0..trials {
            let of = |group: usize, stream: &mut Stream| {
                let [second, third] = [1, 2].map(|other| f64::from(u8::from(group == other)));
                let size = [1.0, 2.0, 4.0][group];
                let shared = stream.normal();
                // Two rows that are not independent of each other.
                let rows = [[1.0, second, third], [1.0, second, third]];
                let right = [size * (shared + 0.3 * stream.normal()), size * shared];
                cluster(&[&rows[0], &rows[1]], &right)
            };
            let clusters: Vec<Cluster> = (0..24).map(|k| of(k % 3, &mut stream)).collect();
            let found = Regression::new(&clusters).unwrap().combined(&[vec![(1, 1.0)], vec![(2, 1.0)]]).unwrap();
            alarms += usize::from(found.p().unwrap() < 0.05);
        }
        // Binomial with 600 and 5 %: more than 48 or fewer than 14 with a probability below 0.2 % each.
        assert!((14..=48).contains(&alarms), "{alarms}");
    }

    #[test]
    fn many_rows_of_a_cluster_are_packed_without_a_change_and_columns_that_others_determine_are_left_out() {
        let mut stream = Stream::new(3, 0, 0);
        let rows = |stream: &mut Stream| {
            let rows: Vec<[f64; 3]> =
                (0..9).map(|_| [1.0, stream.normal(), 0.0]).map(|[a, b, _]| [a, b, a + 2.0 * b]).collect();
            let right: Vec<f64> = (0..9).map(|_| stream.normal()).collect();
            cluster(&rows.iter().map(|row| &row[..]).collect::<Vec<_>>(), &right)
        };
        let clusters: Vec<Cluster> = (0..6).map(|_| rows(&mut stream)).collect();
        let found = Regression::new(&clusters).unwrap();
        assert!(found.has(0) && found.has(1) && !found.has(2));
        assert!(found.combined(&[vec![(2, 1.0)]]).is_none());
        // Oracle: the formula of V with all rows as they are.
        let stacked = |of: &dyn Fn(&Cluster) -> DMatrix<f64>| clusters.iter().map(of).collect::<Vec<_>>();
        let x = stacked(&|c| c.rows.columns(0, 2).into_owned());
        let m = x.iter().map(|x| x.tr_mul(x)).sum::<DMatrix<f64>>().try_inverse().unwrap();
        let beta = &m * x.iter().zip(&clusters).map(|(x, c)| x.tr_mul(&c.right)).sum::<DVector<f64>>();
        let mut meat = DMatrix::zeros(2, 2);
        for (x, c) in x.iter().zip(&clusters) {
            let a = inverse_root(DMatrix::identity(9, 9) - x * &m * x.transpose(), 0.0).unwrap();
            let score = x.tr_mul(&(a * (&c.right - x * &beta)));
            meat += &score * score.transpose();
        }
        let v = &m * meat * &m;
        let own = found.combined(&[vec![(0, 1.0)], vec![(1, 1.0)]]).unwrap();
        assert!((own.covariance - v).amax() < 1e-10 && (own.values - beta).amax() < 1e-10);
    }
}
