//! `compare`.

use schemars::JsonSchema;
use serde::Serialize;

use super::remains::least_left;
use super::{Closure, Keyed, Leaves, Setup};
use crate::compare::{self, NoiseSource};
use crate::diagnose::Options;

/// A statistic as measured and as a model predicts it, in m, rad or 1.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Statistic {
    /// As measured.
    pub measured: f64,
    /// As the model predicts it.
    pub predicted: f64,
    /// Probability of so large a difference where the model is right.
    pub p: f64,
}

/// How one model does.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Judged {
    /// Its name.
    pub name: String,
    /// Whether it explains the runs.
    pub explains: bool,
    /// p of all statistics together.
    pub p: f64,
    /// "model" where the noise is the model's, "pooled" where it is that of the runs.
    pub noise: &'static str,
    /// Root mean square error of positions, in m.
    pub rmse_m: f64,
    /// The same of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
    /// Each statistic, by direction and quantity.
    pub statistics: Keyed<Keyed<Statistic>>,
    /// Where it fails, a sentence each.
    pub sentences: Vec<String>,
    /// What the model leaves.
    #[serde(flatten)]
    pub leaves: Leaves,
}

impl Judged {
    fn new(judged: &compare::Judged, options: &Options) -> Judged {
        let mut directions: Vec<&str> = Vec::new();
        for s in &judged.statistics {
            if !directions.contains(&s.direction.name()) {
                directions.push(s.direction.name());
            }
        }
        let of = |direction: &str| {
            let own = judged.statistics.iter().filter(|s| s.direction.name() == direction);
            let one = |s: &compare::Statistic| Statistic { measured: s.measured, predicted: s.predicted, p: s.p };
            own.map(|s| (s.quantity.key(), one(s))).collect()
        };
        Judged {
            name: judged.name.clone(),
            explains: judged.explains(options.size),
            p: judged.p,
            noise: match judged.noise {
                NoiseSource::Model => "model",
                NoiseSource::Pooled => "pooled",
            },
            rmse_m: judged.rmse,
            heading_rmse_rad: judged.heading_rmse,
            statistics: directions.into_iter().map(|direction| (direction, of(direction))).collect(),
            sentences: judged.sentences.clone(),
            leaves: Some(&judged.remains).into(),
        }
    }
}

/// Models beside measurements: which explain them, and where the others fail.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Comparison {
    /// "end_poses".
    pub observed: &'static str,
    /// Number of clockwise runs.
    pub n_cw: usize,
    /// Number of counter-clockwise runs.
    pub n_ccw: usize,
    /// The models, in the order in which they were given.
    pub models: Vec<Judged>,
    /// What was found of the data before anything was fitted: faults, clock and mounting of the reference, jumps, wrong poses, runs far from
    /// the others.
    pub setup: Setup,
    /// What else should be said.
    pub remarks: Vec<String>,
    /// False-alarm rate: probability with which a right model is accused.
    pub size: f64,
    /// Simulated tests for the p-values.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
    /// What the closure of a square says.
    #[serde(flatten)]
    pub closure: Closure,
    /// What the model leaves which leaves least.
    #[serde(flatten)]
    pub leaves: Leaves,
}

impl Comparison {
    /// A comparison that was asked for with `options`.
    pub fn new(comparison: &compare::Comparison, options: &Options) -> Comparison {
        Comparison {
            observed: "end_poses",
            n_cw: comparison.runs[0],
            n_ccw: comparison.runs[1],
            models: comparison.models.iter().map(|judged| Judged::new(judged, options)).collect(),
            setup: comparison.setup.as_ref().into(),
            remarks: comparison.remarks.clone(),
            size: options.size,
            draws: options.draws,
            seed: options.seed,
            version: crate::VERSION,
            closure: Closure::new(&comparison.contrasts, &comparison.circle),
            leaves: least_left(comparison.models.iter().map(|model| &model.remains)).into(),
        }
    }
}
