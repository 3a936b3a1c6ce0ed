//! A fitted model on tracks beside everything that it may be missing.

use super::errors::Errors;
use super::errors::Misses;
use super::look::Finding;
use super::smooth::{self, Covariate, Motion, smooth_columns};
use super::system::{Projected, System};
use crate::diagnose::ends::names;
use crate::effect::{Changes, Entry, Model, ModelError, Number, is_shape, of_drive};
use crate::likelihood::{ABSORBED, Column, Fitted, NUISANCE, Noise, share_left};
use crate::parameter::Parameter;
use nalgebra::{DMatrix, DVector};
use std::sync::OnceLock;

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
    /// Its shape, where it has one and another value than the usual is tried.
    pub shape: Option<(&'static Parameter, f64)>,
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
    /// What the columns of the model and of the catalogue's effects are derivatives by.
    numbers: Vec<Number>,
    columns: Vec<Vec<Column>>,
    /// What was found of the smooths, once they were looked at.
    pub smooths: OnceLock<Vec<Finding>>,
}

impl Examination {
    /// Asks a fitted model about every effect of the catalogue that it lacks, and every smooth.
    pub fn new(fitted: Fitted) -> Result<Examination, ModelError> {
        let observed = &fitted.observed;
        let own = names(&fitted.model);
        let own = fitted.free.iter().map(|value| own[*value]);
        let mut numbers: Vec<Number> =
            own.map(|(effect, parameter)| Number { effect, parameter, shape: None }).collect();
        let free: Vec<usize> = (0..numbers.len()).collect();
        let offers = offers(&fitted.model);
        numbers.extend(offers.iter().flat_map(Offer::numbers));
        let mut columns = observed.columns_of(&fitted.model, &numbers)?;
        let shows = |number: usize| columns.iter().any(|run| run[number].iter().any(|c| *c != [0.0; 3]));
        let (mut asked, mut kept, mut next, mut silent) = (Vec::new(), free.clone(), free.len(), None);
        for Offer { effect, shape, sizes } in offers {
            let (first, own) = (kept.len(), next..next + sizes.len());
            next = own.end;
            let shown = sizes.into_iter().zip(own).filter(|(_, number)| silent != Some(effect) && shows(*number));
            let (parameters, shown): (Vec<_>, Vec<_>) = shown.unzip();
            if parameters.is_empty() {
                silent = Some(effect);
                continue;
            }
            kept.extend(shown);
            let nuisance = NUISANCE.contains(&effect.about.name);
            let columns = (first..kept.len()).collect();
            asked.push(Asked { question: Question::Effect(effect, parameters), columns, shape, nuisance });
        }
        let numbers: Vec<Number> = kept.iter().map(|number| numbers[*number]).collect();
        for run in &mut columns {
            *run = kept.iter().map(|number| std::mem::take(&mut run[*number])).collect();
        }
        let width = numbers.len();
        for (all, smooths) in columns.iter_mut().zip(smooth_columns(observed, &fitted.model)) {
            all.extend(smooths);
        }
        for (covariate, motion, first, terms) in smooth::groups() {
            let own = (width + first..width + first + terms).collect();
            let question = Question::Smooth(covariate, motion);
            asked.push(Asked { question, columns: own, shape: None, nuisance: false });
        }
        let chain = fitted.model.chain();
        for (all, run) in columns.iter_mut().zip(&observed.runs) {
            all.push(run.residuals_along(&chain));
        }
        let system = System::new(observed, &fitted.noise, &columns);
        let (errors, smooths) = (Errors::default(), OnceLock::new());
        let mut examination = Examination { fitted, system, asked, free, errors, numbers, columns, smooths };
        examination.clean();
        let which = (0..width).chain([examination.system.residual()]).collect();
        let Examination { fitted, system, columns, .. } = &examination;
        examination.errors = Errors::new(&fitted.observed, system, columns, which);
        Ok(examination)
    }

    /// Estimates the noise anew with what is most evidently missing fitted out, so that it is noise alone.
    fn clean(&mut self) {
        let mut out = self.base(None);
        let mut added = 0;
        while added < CLEANED {
            let projected = Projected::new(&self.system.whole, &out);
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
        out.push(self.system.residual());
        let few = self.some_columns(&out);
        let chain = self.fitted.model.chain();
        self.fitted.noise = Noise::estimate(&self.fitted.observed, &chain, &few, &self.fitted.noise);
        self.system = System::new(&self.fitted.observed, &self.fitted.noise, &self.columns);
    }

    /// Some columns, run by run.
    pub fn some_columns(&self, which: &[usize]) -> Vec<Vec<Column>> {
        self.columns.iter().map(|run| which.iter().map(|column| run[*column].clone()).collect()).collect()
    }

    /// Errors by the columns of the model and a smooth.
    pub fn errors_with(&self, columns: &[usize]) -> Errors {
        let which = self.base(None).iter().chain(columns).copied().chain([self.system.residual()]).collect();
        Errors::new(&self.fitted.observed, &self.system, &self.columns, which)
    }

    /// Columns that are fitted out when a group is asked about: the model's own and those of the reference, its own excepted.
    pub fn base(&self, asked: Option<usize>) -> Vec<usize> {
        let others = self.asked.iter().enumerate().filter(|(i, other)| other.nuisance && Some(*i) != asked);
        let mut base = self.free.clone();
        for column in others.flat_map(|(_, other)| other.columns.iter().copied()) {
            if share_left(&self.system.whole, &base, column) > ABSORBED {
                base.push(column);
            }
        }
        base
    }

    /// The effect that a column belongs to.
    pub fn name(&self, column: usize) -> Option<&'static str> {
        self.number(column).map(|number| number.effect)
    }

    /// What a column is a derivative by; `None` for one of a smooth.
    pub fn number(&self, column: usize) -> Option<Number> {
        self.numbers.get(column).copied()
    }

    /// Errors of runs left out, with the model's own values and the columns `found` fitted to the others.
    pub fn left_out(&self, found: &[usize]) -> Misses {
        self.left_out_with(found, |_| None)
    }

    /// The same with one more group, picked anew from the products of the others.
    pub fn left_out_with(
        &self,
        found: &[usize],
        pick: impl Fn(&DMatrix<f64>) -> Option<Answer> + Send + Sync,
    ) -> Misses {
        self.errors.misses(|run| {
            let products = self.system.without(run);
            let mut columns = [&self.free[..], found].concat();
            columns.extend(pick(&products).map(|answer| answer.columns).unwrap_or_default());
            let values = Projected::fit(&products, &columns);
            (columns, values)
        })
    }

    /// The effect that explains most of some products, of those `wanted`, beside the model.
    pub fn likeliest(&self, products: &DMatrix<f64>, wanted: impl Fn(&Asked) -> bool) -> Option<Answer> {
        let plain = Projected::new(products, &self.base(None));
        let effects = self.asked.iter().enumerate().filter(|(_, a)| a.effect().is_some() && wanted(a));
        let answers = effects.filter_map(|(index, asked)| {
            let own = asked.nuisance.then(|| Projected::new(products, &self.base(Some(index))));
            self.answer(own.as_ref().unwrap_or(&plain), products, index)
        });
        answers.max_by(|a, b| worth(a).total_cmp(&worth(b)))
    }

    /// Ljung & Box's Q of the heading innovations over ten lags, summed over runs, with its degrees of freedom.
    pub fn portmanteau(&self) -> (f64, f64) {
        const LAGS: usize = 10;
        let residual = self.system.residual();
        let runs = self.fitted.observed.runs.iter().zip(&self.columns);
        let (mut q, mut freedom) = (0.0, 0);
        for (run, columns) in runs {
            let white = self.fitted.noise.whiten(run, &[&columns[residual]]);
            let rows: Vec<f64> = white.values.iter().zip(&white.block).skip(6).map(|(value, _)| *value).collect();
            let heading: Vec<f64> = rows.chunks_exact(3).map(|row| row[2]).collect();
            let n = heading.len() as f64;
            let whole: f64 = heading.iter().map(|v| v * v).sum();
            if heading.len() <= 3 * LAGS || white.values.len() != 3 * run.blocks.len() || whole <= 0.0 {
                continue;
            }
            for lag in 1..=LAGS {
                let sum: f64 = heading.iter().zip(&heading[lag..]).map(|(a, b)| a * b).sum();
                q += n * (n + 2.0) * (sum / whole).powi(2) / (n - lag as f64);
            }
            freedom += LAGS;
        }
        (q, freedom as f64)
    }

    /// The answer of every group that `wanted` picks and the data shows, beside a base.
    pub fn answers(&self, projected: &Projected, wanted: impl Fn(&Asked) -> bool) -> Vec<Answer> {
        let asked = self.asked.iter().enumerate().filter(|(_, asked)| wanted(asked));
        asked.filter_map(|(index, _)| self.answer(projected, &self.system.whole, index)).collect()
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
    worth_of(answer.drop, answer.columns.len())
}

/// What a drop by so many numbers is worth.
pub fn worth_of(drop: f64, numbers: usize) -> f64 {
    drop - 3.0 * numbers as f64
}

/// A shape is tried at its usual value and at these multiples of it.
const TRIED: [f64; 4] = [1.0, 0.5, 2.0, 4.0];

/// An effect of the catalogue that a model lacks, with one value of its shape.
struct Offer {
    effect: &'static Entry,
    shape: Option<(&'static Parameter, f64)>,
    sizes: Vec<&'static Parameter>,
}

impl Offer {
    fn numbers(&self) -> impl Iterator<Item = Number> + '_ {
        let shape = self.shape.map(|(parameter, value)| (parameter.name, value));
        self.sizes.iter().map(move |size| Number { effect: self.effect.about.name, parameter: size.name, shape })
    }
}

/// Every effect of the catalogue that the model lacks and that may move some observation, with each value of its shape.
fn offers(model: &Model) -> Vec<Offer> {
    let missing = of_drive(model.robot().drive.kind()).filter(|entry| {
        entry.changes.include(Changes::MEAN) && model.parts().iter().all(|part| part.effect != **entry)
    });
    let mut offers = Vec::new();
    for effect in missing {
        let parameters = effect.about.parameters.iter();
        let (shapes, sizes): (Vec<&Parameter>, Vec<&Parameter>) = parameters.partition(|parameter| is_shape(parameter));
        let tried = if shapes.is_empty() { &TRIED[..1] } else { &TRIED[..] };
        for factor in tried {
            let shape = shapes.first().map(|shape| (*shape, factor * shape.default.resolve(model.robot())));
            offers.push(Offer { effect, shape, sizes: sizes.clone() });
        }
    }
    offers
}
