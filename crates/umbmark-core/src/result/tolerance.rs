//! `tolerance`.

use schemars::JsonSchema;
use serde::Serialize;

use super::study::distribution;
use super::{Keyed, NumberOrWord, WithInterval};
use crate::monte_carlo::Metric;
use crate::sensitivity::Noise;
use crate::sensitivity::tolerance::{self, Findings, Varied};

/// What was asked.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// The parameters and their grades.
    pub parameters: &'a [Varied],
    /// The metric of the target.
    pub metric: Metric,
    /// The goal.
    pub target: &'a tolerance::Target,
    /// Whether the robots themselves are judged, or the results of a whole test with each.
    pub noise: Noise,
    /// Seed of the robots.
    pub seed: u64,
    /// What was assumed, a phrase each.
    pub assumed: &'a [String],
}

/// The required share of robots whose metric stays within a size.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Target {
    /// The size of a metric that is a length, in m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_most_m: Option<f64>,
    /// The size of a metric that is an angle, in rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_most_rad: Option<f64>,
    /// The share.
    pub share: f64,
}

/// A grade of tolerance.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Grade {
    /// Its number, from 1 as in the file.
    pub grade: usize,
    /// Its distribution, as in `model.toml`.
    pub distribution: Keyed<NumberOrWord>,
    /// Its cost.
    pub cost: f64,
}

/// Grades of all parameters, their cost, and the quality of the resulting robots.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Choice {
    /// The grade of each parameter.
    pub grades: Keyed<Grade>,
    /// Their total cost.
    pub cost: f64,
    /// The share of robots that meet the target.
    pub share_within: WithInterval,
    /// The quantile of the metric at the required share.
    pub quantile: WithInterval,
}

impl Choice {
    fn new(choice: &tolerance::Choice, wanted: &Wanted) -> Choice {
        let grade = |(one, grade): (&Varied, &usize)| {
            let chosen = &one.grades[*grade];
            let value = Grade { grade: grade + 1, distribution: distribution(&chosen.distribution), cost: chosen.cost };
            (one.quantity.key(), value)
        };
        Choice {
            grades: wanted.parameters.iter().zip(&choice.grades).map(grade).collect(),
            cost: choice.cost,
            share_within: (&choice.robots.share_within(wanted.target.at_most)).into(),
            quantile: (&choice.robots.quantile(wanted.target.share)).into(),
        }
    }
}

/// How many robots meet a target, and the cheapest tolerances with which enough do.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Tolerance {
    /// The metric of the target.
    pub metric: &'static str,
    /// The target.
    pub target: Target,
    /// "simulated" or "absent".
    pub noise: &'static str,
    /// Robots drawn for each choice of grades.
    pub robots: usize,
    /// Seed of the robots.
    pub seed: u64,
    /// Whether it was stopped before all choices were tested.
    pub partial: bool,
    /// The first grade of every parameter.
    pub now: Choice,
    /// One parameter tightened alone.
    pub alone: Vec<Choice>,
    /// The last grade of every parameter.
    pub last: Choice,
    /// The cheapest choice that certainly meets the target, tested on newly drawn robots; null if none does.
    pub cheapest: Option<Choice>,
    /// Number of choices that were tested.
    pub choices_looked_at: u64,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Tolerance {
    /// What was found of what was wanted.
    pub fn new(findings: &Findings, wanted: &Wanted) -> Tolerance {
        let target = wanted.target;
        let angle = wanted.metric.is_angle();
        Tolerance {
            metric: wanted.metric.name(),
            target: Target {
                at_most_m: (!angle).then_some(target.at_most),
                at_most_rad: angle.then_some(target.at_most),
                share: target.share,
            },
            noise: match wanted.noise {
                Noise::Simulated => "simulated",
                Noise::Absent => "absent",
            },
            robots: findings.now.robots.sizes().len(),
            seed: wanted.seed,
            partial: findings.partial,
            now: Choice::new(&findings.now, wanted),
            alone: findings.alone.iter().map(|choice| Choice::new(choice, wanted)).collect(),
            last: Choice::new(&findings.last, wanted),
            cheapest: findings.cheapest.as_ref().map(|choice| Choice::new(choice, wanted)),
            choices_looked_at: findings.looked_at,
            assumed: wanted.assumed.to_vec(),
            version: crate::VERSION,
        }
    }
}
