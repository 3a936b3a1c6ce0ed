//! A model fitted to evidence, and how sure its numbers are.

use super::{AnyEvidence, Ends, Evidence, FitError, Level, robot_of};
use crate::dataset::Dataset;
use crate::effect::Model;
use crate::likelihood::{Noise, Outlier, Taken};
use crate::setup::Setup;
use crate::stats::{Interval, student_t_quantile};
use nalgebra::DMatrix;
use std::sync::Arc;

/// A number of an effect with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The effect.
    pub effect: &'static str,
    /// The parameter, as in files: its unit stands in the name.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// ν of Student's t for its interval.
    pub degrees_of_freedom: f64,
}

impl Estimate {
    /// Its interval with probability `level`, Student's t; `None` where it is not finite.
    pub fn interval(&self, level: f64) -> Option<Interval> {
        let half = student_t_quantile(0.5 + 0.5 * level, self.degrees_of_freedom) * self.standard_error;
        half.is_finite().then(|| Interval::around(self.value, half))
    }
}

/// A model with its free parameters fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// What was fitted.
    pub estimates: Vec<Estimate>,
    /// Their correlations, a row each; empty where the data does not determine them.
    pub correlations: Vec<Vec<f64>>,
    /// The sizes of the noise under which the runs are likeliest; from tracks only.
    pub noise: Option<Noise>,
    /// Where runs were disturbed; the fit leaves these places out. From tracks only.
    pub outliers: Vec<Outlier>,
    /// Whether the values were fitted with noise of the usual sizes; see [`USUAL_NOISE`](crate::likelihood::USUAL_NOISE).
    pub usual_noise: bool,
    /// What was found of the experiment before the fit.
    pub setup: Arc<Setup>,
    /// The part of it that was added to the model.
    pub taken: Vec<Taken>,
}

/// Correlations from a covariance; none where it is not known.
pub(crate) fn correlations(covariance: Option<&DMatrix<f64>>) -> Vec<Vec<f64>> {
    let Some(c) = covariance.filter(|c| (0..c.nrows()).all(|i| c[(i, i)] > 0.0)) else { return Vec::new() };
    let of = |i: usize, j: usize| (c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt()).clamp(-1.0, 1.0);
    (0..c.nrows()).map(|i| (0..c.nrows()).map(|j| of(i, j)).collect()).collect()
}

/// Fits a model's free parameters to a dataset.
pub fn fit(data: &Dataset, model: &Model) -> Result<Fit, FitError> {
    model.check_robot(robot_of(data)?)?;
    AnyEvidence::of(data, Level::of(data))?.fit(model)
}

/// [`fit`] to the return poses alone, even where the runs were observed on the way.
pub fn fit_to_returns(data: &Dataset, model: &Model) -> Result<(Model, Vec<Estimate>), FitError> {
    let fit = Ends::new(data)?.fit(model)?;
    Ok((fit.model, fit.estimates))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_have_ones_on_the_diagonal_and_need_a_covariance() {
        let covariance = DMatrix::from_row_slice(2, 2, &[4.0, -1.0, -1.0, 1.0]);
        assert_eq!(correlations(Some(&covariance)), [[1.0, -0.5], [-0.5, 1.0]]);
        assert!(correlations(None).is_empty());
        assert!(correlations(Some(&DMatrix::from_element(1, 1, f64::NAN))).is_empty());
    }
}
