//! A model extended by a missing effect and fitted without linear approximation.

use super::examination::Examination;
use crate::diagnose::suspect::Suspect;
use crate::effect::{Law, Model, Part, parameter_of};
use crate::evidence::tracks::{Alone, estimates, whole};
use crate::evidence::{Estimate, FitError};
use crate::likelihood::{Fitted, Noise};
use crate::parameter::Role;
use std::sync::Arc;

/// A shape (a length, a threshold) is fitted if its size is this many standard errors from zero.
const SHOWN: f64 = 8.0;
/// Shapes keep their values unless the size is still this many standard errors from zero with them, or AICc falls by this.
const SURE: f64 = 4.0;
const LIKELIER: f64 = 10.0;

/// The model of an examination with one more suspect, fitted: first its sizes, then also its shapes if its size is significant.
pub(crate) fn grown(exam: &Examination, suspect: &Suspect) -> Result<Fitted, FitError> {
    Ok(whole(fitted(exam, &with(exam.fitted.model.clone(), suspect)?, suspect.best)?))
}

/// The model of an examination with one more law outside the catalogue, fitted in the same way, and the name of the law there.
pub(crate) fn grown_by_law(exam: &Examination, law: &Model) -> Result<(Fitted, &'static str), FitError> {
    let mut model = exam.fitted.model.clone();
    let mut name = "";
    for part in law.parts() {
        let Law::Formula(formula) = &part.effect else { continue };
        let taken = |name: &str| model.parts().iter().any(|other| other.effect.name() == name);
        let numbered = |number: usize| {
            if number == 1 { formula.name().to_owned() } else { format!("{}_{number}", formula.name()) }
        };
        let own = (1..).map(numbered).find(|name| !taken(name)).unwrap_or_default();
        let formula = formula.named(&own);
        name = formula.name();
        model.adopt(&Part { effect: Law::Formula(Arc::new(formula)), ..part.clone() });
    }
    Ok((fitted(exam, &model, name)?, name))
}

/// Whether a size of an effect is more than so many standard errors from zero.
pub(super) fn stands_out(fitted: &Fitted, effect: &str, errors: f64) -> bool {
    estimates(fitted).iter().any(|e| e.effect == effect && departs(&fitted.model, e) > errors)
}

/// A model with one more effect, fitted: first its sizes, then also its shapes if its size is significant.
fn fitted(exam: &Examination, model: &Model, effect: &str) -> Result<Fitted, FitError> {
    let observed = &exam.fitted.observed;
    let shapes = model.shapes();
    let taken = || exam.fitted.taken.clone();
    let sized = Fitted { taken: taken(), ..observed.fit(model, &Noise::default(), &shapes)? };
    let shaped = observed.free_values(&sized.model).iter().any(|value| shapes.contains(value));
    if !(shaped && stands_out(&sized, effect, SHOWN)) {
        return Ok(sized);
    }
    let both = Fitted { taken: taken(), ..observed.fit(&sized.model, &sized.noise, &[])? };
    let determined = estimates(&both).iter().all(|e| e.standard_error.is_finite());
    let allowed = observed.tracks().all(|track| track.check(&both.model).is_ok());
    // If a shape can compensate a size (the distance of a bump from the path, say), neither is determined, and fitting the shape does not
    // raise the likelihood.
    let aicc = |fitted: &Fitted| Alone::new(fitted.clone()).criteria().0;
    let sure = stands_out(&both, effect, SURE) || aicc(&both) < aicc(&sized) - LIKELIER;
    Ok(if determined && allowed && sure && keeps_signs(model, &both.model, effect) { both } else { sized })
}

/// Distance of a size from zero effect, in standard errors; 0 for a length, time or threshold.
fn departs(model: &Model, e: &Estimate) -> f64 {
    let nothing = model.place_of(e.effect, e.parameter).and_then(|place| model.nothing(place));
    nothing.map_or(0.0, |nothing| ((e.value - nothing) / e.standard_error).abs())
}

/// Whether the lengths, times and thresholds of an effect kept the signs of their start values: a decay must not become a growth.
fn keeps_signs(begun: &Model, fitted: &Model, effect: &str) -> bool {
    let part = begun.parts().iter().find(|part| part.effect.name() == effect);
    let parameters = part.into_iter().flat_map(|part| part.effect.parameters());
    parameters.filter(|parameter| parameter.role == Role::Shape).all(|shape| {
        let values = begun.get(effect, shape.name).zip(fitted.get(effect, shape.name));
        values.is_none_or(|(then, now)| then * now >= 0.0)
    })
}

/// The model with a suspect at its one-step size, free.
fn with(mut model: Model, suspect: &Suspect) -> Result<Model, FitError> {
    model.add(suspect.best)?.free = true;
    for Estimate { effect, parameter, value, .. } in &suspect.estimate {
        let (low, high) = parameter_of(effect, parameter).map_or((*value, *value), |own| own.bounds);
        model.set(effect, parameter, value.clamp(low, high))?;
    }
    Ok(model)
}
