//! The free parameters of a model, fitted to whole tracks.

use super::noise::Noise;
use super::observed::{Observed, ObservedRun};
use super::outliers::Outlier;
use crate::effect::{Chain, Model, ModelError};
use crate::fit::{Fit, Options, Problem, least_squares};
use crate::geometry::{Dual, Pose2};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// One (x, y, heading) a block.
pub type Column = Vec<[f64; 3]>;

/// A model fitted to tracks, and the noise that it leaves.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The runs, laid along the model.
    pub observed: Observed,
    /// The model with its free parameters at their best.
    pub model: Model,
    /// The noise.
    pub noise: Noise,
    /// Which of [`Model::values`] were fitted.
    pub free: Vec<usize>,
    /// Their covariance; `None` where the data leaves a combination of them open.
    pub covariance: Option<DMatrix<f64>>,
    /// Where runs were disturbed; what happened there is left out.
    pub outliers: Vec<Outlier>,
}

/// Outliers are looked for so many times.
const ROUNDS: usize = 3;
/// Stops where a step changes no parameter by more than a millionth.
const STOP: Options = Options { iterations: 12, step_tolerance: 1e-7, decrease_tolerance: 1e-9 };

impl Observed {
    /// Fits all free values of a model but those `held`, and the noise.
    pub fn fit(&self, model: &Model, from: &Noise, held: &[usize]) -> Result<Fitted, ModelError> {
        let mut fitted = self.whole().unfitted(model, from);
        fitted.free.retain(|value| !held.contains(value));
        fitted.settle()?;
        // An outlier may hide a smaller one, so it is looked for again.
        for _ in 0..ROUNDS {
            let found = fitted.beyond_noise();
            if found.is_empty() {
                break;
            }
            for ((run, block), deviations) in found {
                fitted.outliers.push(fitted.outlier((run, block), f64::from_bits(deviations)));
                fitted.observed.runs[run].start_afresh(block, &fitted.model.chain());
            }
            fitted.settle()?;
        }
        fitted.covariance = fitted.refit()?.covariance();
        Ok(fitted)
    }

    /// A model as it is, ready to be fitted.
    pub fn unfitted(&self, model: &Model, noise: &Noise) -> Fitted {
        let free = self.free_values(model);
        Fitted {
            observed: self.along(model),
            model: model.clone(),
            noise: *noise,
            free,
            covariance: None,
            outliers: Vec::new(),
        }
    }

    /// Values of the free parts of a model that move some observed pose.
    pub fn free_values(&self, model: &Model) -> Vec<usize> {
        let parts = model.parts().iter().flat_map(|part| part.values.iter().map(|_| part.free));
        let free: Vec<usize> = parts.enumerate().filter_map(|(i, free)| free.then_some(i)).collect();
        let columns = self.columns(model, &free);
        let moves = |k: &usize| columns.iter().any(|run| run[*k].iter().any(|c| *c != [0.0; 3]));
        (0..free.len()).filter(moves).map(|k| free[k]).collect()
    }

    /// Derivatives of the predicted poses by some of the values of a model: run by run, one column a value.
    pub fn columns(&self, model: &Model, values: &[usize]) -> Vec<Vec<Column>> {
        let chains: Vec<_> = values.iter().map(|value| seeded(model, *value)).collect();
        self.runs.par_iter().map(|run| chains.iter().map(|chain| run.derivatives(chain)).collect()).collect()
    }
}

/// The chain of a model that carries derivatives by one of its values.
pub(crate) fn seeded(model: &Model, value: usize) -> Chain<Dual> {
    let seed = |(i, v)| Dual::new(v, f64::from(u8::from(i == value)));
    model.chain_with(&model.values().enumerate().map(seed).collect::<Vec<_>>())
}

impl ObservedRun {
    /// Derivatives of the predicted poses, block by block.
    pub(crate) fn derivatives(&self, chain: &Chain<Dual>) -> Column {
        self.column(chain, |pose| Pose2::new(pose.x.eps, pose.y.eps, pose.heading.eps))
    }
}

impl Fitted {
    /// Fits values and noise in turn.
    fn settle(&mut self) -> Result<(), ModelError> {
        for _ in 0..2 {
            self.refit()?;
            let mut columns = self.observed.columns(&self.model, &self.free);
            let chain = self.model.chain();
            for (run, columns) in self.observed.runs.iter().zip(&mut columns) {
                columns.push(run.residuals(&chain));
            }
            self.noise = Noise::estimate(&self.observed, &chain, &columns, &self.noise);
        }
        Ok(())
    }

    /// Fits the free values under the noise as it is.
    pub fn refit(&mut self) -> Result<Fit, ModelError> {
        let start: Vec<f64> = self.model.values().collect();
        let start: Vec<f64> = self.free.iter().map(|i| start[*i]).collect();
        let problem = Tracks { observed: &self.observed, model: &self.model, noise: &self.noise, free: &self.free };
        let fit = least_squares(&problem, &start, &STOP);
        self.model = self.model.with_values(&self.free, &fit.values)?;
        self.observed = self.observed.along(&self.model);
        Ok(fit)
    }
}

struct Tracks<'a> {
    observed: &'a Observed,
    model: &'a Model,
    noise: &'a Noise,
    free: &'a [usize],
}

impl Tracks<'_> {
    /// Whitens one set of columns a run into one matrix.
    fn stacked(&self, columns: &[Vec<Column>]) -> DMatrix<f64> {
        let runs: Vec<Vec<f64>> = self
            .observed
            .runs
            .par_iter()
            .zip(columns)
            .map(|(run, columns)| {
                let columns: Vec<&[[f64; 3]]> = columns.iter().map(Vec::as_slice).collect();
                self.noise.whiten(run, &columns).values
            })
            .collect();
        let width = columns.first().map_or(0, Vec::len);
        let values: Vec<f64> = runs.concat();
        DMatrix::from_row_slice(values.len() / width.max(1), width, &values)
    }
}

impl Problem for Tracks<'_> {
    fn residuals(&self, parameters: &[f64]) -> DVector<f64> {
        let Ok(model) = self.model.with_values(self.free, parameters) else {
            return DVector::from_element(1, f64::INFINITY);
        };
        let chain = model.chain();
        let residuals: Vec<Vec<Column>> =
            self.observed.runs.par_iter().map(|run| vec![run.residuals(&chain)]).collect();
        let stacked = self.stacked(&residuals);
        DVector::from_column_slice(stacked.as_slice())
    }

    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let Ok(model) = self.model.with_values(self.free, parameters) else {
            return DMatrix::zeros(1, self.free.len());
        };
        -self.stacked(&self.observed.columns(&model, self.free))
    }
}
