//! `sensitivity`.

use super::study::distribution;
use crate::monte_carlo::{Distribution, Metric, Quantity, Study};
use crate::sensitivity::{Correlation, Derivative, Estimate, Indices, Screened, Screening};
use crate::stats::Interval;
use serde_json::{Map, Value, json};

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
    /// Whether less was done than was asked for.
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
    pub varied: &'a [(Quantity, Distribution)],
    /// Correlations of two of them, by their places.
    pub correlations: &'a [Correlation],
    /// The metrics, in the order of the outputs.
    pub metrics: &'a [Metric],
    /// The study about which parameters vary.
    pub study: &'a Study,
    /// Whether tests are simulated with their noise.
    pub noisy: bool,
    /// What nobody said and was assumed.
    pub assumed: &'a [String],
}

fn estimate(estimate: &Estimate) -> Value {
    let Interval { low, high } = estimate.interval;
    json!({ "value": estimate.value, "interval": [low, high] })
}

/// Sensitivities of the metrics of whole tests.
pub fn sensitivity(found: &Found, asked: &Asked) -> Value {
    let keys = asked.varied.iter().map(|(quantity, _)| quantity.key());
    let keys: Vec<String> = keys.chain(asked.noisy.then(|| "noise".to_owned())).collect();
    let parameter = |(quantity, spread): &(Quantity, Distribution)| json!({ "name": quantity.key(), "flag": quantity.parameter().flag, "distribution": distribution(spread) });
    let correlation = |c: &Correlation| json!({ "of": c.of.map(|place| keys[place].clone()), "value": c.value });
    let by_key = |estimates: &mut dyn Iterator<Item = Value>| -> Value {
        Value::Object(keys.iter().cloned().zip(estimates).collect())
    };
    let metric = |(output, metric): (usize, &Metric)| {
        let value = match found {
            Found::Sobol(indices) => {
                let output = &indices.outputs[output];
                let pair = |([i, j], value): &([usize; 2], Estimate)| {
                    let mut pair = estimate(value);
                    pair["of"] = json!([keys[*i], keys[*j]]);
                    pair
                };
                json!({
                    "mean": estimate(&output.mean), "std_dev": estimate(&output.std_dev),
                    "first": by_key(&mut output.first.iter().map(estimate)),
                    "total": by_key(&mut output.total.iter().map(estimate)),
                    "second": output.second.iter().map(pair).collect::<Value>(),
                })
            }
            Found::Morris(screening) => {
                let of = |pick: fn(&Screened) -> &Estimate| {
                    by_key(&mut screening.outputs[output].iter().map(|one| estimate(pick(one))))
                };
                json!({ "mu": of(|one| &one.mean), "mu_star": of(|one| &one.size), "sigma": of(|one| &one.spread) })
            }
            Found::Local(derivatives) => {
                let of = |pick: fn(&Derivative) -> &Estimate| {
                    by_key(&mut derivatives[output].iter().map(|one| estimate(pick(one))))
                };
                json!({ "per_unit": of(|one| &one.per_unit), "per_spread": of(|one| &one.per_spread) })
            }
        };
        (metric.name().to_owned(), value)
    };
    let metrics: Map<String, Value> = asked.metrics.iter().enumerate().map(metric).collect();
    let (method, effort) = match found {
        Found::Sobol(i) => ("sobol", json!({ "base_points": i.base_points, "evaluations": i.evaluations })),
        Found::Morris(s) => ("morris", json!({ "trajectories": s.trajectories, "evaluations": s.evaluations })),
        Found::Local(_) => ("local", json!({ "trials": asked.study.trials })),
    };
    let mut document = Map::from_iter([("method".to_owned(), json!(method))]);
    document.extend(effort.as_object().cloned().unwrap_or_default());
    let rest = json!({
        "seed": asked.study.seed, "partial": found.is_partial(),
        "noise": if asked.noisy { "simulated" } else { "absent" },
        "parameters": asked.varied.iter().map(parameter).collect::<Value>(), "correlations": asked.correlations.iter().map(correlation).collect::<Value>(),
        "metrics": metrics, "assumed": asked.assumed, "version": crate::VERSION,
    });
    document.extend(rest.as_object().cloned().unwrap_or_default());
    Value::Object(document)
}
