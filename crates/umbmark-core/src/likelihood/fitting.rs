//! The free parameters of a model, fitted to whole tracks.

use super::noise::Noise;
use super::observed::{Observed, ObservedRun};
use super::outliers::Outlier;
use super::products::{ABSORBED, gram, share_left};
use crate::effect::{Chain, Model, ModelError, find};
use crate::fit::{Options, Problem, least_squares};
use crate::geometry::{Dual, Pose2};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// One (x, y, heading) a block.
pub type Column = Vec<[f64; 3]>;

/// Effects of the reference that every track has; they are fitted out before anything is said of the robot.
pub const NUISANCE: [&str; 3] = ["reference_delay", "marker_offset", "marker_yaw"];

/// What of its runs a model was fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighing {
    /// What is new from pose to pose: the likeliest values, where nothing is missing from the model.
    Increments,
    /// Positions and headings all along: the values that predict best where something is missing.
    Tracks,
}

impl Weighing {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Weighing::Increments => "increments",
            Weighing::Tracks => "tracks",
        }
    }

    /// What is to be said of values so fitted; empty where nothing is.
    pub fn caution(self) -> &'static str {
        match self {
            Weighing::Increments => "",
            Weighing::Tracks => {
                "Fitted to whole tracks, which predict the runs left out better than what is new from pose to pose does: a complete \
                 model would not let that happen. Use the values to predict this robot; as its physics, take them with caution."
            }
        }
    }
}

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
    /// What the effects of the reference that the model lacks would do, run by run: fitted along and left out of the model.
    pub reference: Vec<Vec<Column>>,
    /// The covariance of the free values; `None` where the data leaves a combination of them open.
    pub covariance: Option<DMatrix<f64>>,
    /// What was fitted.
    pub weighing: Weighing,
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
        fitted.refit()?;
        Ok(fitted)
    }

    /// A model as it is, ready to be fitted.
    pub fn unfitted(&self, model: &Model, noise: &Noise) -> Fitted {
        let free = self.free_values(model);
        Fitted {
            observed: self.along(model),
            model: model.clone(),
            noise: *noise,
            reference: vec![Vec::new(); self.runs.len()],
            free,
            covariance: None,
            weighing: Weighing::Increments,
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
            for ((run, columns), reference) in self.observed.runs.iter().zip(&mut columns).zip(&self.reference) {
                columns.extend(reference.iter().cloned());
                columns.push(run.residuals(&chain));
            }
            self.noise = Noise::estimate(&self.observed, &chain, &columns, &self.noise);
        }
        Ok(())
    }

    /// Fits the free values under the noise as it is, and the effects of the reference with them.
    ///
    /// A yaw of 6 mrad of the markers that is not fitted along moves E_d by 1 %: the reference's course over a leg says where the
    /// robot went, its heading where it looked.
    pub fn refit(&mut self) -> Result<(), ModelError> {
        self.reference = self.reference_columns()?;
        let start: Vec<f64> = self.model.values().collect();
        let mut start: Vec<f64> = self.free.iter().map(|i| start[*i]).collect();
        start.resize(self.free.len() + self.reference.first().map_or(0, Vec::len), 0.0);
        let fit = least_squares(&Tracks(self), &start, &STOP);
        let own = self.free.len();
        self.covariance = fit.covariance().map(|all| all.view((0, 0), (own, own)).into_owned());
        self.model = self.model.with_values(&self.free, &fit.values[..own])?;
        self.observed = self.observed.along(&self.model);
        Ok(())
    }

    /// The columns of the effects of the reference that the model lacks and that its free values leave visible.
    fn reference_columns(&self) -> Result<Vec<Vec<Column>>, ModelError> {
        let (mut with, mut own) = (self.model.clone(), Vec::new());
        let known = |name: &&str| self.model.parts().iter().any(|part| part.effect.name() == *name);
        let lacking: Vec<&str> = NUISANCE.into_iter().filter(|name| !known(name)).collect();
        for name in &lacking {
            with.add(name)?;
        }
        for name in lacking {
            let parameters = find(name)?.about.parameters;
            own.extend(parameters.iter().filter_map(|parameter| with.place_of(name, parameter.name)));
        }
        let free = self.observed.columns(&self.model, &self.free);
        let mut columns = self.observed.columns(&with, &own);
        let both: Vec<Vec<Column>> = free.iter().zip(&columns).map(|(a, b)| [&a[..], b].concat()).collect();
        let stacked = self.stacked(&both);
        let products = gram(stacked.transpose().as_slice(), stacked.ncols());
        let mut base: Vec<usize> = (0..self.free.len()).collect();
        for column in self.free.len()..products.ncols() {
            if share_left(&products, &base, column) > ABSORBED {
                base.push(column);
            }
        }
        let kept: Vec<usize> = base[self.free.len()..].iter().map(|column| column - self.free.len()).collect();
        columns.iter_mut().for_each(|run| *run = kept.iter().map(|column| run[*column].clone()).collect());
        Ok(columns)
    }

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

/// The free values of a model, and behind them the sizes of the effects of the reference.
struct Tracks<'a>(&'a Fitted);

impl Tracks<'_> {
    fn model(&self, parameters: &[f64]) -> Result<Model, ModelError> {
        self.0.model.with_values(&self.0.free, &parameters[..self.0.free.len()])
    }
}

impl Problem for Tracks<'_> {
    fn residuals(&self, parameters: &[f64]) -> DVector<f64> {
        let Ok(model) = self.model(parameters) else {
            return DVector::from_element(1, f64::INFINITY);
        };
        let (chain, sizes) = (model.chain(), &parameters[self.0.free.len()..]);
        let left = |(run, reference): (&ObservedRun, &Vec<Column>)| {
            let mut left = run.residuals(&chain);
            for (column, size) in reference.iter().zip(sizes) {
                left.iter_mut().zip(column).for_each(|(l, c)| (0..3).for_each(|k| l[k] -= size * c[k]));
            }
            vec![left]
        };
        let residuals: Vec<Vec<Column>> = self.0.observed.runs.par_iter().zip(&self.0.reference).map(left).collect();
        DVector::from_column_slice(self.0.stacked(&residuals).as_slice())
    }

    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let Ok(model) = self.model(parameters) else {
            return DMatrix::zeros(1, parameters.len());
        };
        let mut columns = self.0.observed.columns(&model, &self.0.free);
        columns.iter_mut().zip(&self.0.reference).for_each(|(own, more)| own.extend(more.iter().cloned()));
        -self.0.stacked(&columns)
    }
}
