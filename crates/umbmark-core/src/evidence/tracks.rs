//! Whole tracks as evidence: fits, and how well they predict runs that were left out.

mod alone;
mod errors;
mod no_surer;
mod packed;
mod possible;
mod silent;
mod system;
mod whole;

use super::{Estimate, Evidence, Fit, FitError, Level, correlations, robot_of};
use crate::dataset::Dataset;
use crate::drive::Robot;
use crate::effect::{Model, ModelError};
use crate::likelihood::{Fitted, Knowledge, KnownNumber, Noise, Observed};
use crate::setup::{Fault, Setup};
use std::sync::Arc;

pub(crate) use alone::{Alone, trusted};
pub(crate) use errors::{Errors, LEAST_GAIN, Misses};
pub(crate) use no_surer::no_surer;
pub(crate) use packed::Packed;
pub(crate) use possible::{fit_possible, is_possible};
pub(crate) use silent::{last_part, silent, without, without_silent_taken};
pub(crate) use system::{Projected, System, Unit};
pub(crate) use whole::whole;

/// The tracks of a dataset.
pub(crate) fn of(data: &Dataset) -> Result<Observed, FitError> {
    Ok(Observed::new(data, robot_of(data)?)?)
}

impl Evidence for Observed {
    fn level(&self) -> Level {
        Level::Tracks
    }

    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn setup(&self) -> &Arc<Setup> {
        &self.setup
    }

    fn faults(&self) -> Vec<Fault> {
        self.setup.faults.clone()
    }

    fn check(&self, model: &Model) -> Result<(), ModelError> {
        self.tracks().try_for_each(|track| track.check(model))
    }

    fn know(&mut self, knowledge: Knowledge) {
        self.knowledge = Arc::new(knowledge);
    }

    fn fit(&self, model: &Model) -> Result<Fit, FitError> {
        let (alone, held) = fit_within(self, model)?;
        let mut fit = told(alone)?;
        // A bound fixes a number in this fit only: numbers with bounds are free ones.
        for KnownNumber { effect, parameter, .. } in self.knowledge.numbers() {
            fit.model.release(effect, parameter);
        }
        // What these runs do not show keeps its values.
        for part in model.parts() {
            if fit.model.parts().iter().all(|own| own.effect.name() != part.effect.name()) {
                fit.model.adopt(part);
            }
        }
        let place = |number: &KnownNumber| fit.model.place_of(&number.effect, &number.parameter);
        fit.held = held.iter().filter_map(place).collect();
        Ok(fit)
    }
}

/// Fits the free parameters of a model as they are reported; those of first effects that the motion denies are not fitted.
pub(crate) fn fit_alone(observed: &Observed, model: &Model) -> Result<Alone, FitError> {
    let (fitted, _) = without_silent_taken(whole(fit_possible(observed, model)?))?;
    Ok(trusted(fitted)?)
}

/// The same with the values that end at a bound kept there: the noise is that beside these, and nothing stands for them.
/// Which these are is told too.
fn fit_within(observed: &Observed, model: &Model) -> Result<(Alone, Vec<KnownNumber>), FitError> {
    let (mut kept, mut all) = (model.clone(), Vec::new());
    loop {
        let alone = fit_alone(observed, &kept)?;
        let fitted = alone.fitted();
        let held = fitted.observed.knowledge.numbers().iter().filter(|number| {
            fitted.model.place_of(&number.effect, &number.parameter).is_some_and(|place| fitted.held.contains(&place))
        });
        let held: Vec<KnownNumber> = held.cloned().collect();
        if held.is_empty() {
            return Ok((alone, all));
        }
        for KnownNumber { effect, parameter, .. } in &held {
            if let Some(bound) = fitted.model.get(effect, parameter) {
                kept.set(effect, parameter, bound)?;
            }
            kept.fix(effect, parameter)?;
        }
        all.extend(held);
    }
}

/// A fit as it is reported.
pub(crate) fn told(alone: Alone) -> Result<Fit, FitError> {
    let leaves = alone.leaves();
    let fitted = no_surer(alone.into_fitted())?;
    let (estimates, correlations) = (estimates(&fitted), correlations(fitted.covariance.as_ref()));
    let Fitted { model, noise, outliers, usual_noise, taken, observed, ended, .. } = fitted;
    let (noise, setup, knowledge) = (Some(noise), observed.setup, observed.knowledge);
    let (held, without_priors) = (Vec::new(), Vec::new());
    Ok(Fit {
        model,
        estimates,
        correlations,
        noise,
        outliers,
        usual_noise,
        setup,
        taken,
        ended,
        leaves,
        knowledge,
        held,
        without_priors,
    })
}

/// Fits the free parameters of a model to the innovations, starting with what the motion says of the reference.
pub(crate) fn fit(observed: &Observed, model: &Model) -> Result<Fitted, FitError> {
    observed.check_columns()?;
    observed.check(model)?;
    let (model, taken) = observed.begin(model)?;
    let fitted = Fitted { taken, ..observed.fit(&model, &Noise::default(), &[])? };
    // An effect whose size started at 0 did not depend on its shape; now it does. That of the catalogue keeps its usual value where the runs
    // do not tell it.
    let has_shapes = model.has_formulas() || !model.shapes().is_empty();
    if !has_shapes || observed.free_values(&fitted.model).len() <= fitted.free.len() {
        return Ok(fitted);
    }
    let shaped = observed.fit(&fitted.model, &fitted.noise, &[])?;
    let is_told = estimates(&shaped).iter().all(|own| own.standard_error.is_finite());
    let is_allowed = || observed.tracks().all(|track| track.check(&shaped.model).is_ok());
    let is_kept = model.has_formulas() || (is_told && is_allowed());
    Ok(if is_kept { Fitted { taken: fitted.taken, ..shaped } } else { fitted })
}

/// The fitted parameters with their standard errors.
pub(crate) fn estimates(fitted: &Fitted) -> Vec<Estimate> {
    let model = &fitted.model;
    let names = model
        .parts()
        .iter()
        .flat_map(|part| part.effect.parameters().iter().map(|parameter| (part.effect.name(), parameter.name)));
    let (names, values): (Vec<_>, Vec<f64>) = (names.collect(), model.values().collect());
    let freedom = degrees_of_freedom(fitted);
    let of = |(k, index): (usize, &usize)| Estimate {
        effect: names[*index].0,
        parameter: names[*index].1,
        value: values[*index],
        standard_error: fitted.covariance.as_ref().map_or(f64::NAN, |c| c[(k, k)].max(0.0).sqrt()),
        degrees_of_freedom: freedom,
    };
    fitted.free.iter().enumerate().map(of).collect()
}

/// ν of Student's t for intervals: the parts of the data that can be left out in turn, less one. Along a run, the noise of poses is known by
/// the few turns and ways on which it grows. Each step of a reference that tells motion only begins anew, so there its noise is known by all
/// of them: their number less that of the fitted values.
fn degrees_of_freedom(fitted: &Fitted) -> f64 {
    let observed = &fitted.observed;
    let folds = system::folds_of(observed).max(2) - 1;
    if !observed.runs.iter().all(|run| run.relative) {
        return folds as f64;
    }
    let steps: usize = observed.runs.iter().map(|run| (0..run.blocks.len()).filter(|k| run.has_step(*k)).count()).sum();
    let values = fitted.free.len() + fitted.reference.first().map_or(0, Vec::len);
    steps.saturating_sub(values).max(folds) as f64
}
