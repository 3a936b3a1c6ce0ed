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
    /// Probability of a difference this large if the model is right.
    pub p: f64,
}

/// Result of one model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Judged {
    /// Its name.
    pub name: String,
    /// Whether it explains the runs.
    pub explains: bool,
    /// p of all statistics together.
    pub p: f64,
    /// "model" if the noise is the model's, "pooled" if it is the scatter of the runs.
    pub noise: &'static str,
    /// Root mean square error of positions, in m.
    pub rmse_m: f64,
    /// The same of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
    /// Each statistic, by direction and quantity.
    pub statistics: Keyed<Keyed<Statistic>>,
    /// Where it fails, a sentence each.
    pub sentences: Vec<String>,
    /// The remaining error of the model.
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

/// Models compared with measurements: which explain them, and where the others fail.
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
    /// Findings about the data before any fit: faults, clock and mounting of the reference, jumps, wrong poses, outlying runs.
    pub setup: Setup,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// False-alarm rate: probability that a correct model is rejected.
    pub size: f64,
    /// Simulated tests for the p-values.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
    /// The closure of a square: contrasts, and end points on a circle.
    #[serde(flatten)]
    pub closure: Closure,
    /// The remaining error of the best model.
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
