//! Learning from tracks: the same story, computed from products of columns instead of one fit per fold.

use super::misfits::{elsewhere, misfits};
use super::story::{Crossed, Error, Learnt, MOST_EFFECTS, Step};
use crate::compare::tracks::{against_as_written, fixed, mounted};
use crate::diagnose::tracks::{self, Added, Conclusion, Found, Search, Wanted};
use crate::diagnose::{Diagnosis, Options, Reason, Verdict};
use crate::effect::{Model, Part, find, parameter_of};
use crate::evidence::tracks::{Alone, LEAST_GAIN, Misses, estimates, fit, fit_alone, is_possible, no_surer, told};
use crate::evidence::{Estimate, Evidence, Fit, FitError};
use crate::likelihood::{Fitted, Noise, Observed, USUAL_NOISE, stands_for_the_reference};
use crate::watch::{Reached, Watch};

/// The runs do not determine a first effect if its standard error exceeds this multiple of its usual size ...
const OPEN: f64 = 10.0;
/// ... and its value is less than this many standard errors from zero effect.
const SURE: f64 = 4.0;

/// Learns which effects the robot of some tracks has, beside those of a `start`.
pub(super) fn learn(observed: &Observed, start: &Model, options: &Options, watch: &Watch) -> Result<Learnt, FitError> {
    if !observed.is_sound() && observed.runs.is_empty() {
        return Ok(Learnt::of_faults(observed, Vec::new()));
    }
    let mut model = Model::new(&observed.robot);
    let mut steps = vec![step(plainly(observed, &model)?, None)];
    Step::reach(&steps, watch);
    if !observed.is_sound() {
        return Ok(Learnt::of_faults(observed, steps));
    }
    let mut add = |model: &mut Model, effect: &'static str, p: Option<f64>, fitted: Fitted| {
        *model = fitted.model.clone();
        steps.push(step(fitted, Some((effect, vec![effect], p))));
        Step::reach(&steps, watch);
    };
    // What the given model fixes of the reference holds, whatever the motion says.
    let fixed = |part: &&Part| !part.free && stands_for_the_reference(part.effect.name());
    for part in start.parts().iter().filter(fixed) {
        model.adopt(part);
        let fitted = plainly(observed, &model)?;
        add(&mut model, part.effect.name(), None, fitted);
    }
    // The values of the reference from the motion come first: without them, physical effects cannot be separated from the reference.
    let (begun, taken) = observed.begin(&model)?;
    for own in &taken {
        let part = begun.parts().iter().find(|part| part.effect.name() == own.effect);
        part.into_iter().for_each(|part| model.adopt(part));
        let fitted = plainly(observed, &model)?;
        add(&mut model, own.effect, Some(own.p), fitted);
    }
    // Each row, and the fit of all of them, starts again from what the motion says: a ratio alone absorbs the effect of the next one, and
    // a delay that was fitted beside a wrong ratio can be one step of the reference off, where the likelihood has another maximum.
    let first = shown(observed, &begun)?;
    let mut fresh = begun;
    for effect in &first {
        fresh.add(effect)?.free = true;
        let fitted = plainly(observed, &observed.begin(&fresh)?.0)?;
        add(&mut model, effect, None, fitted);
    }
    let known =
        |part: &Part| first.contains(&part.effect.name()) || taken.iter().any(|own| own.effect == part.effect.name());
    let given: Vec<&Part> = start.parts().iter().filter(|part| !known(part) && !fixed(part)).collect();
    let own: Vec<&str> = given.iter().filter(|part| part.free).map(|part| part.effect.name()).collect();
    for part in given {
        model.adopt(part);
        let fitted = fit(observed, &model)?;
        add(&mut model, part.effect.name(), None, fitted);
    }
    if !taken.is_empty() {
        let values = std::mem::replace(&mut model, observed.begin(&fresh)?.0);
        let is_new = |part: &&Part| fresh.parts().iter().all(|own| own.effect.name() != part.effect.name());
        values.parts().iter().filter(is_new).for_each(|part| model.adopt(part));
    }
    let fitted = Fitted { taken, ..fit(observed, &model)? };
    let not_shown = observed.robot.drive.first_effects().into_iter().filter(|effect| !first.contains(effect));
    // The search tells the model that it begins with anew, as it is written.
    let begun = steps.last().map(|step| (steps.len() - 1, step.added, step.p_adjusted));
    let after_these = |step: &Reached| {
        let (before, added, p_adjusted) = begun.unwrap_or_default();
        let own = if step.after == 0 { Reached { added, p_adjusted, ..*step } } else { *step };
        watch.reach(|| Reached { after: before + step.after, ..own });
    };
    let watched = Watch { reached: Some(&after_these), ..Watch::new(watch.stop, watch.progress) };
    let listened = if watch.reached.is_some() { &watched } else { watch };
    let search = tracks::search(fitted, options, (MOST_EFFECTS, Wanted::All), not_shown.collect(), listened)?;
    let of_reference = |step: &&mut Step| {
        step.added.is_some_and(|effect| search.exams[0].fitted.taken.iter().any(|own| own.effect == effect))
    };
    for step in steps.iter_mut().filter(of_reference) {
        step.class = step.added.map_or(Vec::new(), |effect| tracks::class_of_own(&search.exams[0], effect));
    }
    let mut remarks = Vec::new();
    for index in 1..steps.len() {
        let before = steps[index - 1].held_out;
        let step = &mut steps[index];
        let Some(effect) = step.added.filter(|effect| own.contains(effect)) else { continue };
        step.class = tracks::class_of_own(&search.exams[0], effect);
        step.p_adjusted = tracks::p_of_own(&search.exams[0], effect, options);
        remarks.extend(uncertified(effect, step, &before, options));
    }
    let partial = search.stopped;
    // The fit of the beginning is reported unchanged if nothing was added.
    if let Some(own) = steps.last_mut() {
        let Step { added, class, p_adjusted, law, .. } = own.clone();
        *own = Step { added, class, p_adjusted, law, ..step_of(&search.written[0], None) };
    }
    steps.retain(|step| step.added.is_none_or(|effect| search.keeps(effect)));
    for (Added { suspect, by }, written) in search.story()? {
        let told = (suspect.best, suspect.class.clone(), Some(suspect.p_adjusted));
        let law = match by {
            Found::Listed(_) => None,
            Found::Unlisted(repeated) => Some(repeated.clone()),
        };
        steps.push(Step { law, ..step_of(&written, Some(told)) });
    }
    remarks.extend(own.iter().filter(|effect| search.is_needless(effect)).map(|effect| {
        format!("{effect} of the given model is not needed: the interval of each of its sizes holds zero.")
    }));
    if options.law > 1 && search.has_law() && !search.laws().any(|number| number == options.law) {
        remarks.push(format!(
            "Law {} of the table was not added: the fit does not confirm it. Another law was taken.",
            options.law
        ));
    }
    let learnt = finish(search, steps, options)?;
    Ok(Learnt { partial, remarks: [remarks, learnt.remarks.clone()].concat(), ..learnt })
}

/// Remark on an effect of the given model that would not be certified: its size may be zero, or held-out runs are predicted no better with
/// it.
fn uncertified(effect: &str, step: &Step, before: &Error, options: &Options) -> Option<String> {
    let p = step.p_adjusted?;
    let fall = |now: f64, then: f64| 1.0 - now / then;
    let heading = step.held_out.heading.zip(before.heading).map_or(0.0, |(now, then)| fall(now, then));
    let gain = fall(step.held_out.position, before.position).max(heading);
    (p > options.size || gain < LEAST_GAIN).then(|| {
        format!(
            "{effect} of the given model is not certified: p = {p:.3}, and the cross-validated error is {:.1} mm with it, {:.1} mm without.",
            1e3 * step.held_out.position,
            1e3 * before.position
        )
    })
}

/// The first effects of the robot's drive that the runs determine, in addition to those of a model.
fn shown(observed: &Observed, model: &Model) -> Result<Vec<&'static str>, FitError> {
    let mut first = observed.robot.drive.first_effects().to_vec();
    loop {
        let mut with = model.clone();
        for effect in &first {
            with.add(effect)?.free = true;
        }
        let fitted = plainly(observed, &observed.begin(&with)?.0)?;
        let Some(silent) = first.iter().rposition(|effect| !is_shown(&fitted, effect)) else { return Ok(first) };
        first.remove(silent);
    }
}

/// Whether every size of a model may be zero: its 95 % interval holds the value without effect.
fn is_nominal(fitted: &Fitted) -> bool {
    let may_be_zero = |own: &Estimate| {
        let nothing =
            parameter_of(own.effect, own.parameter).map(|parameter| parameter.default.resolve(fitted.model.robot()));
        nothing.zip(own.interval(0.95)).is_some_and(|(nothing, interval)| interval.contains(nothing))
    };
    estimates(fitted).iter().all(may_be_zero)
}

/// Whether the runs determine one of the first effects: it differs from zero, or it is below [`OPEN`] times its usual size.
fn is_shown(fitted: &Fitted, effect: &str) -> bool {
    let own = estimates(fitted).into_iter().find(|e| e.effect == effect);
    let parameter = find(effect).ok().and_then(|entry| entry.about.parameters.first());
    let Some((own, parameter)) = own.zip(parameter) else { return false };
    let nothing = parameter.default.resolve(fitted.model.robot());
    let off = (own.value - nothing).abs();
    is_possible(fitted, effect) && (own.standard_error < OPEN * parameter.typical || off > SURE * own.standard_error)
}

/// The final diagnosis, of the learnt model.
fn finish(mut search: Search, steps: Vec<Step>, options: &Options) -> Result<Learnt, FitError> {
    let told = Conclusion::new(&mut search, options)?;
    let Conclusion { verdict, mut reasons, repeats, mut remains, dependence, mut experiments, mut hints } = told;
    let more = search.left.effect.is_some();
    hints.extend(search.removed.iter().map(|effect| {
        format!("{effect} was added and removed again: beside the other effects it no longer lowers the cross-validated error.")
    }));
    let has_law = search.has_law();
    hints.extend(
        search
            .harmful
            .iter()
            .map(|effect| format!("{effect} is significant but was not added: it raises the cross-validated error.")),
    );
    hints.extend(search.inseparable.iter().map(|effect| {
        format!(
            "{effect} is significant but was not added: these runs hardly separate it from E_d, E_b and E_s, and the cross-validated \
             error falls too little for that. Other drives may be predicted worse with it."
        )
    }));
    let told: Vec<&str> = search.harmful.iter().chain(&search.inseparable).copied().collect();
    let (left, runs) = (search.left, search.exams[0].fitted.observed.runs.len());
    let Some(last) = search.exams.pop() else { return Err(FitError::NotConverged { how: "has no model" }) };
    let written = no_surer(search.written.pop().map_or_else(|| last.fitted.clone(), Alone::into_fitted))?;
    if written.usual_noise {
        // The model is written with other values than those that were examined: what is said of it is said of these, as `compare` does.
        let (doubts, left) = tracks::doubts_as_written(&written.observed, &written.model, options);
        let of_laws = |reason: &Reason| matches!(reason, Reason::Repeats(_));
        // What repeats with the likeliest values is in the data, whichever values are written; by how much is told in per cent.
        let examined = std::mem::replace(&mut reasons, doubts);
        reasons.extend(examined.iter().filter(|reason| reason.is_of_runs()).cloned());
        let examined = examined.into_iter().find(of_laws);
        if let Some(Reason::Repeats(mut repeated)) = examined.filter(|_| !reasons.iter().any(of_laws)) {
            repeated.law.left_out = [f64::NAN; 2];
            reasons.push(Reason::Repeats(repeated));
        }
        remains = left.unwrap_or(remains);
        reasons.extend(tracks::of_usual_noise(&written.observed, &written.noise));
    }
    reasons.splice(..0, search.stopped.then_some(Reason::Stopped));
    let against = against_as_written(&written.observed, &written.model, options);
    let mounted = match against {
        Some(_) => mounted(&written.observed, &written.model, &written.noise, options)?,
        None => None,
    };
    hints.extend(mounted.iter().map(|mounted| {
        format!(
            "As written, the model leaves an error that depends on the motion, by a mounting of the reference that was fitted along with it \
             and is too small to be added. {}",
            mounted.words
        )
    }));
    reasons.extend(against.filter(|_| mounted.is_none()));
    let alone = Alone::new(written.clone());
    let (noise, conditions) = (written.observed.setup.noise.position, crossed(&alone));
    reasons.extend(misfits(&steps, runs, noise, is_nominal(&last.fitted), alone.is_told_without_any_fold()));
    reasons.extend(elsewhere(&steps, &conditions, runs, noise));
    let verdict = match (&left.smooth, more) {
        _ if verdict == Verdict::NotEnoughData => verdict,
        (Some(_), _) => Verdict::UnlistedEffect,
        (None, true) => Verdict::SeveralMissing,
        (None, false) if !reasons.is_empty() => Verdict::NotExplained,
        (None, false) if has_law => Verdict::UnlistedEffect,
        (None, false) => Verdict::Explained,
    };
    let diagnosis = tracks::of_model(last, dependence, estimates(&written), options)?;
    hints.extend(tracks::uncertified(&left.asked, &reasons, options));
    let mut remarks = [diagnosis.remarks.clone(), hints].concat();
    let ranking = left.asked;
    let asked = ranking.first().filter(|s| s.p_adjusted <= options.size && !told.contains(&s.best));
    if let Some(suspect) = asked {
        let why = if left.inseparable.contains(&suspect.best) {
            "these runs hardly separate it from E_d, E_b and E_s, so that it needs a smaller p".to_owned()
        } else {
            format!("it lowers the cross-validated error by less than {:.0} %", 100.0 * LEAST_GAIN)
        };
        let (class, p) = (suspect.class.join(" or "), suspect.p_adjusted);
        remarks.push(format!("{class} is significant (p = {p:.1e}) but was not added: {why}."));
    }
    if written.usual_noise {
        remarks.push(USUAL_NOISE.to_owned());
    }
    experiments.extend(diagnosis.next_experiments);
    let model = written.model.clone();
    remarks.extend(kept(&model, &diagnosis.fitted));
    let diagnosis = Diagnosis {
        verdict,
        ranking,
        reasons,
        repeats,
        remains: Some(remains),
        model: model.clone(),
        next_experiments: experiments,
        ..diagnosis
    };
    Ok(Learnt { steps, verdict, model, noise: Some(written.noise), conditions, remarks, diagnosis, partial: false })
}

/// The conditions of the runs, and what of a model is told under one of their levels alone.
fn crossed(alone: &Alone) -> Vec<Crossed> {
    let conditions = alone.fitted().observed.conditions.iter();
    conditions.map(|levels| Crossed::new(levels, alone.elsewhere(levels).only)).collect()
}

/// Remark on lengths, times and thresholds that the runs do not determine: they keep their start values.
fn kept<'a>(model: &'a Model, fitted: &'a [Estimate]) -> impl Iterator<Item = String> + 'a {
    let shapes = model.shapes();
    let of_part = move |part: &'a Part| {
        let name = part.effect.name();
        let shapes = shapes.clone();
        let is_fitted = move |parameter: &str| fitted.iter().any(|e| e.effect == name && e.parameter == parameter);
        let is_kept = move |parameter: &str| {
            !is_fitted(parameter) && model.place_of(name, parameter).is_some_and(|place| shapes.contains(&place))
        };
        let numbers = part.effect.parameters().iter().zip(&part.values);
        numbers.filter(move |(parameter, _)| is_kept(parameter.name)).map(move |(parameter, value)| {
            let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
            format!(
                "{} of {name} is kept at {value:.4}{unit}: fitted with all the others, these runs do not determine it.",
                parameter.name
            )
        })
    };
    let fitted_parts =
        model.parts().iter().filter(move |part| part.free && fitted.iter().any(|e| e.effect == part.effect.name()));
    fitted_parts.flat_map(of_part)
}

/// The error of a model with the values that it has.
pub(super) fn error(observed: &Observed, model: &Model) -> Result<Error, FitError> {
    Ok(step(observed.unfitted(&fixed(model), &Noise::default()), None).error)
}

/// The step that a model is with the values that it has.
pub(super) fn as_it_is(observed: &Observed, model: &Model) -> Result<Step, FitError> {
    Ok(step(plainly(observed, &fixed(model))?, None))
}

/// A model fitted to all runs, and its errors.
pub(super) fn fit_whole(observed: &Observed, model: &Model) -> Result<(Fit, Step), FitError> {
    let alone = fit_alone(observed, model)?;
    let step = step_of(&alone, None);
    Ok((told(alone)?, step))
}

/// A model fitted under noise of the usual size: enough for its errors.
fn plainly(observed: &Observed, model: &Model) -> Result<Fitted, FitError> {
    let mut fitted = observed.unfitted(model, &Noise::default());
    // In the second fit, the noise grows along the poses of the first.
    fitted.refit()?;
    fitted.refit()?;
    Ok(fitted)
}

type Told = (&'static str, Vec<&'static str>, Option<f64>);

fn step(fitted: Fitted, added: Option<Told>) -> Step {
    step_of(&Alone::new(fitted), added)
}

fn step_of(alone: &Alone, added: Option<Told>) -> Step {
    let (inside, held_out) = alone.misses();
    let (aicc, bic, weighted) = alone.criteria();
    let error = |misses: Misses| Error { position: misses.position, heading: misses.heading, weighted };
    let conditions = alone.fitted().observed.conditions.iter();
    let elsewhere = conditions.map(|levels| error(alone.elsewhere(levels).misses)).collect();
    let (added, class, p_adjusted) = added.map_or((None, Vec::new(), None), |(name, class, p)| (Some(name), class, p));
    Step {
        added,
        class,
        p_adjusted,
        law: None,
        error: error(inside),
        held_out: error(held_out),
        elsewhere,
        aicc: Some(aicc),
        bic: Some(bic),
    }
}
