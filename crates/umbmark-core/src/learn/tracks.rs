//! Learning from tracks: the same story, told from products of columns instead of one fit for each fold.

use super::{Error, Learnt, MOST, Step};
use crate::diagnose::tracks::{self, Examination, LEAST_GAIN, Misses, Missing, missing};
use crate::diagnose::{DiagnoseError, Estimate, Options, Suspect, Verdict};
use crate::effect::Model;
use crate::likelihood::{Fitted, Noise, Observed};

/// A shape (a length, a threshold) is fitted where its size stands out by so many standard errors.
const SHOWN: f64 = 8.0;

/// Learns which effects the robot of some tracks has.
pub(super) fn learn(observed: &Observed, options: &Options) -> Result<Learnt, DiagnoseError> {
    let mut model = Model::new(&observed.robot);
    let mut steps = vec![step(&plainly(observed, &model)?, None)];
    let first = observed.robot.drive.kind().first_effects();
    for effect in first {
        model.add(effect)?.free = true;
        let exam = plainly(observed, &model)?;
        model = exam.fitted.model.clone();
        steps.push(step(&exam, Some((effect, vec![effect], None))));
    }
    let mut fitted = tracks::fit(observed, &model)?;
    loop {
        let exam = Examination::new(fitted)?;
        let found = missing(&exam, options, 1);
        let next = found.effects.first().filter(|_| steps.len() < MOST + first.len());
        let Some((finding, suspect)) = next else { return finish(exam, found, steps, options) };
        let grown = exam.fitted.model.clone();
        fitted = refit(&exam, with(grown, suspect)?, suspect.best)?;
        let after = Examination::bare(fitted.clone());
        let told = (suspect.best, suspect.class.clone(), Some(finding.p_adjusted()));
        steps.push(step(&after, Some(told)));
    }
}

/// The story's end: the diagnosis of the model that was learnt.
fn finish(exam: Examination, found: Missing, steps: Vec<Step>, options: &Options) -> Result<Learnt, DiagnoseError> {
    let diagnosis = tracks::conclude(exam, found, options);
    let mut remarks = diagnosis.remarks.clone();
    if let Some(suspect) = diagnosis.ranking.first().filter(|s| s.p_adjusted <= options.size) {
        remarks.push(format!(
            "{} is significant (p = {:.1e}) but was not added: runs that are left out are predicted better by less than {:.0} %.",
            suspect.class.join(" or "),
            suspect.p_adjusted,
            100.0 * LEAST_GAIN
        ));
    }
    let verdict = if diagnosis.verdict == Verdict::MissingEffect { Verdict::SeveralMissing } else { diagnosis.verdict };
    Ok(Learnt { steps, verdict, model: diagnosis.model.clone(), remarks, diagnosis })
}

/// A model fitted under noise of the usual size: enough for its errors.
fn plainly(observed: &Observed, model: &Model) -> Result<Examination, DiagnoseError> {
    let mut fitted = observed.unfitted(model, &Noise::default());
    // The second time the noise grows along the poses of the first.
    fitted.refit()?;
    fitted.refit()?;
    Ok(Examination::bare(fitted))
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

/// Fits a model grown by `effect`: its sizes first, then its shapes too where the size of that effect stands out.
fn refit(exam: &Examination, model: Model, effect: &str) -> Result<Fitted, DiagnoseError> {
    let observed = &exam.fitted.observed;
    let shapes = model.shapes();
    let sized = observed.fit(&model, &Noise::default(), &shapes)?;
    let shaped = observed.free_values(&sized.model).iter().any(|value| shapes.contains(value));
    let stands_out = |e: &Estimate| e.effect == effect && (e.value / e.standard_error).abs() > SHOWN;
    let clear = tracks::estimates(&sized).iter().any(stands_out);
    if !(shaped && clear) {
        return Ok(sized);
    }
    let both = observed.fit(&sized.model, &sized.noise, &[])?;
    let determined = tracks::estimates(&both).iter().all(|e| e.standard_error.is_finite());
    Ok(if determined { both } else { sized })
}

fn step(exam: &Examination, added: Option<(&'static str, Vec<&'static str>, Option<f64>)>) -> Step {
    let (inside, held_out) = exam.best_errors();
    let (aicc, bic, weighted) = exam.criteria();
    let error = |misses: Misses| Error { position: misses.position, heading: misses.heading, weighted };
    let (added, class, p_adjusted) = added.map_or((None, Vec::new(), None), |(name, class, p)| (Some(name), class, p));
    Step { added, class, p_adjusted, error: error(inside), held_out: error(held_out), aicc: Some(aicc), bic: Some(bic) }
}
