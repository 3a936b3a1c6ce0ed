//! Diagnosis from tick logs with absolute poses on the way.
//!
//! | step | in | what it does |
//! |---|---|---|
//! | data | [`evidence::tracks`](crate::evidence::tracks) | fits the model to the tracks, and the noise of its residuals |
//! | columns | `responses`, `smooth` | replays the tracks once for each size of each effect: a linear model around the fit |
//! | whiten | `examination` | makes the residuals and columns independent; all tests follow from their products |
//! | test | `finding`, `significance`, `flips` | F of every effect and smooth, Bonferroni-corrected; sign flips of whole runs |
//! | class | `class` | which effects look the same in these runs |
//! | search | `search`, `missing`, `growth`, `needless`, `lags`, `repeats` | adds what is certified to the model, and tests again |
//! | doubt | `doubts`, `chance`, `odd`, `unequal`, `varying`, `wander`, `unconfirmed` | what speaks against the model: what repeats, runs and numbers that differ, headings that wander |
//! | words | `conclusion`, `left`, `confounders`, `dependence`, `curve`, `suggestion`, `experiments` | the verdict, what the error depends on, and what to drive next |
//!
//! An effect is certified as missing where three things hold: its F is significant (Bonferroni-corrected), by the noise model and
//! by the scatter between runs; its score is significant under sign flips of whole runs, which need no noise model; and held-out
//! runs are predicted better with it, where the effect is chosen again without each run.
//!
//! Smooth functions of how the robot drives stand beside the catalogue: where one explains clearly more than the best
//! effect does, something is missing that the catalogue does not list.

mod chance;
mod class;
mod conclusion;
mod confounders;
mod curve;
pub(super) mod dependence;
mod doubts;
mod examination;
mod experiments;
mod finding;
mod flips;
mod growth;
mod lags;
mod left;
mod missing;
mod needless;
mod odd;
pub(super) mod repeats;
mod responses;
mod search;
mod significance;
mod smooth;
mod suggestion;
mod unconfirmed;
mod unequal;
mod varying;
mod wander;

use super::diagnosis::{Diagnosis, Verdict};
use super::experiments::{Experiment, worth};
use super::options::Options;
use super::suspect::Suspect;
use crate::effect::{Entry, Model};
use crate::evidence::FitError;
use crate::evidence::tracks::{estimates, fit, fit_possible};
use crate::likelihood::Observed;
use crate::watch::Watch;

pub(crate) use class::class_of_own;
pub(crate) use conclusion::{Conclusion, of_model, uncertified};
pub use curve::{Curve, CurvePoint};
pub use dependence::Dependence;
pub(crate) use doubts::of_usual_noise;
pub(crate) use examination::Examination;
pub(crate) use left::doubts_as_written;
pub use odd::OddRun;
pub use repeats::{Repeated, UnlistedLaw, what_repeats};
pub(crate) use search::{Added, Found, Search, Wanted, search};
pub(crate) use significance::p_of_own;
pub use suggestion::Suggestion;
pub use unequal::Unequal;

/// Maximum number of classes that a diagnosis names.
const MAX_CLASSES: usize = 3;

/// Fits a model's free parameters to tracks and tests every other effect and every smooth.
pub(crate) fn diagnose(observed: &Observed, model: &Model, options: &Options) -> Result<Diagnosis, FitError> {
    let fitted = fit_possible(observed, model)?;
    let is_out = |effect: &&str| fitted.model.parts().iter().all(|part| part.effect.name() != *effect);
    let refused: Vec<&str> = model.parts().iter().map(|part| part.effect.name()).filter(is_out).collect();
    let mut search = Watch::nobody(|watch| search(fitted, options, (MAX_CLASSES, Wanted::Listed), refused, watch))?;
    let Conclusion { verdict, reasons, repeats, remains, dependence, experiments, hints } =
        Conclusion::new(&mut search, options)?;
    let Search { mut exams, added, left, .. } = search;
    let uncertified = uncertified(&left.asked, &reasons, options);
    let certified: Vec<Suspect> = added.into_iter().map(|added| added.suspect).collect();
    let asked = left.asked.into_iter().filter(|other| certified.iter().all(|known| known.best != other.best));
    let ranking = certified.iter().cloned().chain(asked).collect();
    // Visibility, tests and remaining error refer to the given model, before anything was added.
    let remains = if exams.len() > 1 { left::remains_of(&exams[0], options) } else { remains };
    let exam = exams.swap_remove(0);
    let fitted = estimates(&exam.fitted);
    let diagnosis = of_model(exam, dependence, fitted, options)?;
    let mut next_experiments = [experiments, diagnosis.next_experiments].concat();
    next_experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    let is_doubted = verdict == Verdict::Explained && !reasons.is_empty();
    Ok(Diagnosis {
        verdict: if is_doubted { Verdict::NotExplained } else { verdict },
        ranking,
        certified: certified.len(),
        next_experiments,
        reasons,
        repeats,
        remains: Some(remains),
        remarks: diagnosis.remarks.into_iter().chain(hints).chain(uncertified).collect(),
        ..diagnosis
    })
}

/// Every available drive that separates two effects, together with these tracks.
pub(crate) fn separating(
    observed: &Observed,
    model: &Model,
    pair: [&'static Entry; 2],
) -> Result<Vec<Experiment>, FitError> {
    experiments::separating(&Examination::new(fit(observed, model)?)?, pair.map(|entry| entry.about.name))
}

#[cfg(test)]
pub(crate) mod tests;
