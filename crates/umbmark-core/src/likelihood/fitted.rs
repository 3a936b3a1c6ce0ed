//! A model fitted to tracks, and what was left out of the fit.

use super::beginning::Taken;
use super::noise::Noise;
use super::observed::{Column, Observed};
use crate::effect::Model;
use crate::fit::Termination;
use nalgebra::DMatrix;
use std::sync::Arc;

/// A place where a run was disturbed.
#[derive(Clone, Debug, PartialEq)]
pub struct Outlier {
    /// The run.
    pub run: String,
    /// Time since START \[s\].
    pub time: f64,
    /// How far the robot seemed to jump \[m\].
    pub moved: f64,
    /// How far it seemed to turn \[rad\]; `None` where headings were not measured.
    pub turned: Option<f64>,
    /// In standard deviations.
    pub deviations: f64,
}

/// A model fitted to tracks, and the noise that it leaves.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The runs, linearised about the model.
    pub observed: Observed,
    /// The model with its fitted parameters.
    pub model: Model,
    /// The noise.
    pub noise: Noise,
    /// Which of [`Model::values`] were fitted.
    pub free: Vec<usize>,
    /// Derivatives, run by run, of the effects of the reference that the model lacks: they are fitted too but not added to the model.
    pub reference: Vec<Vec<Column>>,
    /// The covariance of the free values; `None` where the data leaves a combination of them open.
    pub covariance: Option<DMatrix<f64>>,
    /// Whether the values were fitted with noise of the usual sizes because these predict held-out runs better.
    pub usual_noise: bool,
    /// What was taken from the motion before the fit and added to the model.
    pub taken: Vec<Taken>,
    /// Where runs were disturbed; these places are left out of the fit.
    pub outliers: Vec<Outlier>,
    /// Places of free values that ended at a bound.
    pub held: Vec<usize>,
    /// How the last fit of the values ended.
    pub ended: Ended,
    pub(crate) slopes: Slopes,
}

/// How a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ended {
    /// Why.
    pub termination: Termination,
    /// Steps tried.
    pub steps: usize,
}

impl Default for Ended {
    /// Where there is nothing to fit.
    fn default() -> Self {
        Ended { termination: Termination::SmallStep, steps: 0 }
    }
}

/// Derivatives of the predicted poses by free values of a model, run by run and one column a value: computed once for each model.
#[derive(Clone, Debug)]
pub(crate) struct Slopes {
    pub values: Vec<f64>,
    pub free: Vec<usize>,
    pub columns: Arc<Vec<Vec<Column>>>,
}

impl Slopes {
    /// Whether they are those by these values of a model of the same effects.
    pub fn fit(&self, model: &Model, free: &[usize]) -> bool {
        self.free == free && !self.columns.is_empty() && self.values.iter().copied().eq(model.values())
    }
}
