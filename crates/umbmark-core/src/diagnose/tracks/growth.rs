//! A model grown by an effect that it was missing, fitted without approximation.

use super::examination::Examination;
use super::{DiagnoseError, Estimate, Suspect, estimates};
use crate::effect::Model;
use crate::likelihood::{Fitted, Noise};

/// A shape (a length, a threshold) is fitted where its size stands out by so many standard errors.
const SHOWN: f64 = 8.0;

/// The model of an examination with a suspect more, fitted: its sizes first, then its shapes too where its size stands out.
pub(crate) fn grown(exam: &Examination, suspect: &Suspect) -> Result<Fitted, DiagnoseError> {
    let model = with(exam.fitted.model.clone(), suspect)?;
    let observed = &exam.fitted.observed;
    let shapes = model.shapes();
    let taken = || exam.fitted.taken.clone();
    let sized = Fitted { taken: taken(), ..observed.fit(&model, &Noise::default(), &shapes)? };
    let shaped = observed.free_values(&sized.model).iter().any(|value| shapes.contains(value));
    let stands_out = |e: &Estimate| e.effect == suspect.best && (e.value / e.standard_error).abs() > SHOWN;
    let clear = estimates(&sized).iter().any(stands_out);
    if !(shaped && clear) {
        return Ok(sized);
    }
    let both = Fitted { taken: taken(), ..observed.fit(&sized.model, &sized.noise, &[])? };
    let determined = estimates(&both).iter().all(|e| e.standard_error.is_finite());
    Ok(if determined { both } else { sized })
}

/// The model with a suspect at its one-step size, free.
fn with(mut model: Model, suspect: &Suspect) -> Result<Model, DiagnoseError> {
    model.add(suspect.best)?.free = true;
    for Estimate { effect, parameter, value, .. } in &suspect.estimate {
        let about = &crate::effect::find(effect)?.about;
        let (low, high) = about.parameters.iter().find(|p| p.name == *parameter).map_or((*value, *value), |p| p.bounds);
        model.set(effect, parameter, value.clamp(low, high))?;
    }
    Ok(model)
}
