//! Parameters that differ from trial to trial.

use super::StudyError;
use crate::effect::{ModelError, find};
use crate::parameter::{Parameter, ParameterError};
use crate::random::Stream;
use crate::stats::{normal_quantile, standard_normal_share};

/// Normal draws beyond the bounds that are thrown away before the quantile of the cut distribution is taken: where the standard deviation
/// is many times as wide as the bounds, hardly any draw lies within them.
const REJECTIONS: usize = 64;
/// Where less than this share of a normal distribution lies between the bounds, it is as good as flat there, and differences of shares have
/// lost their digits.
const FLAT: f64 = 1e-6;

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
    /// Triangular: from nothing at one value up to a peak and down to nothing.
    Triangular {
        /// Smallest value.
        min: f64,
        /// Where the peak is.
        mode: f64,
        /// Largest value.
        max: f64,
    },
    /// Uniform in the logarithm between two positive values.
    LogUniform {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
}

impl Distribution {
    /// Refuses what is no distribution of the numbers that `parameter` allows.
    pub fn check(&self, parameter: &Parameter) -> Result<(), DistributionError> {
        let name = parameter.name;
        match *self {
            Distribution::Normal { sd, .. } if !(sd >= 0.0 && sd.is_finite()) => {
                return Err(DistributionError::Deviation { name, value: sd });
            }
            Distribution::Uniform { min, max } | Distribution::LogUniform { min, max } if min > max => {
                return Err(DistributionError::Range { name, min, max });
            }
            Distribution::Triangular { min, mode, max } if !(min <= mode && mode <= max) => {
                return Err(DistributionError::Peak { name, min, mode, max });
            }
            Distribution::LogUniform { min, .. } if !(min > 0.0) => {
                return Err(DistributionError::Logarithm { name, min });
            }
            _ => {}
        }
        let outside = self.ends().into_iter().find_map(|value| parameter.check(value).err());
        outside.map_or(Ok(()), |problem| Err(DistributionError::Bounds(problem)))
    }

    /// The values that must lie within the bounds of a parameter.
    fn ends(&self) -> [f64; 2] {
        match *self {
            Distribution::Normal { mean, .. } => [mean; 2],
            Distribution::Uniform { min, max }
            | Distribution::Triangular { min, max, .. }
            | Distribution::LogUniform { min, max } => [min, max],
        }
    }

    /// A middle value: the mean, or the geometric one of a distribution in the logarithm.
    pub fn centre(&self) -> f64 {
        match *self {
            Distribution::Normal { mean, .. } => mean,
            Distribution::Uniform { min, max } => 0.5 * (min + max),
            Distribution::Triangular { min, mode, max } => (min + mode + max) / 3.0,
            Distribution::LogUniform { min, max } => (min * max).sqrt(),
        }
    }

    /// The value below which a share `u` in (0, 1) of the draws lies, a normal one cut off at `bounds`.
    ///
    /// ```
    /// # use umbmark_core::monte_carlo::Distribution;
    /// let normal = Distribution::Normal { mean: 1.0, sd: 0.001 };
    /// assert!((normal.quantile(0.975, (0.5, 2.0)) - 1.001_959_964).abs() < 1e-9);
    /// let middle = Distribution::LogUniform { min: 100.0, max: 10_000.0 }.quantile(0.5, (0.0, 1e6));
    /// assert!((middle - 1000.0).abs() < 1e-9);
    /// ```
    pub fn quantile(&self, u: f64, bounds: (f64, f64)) -> f64 {
        let (value, ends) = match *self {
            Distribution::Normal { sd: 0.0, mean } => (mean, (mean, mean)),
            Distribution::Normal { mean, sd } => {
                let [low, high] = [bounds.0, bounds.1].map(|end| standard_normal_share((end - mean) / sd));
                // Shares of 0 and 1 have no finite quantile.
                let share = (low + u * (high - low)).clamp(f64::MIN_POSITIVE, 1.0 - 0.5 * f64::EPSILON);
                let is_flat = high - low < FLAT && bounds.0 <= mean && mean <= bounds.1;
                let value =
                    if is_flat { bounds.0 + u * (bounds.1 - bounds.0) } else { mean + sd * normal_quantile(share) };
                (value, bounds)
            }
            Distribution::Uniform { min, max } => (min + (max - min) * u, (min, max)),
            Distribution::Triangular { min, mode, max } => (triangular([min, mode, max], u), (min, max)),
            Distribution::LogUniform { min, max } => (min * libm::exp(u * libm::log(max / min)), (min, max)),
        };
        value.max(ends.0).min(ends.1)
    }
}

/// Quantile of the triangular distribution.
fn triangular([min, mode, max]: [f64; 3], u: f64) -> f64 {
    let (all, rising) = (max - min, mode - min);
    if all <= 0.0 {
        mode
    } else if u * all < rising {
        min + (u * all * rising).sqrt()
    } else {
        max - ((1.0 - u) * all * (max - mode)).sqrt()
    }
}

/// What makes a distribution impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DistributionError {
    /// Invalid standard deviation.
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
    /// A peak beside its range.
    #[error("{name}: the peak must lie between min and max, got min {min}, mode {mode} and max {max}")]
    Peak {
        /// The parameter.
        name: &'static str,
        /// What was given.
        min: f64,
        /// What was given.
        mode: f64,
        /// What was given.
        max: f64,
    },
    /// A logarithm of nothing.
    #[error("{name}: a distribution in the logarithm must begin above 0, got min {min}")]
    Logarithm {
        /// The parameter.
        name: &'static str,
        /// What was given.
        min: f64,
    },
    /// Values that the parameter cannot have.
    #[error(transparent)]
    Bounds(ParameterError),
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
        match distribution.check(found) {
            // Where it lies is asked before a study runs, with the name of the effect.
            Ok(()) | Err(DistributionError::Bounds(_)) => {
                Ok(Draw { effect: about.name, parameter: found, distribution })
            }
            Err(impossible) => Err(impossible.into()),
        }
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
        self.distribution.centre()
    }

    pub(super) fn check(&self) -> Result<(), StudyError> {
        self.distribution.check(self.parameter).map_err(|problem| match problem {
            DistributionError::Bounds(problem) => StudyError::Bounds { effect: self.effect, problem },
            impossible => impossible.into(),
        })
    }

    /// A value for one trial.
    pub(super) fn draw(&self, stream: &mut Stream) -> f64 {
        match self.distribution {
            Distribution::Normal { mean, sd } => {
                for _ in 0..REJECTIONS {
                    let value = mean + sd * stream.normal();
                    if self.parameter.check(value).is_ok() || sd == 0.0 {
                        return value;
                    }
                }
                self.distribution.quantile(stream.uniform(), self.parameter.bounds)
            }
            other => other.quantile(stream.uniform(), self.parameter.bounds),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_distribution_far_wider_than_its_bounds_is_flat_between_them() {
        let mut stream = Stream::new(2, 0, 0);
        for sd in [1e3, 1e8, 1e300] {
            let wide = Draw::new("wheelbase", "e_b", Distribution::Normal { mean: 1.0, sd }).unwrap();
            let (low, high) = wide.parameter().bounds;
            let drawn: Vec<f64> = (0..2000).map(|_| wide.draw(&mut stream)).collect();
            assert!(drawn.iter().all(|value| (low..=high).contains(value)), "{sd}");
            let mean = drawn.iter().sum::<f64>() / 2000.0;
            // Five standard errors of the mean of 2000 uniform values.
            assert!(
                (mean - 0.5 * (low + high)).abs() < 5.0 * (high - low) / 12f64.sqrt() / 2000f64.sqrt(),
                "{sd}: {mean}"
            );
        }
    }

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

    /// Each quantile function against the share of draws below it: the triangle's areas and the logarithm's ratio in closed
    /// form, and a normal distribution cut at both sides.
    #[test]
    fn quantiles_leave_their_share_below() {
        let everywhere = (f64::NEG_INFINITY, f64::INFINITY);
        let triangle = Distribution::Triangular { min: 1.0, mode: 2.0, max: 5.0 };
        for (u, value) in [(0.25, 2.0), (1.0 / 16.0, 1.5), (1.0 - 1.0 / 12.0, 4.0)] {
            assert!((triangle.quantile(u, everywhere) - value).abs() < 1e-12, "{u}");
        }
        assert_eq!(Distribution::Triangular { min: 2.0, mode: 2.0, max: 2.0 }.quantile(0.3, everywhere), 2.0);
        let logarithm = Distribution::LogUniform { min: 1.0, max: 16.0 };
        assert!((logarithm.quantile(0.75, everywhere) - 8.0).abs() < 1e-12);
        let cut = Distribution::Normal { mean: 0.0, sd: 2.0 };
        let bounds = (-2.0, 4.0);
        // Φ(-1) = 0.158655, Φ(2) = 0.977250, Φ(0) = 0.5.
        let share = (0.5 - 0.158_655_253_9) / (0.977_249_868_1 - 0.158_655_253_9);
        assert!(cut.quantile(share, bounds).abs() < 1e-8, "{}", cut.quantile(share, bounds));
        for u in [1e-12, 0.01, 0.99, 1.0 - 1e-12] {
            assert!((-2.0..=4.0).contains(&cut.quantile(u, bounds)));
        }
    }

    #[test]
    fn impossible_distributions_are_refused() {
        let refuse = |d| Draw::new("scale", "e_s", d).unwrap_err().to_string();
        assert!(refuse(Distribution::Normal { mean: 1.0, sd: -1.0 }).contains("got -1"));
        assert!(refuse(Distribution::Uniform { min: 2.0, max: 1.0 }).contains("min 2 and max 1"));
        assert!(refuse(Distribution::Triangular { min: 0.9, mode: 1.2, max: 1.1 }).contains("mode 1.2"));
        assert!(refuse(Distribution::LogUniform { min: 0.0, max: 1.0 }).contains("above 0, got min 0"));
        assert!(Draw::new("scale", "x", Distribution::Normal { mean: 1.0, sd: 1.0 }).is_err());
    }
}
