//! Learning from tracks: the same story, told from products of columns instead of one fit for each fold.

use super::{Error, Learnt, MOST, Step};
use crate::diagnose::tracks::{self, Alone, LEAST_GAIN, Misses, Search};
use crate::diagnose::{DiagnoseError, Diagnosis, Options, Verdict};
use crate::effect::Model;
use crate::likelihood::{Fitted, Noise, Observed};
use crate::watch::Watch;

/// Learns which effects the robot of some tracks has, beside those of a `start`.
pub(super) fn learn(
    observed: &Observed,
    start: &Model,
    options: &Options,
    watch: &Watch,
) -> Result<Learnt, DiagnoseError> {
    let mut model = Model::new(&observed.robot);
    let mut steps = vec![step(plainly(observed, &model)?, None)];
    let first = observed.robot.drive.first_effects();
    let mut add = |model: &mut Model, effect: &'static str, fitted: Fitted| {
        *model = fitted.model.clone();
        steps.push(step(fitted, Some((effect, vec![effect], None))));
    };
    for effect in first {
        model.add(effect)?.free = true;
        let fitted = plainly(observed, &model)?;
        add(&mut model, effect, fitted);
    }
    for part in start.parts().iter().filter(|part| !first.contains(&part.effect.name())) {
        model.adopt(part);
        let fitted = tracks::fit(observed, &model)?;
        add(&mut model, part.effect.name(), fitted);
    }
    let search = tracks::search(tracks::fit(observed, &model)?, options, MOST, watch)?;
    let partial = watch.is_stopped() && search.left.effect.is_some();
    for (exam, (finding, suspect)) in search.exams[1..].iter().zip(&search.added) {
        let told = (suspect.best, suspect.class.clone(), Some(finding.p_adjusted()));
        steps.push(step(exam.fitted.clone(), Some(told)));
    }
    Ok(Learnt { partial, ..finish(search, steps, options)? })
}

/// The story's end: the diagnosis of the model that was learnt.
fn finish(mut search: Search, steps: Vec<Step>, options: &Options) -> Result<Learnt, DiagnoseError> {
    let told = search.left.smooth.as_ref().and_then(|f| tracks::dependence(search.last(), f, &search.left.asked));
    let more = search.left.effect.is_some();
    let verdict = match (&search.left.smooth, more) {
        _ if tracks::verdict(&search) == Verdict::NotEnoughData => Verdict::NotEnoughData,
        (Some(_), _) => Verdict::UnlistedEffect,
        (None, true) => Verdict::SeveralMissing,
        (None, false) => Verdict::Explained,
    };
    let (mut experiments, mut hints) = (Vec::new(), Vec::new());
    for (exam, (finding, suspect)) in search.exams.iter().zip(&search.added) {
        let (told, hint) = tracks::next_experiments(exam, finding, suspect)?;
        experiments.extend(told);
        hints.extend(hint);
    }
    let Some(last) = search.exams.pop() else { return Err(DiagnoseError::NotConverged { how: "has no model" }) };
    let diagnosis = tracks::conclude(last, told, options)?;
    hints.extend(tracks::uncertified(&search.left.asked, options));
    let mut remarks = [diagnosis.remarks.clone(), hints].concat();
    let ranking = search.left.asked;
    if let Some(suspect) = ranking.first().filter(|s| s.p_adjusted <= options.size) {
        remarks.push(format!(
            "{} is significant (p = {:.1e}) but was not added: runs that are left out are predicted better by less than {:.0} %.",
            suspect.class.join(" or "),
            suspect.p_adjusted,
            100.0 * LEAST_GAIN
        ));
    }
    experiments.extend(diagnosis.next_experiments);
    let diagnosis = Diagnosis { verdict, ranking, next_experiments: experiments, ..diagnosis };
    Ok(Learnt { steps, verdict, model: diagnosis.model.clone(), remarks, diagnosis, partial: false })
}

/// A model fitted under noise of the usual size: enough for its errors.
fn plainly(observed: &Observed, model: &Model) -> Result<Fitted, DiagnoseError> {
    let mut fitted = observed.unfitted(model, &Noise::default());
    // The second time the noise grows along the poses of the first.
    fitted.refit()?;
    fitted.refit()?;
    Ok(fitted)
}

fn step(fitted: Fitted, added: Option<(&'static str, Vec<&'static str>, Option<f64>)>) -> Step {
    let alone = Alone::new(fitted);
    let (inside, held_out) = alone.misses();
    let (aicc, bic, weighted) = alone.criteria();
    let error = |misses: Misses| Error { position: misses.position, heading: misses.heading, weighted };
    let (added, class, p_adjusted) = added.map_or((None, Vec::new(), None), |(name, class, p)| (Some(name), class, p));
    Step { added, class, p_adjusted, error: error(inside), held_out: error(held_out), aicc: Some(aicc), bic: Some(bic) }
}
