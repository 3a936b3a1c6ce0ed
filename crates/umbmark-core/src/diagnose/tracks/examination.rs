//! A fitted model on tracks, with the columns of everything that it may be missing.

use super::finding::{Answer, Finding, worth};
use super::responses::{self, Asked, Question, Responses};
use crate::effect::{Changes, Entry, Law, ModelError, Number};
use crate::evidence::ends::names;
use crate::evidence::tracks::{Errors, Misses, Projected, System};
use crate::geometry::Pose2;
use crate::likelihood::{ABSORBED, Column, Fitted, Noise, share_left, solver};
use crate::parameter::Parameter;
use nalgebra::{DMatrix, DVector};
use std::sync::{Arc, OnceLock};

/// At its usual size, a candidate must move the observations by this many standard deviations to be tested.
const VISIBLE: f64 = 0.3;
/// Maximum number of groups that are projected out to estimate the noise, and the decrease per column that each must bring.
const CLEANED: usize = 6;
const WORTH_CLEANING: f64 = 15.0;

/// A fitted model on tracks, its residuals, and the columns of all that may be missing.
#[derive(Clone, Debug)]
pub struct Examination {
    /// The model.
    pub fitted: Fitted,
    /// Products of all columns.
    pub system: System,
    /// All that is tested.
    pub asked: Vec<Asked>,
    /// Columns of the model's free values.
    pub free: Vec<usize>,
    /// Errors in metres and radians, by the columns of the model and of the catalogue's effects.
    pub errors: Errors,
    /// The numbers by which the columns of the model and of the catalogue's effects are derivatives.
    numbers: Vec<Number>,
    columns: Vec<Vec<Column>>,
    /// The true poses along which the tested columns were computed, run by run.
    pub along: Vec<Arc<[Pose2]>>,
    /// Findings about the smooths, once these have been tested.
    pub smooths: OnceLock<Vec<Finding>>,
}

impl Examination {
    /// Prepares the test of every effect of the catalogue that a fitted model lacks, and of every smooth.
    pub fn new(fitted: Fitted) -> Result<Examination, ModelError> {
        let responses = Responses::new(&fitted)?;
        Ok(Examination::by(fitted, responses))
    }

    /// The same for a model that has grown from this one's.
    pub fn of_grown(&self, fitted: Fitted) -> Result<Examination, ModelError> {
        // A delay shifts the moments of all starts and stops, so the responses change much from pose to pose.
        let known = |effect: &Law| self.fitted.model.parts().iter().any(|part| part.effect == *effect);
        let mut effects = fitted.model.parts().iter().map(|part| &part.effect);
        let sees_alike =
            effects.all(|effect| known(effect) || !effect.changes().include(Changes::SEEN.and(Changes::MOMENT)));
        let hold = sees_alike && responses::hold(&self.along, &fitted.observed);
        let responses = if hold { self.lacked_by(&fitted)? } else { Responses::new(&fitted)? };
        Ok(Examination::by(fitted, responses))
    }

    /// The tested effects that a grown model still lacks.
    fn lacked_by(&self, fitted: &Fitted) -> Result<Responses, ModelError> {
        let model = &fitted.model;
        let known = |effect: &Entry| model.parts().iter().any(|part| part.effect == *effect);
        let (mut asked, mut kept) = (Vec::new(), Vec::new());
        for group in self.asked.iter().filter(|group| !group.effect().is_some_and(known)) {
            let first = kept.len();
            kept.extend(&group.columns);
            asked.push(Asked { columns: (first..kept.len()).collect(), ..group.clone() });
        }
        let numbers: Vec<Number> = kept.iter().filter_map(|column| self.number(*column)).collect();
        let mut columns = self.some_columns(&kept);
        let moved = asked.iter().filter(|group| group.effect().is_some_and(|effect| effect.rests_on_others));
        let moved: Vec<usize> = moved.flat_map(|group| group.columns.iter().copied()).collect();
        let of_moved: Vec<Number> = moved.iter().map(|column| numbers[*column]).collect();
        for (run, anew) in columns.iter_mut().zip(fitted.observed.columns_of(model, &of_moved)?) {
            moved.iter().zip(anew).for_each(|(column, anew)| run[*column] = anew);
        }
        Ok(Responses { asked, numbers, columns, along: self.along.clone() })
    }

    fn by(fitted: Fitted, responses: Responses) -> Examination {
        let names = names(&fitted.model);
        let own = fitted.free.iter().map(|value| names[*value]);
        let own = own.map(|(effect, parameter)| Number::of(effect, parameter));
        let free: Vec<usize> = (0..fitted.free.len()).collect();
        let Responses { mut asked, numbers, columns, along } = responses;
        for column in asked.iter_mut().flat_map(|group| &mut group.columns) {
            *column += free.len();
        }
        let numbers: Vec<Number> = own.chain(numbers).collect();
        let chain = fitted.model.chain();
        let slopes = fitted.columns();
        let runs = fitted.observed.runs.iter().zip(slopes.iter()).zip(columns);
        let columns: Vec<Vec<Column>> =
            runs.map(|((run, own), columns)| [own, &columns[..], &[run.residuals_along(&chain)]].concat()).collect();
        let system = System::new(&fitted.observed, &fitted.noise, &columns);
        let (errors, smooths) = (Errors::default(), OnceLock::new());
        let which = (0..numbers.len()).chain([system.residual()]).collect();
        let mut examination = Examination { fitted, system, asked, free, errors, numbers, columns, along, smooths };
        examination.clean();
        let Examination { fitted, system, columns, .. } = &examination;
        examination.errors = Errors::new(&fitted.observed, system, columns, which);
        examination
    }

    /// Estimates the noise again with the most significant missing effects projected out, so that they do not inflate it.
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
        // Never two systems at once: they are most of what is kept.
        self.system.units = Vec::new();
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

    /// Columns that are projected out when a group is tested: those of the model and of the reference, except the group's.
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

    /// The effects that are tested, each by the first of its shapes, which is the usual one: place among all that is tested, effect, and the
    /// parameters of its columns.
    pub fn representatives(&self) -> impl Iterator<Item = (usize, &'static Entry, &[&'static Parameter])> {
        self.asked.iter().enumerate().filter_map(|(index, asked)| match &asked.question {
            Question::Effect(effect, _) if index > 0 && self.asked[index - 1].effect() == Some(*effect) => None,
            Question::Effect(effect, parameters) => Some((index, *effect, &parameters[..])),
            Question::Smooth(..) => None,
        })
    }

    /// The largest factor by which fitting a group's columns too widens a standard error of the first effects.
    pub fn widening(&self, columns: &[usize]) -> f64 {
        let first = self.fitted.model.robot().drive.first_effects();
        let is_first = |column: &usize| self.name(*column).is_some_and(|name| first.contains(&name));
        let base = self.base(None);
        let rest: Vec<usize> = base.iter().copied().filter(|column| !columns.contains(column)).collect();
        let all = [&rest[..], columns].concat();
        let error = |base: &[usize], column: usize| {
            let own = base.iter().position(|other| *other == column)?;
            let unit = DMatrix::from_fn(base.len(), 1, |i, _| f64::from(i == own));
            Some(solver(&self.system.whole, base)?.solve(&unit)[(own, 0)].sqrt())
        };
        let wider = |column: usize| Some(error(&all, column).unwrap_or(f64::INFINITY) / error(&rest, column)?);
        rest.iter().copied().filter(is_first).filter_map(wider).fold(1.0, f64::max)
    }

    /// The columns of an effect of the model that were fitted.
    pub fn columns_of(&self, effect: &str) -> Vec<usize> {
        self.free.iter().copied().filter(|column| self.name(*column) == Some(effect)).collect()
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

    /// The same with one more group, chosen again from the products of the other runs.
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

    /// Errors of held-out runs without some of the model's own columns, which are set to zero effect, and with the columns `beside` fitted
    /// to the other runs.
    pub fn left_out_without(&self, own: &[usize], beside: &[usize]) -> Misses {
        let nothing: Vec<f64> = own.iter().map(|column| self.departure(*column)).collect();
        self.errors.misses(|run| {
            let mut products = self.system.without(run);
            let residual = products.ncols() - 1;
            // The other columns take over what the effect explains.
            for (column, value) in own.iter().zip(&nothing) {
                let added = products.column(*column) * *value;
                products.set_column(residual, &(products.column(residual) + added));
            }
            let values = Projected::fit(&products, beside);
            let values = values.iter().copied().chain(nothing.iter().map(|value| -value));
            ([beside, own].concat(), DVector::from_iterator(beside.len() + own.len(), values))
        })
    }

    /// Distance of one of the model's free values from the value without effect.
    pub fn departure(&self, column: usize) -> f64 {
        self.fitted.departure(column)
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

    /// The answer of every group that `wanted` selects and the data determines, with a base projected out.
    pub fn answers(&self, projected: &Projected, wanted: impl Fn(&Asked) -> bool) -> Vec<Answer> {
        let asked = self.asked.iter().enumerate().filter(|(_, asked)| wanted(asked));
        asked.filter_map(|(index, _)| self.answer(projected, &self.system.whole, index)).collect()
    }

    /// The answer of one group, if the data determines it and a robot can have it.
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
        if !self.is_credible(asked, &columns, &step) {
            return None;
        }
        Some(Answer { asked: index, columns, drop, step, covariance })
    }

    /// Whether a robot can have an effect with these steps of its columns.
    fn is_credible(&self, asked: &Asked, columns: &[usize], step: &DVector<f64>) -> bool {
        let Some(entry) = asked.effect() else { return true };
        let robot = self.fitted.model.robot();
        let stepped = |parameter: &Parameter| {
            let is_own = |column: &usize| self.number(*column).is_some_and(|own| own.parameter == parameter.name);
            columns.iter().position(is_own).map_or(0.0, |place| step[place])
        };
        let value = |parameter: &Parameter| {
            let tried = asked.shapes.iter().find(|(shape, _)| shape.name == parameter.name);
            tried.map_or_else(|| parameter.default.resolve(robot) + stepped(parameter), |(_, value)| *value)
        };
        (entry.is_credible)(&entry.about.parameters.iter().map(value).collect::<Vec<_>>())
    }
}
