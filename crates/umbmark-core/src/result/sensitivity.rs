//! `sensitivity`.

use schemars::JsonSchema;
use serde::Serialize;

use super::study::distribution;
use super::{Keyed, NumberOrWord, finite};
use crate::monte_carlo::{self, Metric, Quantity, Study};
use crate::sensitivity::{self, Derivative, Indices, Screened, Screening};

/// What was found, by method.
#[derive(Debug)]
pub enum Found {
    /// Sobol indices.
    Sobol(Indices),
    /// Elementary effects.
    Morris(Screening),
    /// Derivatives, for each metric and parameter.
    Local(Vec<Vec<Derivative>>),
}

impl Found {
    /// Whether it was stopped before all of it was done.
    pub fn is_partial(&self) -> bool {
        match self {
            Found::Sobol(indices) => indices.partial,
            Found::Morris(screening) => screening.partial,
            Found::Local(_) => false,
        }
    }
}

/// What was asked.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The parameters.
    pub varied: &'a [(Quantity, monte_carlo::Distribution)],
    /// Correlations of two of them, by their places.
    pub correlations: &'a [sensitivity::Correlation],
    /// The metrics, in the order of the outputs.
    pub metrics: &'a [Metric],
    /// The study about which parameters vary.
    pub study: &'a Study,
    /// Whether tests are simulated with their noise.
    pub noisy: bool,
    /// What was assumed.
    pub assumed: &'a [String],
}

/// A number with its interval.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WithInterval {
    /// The number; null if it cannot be estimated.
    pub value: Option<f64>,
    /// Its 95 % interval; an end is null if it cannot be estimated.
    pub interval: [Option<f64>; 2],
}

impl From<&sensitivity::Estimate> for WithInterval {
    fn from(estimate: &sensitivity::Estimate) -> Self {
        let interval = estimate.interval;
        WithInterval { value: finite(estimate.value), interval: [finite(interval.low), finite(interval.high)] }
    }
}

/// The share of two parameters together.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OfPair {
    /// The share; null if it cannot be estimated.
    pub value: Option<f64>,
    /// Its 95 % interval; an end is null if it cannot be estimated.
    pub interval: [Option<f64>; 2],
    /// The two parameters.
    pub of: (String, String),
}

/// Sensitivities of a metric, by parameter; those that the method gives.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct OfMetric {
    /// Mean of the metric.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean: Option<WithInterval>,
    /// Its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std_dev: Option<WithInterval>,
    /// Sobol indices: the share of the variance that a parameter causes alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<Keyed<WithInterval>>,
    /// Sobol indices: the share that it causes alone and together with others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total: Option<Keyed<WithInterval>>,
    /// Sobol indices of pairs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second: Option<Vec<OfPair>>,
    /// Morris: mean of the elementary effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<Keyed<WithInterval>>,
    /// Morris: mean of their sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu_star: Option<Keyed<WithInterval>>,
    /// Morris: their standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma: Option<Keyed<WithInterval>>,
    /// Derivative by the parameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_unit: Option<Keyed<WithInterval>>,
    /// Derivative times the spread of the parameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_spread: Option<Keyed<WithInterval>>,
}

impl OfMetric {
    /// The sensitivities of one output to the parameters that have these keys.
    fn new(found: &Found, output: usize, keys: &[String]) -> OfMetric {
        let by_key = |estimates: &mut dyn Iterator<Item = &sensitivity::Estimate>| {
            Some(keys.iter().cloned().zip(estimates.map(WithInterval::from)).collect())
        };
        match found {
            Found::Sobol(indices) => {
                let output = &indices.outputs[output];
                let pair = |([i, j], estimate): &([usize; 2], sensitivity::Estimate)| {
                    let WithInterval { value, interval } = estimate.into();
                    OfPair { value, interval, of: (keys[*i].clone(), keys[*j].clone()) }
                };
                OfMetric {
                    mean: Some((&output.mean).into()),
                    std_dev: Some((&output.std_dev).into()),
                    first: by_key(&mut output.first.iter()),
                    total: by_key(&mut output.total.iter()),
                    second: Some(output.second.iter().map(pair).collect()),
                    ..OfMetric::default()
                }
            }
            Found::Morris(screening) => {
                let of = |pick: fn(&Screened) -> &sensitivity::Estimate| {
                    by_key(&mut screening.outputs[output].iter().map(pick))
                };
                OfMetric {
                    mu: of(|one| &one.mean),
                    mu_star: of(|one| &one.size),
                    sigma: of(|one| &one.spread),
                    ..OfMetric::default()
                }
            }
            Found::Local(derivatives) => {
                let of =
                    |pick: fn(&Derivative) -> &sensitivity::Estimate| by_key(&mut derivatives[output].iter().map(pick));
                OfMetric {
                    per_unit: of(|one| &one.per_unit),
                    per_spread: of(|one| &one.per_spread),
                    ..OfMetric::default()
                }
            }
        }
    }
}

/// A parameter and the distribution that it was drawn from.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Varied {
    /// Full name of the parameter.
    pub name: String,
    /// Its flag.
    pub flag: &'static str,
    /// Its distribution, as in `model.toml`.
    pub distribution: Keyed<NumberOrWord>,
}

/// Correlation of the normal scores of two parameters.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Correlation {
    /// The two parameters.
    pub of: (String, String),
    /// The correlation.
    pub value: f64,
}

/// Which parameter drives which metric.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Sensitivity {
    /// "sobol", "morris" or "local".
    pub method: &'static str,
    /// Base points of Sobol indices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_points: Option<u64>,
    /// Trajectories of Morris.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trajectories: Option<u64>,
    /// Tests on each side for derivatives.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trials: Option<u64>,
    /// Tests that were simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether it was stopped before all of it was done.
    pub partial: bool,
    /// "simulated" or "absent".
    pub noise: &'static str,
    /// What was varied.
    pub parameters: Vec<Varied>,
    /// Correlations of the parameters.
    pub correlations: Vec<Correlation>,
    /// Sensitivities of each metric; "noise" stands for all that is random in a test.
    pub metrics: Keyed<OfMetric>,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Sensitivity {
    /// Sensitivities of the metrics of whole tests.
    pub fn new(found: &Found, asked: &Asked) -> Sensitivity {
        let keys = asked.varied.iter().map(|(quantity, _)| quantity.key());
        let keys: Vec<String> = keys.chain(asked.noisy.then(|| "noise".to_owned())).collect();
        let parameter = |(quantity, spread): &(Quantity, monte_carlo::Distribution)| Varied {
            name: quantity.key(),
            flag: quantity.parameter().flag,
            distribution: distribution(spread),
        };
        let correlation = |c: &sensitivity::Correlation| {
            let [a, b] = c.of.map(|place| keys[place].clone());
            Correlation { of: (a, b), value: c.value }
        };
        let metrics = asked.metrics.iter().enumerate();
        Sensitivity {
            method: match found {
                Found::Sobol(_) => "sobol",
                Found::Morris(_) => "morris",
                Found::Local(_) => "local",
            },
            base_points: match found {
                Found::Sobol(indices) => Some(indices.base_points),
                _ => None,
            },
            trajectories: match found {
                Found::Morris(screening) => Some(screening.trajectories),
                _ => None,
            },
            trials: matches!(found, Found::Local(_)).then_some(asked.study.trials),
            evaluations: match found {
                Found::Sobol(indices) => Some(indices.evaluations),
                Found::Morris(screening) => Some(screening.evaluations),
                Found::Local(_) => None,
            },
            seed: asked.study.seed,
            partial: found.is_partial(),
            noise: if asked.noisy { "simulated" } else { "absent" },
            parameters: asked.varied.iter().map(parameter).collect(),
            correlations: asked.correlations.iter().map(correlation).collect(),
            metrics: metrics.map(|(output, metric)| (metric.name(), OfMetric::new(found, output, &keys))).collect(),
            assumed: asked.assumed.to_vec(),
            version: crate::VERSION,
        }
    }
}
