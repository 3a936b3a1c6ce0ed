//! `mc` and `simulate`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Keyed, finite};
use crate::calibrate::{Angles, Correction};
use crate::monte_carlo::{self, Draw, Ensemble, Statistics, StudyError};
use crate::path::{Direction, SQUARE};
use crate::score::summarise;
use crate::{dataset, preset};

/// The quantiles of a result.
const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// A number, or one of several words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum NumberOrWord {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
}

/// A value of an effect, or the distribution that it is drawn from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Setting {
    /// A word.
    Word(String),
    /// A number.
    Number(f64),
    /// A distribution, as in `model.toml`.
    Drawn(Keyed<NumberOrWord>),
}

/// A distribution, as in `model.toml`.
pub(super) fn distribution(distribution: &monte_carlo::Distribution) -> Keyed<NumberOrWord> {
    use monte_carlo::Distribution;
    let (numbers, scale) = match *distribution {
        Distribution::Normal { mean, sd } => (vec![("mean", mean), ("sd", sd)], None),
        Distribution::Uniform { min, max } => (vec![("min", min), ("max", max)], None),
        Distribution::Triangular { min, mode, max } => (vec![("min", min), ("mode", mode), ("max", max)], None),
        Distribution::LogUniform { min, max } => (vec![("min", min), ("max", max)], Some("log")),
    };
    let numbers = numbers.into_iter().map(|(key, number)| (key, NumberOrWord::Number(number)));
    numbers.chain(scale.map(|word| ("scale", NumberOrWord::Word(word.to_owned())))).collect()
}

/// E_max,sys of the test without noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoiseFree {
    /// By exact kinematics, in m; null without runs of both directions.
    pub e_max_sys_m: Option<f64>,
    /// By the formulas of the paper's companion, in m; null where the test is no square of a differential drive.
    pub first_order_e_max_sys_m: Option<f64>,
}

impl NoiseFree {
    /// That of a study, all drawn parameters in their middle.
    pub fn of(study: &monte_carlo::Study) -> Result<NoiseFree, StudyError> {
        let [cw, ccw] = study.noise_free()?;
        let middle = |effect: &str, parameter: &str| {
            let drawn = study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter);
            drawn.map(Draw::centre).or(study.model.get(effect, parameter)).unwrap_or(1.0)
        };
        let e_d = middle("wheel_diameter_ratio", "e_d");
        // A square sees the ratio of the two only.
        let e_b = middle("wheelbase", "e_b") / middle("scale", "e_s");
        let of_paper = std::ptr::eq(study.path.shape(), &SQUARE) && study.robot().drive.kind().has_axle_wheels();
        let side = study.path.values().first().filter(|_| of_paper);
        let first_order = side.and_then(|side| {
            let angles = Angles::of(&Correction { e_d, e_b, e_s: 1.0 }, *side, &study.robot().drive);
            let [cw, ccw] = Direction::BOTH.map(|direction| angles.first_order_return(direction, *side));
            summarise(&[cw], &[ccw]).e_max_sys()
        });
        Ok(NoiseFree { e_max_sys_m: summarise(&[cw], &[ccw]).e_max_sys(), first_order_e_max_sys_m: first_order })
    }
}

/// Numbers of runs in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Runs {
    /// Clockwise.
    pub cw: usize,
    /// Counter-clockwise.
    pub ccw: usize,
}

/// Shape and sizes of a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PathSizes {
    /// Its shape.
    pub shape: String,
    /// Its sizes, in the units that their names carry.
    pub sizes: Keyed<f64>,
}

/// What was published of a robot: its row of Table I.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Published {
    /// The row.
    pub row: String,
    /// E_max,sys, in m.
    pub e_max_sys_m: f64,
    /// Standard deviation of one coordinate, in m.
    pub sigma_m: f64,
}

impl From<preset::Published> for Published {
    fn from(p: preset::Published) -> Self {
        Published { row: p.row.to_owned(), e_max_sys_m: p.e_max_sys, sigma_m: p.sigma }
    }
}

/// What a study is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Study {
    /// The same test without noise.
    pub noise_free: NoiseFree,
    /// Numbers of runs of each test.
    pub runs: Runs,
    /// Name of the robot.
    pub robot: String,
    /// The path.
    pub path: PathSizes,
    /// The effects, in the order in which they act: each with its name and its values, or the distributions that these are drawn from.
    pub effects: Vec<Keyed<Setting>>,
    /// Sources of the values, a phrase each.
    pub sources: Vec<String>,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// What was published about this test; null if nothing.
    pub published: Option<Published>,
    /// Version of umbmark.
    pub version: String,
}

/// What is to be said of a study beside its numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told<'a> {
    /// Sources of the values, a phrase each.
    pub sources: &'a [String],
    /// What was assumed, a phrase each.
    pub assumed: &'a [String],
    /// What was published of this test.
    pub published: Option<preset::Published>,
}

impl Study {
    /// What a study is, with what it gives without noise.
    pub fn new(study: &monte_carlo::Study, noise_free: &NoiseFree, told: &Told) -> Study {
        let path = &study.path;
        let sizes = path.shape().parameters.iter().zip(path.values());
        let [cw, ccw] = study.runs;
        Study {
            noise_free: noise_free.clone(),
            runs: Runs { cw, ccw },
            robot: study.robot().name.clone(),
            path: PathSizes {
                shape: path.shape().name.to_owned(),
                sizes: sizes.map(|(parameter, value)| (parameter.name, *value)).collect(),
            },
            effects: effects(study),
            sources: told.sources.to_vec(),
            assumed: told.assumed.to_vec(),
            published: told.published.map(Published::from),
            version: crate::VERSION.to_owned(),
        }
    }
}

fn effects(study: &monte_carlo::Study) -> Vec<Keyed<Setting>> {
    let drawn = |effect: &str, parameter: &str| {
        study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter)
    };
    let effect = |part: &crate::effect::Part| {
        let name = part.effect.name();
        let values = part.effect.parameters().iter().zip(&part.values).map(|(parameter, value)| {
            let setting = match (drawn(name, parameter.name), parameter.word(*value)) {
                (Some(draw), _) => Setting::Drawn(distribution(&draw.distribution())),
                (None, Some(word)) => Setting::Word(word.to_owned()),
                (None, None) => Setting::Number(*value),
            };
            (parameter.name, setting)
        });
        std::iter::once(("name", Setting::Word(name.to_owned()))).chain(values).collect()
    };
    study.model.parts().iter().map(effect).collect()
}

/// Statistics of a metric over the trials, in its unit.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MetricStatistics {
    /// Mean; null if no trial has the metric.
    pub mean: Option<f64>,
    /// Standard deviation; null for fewer than two trials.
    pub std_dev: Option<f64>,
    /// Standard error of the mean; null for fewer than two trials.
    pub std_error: Option<f64>,
    /// Smallest value; null if no trial has the metric.
    pub min: Option<f64>,
    /// Largest value; null if no trial has the metric.
    pub max: Option<f64>,
    /// Quantiles, by the share that lies below.
    pub quantiles: Keyed<Option<f64>>,
}

impl From<&Statistics> for MetricStatistics {
    fn from(s: &Statistics) -> Self {
        MetricStatistics {
            mean: finite(s.mean()),
            std_dev: finite(s.std_dev()),
            std_error: finite(s.std_error()),
            min: finite(s.min()),
            max: finite(s.max()),
            quantiles: QUANTILES.iter().map(|q| (q.to_string(), finite(s.quantile(*q)))).collect(),
        }
    }
}

/// The result of a study.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MonteCarlo {
    /// Trials done.
    pub n: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether it was stopped before all trials were done.
    pub partial: bool,
    /// The metrics that the test has: "e_max_sys_m", "sigma_m", "centroid_cw_x_m", ...
    pub metrics: Keyed<MetricStatistics>,
    /// Trials per second; null if that was not measured.
    pub trials_per_s: Option<f64>,
    /// What the study is.
    #[serde(flatten)]
    pub study: Study,
}

impl MonteCarlo {
    /// An ensemble of a study with its seed; `partial` where trials that were asked for are not done.
    pub fn new(ensemble: &Ensemble, seed: u64, partial: bool, trials_per_s: Option<f64>, study: &Study) -> MonteCarlo {
        MonteCarlo {
            n: ensemble.trials(),
            seed,
            partial,
            metrics: ensemble.statistics().map(|(metric, s)| (metric.name(), s.into())).collect(),
            trials_per_s,
            study: study.clone(),
        }
    }
}

/// A run that was simulated.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SimulatedRun {
    /// Its name.
    pub run: String,
    /// "cw" or "ccw"; null where it has neither.
    pub direction: Option<&'static str>,
    /// "systematic" or "bumps".
    pub test: &'static str,
    /// Return error along the START heading, in m.
    pub ex_m: f64,
    /// Return error to the left of it, in m.
    pub ey_m: f64,
    /// Return error of the heading, in rad; null if it was not measured.
    pub etheta_rad: Option<f64>,
}

impl From<&dataset::Run> for SimulatedRun {
    fn from(run: &dataset::Run) -> Self {
        let error = run.returned.unwrap_or_default();
        SimulatedRun {
            run: run.name.clone(),
            direction: run.direction.map(Direction::name),
            test: run.test.name(),
            ex_m: error.x,
            ey_m: error.y,
            etheta_rad: error.heading,
        }
    }
}
