//! What a fitted model lacks: the certified effect that would be added, and a smooth that no effect explains.

use super::examination::Examination;
use super::finding::{Finding, TELLING};
use super::responses::Asked;
use super::{class, significance};
use crate::diagnose::options::Options;
use crate::diagnose::suspect::Suspect;
use crate::evidence::tracks::{LEAST_GAIN, Projected};

/// A smooth indicates an unlisted effect if the best effect of the catalogue explains less than this share of it.
const EXPLAINED: f64 = 0.85;
/// Maximum number of certified effects whose gain is tried.
const TRIES: usize = 4;
/// Minimum number of runs for a certificate.
pub(super) const FEWEST: usize = 2;
/// Where an effect widens the standard error of E_d, E_b or E_s by more than this factor, it needs a p of at most this share of the
/// usual level.
pub(super) const WIDE: f64 = 2.0;
const SURE: f64 = 0.2;

/// Twice the logarithm of the likelihood by which an effect may be less likely than another of its class, and is added in its place: a number of
/// the robot is.
const NEAR: f64 = 2.0;

/// What a fitted model is missing.
pub(crate) struct Missing {
    /// The certified effect that would be added.
    pub effect: Option<(Finding, Suspect)>,
    /// A certified smooth that this effect does not explain.
    pub smooth: Option<Finding>,
    /// All effects that were tested, the likeliest first.
    pub asked: Vec<Suspect>,
    /// Certified effects that these runs hardly separate from E_d, E_b and E_s.
    pub inseparable: Vec<&'static str>,
}

/// Looks for missing effects that are not refused.
pub fn missing(exam: &Examination, options: &Options, refused: &[&str]) -> Missing {
    let findings = significance::effects(exam, options);
    let smooth = significance::smooths(exam, options).iter().find(|s| s.certified(options)).cloned();
    let enough = exam.fitted.observed.runs.len() >= FEWEST;
    let best = if enough { first_with_gain(exam, &findings, options, refused) } else { None };
    let best = best.map(|best| as_number(exam, &findings, best, refused));
    let unexplained = smooth.filter(|smooth| !explains(exam, best, smooth) && smooth_gains(exam, smooth));
    let unsure = findings.iter().filter(|finding| finding.certified(options) && !is_sure(exam, finding, options));
    let name = |finding: &Finding| exam.asked[finding.answer.asked].effect().map(|effect| effect.about.name);
    Missing {
        effect: best.and_then(|finding| class::suspect(exam, finding).map(|suspect| (finding.clone(), suspect))),
        smooth: unexplained,
        asked: findings.iter().filter_map(|finding| class::suspect(exam, finding)).collect(),
        inseparable: unsure.filter_map(name).collect(),
    }
}

/// An effect that becomes a number of the robot, if these runs do not tell it from the one that was found; else that one.
fn as_number<'a>(exam: &Examination, findings: &'a [Finding], found: &'a Finding, refused: &[&str]) -> &'a Finding {
    let own = exam.fitted.model.robot().drive.own_effects();
    let name = |asked: usize| exam.asked[asked].effect().map_or("", |effect| effect.about.name);
    let is_number = |asked: usize| own.contains(&name(asked)) && !refused.contains(&name(asked));
    let mut numbers = class::rivals(exam, found).into_iter().filter(|_| !is_number(found.answer.asked));
    let rival = numbers.find(|rival| is_number(rival.asked) && rival.drop >= found.answer.drop - NEAR);
    let same = |finding: &&Finding| rival.as_ref().is_some_and(|rival| rival.asked == finding.answer.asked);
    findings.iter().find(same).unwrap_or(found)
}

/// Whether an effect explains as much as a smooth does, both tested beside the same columns.
pub(super) fn explains(exam: &Examination, effect: Option<&Finding>, smooth: &Finding) -> bool {
    let Some(effect) = effect else { return false };
    let whole = &exam.system.whole;
    let beside = Projected::new(whole, effect.base());
    let drop = exam.answer(&beside, whole, smooth.answer.asked).map_or(0.0, |answer| answer.drop);
    effect.answer.drop >= EXPLAINED * drop
}

/// The first certified effect with which held-out runs are predicted better, where it is chosen again without each run.
///
/// Physics comes before the reference: an effect is tested beside all effects of the reference, but a delay, tested without itself,
/// absorbs a share of what physics explains better.
fn first_with_gain<'a>(
    exam: &Examination,
    findings: &'a [Finding],
    options: &Options,
    refused: &[&str],
) -> Option<&'a Finding> {
    let nuisance = |finding: &Finding| exam.asked[finding.answer.asked].nuisance;
    for of_reference in [false, true] {
        let mut passed: Vec<&str> = refused.to_vec();
        let own = findings.iter().filter(|f| nuisance(f) == of_reference && f.certified(options));
        let is_refused =
            |f: &Finding| exam.asked[f.answer.asked].effect().is_some_and(|e| refused.contains(&e.about.name));
        let own = own.filter(|f| significance::possible(exam, f) && !is_refused(f) && is_sure(exam, f, options));
        for finding in own.take(TRIES) {
            let wanted = |asked: &Asked| {
                let name = asked.effect().map_or("", |effect| effect.about.name);
                asked.nuisance == of_reference && !passed.contains(&name)
            };
            // Effects of the reference are in both predictions, so that the gain is the effect's own.
            let beside: Vec<usize> = finding.base().iter().copied().filter(|c| !exam.free.contains(c)).collect();
            let before = exam.left_out(&beside);
            let after = exam.left_out_with(&beside, |products| exam.likeliest(products, wanted));
            if after.gain(&before) >= LEAST_GAIN {
                return Some(finding);
            }
            passed.extend(exam.asked[finding.answer.asked].effect().map(|effect| effect.about.name));
        }
    }
    None
}

/// Whether an effect is certain enough. An effect that doubles the standard error of E_d, E_b or E_s is separated from them only by
/// details, such as ramps of turns that are all alike. A mistake there would make predictions of every other drive worse, so it needs a
/// smaller p.
fn is_sure(exam: &Examination, finding: &Finding, options: &Options) -> bool {
    finding.p_adjusted() <= SURE * options.size || exam.widening(&finding.answer.columns) <= WIDE
}

/// Whether held-out runs are predicted better with a smooth.
fn smooth_gains(exam: &Examination, finding: &Finding) -> bool {
    let own = &finding.answer.columns;
    let errors = exam.errors_with(own);
    let of = |columns: Vec<usize>| {
        errors.misses(|run| {
            let values = Projected::fit(&exam.system.without(run), &columns);
            (columns.clone(), values)
        })
    };
    let base = exam.base(None);
    of([&base[..], own].concat()).gain(&of(base.clone())) >= TELLING
}

/// Whether a smooth that an effect did not seem to explain remains after the effect is fitted. The fit removes what one linear step leaves
/// of a large effect, but not an effect outside the catalogue.
pub fn speaks_on(exam: &Examination, smooth: &Finding, options: &Options) -> bool {
    let mut now = significance::smooths(exam, options).iter().filter(|finding| finding.certified(options));
    now.any(|finding| finding.answer.drop > (1.0 - EXPLAINED) * smooth.answer.drop)
}
