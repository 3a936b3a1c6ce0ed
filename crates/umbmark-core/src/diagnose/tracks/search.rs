//! The missing effects, added to the model one after the other; effects that no longer help are taken out again. Where no effect of the
//! catalogue is certified but something repeats, the law that it follows is added.

use super::examination::Examination;
use super::finding::Finding;
use super::growth;
use super::lags::{DELAY, LAGS, is_held, only_smooths};
use super::missing::{Missing, WIDE, missing, speaks_on};
use super::needless::{idle, with_and_without};
use super::repeats::{self, Repeated, UnlistedLaw};
use crate::diagnose::options::Options;
use crate::diagnose::suspect::Suspect;
use crate::effect::{About, ActsOn, CATALOGUE, Law, Model};
use crate::evidence::FitError;
use crate::evidence::tracks::{Alone, LEAST_GAIN, Misses, silent, trusted, without, without_silent_taken};
use crate::likelihood::Fitted;
use crate::watch::{Reached, Watch};
use std::borrow::Cow;

/// A law outside the catalogue is added where the error of positions or headings in held-out runs falls by this share, or the
/// innovations by the second; at most this many laws are added.
const WORTH_A_LAW: f64 = 0.05;
const WORTH_BY_POSES: f64 = 0.15;
const MOST_LAWS: usize = 3;
/// Where a law outside the catalogue widens the standard error of E_d, E_b or E_s by more than the first number, it speaks for half of what
/// the runs say of them. No physics supports it, so the errors of positions or headings must then fall by the second.
const WIDE_FOR_A_LAW: (f64, f64) = (1.4, 0.25);
/// An effect that is hardly separated from E_d, E_b and E_s is there beyond doubt where its size is more than this multiple of the
/// widening of their standard errors from zero \[standard errors\].
const OUTSTANDING: f64 = 4.0;
/// No effect that is hardly separated from E_d, E_b and E_s needs a greater gain than this.
const GAIN_ENOUGH: f64 = 0.1;
/// A law outside the catalogue is preferred to an effect that explains less than this share of what the law explains.
const OUTDONE: f64 = 0.5;
/// How long a metre of the odometry is.
const SCALE: &str = "scale";
/// A fit with one more effect failed where its error exceeds this multiple of the error before.
const ASTRAY: f64 = 2.0;

/// Something that was missing and was added.
#[derive(Clone)]
pub(crate) struct Added {
    /// What it is, how sure that is, and what is indistinguishable from it.
    pub suspect: Suspect,
    /// How.
    pub by: Found,
}

/// How something that was missing was found.
#[derive(Clone)]
pub(crate) enum Found {
    /// Among the effects of the catalogue.
    Listed(Finding),
    /// Among the laws outside the catalogue.
    Unlisted(Box<Repeated>),
}

/// A model that has grown by an effect.
struct Grown {
    exam: Examination,
    /// As it is written.
    written: Alone,
    /// Effects that no longer helped and were taken out.
    removed: Vec<&'static str>,
    /// Effects that are no longer separated well enough from E_d, E_b and E_s and were taken out.
    inseparable: Vec<&'static str>,
}

/// What came of adding an effect.
enum Growth {
    Stands(Box<Grown>),
    /// A fit without approximation does not bear it out.
    Idle,
    /// It is hardly separated from E_d, E_b and E_s and does not pay for that.
    Inseparable,
    /// The search was stopped before that was known.
    Stopped,
}

/// What may be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Effects of the catalogue.
    Listed,
    /// These, and laws that it does not list.
    All,
}

/// The missing effects, one after the other, each fitted before the next test.
pub(crate) struct Search {
    /// The model as it was, and after each effect.
    pub exams: Vec<Examination>,
    /// Each of them as it is written.
    pub written: Vec<Alone>,
    /// The effects.
    pub added: Vec<Added>,
    /// Effects that no longer helped once others were there, and were taken out again.
    pub removed: Vec<&'static str>,
    /// Certified effects with which held-out runs are predicted worse; they were not added.
    pub harmful: Vec<&'static str>,
    /// Certified effects that these runs hardly separate from E_d, E_b and E_s, for too small a gain; they were not added.
    pub inseparable: Vec<&'static str>,
    /// What the last model is missing and was not added.
    pub left: Missing,
    /// The strongest repeating pattern beside the last model, once it was looked for.
    repeats: Option<Option<Repeated>>,
    /// Effects that are not tested, from the beginning.
    refused: Vec<&'static str>,
    /// Formulas that were tried and taken back.
    refused_laws: Vec<String>,
    /// Whether a law that explains more than the effect that would be added could not be.
    law_failed: bool,
    /// Whether it was stopped before its end.
    pub stopped: bool,
}

/// Adds what is certified as missing and `wanted`, at most `most` effects and none of those `refused`, nor what bends
/// a scale that is refused. Each is fitted without approximation before the next test. Once stopped, no more are added.
pub(crate) fn search(
    fitted: Fitted,
    options: &Options,
    (most, wanted): (usize, Wanted),
    mut refused: Vec<&'static str>,
    watch: &Watch,
) -> Result<Search, FitError> {
    refused.extend(bent_scales(&refused));
    // Effects that were taken from the motion must help, as every effect added here; those of the user's model stay.
    let (fitted, removed) = without_silent_taken(fitted)?;
    let exam = Examination::new(fitted)?;
    let left = missing(&exam, options, &[&refused[..], &removed].concat());
    let written = vec![trusted(exam.fitted.clone())?];
    watch.reach(|| reached(&written[0], 0, None));
    let mut search = Search {
        exams: vec![exam],
        written,
        added: Vec::new(),
        removed,
        harmful: Vec::new(),
        inseparable: Vec::new(),
        left,
        repeats: None,
        refused,
        refused_laws: Vec::new(),
        law_failed: false,
        stopped: false,
    };
    search.grow(options, (most, wanted), watch)?;
    while !search.stopped && search.undo_harm() {
        search.left = missing(search.last(), options, &search.passed());
        search.grow(options, (most, wanted), watch)?;
    }
    Ok(search)
}

/// Effects of the reference that look like a scale, where that is refused: runs that do not show how long a metre is do not show either that
/// it is longer near the edge of a picture.
fn bent_scales(refused: &[&'static str]) -> Vec<&'static str> {
    let is_one = |about: &About| about.acts_on == ActsOn::Reference && about.confused_with.contains(&SCALE);
    let all = CATALOGUE.iter().map(|entry| &entry.about).filter(|about| refused.contains(&SCALE) && is_one(about));
    all.map(|about| about.name).collect()
}

/// Whether a fit ended far from the one before it: with an effect more, no model need miss by more.
fn astray(exam: &Examination, before: &Examination) -> bool {
    let [now, then] = [exam, before].map(|exam| exam.errors.in_sample().position);
    now > ASTRAY * then
}

/// An effect among those `asked` with values that a robot cannot have, in one of these fits.
fn incredible(fits: [&Fitted; 2], asked: impl Fn(&str) -> bool) -> Result<Option<&'static str>, FitError> {
    let mut parts = fits.into_iter().flat_map(|fitted| fitted.model.parts());
    let found = parts.find(|part| asked(part.effect.name()) && !part.is_credible()).map(|part| part.effect.name());
    for lag in LAGS {
        if found.is_none() && asked(lag) && only_smooths(fits[0], lag)? {
            return Ok(Some(lag));
        }
    }
    Ok(found)
}

/// An effect among those `asked` that is hardly separated from E_d, E_b and E_s and does not pay for it, and the model as it is written
/// without it.
///
/// Details alone separate it from them, such as ramps of turns that are all alike. What the model misses of these details then moves E_d,
/// E_b and E_s, as many times as far as their standard errors are wider, and with them the predictions of every other drive. Either the
/// errors of held-out positions or headings pay for that, by its square, or the effect is so large that no detail can be as large.
fn too_dear(
    exam: &Examination,
    written: &Alone,
    asked: impl Fn(&str) -> bool,
) -> Result<Option<(&'static str, Alone)>, FitError> {
    let effects: Vec<&'static str> = exam.fitted.model.parts().iter().map(|part| part.effect.name()).collect();
    let first = exam.fitted.model.robot().drive.first_effects();
    for effect in effects.into_iter().rev().filter(|effect| asked(effect) && !first.contains(effect)) {
        let widening = exam.widening(&exam.columns_of(effect));
        if widening > WIDE && !growth::stands_out(&exam.fitted, effect, OUTSTANDING * widening) {
            let fewer = trusted(without(&exam.fitted, effect)?)?;
            let [_, most] = written.left_out().falls(&fewer.left_out());
            if most < (LEAST_GAIN * widening.powi(2)).min(GAIN_ENOUGH) {
                return Ok(Some((effect, fewer)));
            }
        }
    }
    Ok(None)
}

/// A model as a step of what is told while the search goes on: the one that it begins with is step 0.
fn reached(written: &Alone, after: usize, added: Option<&Suspect>) -> Reached {
    let (inside, held_out) = written.misses();
    Reached {
        after,
        added: added.map(|suspect| suspect.best),
        p_adjusted: added.map(|suspect| suspect.p_adjusted),
        rmse: inside.position,
        heldout_rmse: held_out.position,
    }
}

impl Search {
    /// Adds what is certified as missing, one effect after the other.
    fn grow(&mut self, options: &Options, (most, wanted): (usize, Wanted), watch: &Watch) -> Result<(), FitError> {
        while self.added.len() < most {
            if watch.is_stopped() {
                self.stopped = true;
                return Ok(());
            }
            (watch.progress)((self.added.len() + 1) as f64 / (most + 1) as f64);
            let outdone = wanted == Wanted::All && self.is_outdone(options);
            if let Some((finding, suspect)) = self.left.effect.clone().filter(|_| !outdone) {
                let exam = self.last().of_grown(growth::grown(self.last(), &suspect)?)?;
                let grown = match self.borne_out(exam, suspect.best, watch)? {
                    Growth::Stands(grown) => grown,
                    Growth::Stopped => continue,
                    failed => {
                        let gone =
                            if matches!(failed, Growth::Idle) { &mut self.removed } else { &mut self.inseparable };
                        gone.push(suspect.best);
                        self.left = missing(self.last(), options, &self.passed());
                        continue;
                    }
                };
                if !self.left.smooth.as_ref().is_some_and(|smooth| speaks_on(&grown.exam, smooth, options)) {
                    self.take(*grown, Added { suspect, by: Found::Listed(finding) }, watch);
                    self.left = missing(self.last(), options, &self.passed());
                    continue;
                }
            }
            let next = if wanted == Wanted::All { self.law(options, watch)? } else { None };
            let Some((grown, added)) = next else {
                if watch.is_stopped() {
                    continue;
                }
                if outdone {
                    self.law_failed = true;
                    continue;
                }
                break;
            };
            self.take(grown, added, watch);
            self.left = missing(self.last(), options, &self.passed());
        }
        Ok(())
    }

    /// A model grown by an effect, less those that no longer help beside it, and which they are.
    fn borne_out(&self, mut exam: Examination, effect: &'static str, watch: &Watch) -> Result<Growth, FitError> {
        if astray(&exam, self.last()) || idle(&exam, |asked| asked == effect).is_some() {
            return Ok(Growth::Idle);
        }
        let first = &self.exams[0].fitted;
        let taken: Vec<&str> = first.taken.iter().map(|taken| taken.effect).collect();
        let own: Vec<&str> = first.model.parts().iter().map(|part| part.effect.name()).collect();
        let stands = |effect: &str| own.contains(&effect) && !taken.contains(&effect);
        let (mut kept, mut removed) = (vec![effect], Vec::new());
        while let Some(effect) = idle(&exam, |effect| !stands(effect) && !kept.contains(&effect)) {
            let fewer = Examination::new(without(&exam.fitted, effect)?)?;
            if watch.is_stopped() {
                return Ok(Growth::Stopped);
            }
            // One linear step shows that it no longer helps; the full fit must confirm it.
            let is_silent = silent(&exam.fitted, |asked| asked == effect).is_some();
            if !is_silent && exam.left_out(&[]).gain(&fewer.left_out(&[])) >= LEAST_GAIN {
                kept.push(effect);
            } else {
                exam = fewer;
                removed.push(effect);
            }
        }
        if LAGS.contains(&effect) && !stands(DELAY) && is_held(&exam.fitted, effect)? {
            exam = Examination::new(without(&exam.fitted, DELAY)?)?;
            if idle(&exam, |asked| asked == effect).is_some() {
                return Ok(Growth::Idle);
            }
            removed.push(DELAY);
        }
        let mut written = trusted(exam.fitted.clone())?;
        while let Some(incredible) = incredible([&exam.fitted, written.fitted()], |effect| !stands(effect))? {
            if incredible == effect {
                return Ok(Growth::Idle);
            }
            exam = Examination::new(without(&exam.fitted, incredible)?)?;
            written = trusted(exam.fitted.clone())?;
            removed.push(incredible);
            if watch.is_stopped() {
                return Ok(Growth::Stopped);
            }
        }
        let mut inseparable = Vec::new();
        while let Some((dear, fewer)) = too_dear(&exam, &written, |effect| !stands(effect))? {
            if dear == effect {
                return Ok(Growth::Inseparable);
            }
            exam = Examination::new(without(&exam.fitted, dear)?)?;
            written = fewer;
            inseparable.push(dear);
            if watch.is_stopped() {
                return Ok(Growth::Stopped);
            }
        }
        Ok(Growth::Stands(Box::new(Grown { exam, written, removed, inseparable })))
    }

    /// The model grown by the law that what repeats follows, where it counts and a fit bears it out.
    fn law(&mut self, options: &Options, watch: &Watch) -> Result<Option<(Grown, Added)>, FitError> {
        while let Some(repeated) = self.repeats(options).cloned().filter(|repeated| repeated.counts(WORTH_A_LAW)) {
            if watch.is_stopped() {
                return Ok(None);
            }
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
            let growth = if is_told { self.borne_out(exam, name, watch)? } else { Growth::Inseparable };
            if let Growth::Stands(grown) = growth
                && self.is_worth_a_law(&grown, name)
            {
                let suspect = repeats::suspect(&repeated, name, &grown.exam);
                repeated.law = repeated.law.fitted(name, &grown.exam);
                return Ok(Some((*grown, Added { suspect, by: Found::Unlisted(Box::new(repeated)) })));
            }
            self.refused_laws.push(text_of(&model));
        }
        Ok(None)
    }

    /// Whether a law that was added predicts held-out runs better: positions or headings, or the innovations by far, and neither
    /// positions nor headings worse, with the values that are written and with the likeliest ones. No physics supports such a law, so its
    /// predictions must.
    fn is_worth_a_law(&self, grown: &Grown, name: &str) -> bool {
        let before = self.written[self.written.len() - 1].left_out();
        let [least, most] = grown.written.left_out().falls(&before);
        let [with, without] = with_and_without(&grown.exam, name);
        let harmless = least.min(with.falls(&without)[0]) >= -LEAST_GAIN;
        if grown.exam.widening(&grown.exam.columns_of(name)) > WIDE_FOR_A_LAW.0 {
            return harmless && most >= WIDE_FOR_A_LAW.1;
        }
        harmless && (most >= WORTH_A_LAW || with.white_fall(&without) >= WORTH_BY_POSES)
    }

    /// Whether a law that no catalogue lists explains far more than the effect that would be added.
    fn is_outdone(&mut self, options: &Options) -> bool {
        let Some((finding, _)) = &self.left.effect else { return false };
        let drop = finding.answer.drop;
        let law_failed = self.law_failed;
        let repeated = self.repeats(options).filter(|repeated| repeated.counts(WORTH_A_LAW));
        !law_failed && repeated.is_some_and(|repeated| drop < OUTDONE * repeated.law.drop)
    }

    /// The strongest pattern that repeats in the residuals of the last model. A search that was stopped does not look for one any more.
    pub fn repeats(&mut self, options: &Options) -> Option<&Repeated> {
        if self.repeats.is_none() && !self.stopped {
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

    /// Whether an effect is in the last model, and the interval of each of its sizes holds zero.
    pub fn is_needless(&self, effect: &str) -> bool {
        silent(&self.last().fitted, |asked| asked == effect).is_some()
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
    fn take(&mut self, Grown { exam, written, removed, inseparable }: Grown, added: Added, watch: &Watch) {
        let before = self.last().fitted.model.clone();
        removed.iter().chain(&inseparable).for_each(|effect| self.refuse(&before, effect));
        self.removed.extend(removed);
        self.inseparable.extend(inseparable);
        watch.reach(|| reached(&written, self.exams.len(), Some(&added.suspect)));
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

    /// Effects that are not tested, or not again.
    fn passed(&self) -> Vec<&'static str> {
        self.refused.iter().chain(&self.removed).chain(&self.harmful).chain(&self.inseparable).copied().collect()
    }

    /// Whether an effect is not tested, or not again.
    pub fn is_refused(&self, effect: &str) -> bool {
        self.passed().contains(&effect)
    }

    /// The last model with one more effect as it would be written; `None` where the fit went astray or its values are none of a robot.
    pub fn tried(&self, grown: Fitted, effect: &str) -> Result<Option<Alone>, FitError> {
        let exam = self.last().of_grown(grown)?;
        if astray(&exam, self.last()) {
            return Ok(None);
        }
        let written = trusted(exam.fitted.clone())?;
        let is_incredible = incredible([&exam.fitted, written.fitted()], |asked| asked == effect)?.is_some();
        Ok((!is_incredible).then_some(written))
    }

    /// Takes back the last effect by which the last model predicts runs left out worse than before it, or those of a floor, a load or a
    /// session left out, and all that came after; whether there is one.
    ///
    /// An effect that does harm alone is not refused at once: where two are missing, what the second does may hide in the values until
    /// both are there. Nor does an effect do harm with which poses are predicted better, and runs as well, beside values that are fitted alike:
    /// two models may be written with values that are fitted under other noise, and the way of few runs then is off by chance.
    fn undo_harm(&mut self) -> bool {
        let conditions = &self.last().fitted.observed.conditions;
        let elsewhere = |alone: &Alone| conditions.iter().map(|levels| alone.elsewhere(levels).misses).collect();
        let errors: Vec<(Misses, Vec<Misses>)> =
            self.written.iter().map(|alone| (alone.left_out(), elsewhere(alone))).collect();
        let [.., last] = &errors[..] else { return false };
        let does_harm = |effect: &str| {
            let [with, without] = with_and_without(self.last(), effect);
            with.harms(&without) || with.white_fall(&without) < LEAST_GAIN
        };
        let harmful = |(place, before): (usize, &(Misses, Vec<Misses>))| {
            let added = self.added.get(place)?.suspect.best;
            let harms_elsewhere = last.1.iter().zip(&before.1).any(|(now, then)| now.harms(then));
            let harms = last.0.harms(&before.0) && (!self.keeps(added) || does_harm(added));
            (harms || harms_elsewhere).then_some(place)
        };
        let Some(before) = errors.iter().enumerate().rev().find_map(harmful) else { return false };
        let effect = self.added[before].suspect.best;
        let model = self.exams[before + 1].fitted.model.clone();
        self.refuse(&model, effect);
        self.harmful.push(effect);
        self.repeats = None;
        self.added.truncate(before);
        self.exams.truncate(before + 1);
        self.written.truncate(before + 1);
        let kept = self.exams[before].fitted.model.parts();
        for gone in [&mut self.removed, &mut self.inseparable] {
            gone.retain(|effect| kept.iter().all(|part| part.effect.name() != *effect));
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_do_not_show_how_long_a_metre_is_show_no_picture_that_is_bent_or_stretched() {
        assert_eq!(bent_scales(&["scale"]), ["reference_lens", "reference_stretch"]);
        assert!(bent_scales(&["wheel_diameter_ratio", "wheelbase"]).is_empty());
    }
}
