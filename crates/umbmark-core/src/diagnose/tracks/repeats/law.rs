//! A law outside the catalogue, and whether what repeats is significant.

use super::laws::SIZES;
use crate::diagnose::tracks::class::ALIKE;
use crate::effect::Model;
use crate::stats::chi_squared_upper_tail;

/// False-alarm rate of what repeats: the other tests together use the rest of 5 %. Where p by the noise model is below the first number of
/// `LOUD` and the gain in held-out runs above the second, `SIZE_IF_LOUD` applies: ten runs, of which the fast ones carry most, have few flips.
const SIZE: f64 = 0.01;
const LOUD: (f64, f64) = (1e-6, 0.1);
const SIZE_IF_LOUD: f64 = 0.05;
/// Fewer runs do not show whether a pattern is the same in all.
const ENOUGH_RUNS: usize = 4;
/// With this gain in held-out runs, the fitted noise may already contain what repeats, so it is not widened further, and `SIZE_IF_PLAIN`
/// applies to p of the flips: few runs, of which some carry most, have few flips.
const PLAIN: f64 = 0.4;
const SIZE_IF_PLAIN: f64 = 0.2;
/// With this gain in held-out runs a law accounts for nearly all that is left. p by the noise model must then be below the first number, and
/// `SIZE_IF_LOUD` applies.
const NEARLY_ALL: (f64, f64) = (1e-3, 0.7);
/// False-alarm rate by the noise model, and the factor by which correlated noise widens a heading drift against that model.
const SIZE_BY_NOISE: f64 = 0.05;
pub(super) const REMEMBERS: f64 = 2.6;

/// The strongest repeating pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeated {
    /// p of all laws together.
    pub p: f64,
    /// The greatest score, in standard deviations of the noise model.
    pub deviations: f64,
    /// Number of laws that the data could show.
    pub laws: usize,
    /// Number of runs in which it was looked for.
    pub runs: usize,
    /// The law that is chosen for it.
    pub law: UnlistedLaw,
    /// Other significant laws, the one that predicts held-out runs best first.
    pub others: Vec<UnlistedLaw>,
}

/// A law outside the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct UnlistedLaw {
    /// Its number in the table of laws, from 1.
    pub number: usize,
    /// A model that holds it alone, with start values, where it can be written as a formula.
    pub model: Option<Model>,
    /// What it acts on: "forward", "sideways", "yaw", "left wheel" or "right wheel".
    pub acts_on: &'static str,
    /// What it is in proportion to: "second", "metre" or "radian turned".
    pub per: &'static str,
    /// Whether it changes sign with the sense of the run.
    pub with_sense: bool,
    /// By what, in words, with {c} for the value of its parameter c.
    pub(in crate::diagnose::tracks) follows: String,
    /// What its length corresponds to on the robot or its path: "the circumference of a wheel".
    pub means: Option<String>,
    /// The effect of the catalogue that is most similar to it after its fit, and the share of its response that the effect reproduces, as a
    /// cosine.
    pub nearest: Option<(&'static str, f64)>,
    /// How long its formula is: operations, variables and numbers.
    pub length: usize,
    /// Root mean square error of runs left out \[m\], and with the law; no number in a [reason](crate::diagnose::Reason) against a model that is
    /// written with other values than those for which these were found.
    pub left_out: [f64; 2],
    /// Relative decrease of the errors of held-out runs: the largest of those of positions, headings and innovations, minus any increase of
    /// positions.
    pub gain: f64,
    /// Decrease of the sum of squares, in units of the noise variance.
    pub drop: f64,
    /// Share of its response that the chosen law reproduces, as a cosine.
    pub likeness: f64,
}

impl UnlistedLaw {
    /// Whether these runs cannot separate it from the chosen law.
    pub fn is_alike(&self) -> bool {
        self.likeness > ALIKE
    }

    /// The numbers that shape it, each with its name and three digits: a period, a scale, a threshold, a place.
    pub fn shapes(&self) -> Vec<(&'static str, String)> {
        let part = self.model.as_ref().and_then(|model| model.parts().first());
        let numbers = part.into_iter().flat_map(|part| part.effect.parameters().iter().zip(&part.values));
        let shapes = numbers.filter(|(parameter, _)| !SIZES.contains(&parameter.name));
        shapes.map(|(parameter, value)| (parameter.name, three_digits(*value))).collect()
    }

    /// What it follows, in words: "a wave of the time with a period of 18.9 s".
    pub fn by(&self) -> String {
        let part = self.model.as_ref().and_then(|model| model.parts().first());
        let numbers = part.into_iter().flat_map(|part| part.effect.parameters().iter().zip(&part.values));
        numbers.fold(self.follows.clone(), |words, (parameter, value)| {
            words.replace(&format!("{{{}}}", parameter.name), &three_digits(*value))
        })
    }

    /// In words: "the yaw motion for each metre follows the speed".
    pub fn words(&self) -> String {
        let sense = if self.with_sense { ", with the sense of the run" } else { "" };
        let means = self.means.as_ref().map(|means| format!(" ({means})")).unwrap_or_default();
        format!("the {} motion for each {} follows {}{means}{sense}", self.acts_on, self.per, self.by())
    }
}

fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

impl Repeated {
    /// Whether it is significant, and reduces the errors of held-out runs by this share.
    pub(in crate::diagnose::tracks) fn counts(&self, least: f64) -> bool {
        let (by_noise, gain) = (self.p_by_noise(REMEMBERS), self.law.gain);
        let is_plain = gain >= PLAIN && self.p_by_noise(1.0) <= LOUD.0;
        let is_loud = by_noise <= LOUD.0 && gain >= LOUD.1;
        let is_nearly_all = self.p_by_noise(1.0) <= NEARLY_ALL.0 && gain >= NEARLY_ALL.1;
        let is_clear = ((is_loud || is_nearly_all) && self.p <= SIZE_IF_LOUD) || (is_plain && self.p <= SIZE_IF_PLAIN);
        let is_certain = self.p <= SIZE && by_noise <= SIZE_BY_NOISE;
        gain >= least && (is_certain || (is_clear && self.runs >= ENOUGH_RUNS))
    }

    /// Whether it is a reason not to call a model explained: it is significant, or its p by the noise model is below 1e-6 and it predicts
    /// held-out runs 10 % better, even where the flips of few runs do not confirm it. A doubt needs less than an addition.
    pub(in crate::diagnose::tracks) fn is_doubt(&self, least: f64) -> bool {
        let stands_out = self.p_by_noise(1.0) <= LOUD.0 && self.law.gain >= LOUD.1.max(least);
        self.counts(least) || (stands_out && self.runs >= ENOUGH_RUNS)
    }

    /// Bonferroni-corrected p of all laws by the noise model, with scores widened by a factor: few runs have few flips, one of which may
    /// be extreme by chance.
    pub(super) fn p_by_noise(&self, wider: f64) -> f64 {
        let square = (self.deviations / wider).powi(2);
        (self.laws as f64 * chi_squared_upper_tail(square, 1.0)).min(1.0)
    }

    /// In a sentence, without a full stop.
    pub(crate) fn sentence(&self) -> String {
        let [before, after] = self.law.left_out;
        let p = if self.p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {:.3}", self.p) };
        let told = match self.counts(0.0) {
            true => format!("what the model leaves repeats ({p} among {} laws)", self.laws),
            false => format!(
                "what the model leaves may repeat ({:.1} standard deviations, the largest of {} laws; sign flips of these runs do not confirm it, {p})",
                self.deviations, self.laws
            ),
        };
        let words = self.law.words();
        match after < 0.995 * before {
            _ if before.is_nan() => {
                format!(
                    "{told}: {words}; with that law, runs left out would be predicted {:.0} % nearer",
                    100.0 * self.law.gain
                )
            }
            true => format!(
                "{told}: {words}; with that law, the cross-validated error would be {:.1} mm instead of {:.1} mm",
                1e3 * after,
                1e3 * before
            ),
            false => format!(
                "{told}: {words}; with that law, the headings or the increments of runs left out are predicted {:.0} % nearer, \
                 though not their positions ({:.1} mm)",
                100.0 * self.law.gain,
                1e3 * before
            ),
        }
    }

    /// The same with another law chosen: number 1 is the present one. Skips laws that are `refused`; `None` where none is left.
    pub(in crate::diagnose::tracks) fn taking(
        &self,
        number: usize,
        refused: impl Fn(&UnlistedLaw) -> bool,
    ) -> Option<Repeated> {
        let mut laws: Vec<UnlistedLaw> = std::iter::once(&self.law).chain(&self.others).cloned().collect();
        let which = (number.saturating_sub(1)..laws.len()).find(|which| !refused(&laws[*which]))?;
        let law = laws.remove(which);
        Some(Repeated { law, others: laws, ..self.clone() })
    }
}
