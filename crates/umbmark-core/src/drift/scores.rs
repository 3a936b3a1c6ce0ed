//! The scores of runs: how far each lies from what the earlier runs of its direction predict.
//!
//! Of the n earlier runs of one direction, let ȳ be the mean and L Lᵀ = Σ (y - ȳ)(y - ȳ)ᵀ. A new run y of the same normal distribution has, with
//! w = L⁻¹ (y - ȳ),
//!
//! ```text
//! t_k = w_k √(n - k) / √(1 + 1/n + w_1² + … + w_{k-1}²),    k = 1 … q
//! ```
//!
//! which is Student's t with n - k degrees of freedom, independent of the other components and of all earlier runs, whatever mean and covariance are.
//! z_k = Φ⁻¹(F_t(t_k)) is then standard normal.
//!
//! A run beyond [`OUTLYING`] counts as if it lay there, in the statistic and in the prediction of later runs.
//!
//! Source: Hawkins (1987), The Statistician 36, 299, for one component; Sullivan & Jones (2002), Technometrics 44, 24, for several.

use crate::stats::{chi_squared_quantile, f_upper_tail, normal_quantile, student_t_quantile};

/// Components at most: x, y, heading and scale.
pub const COMPONENTS: usize = 4;

/// A vector of components; those that are not measured are zero.
pub type Vector = [f64; COMPONENTS];

/// A matrix of components.
pub type Matrix = [[f64; COMPONENTS]; COMPONENTS];

/// One good run in so many is called outlying.
pub const OUTLYING: f64 = 200.0;

/// Runs of one direction, and what they predict.
#[derive(Clone, Debug)]
pub(super) struct Scorer {
    /// Components that are measured.
    count: usize,
    /// Distance beyond which a run is outlying.
    reach: f64,
    pub runs: usize,
    pub mean: Vector,
    /// Σ (y - ȳ)(y - ȳ)ᵀ.
    pub scatter: Matrix,
}

/// A run that was predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scored {
    /// Its scores, at most [`Scorer::reach`] long.
    pub scores: Vector,
    /// Their length before they were shortened.
    pub distance: f64,
    /// Earlier runs of its direction.
    pub earlier: usize,
    /// dz/dy, lower triangular.
    pub slopes: Matrix,
}

impl Scorer {
    pub fn new(count: usize) -> Scorer {
        Scorer {
            count,
            reach: reach(count),
            runs: 0,
            mean: [0.0; COMPONENTS],
            scatter: [[0.0; COMPONENTS]; COMPONENTS],
        }
    }

    /// Runs of a direction before the first that is scored: so that every t has two degrees of freedom at least.
    pub fn baseline(count: usize) -> usize {
        count + 2
    }

    /// Scores a run by the earlier ones, and adds it to them. `None` for a run of the baseline, and where earlier runs do not scatter.
    pub fn add(&mut self, run: &Vector) -> Option<Scored> {
        let mut run = *run;
        let scored = if self.runs < Scorer::baseline(self.count) { None } else { self.score(&mut run) };
        self.runs += 1;
        let mut off = [0.0; COMPONENTS];
        for k in 0..self.count {
            off[k] = run[k] - self.mean[k];
            self.mean[k] += off[k] / self.runs as f64;
        }
        let weight = (self.runs - 1) as f64 / self.runs as f64;
        for i in 0..self.count {
            for j in 0..self.count {
                self.scatter[i][j] += weight * off[i] * off[j];
            }
        }
        scored
    }

    /// The scores of a run; one that is outlying is moved to where it would be just so.
    fn score(&self, run: &mut Vector) -> Option<Scored> {
        let factor = cholesky(&self.scatter, self.count)?;
        let inverse = inverse(&factor, self.count);
        let n = self.runs as f64;
        let mut off = [0.0; COMPONENTS];
        (0..self.count).for_each(|k| off[k] = run[k] - self.mean[k]);
        let (mut scores, mut slopes) = ([0.0; COMPONENTS], [[0.0; COMPONENTS]; COMPONENTS]);
        let mut spread = 1.0 + 1.0 / n;
        for k in 0..self.count {
            let freedom = n - (k + 1) as f64;
            let w: f64 = (0..=k).map(|j| inverse[k][j] * off[j]).sum();
            let scale = (freedom / spread).sqrt();
            scores[k] = normal_score(w * scale, freedom);
            // The information of a t on its place, against that of a normal.
            let worth = ((freedom + 1.0) / (freedom + 3.0)).sqrt();
            (0..=k).for_each(|j| slopes[k][j] = worth * scale * inverse[k][j]);
            spread += w * w;
        }
        let distance = scores.iter().map(|z| z * z).sum::<f64>().sqrt();
        if distance > self.reach {
            scores.iter_mut().for_each(|z| *z *= self.reach / distance);
            *run = self.at(&scores, &factor);
        }
        Some(Scored { scores, distance, earlier: self.runs, slopes })
    }

    /// The run that has these scores.
    fn at(&self, scores: &Vector, factor: &Matrix) -> Vector {
        let n = self.runs as f64;
        let (mut w, mut spread) = ([0.0; COMPONENTS], 1.0 + 1.0 / n);
        let mut run = self.mean;
        for k in 0..self.count {
            let freedom = n - (k + 1) as f64;
            let upper = crate::stats::standard_normal_share(scores[k].abs());
            w[k] = student_t_quantile(upper, freedom).copysign(scores[k]) * (spread / freedom).sqrt();
            spread += w[k] * w[k];
            run[k] += (0..=k).map(|j| factor[k][j] * w[j]).sum::<f64>();
        }
        run
    }
}

/// Length of the scores of so many components that one run in [`OUTLYING`] exceeds.
pub(super) fn reach(count: usize) -> f64 {
    chi_squared_quantile(1.0 - 1.0 / OUTLYING, count as f64).sqrt()
}

/// Φ⁻¹(F_t(t)), from the nearer tail.
fn normal_score(t: f64, freedom: f64) -> f64 {
    let tail = 0.5 * f_upper_tail(t * t, [1.0, freedom]);
    let z = if tail >= 0.5 { 0.0 } else { -normal_quantile(tail.max(f64::MIN_POSITIVE)) };
    z.copysign(t)
}

/// The lower triangle L with L Lᵀ = `matrix`; `None` where a component does not scatter beside those before it.
pub(super) fn cholesky(matrix: &Matrix, count: usize) -> Option<Matrix> {
    let mut factor = [[0.0; COMPONENTS]; COMPONENTS];
    for i in 0..count {
        for j in 0..=i {
            let rest = matrix[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            if i == j {
                if !(rest > 1e-12 * matrix[i][i] && rest.is_finite()) {
                    return None;
                }
                factor[i][i] = rest.sqrt();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    Some(factor)
}

/// The inverse of a lower triangle.
#[expect(clippy::needless_range_loop, reason = "indices as in the equation")]
pub(super) fn inverse(factor: &Matrix, count: usize) -> Matrix {
    let mut inverse = [[0.0; COMPONENTS]; COMPONENTS];
    for i in 0..count {
        inverse[i][i] = 1.0 / factor[i][i];
        for j in 0..i {
            let sum: f64 = (j..i).map(|k| factor[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum / factor[i][i];
        }
    }
    inverse
}
