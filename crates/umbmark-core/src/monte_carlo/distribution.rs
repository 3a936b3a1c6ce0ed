//! Parameters that differ from trial to trial.

use super::StudyError;
use crate::effect::{ModelError, find};
use crate::parameter::Parameter;
use crate::random::Stream;

/// The distribution of a parameter over robots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Normal, cut off at the bounds of the parameter.
    Normal {
        /// Mean before the cut.
        mean: f64,
        /// Standard deviation before the cut.
        sd: f64,
    },
    /// Uniform between two values.
    Uniform {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
}

/// What makes a distribution impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DistributionError {
    /// A standard deviation that is none.
    #[error("standard deviation of {name} must be finite and 0 or more, got {value}")]
    Deviation {
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A range that is upside down.
    #[error("{name}: min must not exceed max, got min {min} and max {max}")]
    Range {
        /// The parameter.
        name: &'static str,
        /// What was given.
        min: f64,
        /// What was given.
        max: f64,
    },
}

/// A parameter of an effect and the distribution that it is drawn from.
#[derive(Clone, Debug)]
pub struct Draw {
    effect: &'static str,
    parameter: &'static Parameter,
    distribution: Distribution,
}

impl PartialEq for Draw {
    fn eq(&self, other: &Draw) -> bool {
        let named = |draw: &Draw| (draw.effect, draw.parameter.name);
        named(self) == named(other) && self.distribution == other.distribution
    }
}

impl Draw {
    /// A parameter by the names of its effect and its own.
    pub fn new(effect: &str, parameter: &str, distribution: Distribution) -> Result<Draw, StudyError> {
        let about = &find(effect)?.about;
        let found = about.parameters.iter().find(|p| p.name == parameter).ok_or_else(|| {
            ModelError::UnknownParameter { effect: about.name, name: parameter.to_owned(), nearest: None }
        })?;
        match distribution {
            Distribution::Normal { sd, .. } if !(sd >= 0.0 && sd.is_finite()) => {
                return Err(DistributionError::Deviation { name: found.name, value: sd }.into());
            }
            Distribution::Uniform { min, max } if min > max => {
                return Err(DistributionError::Range { name: found.name, min, max }.into());
            }
            _ => {}
        }
        Ok(Draw { effect: about.name, parameter: found, distribution })
    }

    /// The effect's name.
    pub fn effect(&self) -> &'static str {
        self.effect
    }

    /// The parameter.
    pub fn parameter(&self) -> &'static Parameter {
        self.parameter
    }

    /// The distribution.
    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// A middle value, to describe the study by.
    pub fn centre(&self) -> f64 {
        match self.distribution {
            Distribution::Normal { mean, .. } => mean,
            Distribution::Uniform { min, max } => 0.5 * (min + max),
        }
    }

    pub(super) fn check(&self) -> Result<(), StudyError> {
        let ends = match self.distribution {
            Distribution::Normal { mean, .. } => [mean; 2],
            Distribution::Uniform { min, max } => [min, max],
        };
        ends.iter().try_for_each(|value| {
            self.parameter
                .check(*value)
                .map(|_| ())
                .map_err(|problem| StudyError::Bounds { effect: self.effect, problem })
        })
    }

    /// A value for one trial.
    pub(super) fn draw(&self, stream: &mut Stream) -> f64 {
        match self.distribution {
            Distribution::Uniform { min, max } => min + (max - min) * stream.uniform(),
            Distribution::Normal { mean, sd } => {
                // The mean lies within the bounds, so half of the draws or more do: this ends.
                loop {
                    let value = mean + sd * stream.normal();
                    if self.parameter.check(value).is_ok() || sd == 0.0 {
                        return value;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_draws_stay_within_the_bounds_and_uniform_ones_within_their_range() {
        let mut stream = Stream::new(1, 0, 0);
        let wide = Draw::new("wheelbase", "e_b", Distribution::Normal { mean: 1.0, sd: 1.0 }).unwrap();
        let flat = Draw::new("scale", "e_s", Distribution::Uniform { min: 0.9, max: 0.91 }).unwrap();
        for _ in 0..2000 {
            assert!((0.2..=5.0).contains(&wide.draw(&mut stream)));
            assert!((0.9..=0.91).contains(&flat.draw(&mut stream)));
        }
    }

    #[test]
    fn impossible_distributions_are_refused() {
        let refuse = |d| Draw::new("scale", "e_s", d).unwrap_err().to_string();
        assert!(refuse(Distribution::Normal { mean: 1.0, sd: -1.0 }).contains("got -1"));
        assert!(refuse(Distribution::Uniform { min: 2.0, max: 1.0 }).contains("min 2 and max 1"));
        assert!(Draw::new("scale", "x", Distribution::Normal { mean: 1.0, sd: 1.0 }).is_err());
    }
}
