//! What a model is missing, and a model that grows by it: one effect after the other, and what no longer helps taken out again. Where no
//! effect of the catalogue is certified and something repeats all the same, the law that it follows is added.

use super::class;
use super::examination::Examination;
use super::finding::{Finding, TELLING};
use super::growth;
use super::repeats::{self, Repeated, UnlistedLaw};
use super::responses::Asked;
use super::significance;
use crate::diagnose::options::Options;
use crate::diagnose::suspect::Suspect;
use crate::effect::{Law, Model, Part};
use crate::evidence::tracks::LEAST_GAIN;
use crate::evidence::tracks::Misses;
use crate::evidence::tracks::Projected;
use crate::evidence::tracks::estimates;
use crate::evidence::tracks::{Alone, trusted};
use crate::evidence::{Estimate, FitError};
use crate::likelihood::{Fitted, Noise};
use crate::watch::Watch;
use std::borrow::Cow;

/// A smooth speaks for an unlisted effect where the best effect of the catalogue explains less than this share of it.
const EXPLAINED: f64 = 0.85;
/// So many certified effects are tried for their gain.
const TRIES: usize = 4;
/// Fewer runs give no certificate.
pub(super) const FEWEST: usize = 2;
/// A law that no catalogue lists is added where positions or headings of runs left out fall by this share, or what is new from pose to pose by
/// the second, and so many laws at most.
const WORTH_A_LAW: f64 = 0.05;
const WORTH_BY_POSES: f64 = 0.15;
const MOST_LAWS: usize = 3;
/// A law that no catalogue lists comes before an effect that explains less than this share of what it does.
const OUTDONE: f64 = 0.5;
/// An effect by which the standard error of E_d, E_b or E_s grows by more than this factor needs a p of at most this share of the usual one. A
/// law that is not in the catalogue is not added then: these runs hardly separate it from them.
const WIDE: f64 = 2.0;
const SURE: f64 = 0.2;
/// A fit with an effect more went astray where its error is so many times as large.
const ASTRAY: f64 = 2.0;

/// What a fitted model is missing.
pub(crate) struct Missing {
    /// The certified effect that would be added.
    pub effect: Option<(Finding, Suspect)>,
    /// A certified smooth that this effect, or none, explains.
    pub smooth: Option<Finding>,
    /// All effects that were asked, the likeliest first.
    pub asked: Vec<Suspect>,
}

/// Looks for what is missing and not refused.
fn missing(exam: &Examination, options: &Options, refused: &[&str]) -> Missing {
    let findings = significance::effects(exam, options);
    let smooth = significance::smooths(exam, options).iter().find(|s| s.certified(options)).cloned();
    let enough = exam.fitted.observed.runs.len() >= FEWEST;
    let best = if enough { first_with_gain(exam, &findings, options, refused) } else { None };
    let unexplained = smooth.filter(|smooth| !explains(exam, best, smooth) && smooth_gains(exam, smooth));
    Missing {
        effect: best.and_then(|finding| class::suspect(exam, finding).map(|suspect| (finding.clone(), suspect))),
        smooth: unexplained,
        asked: findings.iter().filter_map(|finding| class::suspect(exam, finding)).collect(),
    }
}

/// Whether an effect explains as much as a smooth does, both asked beside the same.
pub(super) fn explains(exam: &Examination, effect: Option<&Finding>, smooth: &Finding) -> bool {
    let Some(effect) = effect else { return false };
    let whole = &exam.system.whole;
    let beside = Projected::new(whole, effect.base());
    let drop = exam.answer(&beside, whole, smooth.answer.asked).map_or(0.0, |answer| answer.drop);
    effect.answer.drop >= EXPLAINED * drop
}

/// The first certified effect with which runs left out are predicted better, the choice being made anew without each.
///
/// Physics comes before the reference: an effect is asked beside all effects of the reference and stands for itself, where a
/// delay, asked without itself, takes a share of what physics explains better.
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

/// Whether an effect is certain enough. One that doubles the standard error of E_d, E_b or E_s is separated from them by little, such as the
/// ramps of turns that are all alike; a mistake there makes every other drive worse, so it needs a smaller p.
fn is_sure(exam: &Examination, finding: &Finding, options: &Options) -> bool {
    finding.p_adjusted() <= SURE * options.size || exam.widening(&finding.answer.columns) <= WIDE
}

/// Whether runs left out are predicted better with a smooth.
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

/// Something that was missing and was added.
#[derive(Clone)]
pub(crate) struct Added {
    /// What it is, how sure that is, and what cannot be told from it.
    pub suspect: Suspect,
    /// How.
    pub by: Found,
}

/// How something that was missing was found.
#[derive(Clone)]
pub(crate) enum Found {
    /// Among the effects of the catalogue.
    Listed(Finding),
    /// Among the laws that no catalogue lists.
    Unlisted(Box<Repeated>),
}

/// A model that has grown by an effect.
struct Grown {
    exam: Examination,
    /// As it is written.
    written: Alone,
    /// Effects that no longer helped and were taken out.
    removed: Vec<&'static str>,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Effects of the catalogue.
    Listed,
    /// These, and laws that it does not list.
    All,
}

/// What was found missing, one effect after the other, each fitted before the next was asked about.
pub(crate) struct Search {
    /// The model as it was, and after each effect.
    pub exams: Vec<Examination>,
    /// Each of them as it is written.
    pub written: Vec<Alone>,
    /// The effects.
    pub added: Vec<Added>,
    /// Effects that no longer helped once others were there, and were taken out again.
    pub removed: Vec<&'static str>,
    /// Certified effects with which runs left out are predicted worse; they were not added.
    pub harmful: Vec<&'static str>,
    /// What the last model is missing and was not added.
    pub left: Missing,
    /// What repeats most beside the last model, once it was asked for.
    repeats: Option<Option<Repeated>>,
    /// Formulas that were tried and taken back.
    refused_laws: Vec<String>,
    /// Whether a law that explains more than the effect that would be added could not be.
    law_failed: bool,
}

/// Adds what is certified as missing and `wanted`, at most `most` effects and none of those `refused`, each fitted without approximation
/// before the next is asked; once stopped, no more.
pub(crate) fn search(
    fitted: Fitted,
    options: &Options,
    (most, wanted): (usize, Wanted),
    refused: Vec<&'static str>,
    watch: &Watch,
) -> Result<Search, FitError> {
    let mut exam = Examination::new(fitted)?;
    // What was taken from the motion is asked whether it helps, as all that is added here is; what the user's model says stands.
    let taken: Vec<&str> = exam.fitted.taken.iter().map(|taken| taken.effect).collect();
    let mut removed = Vec::new();
    while let Some(effect) = silent(&exam, |effect| taken.contains(&effect)) {
        exam = Examination::new(without(&exam.fitted, effect)?)?;
        removed.push(effect);
    }
    let left = missing(&exam, options, &[&refused[..], &removed].concat());
    let written = vec![trusted(exam.fitted.clone())?];
    let mut search = Search {
        exams: vec![exam],
        written,
        added: Vec::new(),
        removed,
        harmful: Vec::new(),
        left,
        repeats: None,
        refused_laws: Vec::new(),
        law_failed: false,
    };
    search.grow(options, (most, wanted), &refused, watch)?;
    while search.undo_harm() {
        search.left = missing(search.last(), options, &search.passed(&refused));
        search.grow(options, (most, wanted), &refused, watch)?;
    }
    Ok(search)
}

/// A fit without one of its effects.
fn without(fitted: &Fitted, effect: &str) -> Result<Fitted, FitError> {
    let taken = fitted.taken.iter().filter(|taken| taken.effect != effect).copied().collect();
    let again = fitted.observed.fit(&fitted.model.without(effect), &Noise::default(), &[])?;
    Ok(Fitted { taken, ..again })
}

/// Whether a fit ended far from the one before it: with an effect more, no model need miss by more.
fn astray(exam: &Examination, before: &Examination) -> bool {
    let [now, then] = [exam, before].map(|exam| exam.errors.in_sample().position);
    now > ASTRAY * then
}

/// An effect among those `asked` that does not help: none of its sizes is known to be other than nothing, or runs left out are predicted
/// as well without it.
fn idle(exam: &Examination, asked: impl Fn(&'static str) -> bool) -> Option<&'static str> {
    silent(exam, &asked).or_else(|| last_part(exam, asked, |part| !helps(exam, part.effect.name())))
}

/// An effect among those `asked` of which no size is known to be other than nothing.
fn silent(exam: &Examination, asked: impl Fn(&'static str) -> bool) -> Option<&'static str> {
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

/// The last added of the effects that are fitted, `asked` and such.
fn last_part(
    exam: &Examination,
    asked: impl Fn(&'static str) -> bool,
    is_such: impl Fn(&Part) -> bool,
) -> Option<&'static str> {
    let parts = exam.fitted.model.parts().iter().filter(|part| part.free && asked(part.effect.name()));
    parts.rev().find(|part| is_such(part)).map(|part| part.effect.name())
}

/// Whether runs left out are predicted better with an effect of the model than without it.
fn helps(exam: &Examination, effect: &str) -> bool {
    let [with, without] = with_and_without(exam, effect);
    exam.columns_of(effect).is_empty() || with.gain(&without) >= LEAST_GAIN
}

/// Errors of runs left out with an effect of the model, and without it, the others fitted anew.
fn with_and_without(exam: &Examination, effect: &str) -> [Misses; 2] {
    let own = exam.columns_of(effect);
    let beside: Vec<usize> = exam.base(None).into_iter().filter(|column| !own.contains(column)).collect();
    let of_reference: Vec<usize> = beside.iter().copied().filter(|column| !exam.free.contains(column)).collect();
    [exam.left_out(&of_reference), exam.left_out_without(&own, &beside)]
}

impl Search {
    /// Adds what is certified as missing, one effect after the other.
    fn grow(
        &mut self,
        options: &Options,
        (most, wanted): (usize, Wanted),
        refused: &[&'static str],
        watch: &Watch,
    ) -> Result<(), FitError> {
        while self.added.len() < most && !watch.is_stopped() {
            (watch.progress)((self.added.len() + 1) as f64 / (most + 1) as f64);
            let outdone = wanted == Wanted::All && self.is_outdone(options);
            if let Some((finding, suspect)) = self.left.effect.clone().filter(|_| !outdone) {
                let exam = self.last().of_grown(growth::grown(self.last(), &suspect)?)?;
                let Some(grown) = self.borne_out(exam, suspect.best)? else {
                    self.removed.push(suspect.best);
                    self.left = missing(self.last(), options, &self.passed(refused));
                    continue;
                };
                if !self.left.smooth.as_ref().is_some_and(|smooth| speaks_on(&grown.exam, smooth, options)) {
                    self.take(grown, Added { suspect, by: Found::Listed(finding) });
                    self.left = missing(self.last(), options, &self.passed(refused));
                    continue;
                }
            }
            let next = if wanted == Wanted::All { self.law(options)? } else { None };
            let Some((grown, added)) = next else {
                if outdone {
                    self.law_failed = true;
                    continue;
                }
                break;
            };
            self.take(grown, added);
            self.left = missing(self.last(), options, &self.passed(refused));
        }
        Ok(())
    }

    /// A model grown by an effect, less those that no longer help beside it, and which they are; `None` where a fit without approximation
    /// does not bear the effect out.
    fn borne_out(&self, mut exam: Examination, effect: &'static str) -> Result<Option<Grown>, FitError> {
        if astray(&exam, self.last()) || idle(&exam, |asked| asked == effect).is_some() {
            return Ok(None);
        }
        let first = &self.exams[0].fitted;
        let taken: Vec<&str> = first.taken.iter().map(|taken| taken.effect).collect();
        let own: Vec<&str> = first.model.parts().iter().map(|part| part.effect.name()).collect();
        let stands = |effect: &str| own.contains(&effect) && !taken.contains(&effect);
        let (mut kept, mut removed) = (vec![effect], Vec::new());
        while let Some(effect) = idle(&exam, |effect| !stands(effect) && !kept.contains(&effect)) {
            let fewer = Examination::new(without(&exam.fitted, effect)?)?;
            // That it helps no longer was seen in one step; the fit has to say so too.
            let is_silent = silent(&exam, |asked| asked == effect).is_some();
            if !is_silent && exam.left_out(&[]).gain(&fewer.left_out(&[])) >= LEAST_GAIN {
                kept.push(effect);
            } else {
                exam = fewer;
                removed.push(effect);
            }
        }
        let written = trusted(exam.fitted.clone())?;
        Ok(Some(Grown { exam, written, removed }))
    }

    /// The model grown by the law that what repeats follows, where it counts and a fit bears it out.
    fn law(&mut self, options: &Options) -> Result<Option<(Grown, Added)>, FitError> {
        while let Some(repeated) = self.repeats(options).cloned().filter(|repeated| repeated.counts(WORTH_A_LAW)) {
            let tried =
                |law: &UnlistedLaw| law.model.as_ref().is_none_or(|model| self.refused_laws.contains(&text_of(model)));
            if self.added.iter().filter(|added| matches!(added.by, Found::Unlisted(_))).count() >= MOST_LAWS {
                return Ok(None);
            }
            let wanted = if self.has_law() { 1 } else { options.law };
            let Some(mut repeated) = repeated.taking(wanted, tried) else { return Ok(None) };
            let Some(model) = repeated.law.model.clone() else { return Ok(None) };
            let observed = &self.last().fitted.observed;
            if observed.tracks().any(|track| track.check(&model).is_err()) {
                self.refused_laws.push(text_of(&model));
                continue;
            }
            let (fitted, name) = growth::grown_by_law(self.last(), &model)?;
            let exam = self.last().of_grown(fitted)?;
            let is_told = exam.widening(&exam.columns_of(name)) <= WIDE;
            let borne_out = if is_told { self.borne_out(exam, name)? } else { None };
            if let Some(grown) = borne_out.filter(|grown| self.is_worth_a_law(grown, name)) {
                let suspect = repeats::suspect(&repeated, name, &grown.exam);
                repeated.law = repeated.law.fitted(name, &grown.exam);
                return Ok(Some((grown, Added { suspect, by: Found::Unlisted(Box::new(repeated)) })));
            }
            self.refused_laws.push(text_of(&model));
        }
        Ok(None)
    }

    /// Whether a law that a model has grown by predicts runs left out better: positions or headings, or by far what is new from pose to pose,
    /// and neither positions nor headings worse. No physics speaks for such a law, so what it predicts has to.
    fn is_worth_a_law(&self, grown: &Grown, name: &str) -> bool {
        let before = self.written[self.written.len() - 1].left_out();
        let [least, most] = grown.written.left_out().falls(&before);
        let [with, without] = with_and_without(&grown.exam, name);
        least >= -LEAST_GAIN && (most >= WORTH_A_LAW || with.white_fall(&without) >= WORTH_BY_POSES)
    }

    /// Whether a law that no catalogue lists explains far more than the effect that would be added.
    fn is_outdone(&mut self, options: &Options) -> bool {
        let Some((finding, _)) = &self.left.effect else { return false };
        let drop = finding.answer.drop;
        let law_failed = self.law_failed;
        let repeated = self.repeats(options).filter(|repeated| repeated.counts(WORTH_A_LAW));
        !law_failed && repeated.is_some_and(|repeated| drop < OUTDONE * repeated.law.drop)
    }

    /// What repeats most beside the last model.
    pub fn repeats(&mut self, options: &Options) -> Option<&Repeated> {
        if self.repeats.is_none() {
            self.repeats = Some(repeats::beside(self.last(), options.seed));
        }
        self.repeats.as_ref().and_then(Option::as_ref)
    }

    /// What was added and is in the last model, each with the fit that it led to: without what was added on the way and taken out again.
    pub fn story(&self) -> Result<Vec<(&Added, Cow<'_, Alone>)>, FitError> {
        let mut told = Vec::new();
        for (written, added) in self.written[1..].iter().zip(&self.added) {
            if !self.keeps(added.suspect.best) {
                continue;
            }
            let parts = written.fitted().model.parts().iter().map(|part| part.effect.name());
            let mut gone = parts.filter(|effect| !self.keeps(effect)).peekable();
            if gone.peek().is_none() {
                told.push((added, Cow::Borrowed(written)));
                continue;
            }
            let mut fitted = written.fitted().clone();
            for effect in gone {
                fitted = without(&fitted, effect)?;
            }
            told.push((added, Cow::Owned(trusted(fitted)?)));
        }
        Ok(told)
    }

    /// Whether an effect is in the last model.
    pub fn keeps(&self, effect: &str) -> bool {
        self.last().fitted.model.parts().iter().any(|part| part.effect.name() == effect)
    }

    /// Whether an effect is in the last model, and no size of it is known to be other than nothing.
    pub fn is_needless(&self, effect: &str) -> bool {
        silent(self.last(), |asked| asked == effect).is_some()
    }

    /// The numbers in the table of laws of those that were added.
    pub fn laws(&self) -> impl Iterator<Item = usize> {
        self.added.iter().filter_map(|added| match &added.by {
            Found::Unlisted(repeated) => Some(repeated.law.number),
            Found::Listed(_) => None,
        })
    }

    /// Whether a law that no catalogue lists was added.
    pub fn has_law(&self) -> bool {
        self.added.iter().any(|added| matches!(added.by, Found::Unlisted(_)))
    }

    /// Goes on from a model that has grown.
    fn take(&mut self, Grown { exam, written, removed }: Grown, added: Added) {
        let before = self.last().fitted.model.clone();
        for effect in removed {
            self.refuse(&before, effect);
            self.removed.push(effect);
        }
        self.written.push(written);
        self.exams.push(exam);
        self.added.push(added);
        (self.repeats, self.law_failed) = (None, false);
    }

    /// Remembers a formula of a model that is taken out of it.
    fn refuse(&mut self, model: &Model, effect: &str) {
        let part = model.parts().iter().find(|part| part.effect.name() == effect);
        if let Some(Law::Formula(formula)) = part.map(|part| &part.effect) {
            self.refused_laws.push(formula.text().to_owned());
        }
    }

    /// Effects that are not asked for again, beside those `refused` from the beginning.
    fn passed(&self, refused: &[&'static str]) -> Vec<&'static str> {
        refused.iter().chain(&self.removed).chain(&self.harmful).copied().collect()
    }

    /// Takes back the last effect by which the last model predicts runs left out worse than before it, and all that came after; whether
    /// there is one.
    ///
    /// An effect that does harm alone is not refused at once: where two are missing, what the second does may hide in the values until
    /// both are there.
    fn undo_harm(&mut self) -> bool {
        let errors: Vec<Misses> = self.written.iter().map(Alone::left_out).collect();
        let Some(before) = errors.iter().rposition(|before| errors[errors.len() - 1].harms(before)) else {
            return false;
        };
        let effect = self.added[before].suspect.best;
        let model = self.exams[before + 1].fitted.model.clone();
        self.refuse(&model, effect);
        self.harmful.push(effect);
        self.repeats = None;
        self.added.truncate(before);
        self.exams.truncate(before + 1);
        self.written.truncate(before + 1);
        let kept = self.exams[before].fitted.model.parts();
        self.removed.retain(|effect| kept.iter().all(|part| part.effect.name() != *effect));
        true
    }

    /// The last examination.
    pub fn last(&self) -> &Examination {
        &self.exams[self.exams.len() - 1]
    }
}

/// The formula that a law is written as.
fn text_of(law: &Model) -> String {
    let formula = law.parts().first().and_then(|part| part.effect.formula());
    formula.map_or_else(String::new, |formula| formula.text().to_owned())
}

/// Whether a smooth that an effect seemed not to explain is there after that effect was fitted. What one linear step
/// leaves of a large effect is gone then; what is not in the catalogue is not.
pub(super) fn speaks_on(exam: &Examination, smooth: &Finding, options: &Options) -> bool {
    let mut now = significance::smooths(exam, options).iter().filter(|finding| finding.certified(options));
    now.any(|finding| finding.answer.drop > (1.0 - EXPLAINED) * smooth.answer.drop)
}
