//! Which number of a robot or a test drives which metric.
//!
//! *Inputs* have distributions, on their own or joined by a Gaussian copula ([`Inputs`]); a [`Response`] turns their values
//! and a stream of noise into outputs: whole UMBmark tests ([`Tests`]), or any function. Three questions are asked of it:
//!
//! - [`local_derivatives`]: what does a small change do, about the middle of all distributions?
//! - [`screen`] (Morris): which inputs matter at all, and which act by themselves?
//! - [`sobol_indices`]: what share of an output's variance does each input explain, alone and with others?
//!
//! and of the tolerances that a robot is built to ([`tolerance`]): how many robots are good enough, and what is the cheapest
//! way to make more so?
//!
//! Noise that a test makes itself (wheel noise, where within a tick the wheels stop) is one more input, "noise": the stream of
//! a trial, drawn anew or kept like the value of any other input. Its share of the variance is what no tolerance can buy.

mod inputs;
mod local;
mod morris;
mod sobol_indices;
mod sobol_points;
mod sums;
#[cfg(test)]
mod test_functions;
mod tests_of_robots;
pub mod tolerance;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::monte_carlo::StudyError;
use crate::stats::{Interval, student_t_quantile};
use crate::watch::Watch;

pub use inputs::{Correlation, Input, Inputs};
pub use local::{Derivative, local_derivatives};
pub use morris::{Screened, Screening, screen};
pub use sobol_indices::{Indices, SobolDesign, SobolOptions, SobolSums, sobol_indices};
pub use sobol_points::SobolPoints;
pub use sums::OutputIndices;
pub use tests_of_robots::{Noise, Tests};

/// What cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensitivityError {
    /// The tests cannot be run.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// Nothing, or too much, is varied.
    #[error("between 1 and {most} parameters can be varied, got {got}")]
    Inputs {
        /// The most that there are points for.
        most: usize,
        /// How many there are.
        got: usize,
    },
    /// A parameter with two distributions.
    #[error("{name} is varied twice; keep one of its distributions")]
    Twice {
        /// The parameter.
        name: String,
    },
    /// Invalid correlation.
    #[error(
        "a correlation must lie between -1 and 1, both excluded, and join two different parameters; got {value} of {one} and {two}"
    )]
    Correlation {
        /// The one parameter.
        one: String,
        /// The other.
        two: String,
        /// What was given.
        value: f64,
    },
    /// Correlations that contradict each other.
    #[error("the correlations contradict each other: no joint distribution has them all; make some smaller")]
    Contradiction,
    /// A method that means nothing for correlated inputs.
    #[error(
        "{what} is defined for independent parameters only; leave the correlations out, or ask for Sobol indices without it"
    )]
    NeedsIndependence {
        /// The name that was given.
        what: &'static str,
    },
    /// A count out of range.
    #[error("{what} must be {allowed}, got {value}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// What it may be.
        allowed: &'static str,
        /// What was given.
        value: u64,
    },
    /// An output that is no number.
    #[error("output {output} is not a number at {values:?}")]
    NotANumber {
        /// Which output, from 0.
        output: usize,
        /// The values of the inputs there.
        values: Vec<f64>,
    },
    /// Stopped before anything can be said.
    #[error("stopped before anything can be said")]
    Stopped,
}

/// What turns values of the inputs and a number that names the noise into outputs: one thread's own.
pub type Evaluator<'a> = Box<dyn FnMut(&[f64], u64, &mut [f64]) -> Result<(), SensitivityError> + 'a>;

/// A function of some inputs and of noise.
///
/// Its outputs must depend on the values and the number of the noise alone: then no number depends on the threads.
pub trait Response: Sync {
    /// How many outputs it has.
    fn outputs(&self) -> usize;

    /// Whether it takes notice of the noise.
    fn is_noisy(&self) -> bool;

    /// What a thread needs to evaluate it.
    fn evaluator(&self) -> Result<Evaluator<'_>, SensitivityError>;
}

/// A number with an interval that holds the true one with a probability of 95 %, as far as the method's own error goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its interval.
    pub interval: Interval,
}

impl Estimate {
    /// The mean of independent estimates alike, by Student's t.
    fn of_mean(values: &[f64]) -> Estimate {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        Estimate::with_error(mean, (squares / (n - 1.0) / n).sqrt(), n - 1.0)
    }

    /// An estimate with its standard error, known with so many degrees of freedom.
    fn with_error(value: f64, std_error: f64, degrees_of_freedom: f64) -> Estimate {
        let half_width = student_t_quantile(0.975, degrees_of_freedom) * std_error;
        Estimate { value, interval: Interval::around(value, half_width) }
    }

    /// A function of equal parts of the data, with the jackknife's standard error: `of(None)` is the function of all
    /// parts, `of(Some(i))` of all but the i-th.
    fn jackknife(parts: usize, of: impl Fn(Option<usize>) -> f64) -> Estimate {
        let without: Vec<f64> = (0..parts).map(|i| of(Some(i))).collect();
        let n = parts as f64;
        let mean = without.iter().sum::<f64>() / n;
        let squares: f64 = without.iter().map(|v| (v - mean) * (v - mean)).sum();
        Estimate::with_error(of(None), (squares * (n - 1.0) / n).sqrt(), n - 1.0)
    }
}

impl Watch<'_> {
    /// Does pieces of work on the present rayon pool: their results in order, none where it was stopped before.
    fn pieces<T: Send>(
        &self,
        response: &dyn Response,
        count: usize,
        work: impl Fn(&mut Evaluator, usize) -> Result<T, SensitivityError> + Sync,
    ) -> Result<Vec<Option<T>>, SensitivityError> {
        let done = AtomicU64::new(0);
        (0..count)
            .into_par_iter()
            .with_max_len(1)
            .map_init(
                || response.evaluator(),
                |evaluator, piece| {
                    let evaluator = evaluator.as_mut().map_err(|error| error.clone())?;
                    if self.is_stopped() {
                        return Ok(None);
                    }
                    let result = work(evaluator, piece)?;
                    let now = done.fetch_add(1, Ordering::Relaxed) + 1;
                    (self.progress)(now as f64 / count as f64);
                    Ok(Some(result))
                },
            )
            .collect()
    }
}

/// Evaluates a response where its inputs have these values, and refuses what is no number.
fn evaluate(
    evaluator: &mut Evaluator,
    values: &[f64],
    noise: u64,
    outputs: &mut [f64],
) -> Result<(), SensitivityError> {
    evaluator(values, noise, outputs)?;
    match outputs.iter().position(|output| !output.is_finite()) {
        Some(output) => Err(SensitivityError::NotANumber { output, values: values.to_vec() }),
        None => Ok(()),
    }
}
