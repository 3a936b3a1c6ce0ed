//! Diagnosis from tick logs with absolute poses on the way.
//!
//! One replay for each size of each effect gives the columns of a linear model around the fit; whitened by the likelihood
//! ([`crate::likelihood`]), all tests follow from their products. An effect is certified as missing where three things hold: its F
//! stands out of all effects asked (Bonferroni), by the noise model and by how the runs differ from one another; so does its
//! score when the signs of runs are flipped, which trusts no noise model; and runs that are left out are predicted better with
//! it, the choice being made anew without each.
//!
//! Smooth functions of how the robot drives stand beside the catalogue: where one explains clearly more than the best
//! effect does, something is missing that the catalogue does not list.

mod chance;
mod curve;
mod doubts;
mod examination;
mod experiments;
mod flips;
pub(crate) mod growth;
mod look;
mod repeats;
mod responses;
mod search;
mod smooth;
mod suggestion;

use super::{
    Dependence, Detectable, Diagnosis, Experiment, GoodnessOfFit, Identifiability, Likeness, Options, Reason, Remains,
    Suspect, Unseen, Verdict, Why, experiments::worth,
};
use crate::diagnose::likeness::correlations;
use crate::effect::Model;
use crate::evidence::tracks::{Errors, LEAST_GAIN, Projected, System, estimates};
use crate::evidence::{FitError, Level};
use crate::likelihood::{Column, Fitted, Noise, Observed};
use crate::stats::{chi_squared_upper_tail, normal_quantile};
use crate::watch::Watch;
use responses::Question;
use smooth::Motion;
use std::sync::Arc;

pub(crate) use examination::Examination;
pub(crate) use look::{Finding, class_of_own, p_of_own};
pub use repeats::{Repeated, UnlistedLaw, what_repeats};
pub(crate) use search::{Added, Found, Search, Wanted, search};
pub use suggestion::Suggestion;

/// A smooth speaks for an unlisted effect where the best effect of the catalogue explains less than this share of it.
const EXPLAINED: f64 = 0.85;
/// Share by which errors in runs left out must fall for an unlisted effect to be spoken of.
const TELLING: f64 = 0.1;
/// So many certified effects are tried for their gain.
const TRIES: usize = 4;
/// p by F below which a suspect is spoken of though no flips certify it.
const LOUD: f64 = 1e-20;
/// An effect of the catalogue that explains less than this share of what is unlisted is not near.
const NEAR: f64 = 0.5;
/// A diagnosis names at most so many classes.
const MOST: usize = 3;
/// Fewer runs give no certificate.
const FEWEST: usize = 2;

/// A smooth, for people.
pub(crate) fn dependence(exam: &Examination, finding: &Finding, asked: &[Suspect]) -> Option<Dependence> {
    let Question::Smooth(covariate, motion) = &exam.asked[finding.answer.asked].question else { return None };
    let share = |suspect: &&Suspect| suspect.expected_drop / finding.answer.drop;
    let nearest = asked.iter().max_by(|a, b| a.expected_drop.total_cmp(&b.expected_drop));
    Some(Dependence {
        acts_on: motion.name(),
        depends_on: covariate.name,
        title: covariate.title,
        p_adjusted: finding.p_adjusted(),
        drop: finding.answer.drop,
        curve: curve::curve(exam, finding, covariate, *motion),
        suggestion: suggestion::suggestion(exam, finding, covariate, *motion),
        nearest: nearest.map(|suspect| (suspect.best, share(&suspect).min(1.0))),
    })
}

/// Fits a model's free parameters to tracks and asks every other effect, and every smooth, whether it is missing.
pub(crate) fn diagnose(fitted: Fitted, options: &Options) -> Result<Diagnosis, FitError> {
    let mut search = Watch::nobody(|watch| search(fitted, options, (MOST, Wanted::Listed), Vec::new(), watch))?;
    let verdict = verdict(&search);
    let repeats = search.repeats(options).cloned();
    let mut reasons = doubts_of(search.last(), options);
    reasons.extend(reason_to_doubt(repeats.as_ref()));
    let Search { mut exams, added, left, .. } = search;
    let last = exams.len() - 1;
    let at_last = remains_of(&exams[last], options);
    reasons.extend(Reason::of_remains(&at_last));
    let remains = if last > 0 { remains_of(&exams[0], options) } else { at_last };
    let told = left.smooth.as_ref().and_then(|finding| dependence(&exams[last], finding, &left.asked));
    let mut certified: Vec<Suspect> = Vec::new();
    let mut experiments = Vec::new();
    let mut hints = Vec::new();
    for (exam, added) in exams.iter().zip(&added) {
        let (told, hint) = next_experiments(exam, added)?;
        experiments.extend(told);
        hints.extend(hint);
        certified.push(added.suspect.clone());
    }
    hints.extend(uncertified(&left.asked, options));
    let asked = left.asked.into_iter().filter(|other| certified.iter().all(|known| known.best != other.best));
    let ranking = certified.iter().cloned().chain(asked.collect::<Vec<_>>()).collect();
    let mut diagnosis = conclude(exams.swap_remove(0), told, options)?;
    diagnosis.remarks.extend(hints);
    let mut next_experiments = [experiments, diagnosis.next_experiments].concat();
    next_experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    let verdict = if verdict == Verdict::Explained && !reasons.is_empty() { Verdict::NotExplained } else { verdict };
    Ok(Diagnosis {
        verdict,
        ranking,
        certified: certified.len(),
        next_experiments,
        reasons,
        repeats,
        remains: Some(remains),
        ..diagnosis
    })
}

/// What the model of an examination leaves.
pub(crate) fn remains_of(exam: &Examination, options: &Options) -> Remains {
    let base = exam.base(None);
    let values = Projected::fit(&exam.system.whole, &base);
    let own = exam.some_columns(&[&base[..], &[exam.system.residual()]].concat());
    let left: Vec<Column> = own.iter().map(|columns| less(columns, values.as_slice())).collect();
    let Fitted { observed, noise, .. } = &exam.fitted;
    chance::remains(observed, noise, &left, &exam.errors.in_sample(), options)
}

/// The last of some columns less the others, each times its value.
fn less(columns: &[Column], values: &[f64]) -> Column {
    let Some((left, others)) = columns.split_last() else { return Column::new() };
    let mut left = left.clone();
    for (column, value) in others.iter().zip(values) {
        left.iter_mut().zip(column).for_each(|(left, own)| (0..3).for_each(|k| left[k] -= value * own[k]));
    }
    left
}

/// What speaks against the model of an examination as a whole.
pub(crate) fn doubts_of(exam: &Examination, options: &Options) -> Vec<Reason> {
    let Examination { fitted, errors, .. } = exam;
    doubts::of_model(&fitted.observed, &fitted.model, &fitted.noise, &errors.in_sample(), options.seed)
}

/// The reason that what repeats beside a fitted model is, where it is a doubt.
pub(crate) fn reason_to_doubt(repeated: Option<&Repeated>) -> Option<Reason> {
    repeated
        .filter(|repeated| repeated.is_doubt(LEAST_GAIN))
        .cloned()
        .map(|repeated| Reason::Repeats(Box::new(repeated)))
}

/// The same of a model with the values that it has, nothing but START fitted: under the noise that would make what it leaves
/// likeliest.
pub(crate) fn doubts_as_written(
    observed: &Observed,
    model: &Model,
    options: &Options,
) -> (Vec<Reason>, Option<Remains>) {
    if observed.runs.is_empty() {
        return (Vec::new(), None);
    }
    let fixed = observed.whole().unfitted(model, &Noise::default());
    let chain = fixed.model.chain();
    let columns: Vec<Vec<_>> = fixed.observed.runs.iter().map(|run| vec![run.residuals_along(&chain)]).collect();
    let noise = Noise::estimate(&fixed.observed, &chain, &columns, &fixed.noise);
    let system = System::new(&fixed.observed, &noise, &columns);
    let errors = Errors::new(&fixed.observed, &system, &columns, vec![0]);
    let mut reasons = doubts::of_model(&fixed.observed, model, &noise, &errors.in_sample(), options.seed);
    let repeated = what_repeats(&fixed.observed, model, &noise, &columns, options.seed);
    reasons.extend(
        repeated.filter(|repeated| repeated.is_doubt(TELLING)).map(|repeated| Reason::Repeats(Box::new(repeated))),
    );
    let left: Vec<Column> = columns.iter().map(|columns| less(columns, &[])).collect();
    let remains = chance::remains(&fixed.observed, &noise, &left, &errors.in_sample(), options);
    reasons.extend(Reason::of_remains(&remains));
    (reasons, Some(remains))
}

/// Drives that would tell apart the members of a certified class, and for those that none does, what their own pages say.
pub(crate) fn next_experiments(exam: &Examination, added: &Added) -> Result<(Vec<Experiment>, Vec<String>), FitError> {
    let Added { suspect, by } = added;
    let finding = match by {
        Found::Listed(finding) => finding,
        Found::Unlisted(repeated) => return Ok((experiments::of_laws(exam, repeated)?, Vec::new())),
    };
    let told = experiments::next(exam, &[finding], &[])?;
    let mut hints = Vec::new();
    for other in suspect.class.iter().filter(|name| **name != suspect.best) {
        if told.iter().all(|experiment| !experiment.separates.contains(other)) {
            let how =
                [suspect.best, other].map(|name| crate::effect::find(name).map(|effect| effect.about.separated_by));
            let [own, others] = [how[0].clone()?, how[1].clone()?];
            let best = suspect.best;
            hints.push(format!(
                "No drive that was tried on paper tells {best} from {other}. {best}: {own}. {other}: {others}."
            ));
        }
    }
    Ok((told, hints))
}

/// Every drive on offer for telling two effects apart, together with these tracks.
pub(crate) fn separating(fitted: Fitted, pair: [&'static str; 2]) -> Result<Vec<Experiment>, FitError> {
    experiments::separating(&Examination::new(fitted)?, pair)
}

/// What stands far out by F and is not certified by the flips: these runs are too few, or too unlike, to vouch for it.
pub(crate) fn uncertified(asked: &[Suspect], options: &Options) -> Option<String> {
    let loud = asked.first().filter(|s| s.p < LOUD && s.p_adjusted > options.size)?;
    Some(format!(
        "{} stands out by F (p = {:.0e}), but with the signs of whole runs flipped as much comes about by chance (p = {:.2}): \
         more runs would tell.",
        loud.class.join(" or "),
        loud.p,
        loud.p_adjusted
    ))
}

/// The answer to a search in one word.
pub(crate) fn verdict(search: &Search) -> Verdict {
    match (&search.left.smooth, search.added.len()) {
        _ if search.last().fitted.observed.runs.len() < FEWEST => Verdict::NotEnoughData,
        (Some(_), 0) => Verdict::UnlistedEffect,
        (None, 0) => Verdict::Explained,
        (None, 1) => Verdict::MissingEffect,
        _ => Verdict::SeveralMissing,
    }
}

/// The diagnosis of a model that nothing is added to: what it cannot see, and what else is to be said of it.
pub(crate) fn conclude(
    exam: Examination,
    dependence: Option<Dependence>,
    options: &Options,
) -> Result<Diagnosis, FitError> {
    let (invisible, minimum_detectable) = visibility(&exam);
    Ok(Diagnosis {
        level: Level::Tracks,
        verdict: Verdict::Explained,
        fitted: estimates(&exam.fitted),
        correlations: correlations(exam.fitted.covariance.as_ref()),
        likeness: likeness(&exam),
        goodness_of_fit: whole_model(&exam, options),
        ranking: Vec::new(),
        certified: 0,
        next_experiments: experiments::next(&exam, &[], &invisible)?,
        invisible,
        minimum_detectable,
        contrasts: Vec::new(),
        circle: Vec::new(),
        identifiability: Identifiability { shares: Vec::new(), rank: exam.free.len(), hidden: Vec::new() },
        remarks: remarks(&exam, dependence.as_ref()),
        outliers: exam.fitted.outliers.clone(),
        setup: Arc::clone(&exam.fitted.observed.setup),
        taken: exam.fitted.taken.clone(),
        reasons: Vec::new(),
        repeats: None,
        remains: None,
        dependence,
        model: exam.fitted.model,
    })
}

/// What the data cannot see, and the least that it would see.
fn visibility(exam: &Examination) -> (Vec<Unseen>, Vec<Detectable>) {
    let products = &exam.system.whole;
    let surely = normal_quantile(0.975) + normal_quantile(0.8);
    let (mut unseen, mut detectable) = (Vec::new(), Vec::new());
    for (index, asked) in exam.asked.iter().enumerate() {
        let Question::Effect(effect, parameters) = &asked.question else { continue };
        // Where shapes were tried, the usual one comes first and speaks for all.
        if index > 0 && exam.asked[index - 1].effect() == Some(*effect) {
            continue;
        }
        let projected = Projected::new(products, &exam.base(Some(index)));
        let mut why = None;
        let mut seen = false;
        for (column, parameter) in asked.columns.iter().zip(parameters) {
            if projected.absorbed(products, *column) {
                why = why.or_else(|| Some(Why::Absorbed(absorbing(exam, products, &projected.base, *column))));
                continue;
            }
            let strength = projected.products[(*column, *column)].sqrt();
            if strength * parameter.typical < 1.0 {
                why = Some(Why::BelowNoise);
            } else {
                seen = true;
            }
            let (effect, parameter) = (effect.about.name, parameter.name);
            detectable.push(Detectable { effect, parameter, size: surely / strength });
        }
        if let (false, Some(why)) = (seen, why) {
            unseen.push(Unseen { effect: effect.about.name, why });
        }
    }
    (unseen, detectable)
}

/// How alike the effects look beside the model, each size at its usual value.
fn likeness(exam: &Examination) -> Likeness {
    let products = &exam.system.whole;
    let projected = Projected::new(products, &exam.free);
    let mut sizes: Vec<(&'static str, usize, f64)> = Vec::new();
    for asked in &exam.asked {
        let Question::Effect(effect, parameters) = &asked.question else { continue };
        let seen = asked.columns.iter().zip(parameters).filter(|(c, _)| !projected.absorbed(products, **c));
        sizes.extend(seen.map(|(column, parameter)| (effect.about.name, *column, parameter.typical)));
    }
    let names: Vec<&'static str> = sizes.iter().map(|(name, _, _)| *name).collect();
    let of = |i: usize, j: usize| sizes[i].2 * sizes[j].2 * projected.products[(sizes[i].1, sizes[j].1)];
    Likeness::new(&names, &nalgebra::DMatrix::from_fn(sizes.len(), sizes.len(), of))
}

/// The effects of the base that a column is most like.
fn absorbing(
    exam: &Examination,
    products: &nalgebra::DMatrix<f64>,
    base: &[usize],
    column: usize,
) -> Vec<&'static str> {
    let alike = |other: &usize| {
        let lengths = (products[(*other, *other)] * products[(column, column)]).sqrt();
        (products[(*other, column)] / lengths.max(f64::MIN_POSITIVE)).abs()
    };
    let nearest = base.iter().max_by(|a, b| alike(a).total_cmp(&alike(b)));
    nearest.and_then(|column| exam.name(*column)).into_iter().collect()
}

/// Tests of the model as a whole: errors that repeat themselves along the way, and innovations that remember.
fn whole_model(exam: &Examination, options: &Options) -> Vec<GoodnessOfFit> {
    let mut tests: Vec<GoodnessOfFit> = look::smooths(exam, options)
        .iter()
        .filter_map(|finding| {
            let name = match &exam.asked[finding.answer.asked].question {
                Question::Smooth(covariate, motion) if covariate.name == smooth::ALONG_THE_WAY => match motion {
                    Motion::Forward => "forward errors repeat along the way",
                    Motion::Sideways => "sideways errors repeat along the way",
                    Motion::Yaw => "yaw errors repeat along the way",
                },
                _ => return None,
            };
            let freedom = Some(finding.degrees_of_freedom);
            Some(GoodnessOfFit { name, statistic: finding.f, degrees_of_freedom: freedom, p: finding.p_flips })
        })
        .collect();
    tests.sort_by_key(|test| test.name);
    let (q, lags) = exam.portmanteau();
    let p = chi_squared_upper_tail(q, lags);
    tests.push(GoodnessOfFit {
        name: "innovations are correlated (Ljung-Box)",
        statistic: q,
        degrees_of_freedom: None,
        p,
    });
    tests
}

fn remarks(exam: &Examination, unlisted: Option<&Dependence>) -> Vec<String> {
    let noise = &exam.fitted.noise;
    let mut remarks = Vec::new();
    if let Some(told) = unlisted {
        remarks.push(format!(
            "Something that the catalogue does not list acts on the {} motion; it depends on {} (p = {:.2e}).",
            told.acts_on, told.title, told.p_adjusted
        ));
        if let Some((effect, share)) = told.nearest.filter(|(_, share)| *share >= NEAR) {
            remarks.push(format!(
                "The nearest effect of the catalogue is {effect}: it explains {:.0} % of that.",
                100.0 * share
            ));
        }
    }
    if exam.fitted.observed.runs.iter().any(|run| !run.start_seen) {
        remarks.push(format!(
            "START was not measured in every run: a scatter of {:.0} mm and {:.1} deg is assumed there.",
            1e3 * noise.start_position,
            noise.start_heading.to_degrees()
        ));
    }
    remarks.push(format!(
        "Noise found: heading {:.2} mrad per root metre and {:.2} mrad per root radian, forward {:.2} mm per root metre; clock of the \
         reference {:.1} ms from pose to pose and {:.1} ms from run to run.",
        1e3 * noise.heading_per_metre,
        1e3 * noise.heading_per_radian,
        1e3 * noise.forward_per_metre,
        1e3 * noise.reference_time,
        1e3 * noise.reference_delay
    ));
    remarks
}

#[cfg(test)]
pub(crate) mod tests;
