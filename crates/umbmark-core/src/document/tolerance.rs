//! `tolerance`.

use super::study::distribution;
use crate::monte_carlo::Metric;
use crate::sensitivity::tolerance::{Choice, Findings, Target, Varied};
use crate::sensitivity::{Estimate, Noise};
use serde_json::{Map, Value, json};

/// What was asked.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// The parameters and their grades.
    pub parameters: &'a [Varied],
    /// The metric of the target.
    pub metric: Metric,
    /// The goal.
    pub target: &'a Target,
    /// Whether the robots themselves are judged, or what a whole test shows of them.
    pub noise: Noise,
    /// Seed of the robots.
    pub seed: u64,
    /// What nobody said and was assumed, a phrase each.
    pub assumed: &'a [String],
}

/// How many robots are good enough, and the cheapest tolerances that make it enough.
pub fn tolerance(findings: &Findings, wanted: &Wanted) -> Value {
    let target = wanted.target;
    let at_most = if wanted.metric.is_angle() { "at_most_rad" } else { "at_most_m" };
    let told = |choice: &Choice| told(choice, wanted);
    json!({
        "metric": wanted.metric.name(), "target": { at_most: target.at_most, "share": target.share },
        "noise": match wanted.noise { Noise::Simulated => "simulated", Noise::Absent => "absent" },
        "robots": findings.now.robots.sizes().len(), "seed": wanted.seed, "partial": findings.partial,
        "now": told(&findings.now), "alone": findings.alone.iter().map(told).collect::<Value>(),
        "last": told(&findings.last),
        "cheapest": findings.cheapest.as_ref().map(told), "choices_looked_at": findings.looked_at,
        "assumed": wanted.assumed, "version": crate::VERSION,
    })
}

fn told(choice: &Choice, wanted: &Wanted) -> Value {
    let estimate = |e: Estimate| json!({ "value": e.value, "interval": [e.interval.low, e.interval.high] });
    let grade = |(one, grade): (&Varied, &usize)| {
        let chosen = &one.grades[*grade];
        let value =
            json!({ "grade": grade + 1, "distribution": distribution(&chosen.distribution), "cost": chosen.cost });
        (one.quantity.key(), value)
    };
    let grades: Map<String, Value> = wanted.parameters.iter().zip(&choice.grades).map(grade).collect();
    json!({
        "grades": grades, "cost": choice.cost,
        "share_within": estimate(choice.robots.share_within(wanted.target.at_most)),
        "quantile": estimate(choice.robots.quantile(wanted.target.share)),
    })
}
