//! Diagnosis from tick logs with absolute poses on the way.
//!
//! One replay for each size of each effect gives the columns of a linear model around the fit; whitened by the likelihood
//! ([`crate::likelihood`]), all tests follow from their products. An effect is certified as missing where three things hold: its F
//! stands out of all effects asked (Bonferroni), so does its score when the signs of runs are flipped, which trusts no
//! noise model, and runs that are left out are predicted better with it, the choice being made anew without each.
//!
//! Smooth functions of how the robot drives stand beside the catalogue: where one explains clearly more than the best
//! effect does, something is missing that the catalogue does not list.

mod errors;
mod examination;
mod flips;
mod look;
mod smooth;
mod system;

use super::{
    Dependence, Detectable, DiagnoseError, Diagnosis, Estimate, GoodnessOfFit, Identifiability, Level, Likeness,
    Options, Suspect, Unseen, Verdict, Why,
};
use crate::diagnose::likeness::correlations;
use crate::likelihood::{Fitted, Observed};
use crate::stats::{chi_squared_upper_tail, normal_quantile};
use examination::Question;
use system::Projected;

pub use errors::Misses;
pub(crate) use examination::Examination;
pub(crate) use look::Finding;

/// Share by which errors in runs left out must fall for an effect to count: less is not worth a parameter.
pub const LEAST_GAIN: f64 = 0.02;
/// A smooth speaks for an unlisted effect where the best effect of the catalogue explains less than this share of it.
const EXPLAINED: f64 = 0.85;
/// Share by which errors in runs left out must fall for an unlisted effect to be spoken of.
const TELLING: f64 = 0.1;
/// So many certified effects are tried for their gain.
const TRIES: usize = 4;
/// Fewer runs give no certificate.
const FEWEST: usize = 2;

/// What a fitted model is missing, in the order in which it would be added.
pub(crate) struct Missing {
    /// Certified effects, each asked beside those before it.
    pub effects: Vec<(Finding, Suspect)>,
    /// All other effects, the likeliest first.
    pub others: Vec<Suspect>,
    /// A certified smooth that the effects do not explain.
    pub smooth: Option<(Finding, Dependence)>,
}

/// Looks for what is missing, at most `most` effects.
pub(crate) fn missing(exam: &Examination, options: &Options, most: usize) -> Missing {
    let mut found: Vec<usize> = Vec::new();
    let mut effects = Vec::new();
    loop {
        let findings = look::look(exam, &found, false, options);
        let smooth = look::look(exam, &found, true, options).into_iter().next().filter(|s| s.certified(options));
        let enough = effects.len() < most && exam.fitted.observed.runs.len() >= FEWEST;
        let best = if enough { first_with_gain(exam, &findings, &found, options) } else { None };
        let explains = best.map_or(0.0, |finding| finding.answer.drop);
        let unlisted = smooth.filter(|s| explains < EXPLAINED * s.answer.drop && smooth_gains(exam, s, &found));
        let next = best.filter(|_| unlisted.is_none());
        if let Some((finding, suspect)) = next.and_then(|f| look::suspect(exam, f, &found).map(|s| (f, s))) {
            found.extend(&finding.answer.columns);
            effects.push((finding.clone(), suspect));
            continue;
        }
        let others = findings.iter().filter_map(|finding| look::suspect(exam, finding, &found)).collect();
        let smooth = unlisted.and_then(|finding| dependence(exam, &finding).map(|told| (finding, told)));
        return Missing { effects, others, smooth };
    }
}

/// The first certified effect with which runs left out are predicted better, the choice being made anew without each.
///
/// Physics comes before the reference: an effect is asked beside all effects of the reference and stands for itself, where a
/// delay, asked without itself, takes a share of what physics explains better.
fn first_with_gain<'a>(
    exam: &Examination,
    findings: &'a [Finding],
    found: &[usize],
    options: &Options,
) -> Option<&'a Finding> {
    let nuisance = |finding: &Finding| exam.asked[finding.answer.asked].nuisance;
    for of_reference in [false, true] {
        let mut passed: Vec<&str> = Vec::new();
        let own = findings.iter().filter(|f| nuisance(f) == of_reference && f.certified(options));
        let own = own.filter(|f| look::possible(exam, f));
        for finding in own.take(TRIES) {
            let wanted = |asked: &examination::Asked| {
                let name = asked.effect().map_or("", |effect| effect.about.name);
                asked.nuisance == of_reference && !passed.contains(&name)
            };
            // Effects of the reference are in both predictions, so that the gain is the effect's own.
            let others = exam.base(Some(finding.answer.asked)).into_iter().filter(|c| !exam.free.contains(c));
            let beside: Vec<usize> = found.iter().copied().chain(others).collect();
            let before = exam.left_out(&beside);
            let after = exam.left_out_with(&beside, |products| exam.likeliest(products, found, wanted));
            if after.gain(&before) >= LEAST_GAIN {
                return Some(finding);
            }
            passed.extend(exam.asked[finding.answer.asked].effect().map(|effect| effect.about.name));
        }
    }
    None
}

/// Whether runs left out are predicted better with a smooth.
fn smooth_gains(exam: &Examination, finding: &Finding, found: &[usize]) -> bool {
    let own = &finding.answer.columns;
    let errors = exam.errors_with(&[found, own].concat());
    let of = |columns: Vec<usize>| {
        errors.misses(|run| {
            let products = exam.system.sum(|unit| unit.run != run);
            let values = Projected::fit(&products, &columns);
            (columns.clone(), values)
        })
    };
    let base = [&exam.base(None)[..], found].concat();
    of([&base[..], own].concat()).gain_along(&of(base.clone())) >= TELLING
}

/// A smooth, for people.
fn dependence(exam: &Examination, finding: &Finding) -> Option<Dependence> {
    let Question::Smooth(covariate, motion) = &exam.asked[finding.answer.asked].question else { return None };
    Some(Dependence {
        acts_on: motion.name(),
        depends_on: covariate.name,
        title: covariate.title,
        p_adjusted: finding.p_adjusted(),
        drop: finding.answer.drop,
    })
}

/// Fits a model's free parameters to tracks and asks every other effect, and every smooth, whether it is missing.
pub(crate) fn diagnose(fitted: Fitted, options: &Options) -> Result<Diagnosis, DiagnoseError> {
    let exam = Examination::new(fitted)?;
    let found = missing(&exam, options, 3);
    Ok(conclude(exam, found, options))
}

/// The diagnosis of a model from what was found missing.
pub(crate) fn conclude(exam: Examination, missing: Missing, options: &Options) -> Diagnosis {
    let verdict = match (&missing.smooth, missing.effects.len()) {
        _ if exam.fitted.observed.runs.len() < FEWEST => Verdict::NotEnoughData,
        (Some(_), 0) => Verdict::UnlistedEffect,
        (None, 0) => Verdict::Explained,
        (None, 1) => Verdict::MissingEffect,
        _ => Verdict::SeveralMissing,
    };
    let certified = missing.effects.len();
    let mut ranking: Vec<Suspect> = missing.effects.into_iter().map(|(_, suspect)| suspect).collect();
    ranking.extend(missing.others);
    let (invisible, minimum_detectable) = visibility(&exam);
    Diagnosis {
        level: Level::Tracks,
        verdict,
        fitted: estimates(&exam.fitted),
        correlations: correlations(exam.fitted.covariance.as_ref()),
        likeness: likeness(&exam),
        goodness_of_fit: whole_model(&exam, options),
        ranking,
        certified,
        invisible,
        minimum_detectable,
        next_experiments: Vec::new(),
        contrasts: Vec::new(),
        circle: Vec::new(),
        identifiability: Identifiability { shares: Vec::new(), rank: exam.free.len(), hidden: Vec::new() },
        remarks: remarks(&exam, missing.smooth.as_ref().map(|(_, told)| told)),
        dependence: missing.smooth.map(|(_, told)| told),
        model: exam.fitted.model,
    }
}

/// The fitted parameters with their standard errors.
pub(crate) fn estimates(fitted: &Fitted) -> Vec<Estimate> {
    let model = &fitted.model;
    let names = model
        .parts()
        .iter()
        .flat_map(|part| part.effect.parameters().iter().map(|parameter| (part.effect.name(), parameter.name)));
    let (names, values): (Vec<_>, Vec<f64>) = (names.collect(), model.values().collect());
    let of = |(k, index): (usize, &usize)| Estimate {
        effect: names[*index].0,
        parameter: names[*index].1,
        value: values[*index],
        standard_error: fitted.covariance.as_ref().map_or(f64::NAN, |c| c[(k, k)].max(0.0).sqrt()),
        degrees_of_freedom: (fitted.observed.runs.len().max(2) - 1) as f64,
    };
    fitted.free.iter().enumerate().map(of).collect()
}

/// What the data cannot see, and the least that it would see.
fn visibility(exam: &Examination) -> (Vec<Unseen>, Vec<Detectable>) {
    let products = exam.system.sum(|_| true);
    let surely = normal_quantile(0.975) + normal_quantile(0.8);
    let (mut unseen, mut detectable) = (Vec::new(), Vec::new());
    for (index, asked) in exam.asked.iter().enumerate() {
        let Question::Effect(effect, parameters) = &asked.question else { continue };
        let projected = Projected::new(&products, &exam.base(Some(index)));
        let mut why = None;
        let mut seen = false;
        for (column, parameter) in asked.columns.iter().zip(parameters) {
            if projected.absorbed(&products, *column) {
                why = why.or_else(|| Some(Why::Absorbed(absorbing(exam, &products, &projected.base, *column))));
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
    let products = exam.system.sum(|_| true);
    let projected = Projected::new(&products, &exam.free);
    let mut sizes: Vec<(&'static str, usize, f64)> = Vec::new();
    for asked in &exam.asked {
        let Question::Effect(effect, parameters) = &asked.question else { continue };
        let seen = asked.columns.iter().zip(parameters).filter(|(c, _)| !projected.absorbed(&products, **c));
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
    let mut tests: Vec<GoodnessOfFit> = look::look(exam, &[], true, options)
        .into_iter()
        .filter_map(|finding| {
            let told = dependence(exam, &finding).filter(|told| told.depends_on == smooth::ALONG_THE_WAY)?;
            let name = match told.acts_on {
                "forward" => "forward errors repeat along the way",
                "sideways" => "sideways errors repeat along the way",
                _ => "yaw errors repeat along the way",
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
    }
    if exam.fitted.observed.runs.iter().any(|run| !run.start_seen) {
        remarks.push(format!(
            "START was not measured in every run: a scatter of {:.0} mm and {:.1} deg is assumed there.",
            1e3 * noise.start_position,
            noise.start_heading.to_degrees()
        ));
    }
    remarks.push(format!(
        "Noise found: heading {:.2} mrad per root metre and {:.2} mrad per root radian, forward {:.2} mm per root metre.",
        1e3 * noise.heading_per_metre,
        1e3 * noise.heading_per_radian,
        1e3 * noise.forward_per_metre
    ));
    remarks
}

/// Fits the free parameters of a model to tracks.
pub(crate) fn fit(observed: &Observed, model: &crate::effect::Model) -> Result<Fitted, DiagnoseError> {
    model.check_along(observed.tracks().flat_map(|track| track.contexts()))?;
    let fitted = observed.fit(model, &crate::likelihood::Noise::default(), &[])?;
    // Where the size of a formula began at 0, its shape shows only now.
    if model.has_formulas() && observed.free_values(&fitted.model).len() > fitted.free.len() {
        return Ok(observed.fit(&fitted.model, &fitted.noise, &[])?);
    }
    Ok(fitted)
}
