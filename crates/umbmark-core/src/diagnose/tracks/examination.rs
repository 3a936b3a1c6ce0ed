//! A fitted model on tracks beside everything that it may be missing.

use super::errors::Errors;
use super::smooth::{self, Covariate, Motion, smooth_columns};
use super::system::{Projected, System};
use crate::effect::{CATALOGUE, Entry, ModelError};
use crate::likelihood::{Column, Fitted, Noise, Observed};
use crate::parameter::Parameter;
use nalgebra::{DMatrix, DVector};

/// Effects of the reference that every track has; they are fitted out before physics is asked about.
pub const NUISANCE: [&str; 3] = ["reference_delay", "marker_offset", "marker_yaw"];
/// At its usual size a candidate must move the observations by so many standard deviations to be asked about.
const VISIBLE: f64 = 0.3;
/// Response that others must be able to make to be of the same class, as a cosine.
pub const ALIKE: f64 = 0.95;
/// Groups that are fitted out for a clean estimate of the noise, and the drop that each must bring a column.
const CLEANED: usize = 6;
const WORTH_CLEANING: f64 = 15.0;

/// What is asked about.
#[derive(Clone, Debug)]
pub enum Question {
    /// An effect of the catalogue, with the parameters that its columns stand for.
    Effect(&'static Entry, Vec<&'static Parameter>),
    /// A smooth of a covariate.
    Smooth(&'static Covariate, Motion),
}

/// A group of columns that may be missing from the model.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What it is.
    pub question: Question,
    /// Its columns in the system.
    pub columns: Vec<usize>,
    /// Whether it is an effect of the reference, fitted out for the others.
    pub nuisance: bool,
}

impl Asked {
    /// The effect, if it is one.
    pub fn effect(&self) -> Option<&'static Entry> {
        match self.question {
            Question::Effect(entry, _) => Some(entry),
            Question::Smooth(..) => None,
        }
    }
}

/// A group after one step from zero.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Which of [`Examination::asked`].
    pub asked: usize,
    /// Its columns that the rest of the model leaves visible.
    pub columns: Vec<usize>,
    /// What it takes off the sum of squares.
    pub drop: f64,
    /// Values of the columns.
    pub step: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// A fitted model on tracks, its residuals, and the columns of all that may be missing.
#[derive(Clone, Debug)]
pub struct Examination {
    /// The model.
    pub fitted: Fitted,
    /// Products of all columns.
    pub system: System,
    /// All that is asked about.
    pub asked: Vec<Asked>,
    /// Columns of the model's free values.
    pub free: Vec<usize>,
    /// Errors in metres and radians, by the columns of the model and of the catalogue's effects.
    pub errors: Errors,
    columns: Vec<Vec<Column>>,
}

impl Examination {
    /// Asks a fitted model about every effect of the catalogue that it lacks, and every smooth.
    pub fn new(fitted: Fitted) -> Result<Examination, ModelError> {
        let observed = &fitted.observed;
        let mut columns = observed.columns(&fitted.model, &fitted.free);
        let free: Vec<usize> = (0..fitted.free.len()).collect();
        let mut asked = Vec::new();
        let mut width = free.len();
        for candidate in candidates(observed, &fitted)? {
            let (effect, sizes) = candidate;
            let parameters = sizes.iter().map(|(parameter, _)| *parameter).collect();
            let own = (width..width + sizes.len()).collect();
            width += sizes.len();
            for (_, by_run) in sizes {
                columns.iter_mut().zip(by_run).for_each(|(all, column)| all.push(column));
            }
            let nuisance = NUISANCE.contains(&effect.about.name);
            asked.push(Asked { question: Question::Effect(effect, parameters), columns: own, nuisance });
        }
        for (all, smooths) in columns.iter_mut().zip(smooth_columns(observed, &fitted.model)) {
            all.extend(smooths);
        }
        for (covariate, motion, first, terms) in smooth::groups() {
            let own = (width + first..width + first + terms).collect();
            asked.push(Asked { question: Question::Smooth(covariate, motion), columns: own, nuisance: false });
        }
        let chain = fitted.model.chain();
        for (all, run) in columns.iter_mut().zip(&observed.runs) {
            all.push(run.residuals(&chain));
        }
        let system = System::new(observed, &fitted.noise, &columns);
        let errors = Errors::new(observed, &columns, (0..width).chain([system.residual()]).collect());
        let mut examination = Examination { fitted, system, asked, free, errors, columns };
        examination.clean();
        Ok(examination)
    }

    /// A fitted model asked about nothing: for its errors alone.
    pub fn bare(fitted: Fitted) -> Examination {
        let observed = &fitted.observed;
        let mut columns = observed.columns(&fitted.model, &fitted.free);
        let chain = fitted.model.chain();
        for (all, run) in columns.iter_mut().zip(&observed.runs) {
            all.push(run.residuals(&chain));
        }
        let system = System::new(observed, &fitted.noise, &columns);
        let errors = Errors::new(observed, &columns, (0..system.width).collect());
        let free = (0..fitted.free.len()).collect();
        Examination { fitted, system, asked: Vec::new(), free, errors, columns }
    }

    /// Estimates the noise anew with what is most evidently missing fitted out, so that it is noise alone.
    fn clean(&mut self) {
        let mut out = self.base(None);
        let mut added = 0;
        while added < CLEANED {
            let projected = Projected::new(&self.system.sum(|_| true), &out);
            let best = self
                .answers(&projected, |asked| !asked.nuisance)
                .into_iter()
                .max_by(|a, b| worth(a).total_cmp(&worth(b)))
                .filter(|a| a.drop > WORTH_CLEANING * a.columns.len() as f64);
            let Some(best) = best else { break };
            out.extend(best.columns);
            added += 1;
        }
        if added == 0 {
            return;
        }
        let few: Vec<Vec<Column>> = self
            .columns
            .iter()
            .map(|run| out.iter().copied().chain([self.system.residual()]).map(|c| run[c].clone()).collect())
            .collect();
        let chain = self.fitted.model.chain();
        self.fitted.noise = Noise::estimate(&self.fitted.observed, &chain, &few, &self.fitted.noise);
        self.system = System::new(&self.fitted.observed, &self.fitted.noise, &self.columns);
    }

    /// Errors by the columns of the model and a smooth.
    pub fn errors_with(&self, columns: &[usize]) -> Errors {
        let which = self.free.iter().chain(columns).copied().chain([self.system.residual()]).collect();
        Errors::new(&self.fitted.observed, &self.columns, which)
    }

    /// Columns that are fitted out when a group is asked about: the model's own and those of the reference, its own excepted.
    pub fn base(&self, asked: Option<usize>) -> Vec<usize> {
        let others = self.asked.iter().enumerate().filter(|(i, other)| other.nuisance && Some(*i) != asked);
        let mut base = self.free.clone();
        let products = self.system.sum(|_| true);
        for column in others.flat_map(|(_, other)| other.columns.iter().copied()) {
            if !Projected::new(&products, &base).absorbed(&products, column) {
                base.push(column);
            }
        }
        base
    }

    /// The answer of every group that `wanted` picks and the data shows, beside a base.
    pub fn answers(&self, projected: &Projected, wanted: impl Fn(&Asked) -> bool) -> Vec<Answer> {
        let products = self.system.sum(|_| true);
        let asked = self.asked.iter().enumerate().filter(|(_, asked)| wanted(asked));
        asked.filter_map(|(index, _)| self.answer(projected, &products, index)).collect()
    }

    /// The answer of one group, where the data shows it.
    pub fn answer(&self, projected: &Projected, products: &DMatrix<f64>, index: usize) -> Option<Answer> {
        let asked = &self.asked[index];
        let shown = asked.columns.iter().enumerate().filter(|(k, column)| {
            let typical = match &asked.question {
                Question::Effect(_, parameters) => parameters[*k].typical,
                Question::Smooth(..) => f64::INFINITY,
            };
            let left = projected.products[(**column, **column)];
            !projected.absorbed(products, **column) && left.sqrt() * typical > VISIBLE
        });
        let columns: Vec<usize> = shown.map(|(_, column)| *column).collect();
        if columns.is_empty() {
            return None;
        }
        let (drop, step, covariance) = projected.drop(&columns)?;
        Some(Answer { asked: index, columns, drop, step, covariance })
    }
}

/// How much better a group makes the fit than as many columns of nothing would.
pub fn worth(answer: &Answer) -> f64 {
    answer.drop - 3.0 * answer.columns.len() as f64
}

/// An effect with, for each of its sizes, the columns by run.
type WithColumns = (&'static Entry, Vec<(&'static Parameter, Vec<Column>)>);

/// Every effect of the catalogue that the model lacks and that moves some observation, with its columns by run.
fn candidates(observed: &Observed, fitted: &Fitted) -> Result<Vec<WithColumns>, ModelError> {
    let model = &fitted.model;
    let missing = CATALOGUE.iter().filter(|entry| model.parts().iter().all(|part| part.effect != *entry));
    let mut found = Vec::new();
    for effect in missing {
        let mut with = model.clone();
        with.add(effect.about.name)?;
        let before = with.parts().iter().take_while(|part| part.effect != effect);
        let first: usize = before.map(|part| part.values.len()).sum();
        let count = effect.about.parameters.len();
        let columns = observed.columns(&with, &(first..first + count).collect::<Vec<_>>());
        let mut sizes = Vec::new();
        for (index, parameter) in effect.about.parameters.iter().enumerate() {
            let by_run: Vec<Column> = columns.iter().map(|run| run[index].clone()).collect();
            if by_run.iter().flatten().any(|c| *c != [0.0; 3]) {
                sizes.push((parameter, by_run));
            }
        }
        if !sizes.is_empty() {
            found.push((effect, sizes));
        }
    }
    Ok(found)
}
