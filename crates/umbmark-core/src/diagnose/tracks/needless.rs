//! Effects of a fitted model that do not help.

use super::examination::Examination;
use crate::effect::Part;
use crate::evidence::tracks::{LEAST_GAIN, Misses, estimates};
use crate::evidence::{Estimate, FitError};
use crate::likelihood::{Fitted, Noise};

/// A fit without one of its effects.
pub fn without(fitted: &Fitted, effect: &str) -> Result<Fitted, FitError> {
    let taken = fitted.taken.iter().filter(|taken| taken.effect != effect).copied().collect();
    let again = fitted.observed.fit(&fitted.model.without(effect), &Noise::default(), &[])?;
    Ok(Fitted { taken, ..again })
}

/// An effect among those `asked` that does not help: the interval of each of its sizes holds zero, or held-out runs are predicted as
/// well without it.
pub fn idle(exam: &Examination, asked: impl Fn(&'static str) -> bool) -> Option<&'static str> {
    silent(exam, &asked).or_else(|| last_part(exam, asked, |part| !helps(exam, part.effect.name())))
}

/// An effect among those `asked` whose sizes all have an interval that holds zero.
pub fn silent(exam: &Examination, asked: impl Fn(&'static str) -> bool) -> Option<&'static str> {
    let estimates = estimates(&exam.fitted);
    let model = &exam.fitted.model;
    let is_silent = |part: &Part| {
        let own: Vec<&Estimate> = estimates.iter().filter(|e| e.effect == part.effect.name()).collect();
        let shows = |e: &&&Estimate| {
            let nothing = model.place_of(e.effect, e.parameter).and_then(|place| model.nothing(place));
            nothing.is_some_and(|nothing| e.interval(0.95).is_none_or(|interval| !interval.contains(nothing)))
        };
        !own.is_empty() && own.iter().all(|e| !shows(&e))
    };
    last_part(exam, asked, is_silent)
}

/// Of the fitted effects that are `asked` and fulfil a condition, the one that was added last.
fn last_part(
    exam: &Examination,
    asked: impl Fn(&'static str) -> bool,
    is_such: impl Fn(&Part) -> bool,
) -> Option<&'static str> {
    let parts = exam.fitted.model.parts().iter().filter(|part| part.free && asked(part.effect.name()));
    parts.rev().find(|part| is_such(part)).map(|part| part.effect.name())
}

/// Whether held-out runs are predicted better with an effect of the model than without it.
fn helps(exam: &Examination, effect: &str) -> bool {
    let [with, without] = with_and_without(exam, effect);
    exam.columns_of(effect).is_empty() || with.gain(&without) >= LEAST_GAIN
}

/// Errors of held-out runs with an effect of the model, and without it, the others fitted again.
pub fn with_and_without(exam: &Examination, effect: &str) -> [Misses; 2] {
    let own = exam.columns_of(effect);
    let beside: Vec<usize> = exam.base(None).into_iter().filter(|column| !own.contains(column)).collect();
    let of_reference: Vec<usize> = beside.iter().copied().filter(|column| !exam.free.contains(column)).collect();
    [exam.left_out(&of_reference), exam.left_out_without(&own, &beside)]
}
