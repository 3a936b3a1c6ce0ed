//! The repeating part of the residuals of a model, and the laws that it may follow.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Keyed, finite};
use crate::diagnose;
use crate::effect::{Formula, effects_text};

/// The effect of the catalogue that is most similar to the missing one.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Nearest {
    /// Its name.
    pub effect: &'static str,
    /// The share of the missing effect that it explains.
    pub share: f64,
}

impl Nearest {
    pub(super) fn new((effect, share): (&'static str, f64)) -> Nearest {
        Nearest { effect, share }
    }
}

/// A law that no catalogue lists.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct UnlistedLaw {
    /// Its number in the table of laws, as `--law` of `umbmark learn` takes it.
    pub number: usize,
    /// The law as an effect of a model file, with start values or, once it was added, the fitted ones; null if formulas do not have a
    /// variable that it depends on.
    pub toml: Option<String>,
    /// Its formula; null where it cannot be written as one.
    pub formula: Option<String>,
    /// The numbers of the formula.
    pub parameters: Option<Keyed<Option<f64>>>,
    /// What the formula acts on.
    pub acts_on: Option<&'static str>,
    /// "forward", "sideways" or "yaw", or "left wheel" or "right wheel".
    pub motion: &'static str,
    /// What the motion is in proportion to: "second", "metre", "radian turned", or "metre that it rolls", of a wheel.
    pub per: &'static str,
    /// The law in words.
    pub meaning: String,
    /// What it follows, in words.
    pub by: String,
    /// What its length corresponds to on the robot or its path, such as the circumference of a wheel; null if it has no length or the
    /// length is unknown.
    pub means: Option<String>,
    /// The effect of the catalogue that is most similar to it after the fit, and the share of its response that this effect reproduces, as
    /// a cosine.
    pub nearest: Option<Nearest>,
    /// Whether it changes sign with the sense of the run.
    pub with_sense: bool,
    /// Length of the formula: operations, variables and numbers.
    pub length: Option<usize>,
    /// Error of held-out runs, in m.
    pub heldout_rmse_m: f64,
    /// The same with the law, in m.
    pub heldout_rmse_with_law_m: f64,
    /// Relative decrease of the errors of held-out runs: the largest of those of positions, of headings and from pose to pose.
    pub gain: f64,
    /// Share of its response that the chosen law reproduces, as a cosine.
    pub likeness: f64,
}

impl From<&diagnose::UnlistedLaw> for UnlistedLaw {
    fn from(law: &diagnose::UnlistedLaw) -> Self {
        let part = law.model.as_ref().and_then(|model| model.parts().first());
        let formula = part.and_then(|part| part.effect.formula());
        let parameters = part.map(|part| {
            let numbers = part.effect.parameters().iter().zip(&part.values);
            numbers.map(|(parameter, value)| (parameter.name, finite(*value))).collect()
        });
        UnlistedLaw {
            number: law.number,
            toml: law.model.as_ref().map(effects_text),
            formula: formula.map(|formula| formula.text().to_owned()),
            parameters,
            acts_on: formula.map(|formula| formula.target().name()),
            motion: law.acts_on,
            per: law.per,
            meaning: law.words(),
            by: law.by(),
            means: law.means.clone(),
            nearest: law.nearest.map(Nearest::new),
            with_sense: law.with_sense,
            length: formula.map(|_| law.length),
            heldout_rmse_m: law.left_out[0],
            heldout_rmse_with_law_m: law.left_out[1],
            gain: law.gain,
            likeness: law.likeness,
        }
    }
}

/// The repeating part of the remaining error: the law that was chosen for it, and its p.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Repeated {
    /// The law.
    #[serde(flatten)]
    pub law: UnlistedLaw,
    /// p of all laws together, by sign flips of runs.
    pub p: f64,
    /// Largest score of any law, in standard deviations of the noise model.
    pub standard_deviations: f64,
    /// Number of laws that the data could show.
    pub laws: usize,
    /// Formulas of the laws that these runs cannot separate from it.
    pub class: Vec<String>,
    /// Other significant laws, the one that predicts held-out runs best first.
    pub others: Vec<UnlistedLaw>,
}

impl From<&diagnose::Repeated> for Repeated {
    fn from(repeated: &diagnose::Repeated) -> Self {
        let alike = repeated.others.iter().filter(|other| other.is_alike());
        Repeated {
            law: (&repeated.law).into(),
            p: repeated.p,
            standard_deviations: repeated.deviations,
            laws: repeated.laws,
            class: alike.filter_map(text_of).collect(),
            others: repeated.others.iter().map(UnlistedLaw::from).collect(),
        }
    }
}

/// A law as it stands in a model file: what it acts on, and its formula.
fn text_of(law: &diagnose::UnlistedLaw) -> Option<String> {
    let formula: &Formula = law.model.as_ref()?.parts().first()?.effect.formula()?;
    Some(format!("{} = {}", formula.target().name(), formula.text()))
}
