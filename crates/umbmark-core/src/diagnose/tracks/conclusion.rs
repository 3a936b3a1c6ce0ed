//! What was found, in words: the verdict, the reasons for doubt, what is hidden, and what to drive next.

use super::confounders::confounders;
use super::dependence::{Dependence, dependence};
use super::examination::Examination;
use super::left::{doubts_of, reason_to_doubt, remains_of};
use super::missing::FEWEST;
use super::odd::odd_run;
use super::repeats::Repeated;
use super::responses::Question;
use super::search::{Added, Found, Search};
use super::smooth::{ALONG_THE_WAY, Motion};
use super::unconfirmed::unconfirmed;
use super::unequal::unequal;
use super::{experiments, significance, varying};
use crate::diagnose::diagnosis::{Diagnosis, GoodnessOfFit, Verdict};
use crate::diagnose::experiments::Experiment;
use crate::diagnose::identifiability::Identifiability;
use crate::diagnose::likeness::Likeness;
use crate::diagnose::options::Options;
use crate::diagnose::reason::Reason;
use crate::diagnose::remains::Remains;
use crate::diagnose::suspect::Suspect;
use crate::diagnose::unseen::{Detectable, Unseen, Why};
use crate::effect::find;
use crate::evidence::tracks::Projected;
use crate::evidence::{Estimate, FitError, Level, correlations};
use crate::stats::{chi_squared_upper_tail, normal_quantile};
use nalgebra::DMatrix;
use std::sync::Arc;

/// p by F below which a suspect is reported although the sign flips do not certify it.
const LOUD: f64 = 1e-20;
/// An effect of the catalogue is not named as near if it explains less than this share of the unlisted effect.
const NEAR: f64 = 0.5;

/// The conclusion of a search, for `diagnose`, which names effects, and `learn`, which adds them.
pub(crate) struct Conclusion {
    /// The verdict, without regard to the reasons for doubt.
    pub verdict: Verdict,
    /// Reasons against the last model.
    pub reasons: Vec<Reason>,
    /// The strongest pattern that repeats in the residuals of the last model.
    pub repeats: Option<Repeated>,
    /// What the last model leaves.
    pub remains: Remains,
    /// An effect outside the catalogue that the last model lacks.
    pub dependence: Option<Dependence>,
    /// Drives that would separate the members of the classes that were found.
    pub experiments: Vec<Experiment>,
    /// Remarks on members that no drive separates.
    pub hints: Vec<String>,
}

impl Conclusion {
    /// The conclusion of a search.
    pub fn new(search: &mut Search, options: &Options) -> Result<Conclusion, FitError> {
        let repeats = search.repeats(options).cloned();
        let (last, left) = (search.last(), &search.left);
        let remains = remains_of(last, options);
        let mut reasons = doubts_of(last, options);
        reasons.extend(reason_to_doubt(repeats.as_ref()));
        reasons.extend(Reason::of_remains(&remains, last.fitted.observed.resolution()));
        reasons.extend(unequal(last).or_else(|| odd_run(last)));
        reasons.extend(varying::of_smooths(last, options));
        reasons.extend(unconfirmed(search, options)?);
        let (mut experiments, mut hints) = (Vec::new(), Vec::new());
        for (exam, added) in search.exams.iter().zip(&search.added) {
            let (told, hint) = next_experiments(exam, added)?;
            experiments.extend(told);
            hints.extend(hint);
        }
        let dependence = left.smooth.as_ref().and_then(|finding| dependence(last, finding, &left.asked));
        Ok(Conclusion { verdict: verdict(search), reasons, repeats, remains, dependence, experiments, hints })
    }
}

/// The verdict of a search.
fn verdict(search: &Search) -> Verdict {
    match (&search.left.smooth, search.added.len()) {
        _ if search.last().fitted.observed.runs.len() < FEWEST => Verdict::NotEnoughData,
        (Some(_), 0) => Verdict::UnlistedEffect,
        (None, 0) => Verdict::Explained,
        (None, 1) => Verdict::MissingEffect,
        _ => Verdict::SeveralMissing,
    }
}

/// Drives that would separate the members of a certified class; for members that no drive separates, the advice of their own pages.
fn next_experiments(exam: &Examination, added: &Added) -> Result<(Vec<Experiment>, Vec<String>), FitError> {
    let Added { suspect, by } = added;
    let finding = match by {
        Found::Listed(finding) => finding,
        Found::Unlisted(repeated) => return Ok((experiments::of_laws(exam, repeated)?, Vec::new())),
    };
    let told = experiments::next(exam, &[finding], &[])?;
    let mut hints = Vec::new();
    for other in suspect.class.iter().filter(|name| **name != suspect.best) {
        if told.iter().all(|experiment| !experiment.separates.contains(other)) {
            let how = [suspect.best, other].map(|name| find(name).map(|effect| effect.about.separated_by));
            let [own, others] = [how[0].clone()?, how[1].clone()?];
            let best = suspect.best;
            hints.push(format!("No planned drive separates {best} from {other}. {best}: {own}. {other}: {others}."));
        }
    }
    Ok((told, hints))
}

/// A remark on a suspect that is very significant by F but not by sign flips, because the runs are too few or too different, unless a reason
/// for doubt says so.
pub(crate) fn uncertified(asked: &[Suspect], reasons: &[Reason], options: &Options) -> Option<String> {
    let is_told = reasons.iter().any(|reason| matches!(reason, Reason::Unconfirmed { .. }));
    let loud = asked.first().filter(|s| !is_told && s.p < LOUD && s.p_adjusted > options.size)?;
    Some(format!(
        "{} is significant by F (p = {:.0e}), but not under sign flips of whole runs (p = {:.2}): more runs are needed.",
        loud.class.join(" or "),
        loud.p,
        loud.p_adjusted
    ))
}

/// The diagnosis of the final model, of which `fitted` is told: what the data cannot show, and further remarks.
pub(crate) fn of_model(
    exam: Examination,
    dependence: Option<Dependence>,
    fitted: Vec<Estimate>,
    options: &Options,
) -> Result<Diagnosis, FitError> {
    let (invisible, minimum_detectable) = visibility(&exam);
    let confounders = confounders(&exam, &fitted, 1.0 - options.size);
    Ok(Diagnosis {
        level: Level::Tracks,
        verdict: Verdict::Explained,
        fitted,
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
        confounders,
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

/// An effect is shown with 80 % probability at 5 % where it moves the observations by so many standard deviations.
pub(super) fn surely() -> f64 {
    normal_quantile(0.975) + normal_quantile(0.8)
}

/// What the data cannot show, and the minimum detectable sizes.
fn visibility(exam: &Examination) -> (Vec<Unseen>, Vec<Detectable>) {
    let products = &exam.system.whole;
    let (mut unseen, mut detectable) = (Vec::new(), Vec::new());
    for (index, effect, parameters) in exam.representatives() {
        let projected = Projected::new(products, &exam.base(Some(index)));
        let mut why = None;
        let mut seen = false;
        for (column, parameter) in exam.asked[index].columns.iter().zip(parameters) {
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
            detectable.push(Detectable { effect, parameter, size: surely() / strength });
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
    Likeness::new(&names, &DMatrix::from_fn(sizes.len(), sizes.len(), of))
}

/// The effects of the base that a column is most like.
fn absorbing(exam: &Examination, products: &DMatrix<f64>, base: &[usize], column: usize) -> Vec<&'static str> {
    let alike = |other: &usize| {
        let lengths = (products[(*other, *other)] * products[(column, column)]).sqrt();
        (products[(*other, column)] / lengths.max(f64::MIN_POSITIVE)).abs()
    };
    let nearest = base.iter().max_by(|a, b| alike(a).total_cmp(&alike(b)));
    nearest.and_then(|column| exam.name(*column)).into_iter().collect()
}

/// Tests of the model as a whole: repeating errors along the path, and correlated innovations.
fn whole_model(exam: &Examination, options: &Options) -> Vec<GoodnessOfFit> {
    let mut tests: Vec<GoodnessOfFit> = significance::smooths(exam, options)
        .iter()
        .filter_map(|finding| {
            let name = match &exam.asked[finding.answer.asked].question {
                Question::Smooth(covariate, motion) if covariate.name == ALONG_THE_WAY => match motion {
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
            "An effect outside the catalogue acts on the {} motion and depends on {} (p = {:.2e}).",
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
