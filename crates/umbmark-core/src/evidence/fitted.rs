//! A model fitted to evidence, and how sure its numbers are.

use super::{AnyEvidence, Ends, Evidence, FitError, Level, robot_of};
use crate::dataset::Dataset;
use crate::effect::Model;
use crate::likelihood::{Noise, Outlier, Taken};
use crate::setup::Setup;
use crate::stats::{Interval, student_t_quantile};
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
