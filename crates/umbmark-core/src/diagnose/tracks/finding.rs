//! What a group of columns explains beyond a fitted model, and how significant that is.

use crate::diagnose::options::Options;
use crate::evidence::tracks::Projected;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Share by which errors in held-out runs must fall for an unlisted effect to be reported.
pub const TELLING: f64 = 0.1;

/// A group after one step from zero.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Which of [`Examination::asked`].
    pub asked: usize,
    /// Its columns that the rest of the model does not absorb.
    pub columns: Vec<usize>,
    /// Decrease of the sum of squares.
    pub drop: f64,
    /// Values of the columns.
    pub step: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// A tested group, beside the columns that were fitted out.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The group after one step.
    pub answer: Answer,
    /// Family-wise p by F and Bonferroni, among effects (or among smooths): by the noise model, or by the scatter of the runs,
    /// whichever is larger.
    pub p_f: f64,
    /// Family-wise p by sign flips; 1 if F is not significant, which flips could not change.
    pub p_flips: f64,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: [f64; 2],
    /// F.
    pub f: f64,
    /// p by F alone.
    pub p: f64,
    pub(super) projected: Arc<Projected>,
}

impl Finding {
    /// Whether both tests are significant.
    pub fn certified(&self, options: &Options) -> bool {
        self.p_f <= options.size && self.p_flips <= options.size
    }

    /// The columns that were fitted out in its test.
    pub fn base(&self) -> &[usize] {
        &self.projected.base
    }

    /// The larger of the two.
    pub fn p_adjusted(&self) -> f64 {
        self.p_f.max(self.p_flips).min(1.0)
    }
}

/// How much a group improves the fit beyond the same number of random columns.
pub fn worth(answer: &Answer) -> f64 {
    worth_of(answer.drop, answer.columns.len())
}

/// Worth of a drop by a given number of parameters.
pub fn worth_of(drop: f64, numbers: usize) -> f64 {
    drop - 3.0 * numbers as f64
}
