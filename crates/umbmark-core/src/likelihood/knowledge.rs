//! What is known of the numbers of a model besides the runs.

use crate::effect::{Model, ModelError};
use crate::fit::{Known, Prior};

/// Bounds and earlier measurements of numbers of a model.
///
/// A bound is a limit that a fit does not exceed. An earlier measurement (a ruler, a data sheet) is a Gaussian prior: its mean and standard
/// deviation are one more residual beside those of the runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knowledge {
    numbers: Vec<KnownNumber>,
}

/// What is known of one number.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownNumber {
    /// Its effect.
    pub effect: String,
    /// Its parameter.
    pub parameter: String,
    /// What is known.
    pub known: Known,
}

/// Why something cannot be known of a number of a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnowledgeError {
    /// A model that lacks the effect, or an effect that lacks the parameter.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A number that is not fitted.
    #[error(
        "{effect}.{parameter} is not fitted, so neither bounds nor an earlier measurement of it mean anything: {why}"
    )]
    NotFitted {
        /// Its effect.
        effect: String,
        /// Its parameter.
        parameter: String,
        /// Why it is not fitted, and what to do.
        why: &'static str,
    },
    /// A least value that is not below the greatest.
    #[error("the bounds of {effect}.{parameter} must be LOW and HIGH with LOW < HIGH, got {low} and {high}")]
    Bounds {
        /// Its effect.
        effect: String,
        /// Its parameter.
        parameter: String,
        /// The least value.
        low: f64,
        /// The greatest.
        high: f64,
    },
    /// A prior that is no Gaussian.
    #[error(
        "the earlier measurement of {effect}.{parameter} must be a finite mean and a standard deviation above 0, got {mean} and {sd}"
    )]
    Prior {
        /// Its effect.
        effect: String,
        /// Its parameter.
        parameter: String,
        /// The mean.
        mean: f64,
        /// The standard deviation.
        sd: f64,
    },
    /// A prior beside return poses whose scatter is not known.
    #[error(
        "an earlier measurement counts by its standard deviation beside the scatter of the return poses, which these runs do not show: \
         drive two runs or more in one direction"
    )]
    NoScatter,
}

impl Knowledge {
    /// Keeps a number from `low` to `high`; either may be infinite.
    pub fn bound(&mut self, effect: &str, parameter: &str, low: f64, high: f64) -> Result<(), KnowledgeError> {
        if low < high {
            let known = self.of_number(effect, parameter);
            (known.low, known.high) = (low, high);
            return Ok(());
        }
        Err(KnowledgeError::Bounds { effect: effect.to_owned(), parameter: parameter.to_owned(), low, high })
    }

    /// Adds an earlier measurement of a number.
    pub fn measured(&mut self, effect: &str, parameter: &str, mean: f64, sd: f64) -> Result<(), KnowledgeError> {
        if mean.is_finite() && sd.is_finite() && sd > 0.0 {
            self.of_number(effect, parameter).prior = Some(Prior { mean, sd });
            return Ok(());
        }
        Err(KnowledgeError::Prior { effect: effect.to_owned(), parameter: parameter.to_owned(), mean, sd })
    }

    fn of_number(&mut self, effect: &str, parameter: &str) -> &mut Known {
        let is_own = |number: &KnownNumber| number.effect == effect && number.parameter == parameter;
        let place = self.numbers.iter().position(is_own).unwrap_or_else(|| {
            let (effect, parameter) = (effect.to_owned(), parameter.to_owned());
            self.numbers.push(KnownNumber { effect, parameter, known: Known::default() });
            self.numbers.len() - 1
        });
        &mut self.numbers[place].known
    }

    /// All numbers of which something is known.
    pub fn numbers(&self) -> &[KnownNumber] {
        &self.numbers
    }

    /// Whether there is an earlier measurement of any number.
    pub(crate) fn has_priors(&self) -> bool {
        self.numbers.iter().any(|number| number.known.prior.is_some())
    }

    /// The same without earlier measurements.
    pub(crate) fn without_priors(&self) -> Knowledge {
        let mut bounds = self.clone();
        bounds.numbers.iter_mut().for_each(|number| number.known.prior = None);
        bounds
    }

    /// Refuses numbers that a model does not have, or that a fit of it does not change.
    pub(crate) fn check(&self, model: &Model) -> Result<(), KnowledgeError> {
        let free = model.free_places();
        for KnownNumber { effect, parameter, .. } in &self.numbers {
            // The model's own error for a name that is not there.
            model.clone().fix(effect, parameter)?;
            let place = model.place_of(effect, parameter);
            if place.is_none_or(|place| !free.contains(&place)) {
                let why = match place {
                    None => "the model lacks its effect; add it",
                    Some(_) => "its effect is not free, or it is fixed",
                };
                return Err(KnowledgeError::NotFitted { effect: effect.clone(), parameter: parameter.clone(), why });
            }
        }
        Ok(())
    }

    /// What is known of some of the [values](Model::values) of a model, by their places.
    pub(crate) fn of(&self, model: &Model, places: &[usize]) -> Vec<Known> {
        let mut known = vec![Known::default(); places.len()];
        for number in &self.numbers {
            let place = model.place_of(&number.effect, &number.parameter);
            if let Some(own) = places.iter().position(|free| Some(*free) == place) {
                known[own] = number.known;
            }
        }
        known
    }
}
