//! `plan`.

use schemars::JsonSchema;
use serde::Serialize;

use super::diagnosis::{Experiment, experiments};
use super::{Keyed, Runs};
use crate::diagnose::{self, Options};
use crate::plan::{self, Findings, Request, Setting, Shown};

/// A size to be detected, and the runs per direction that detect it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Sought {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// The size, in the unit of the parameter.
    pub value: f64,
    /// "calibrate", "diagnose", "not_asked" or "never".
    pub seen_by: &'static str,
    /// The effects of the model that absorb it; null unless it is "never" detected.
    pub absorbed_by: Option<Vec<&'static str>>,
    /// Runs per direction that detect it; null if 1000 are not enough.
    pub runs: Option<usize>,
    /// The same at both ends of the interval of the scatter; null if that is not from data.
    pub runs_at_sigma_interval: Option<[Option<usize>; 2]>,
    /// Probability that the planned runs detect it.
    pub power: f64,
    /// Experiments that would detect it if return poses do not.
    pub experiments: Vec<Experiment>,
}

impl From<&plan::Answer> for Sought {
    fn from(answer: &plan::Answer) -> Self {
        let (seen_by, absorbed_by) = match &answer.shown {
            Shown::Fitted(_) => ("calibrate", None),
            Shown::Asked => ("diagnose", None),
            Shown::Absorbed(by) => ("never", Some(by.clone())),
            Shown::BelowNoise => ("not_asked", None),
        };
        Sought {
            effect: answer.sought.effect.about.name,
            parameter: answer.sought.parameter.name,
            value: answer.value,
            seen_by,
            absorbed_by,
            runs: answer.runs,
            runs_at_sigma_interval: answer.runs_at_sigma,
            power: answer.power,
            experiments: experiments(&answer.separable),
        }
    }
}

/// Minimum size of an effect that is detected with the wanted power.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LeastSize {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// The size, in the unit of the parameter; null if none is detected.
    pub size: Option<f64>,
}

fn least(sizes: &[plan::Sought], values: &[Option<f64>]) -> Vec<LeastSize> {
    let one = |(s, size): (&plan::Sought, &Option<f64>)| LeastSize {
        effect: s.effect.about.name,
        parameter: s.parameter.name,
        size: *size,
    };
    sizes.iter().zip(values).map(one).collect()
}

/// E_max,sys as tests would measure it, and how precisely.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ExpectedEMaxSys {
    /// Mean over tests, in m.
    pub mean: f64,
    /// Standard deviation over tests, in m.
    pub std_dev: f64,
    /// Half the width of its interval, in m.
    pub interval_half_width_m: f64,
    /// Share of tests whose interval contains the true value.
    pub coverage: f64,
    /// Number of simulated tests.
    pub tests: u32,
    /// E_max,sys that a robot without systematic error stays below, in m.
    pub noise_band_m: f64,
}

/// What a number of runs per direction can detect.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OfRuns {
    /// Runs in each direction.
    pub runs: usize,
    /// Their duration, in min.
    pub minutes: f64,
    /// E_max,sys as they would measure it.
    pub e_max_sys_m: ExpectedEMaxSys,
    /// The minimum sizes that they detect.
    pub minimum_detectable: Vec<LeastSize>,
}

impl OfRuns {
    fn new(setting: &Setting, sizes: &[plan::Sought], row: &plan::OfRuns) -> OfRuns {
        let i = &row.interval;
        OfRuns {
            runs: i.runs,
            minutes: 2.0 * i.runs as f64 * setting.minutes_a_run(),
            e_max_sys_m: ExpectedEMaxSys {
                mean: i.mean,
                std_dev: i.std_dev,
                interval_half_width_m: i.half_width,
                coverage: i.coverage,
                tests: i.tests,
                noise_band_m: i.noise_band,
            },
            minimum_detectable: least(sizes, &row.least),
        }
    }
}

/// Another test in place of the planned one.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Alternative {
    /// What is driven.
    pub what: String,
    /// Numbers of runs.
    pub runs: Runs,
    /// Its duration, in min.
    pub minutes: f64,
    /// Scatter of the return positions, one coordinate, in m.
    pub sigma_m: f64,
    /// Half the width of the interval of E_max,sys, in m; null if the test does not give one.
    pub e_max_sys_interval_half_width_m: Option<f64>,
    /// The minimum sizes that it detects.
    pub minimum_detectable: Vec<LeastSize>,
}

impl Alternative {
    fn new(compared: &[plan::Sought], a: &plan::Alternative) -> Alternative {
        let [cw, ccw] = a.runs;
        Alternative {
            what: a.what.clone(),
            runs: Runs { cw, ccw },
            minutes: a.minutes,
            sigma_m: a.sigma,
            e_max_sys_interval_half_width_m: a.half_width,
            minimum_detectable: least(compared, &a.least),
        }
    }
}

/// The extended test, with bumps.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ExtendedTest {
    /// Number of bumps in a run.
    pub bumps: f64,
    /// Runs in each direction.
    pub runs: usize,
    /// Their duration, in min.
    pub minutes: f64,
    /// Average absolute orientation error (Eq. 5), in rad.
    pub nonsys_orientation_rad: f64,
    /// Half the width of its interval, in rad.
    pub interval_half_width_rad: f64,
}

/// A change over the session, and the error that it causes for an order of the runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Drift {
    /// The effect that changes.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// Its change, in the unit of the parameter.
    pub change: f64,
    /// "mirrored", "alternating" or "blocks".
    pub order: &'static str,
    /// The error that it causes in each quantity.
    pub error: Keyed<f64>,
    /// The same in standard deviations.
    pub error_sd: Keyed<f64>,
}

impl From<&plan::Drift> for Drift {
    fn from(d: &plan::Drift) -> Self {
        Drift {
            effect: d.effect,
            parameter: d.parameter,
            change: d.change,
            order: d.order.name(),
            error: d.errors.iter().map(|e| (e.0, e.1)).collect(),
            error_sd: d.errors.iter().map(|e| (e.0, e.2)).collect(),
        }
    }
}

/// What a test would show before it is driven.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Plan {
    /// Name of the robot.
    pub robot: String,
    /// Runs in each direction that are planned.
    pub runs: usize,
    /// Duration of a run, in min.
    pub minutes_a_run: f64,
    /// Scatter of the return positions, one coordinate, in m.
    pub sigma_m: f64,
    /// Its interval, in m; null if it is not from data.
    pub sigma_interval_m: Option<[f64; 2]>,
    /// E_max,sys of the robot on its path, in m.
    pub e_max_sys_m: f64,
    /// Whether return headings are measured.
    pub with_heading: bool,
    /// Power: probability with which a size should be detected.
    pub power: f64,
    /// False-alarm rate: probability of detecting an effect that the robot does not have.
    pub size: f64,
    /// Simulated tests for every figure without a closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// The sizes to be detected, with the runs that they need.
    pub see: Vec<Sought>,
    /// What each number of runs per direction can detect.
    pub by_runs: Vec<OfRuns>,
    /// Effects that no number of runs can detect.
    pub invisible: Vec<&'static str>,
    /// Another size, another speed, one direction only.
    pub alternatives: Vec<Alternative>,
    /// The extended test; null without bumps.
    pub extended: Option<ExtendedTest>,
    /// Error from a drift over the session, for each order of the runs.
    pub order: Vec<Drift>,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// Whether it was stopped early.
    pub partial: bool,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Plan {
    /// What a planned test would show; `assumed` is what was assumed, a phrase each.
    pub fn new(setting: &Setting, request: &Request, findings: &Findings, assumed: &[String]) -> Plan {
        let of_runs = |row: &plan::OfRuns| OfRuns::new(setting, &findings.sizes, row);
        let extended = |e: plan::ExtendedTest| ExtendedTest {
            bumps: e.bumps,
            runs: e.runs,
            minutes: e.minutes,
            nonsys_orientation_rad: e.orientation,
            interval_half_width_rad: e.half_width,
        };
        Plan {
            robot: setting.robot().name.clone(),
            runs: request.runs,
            minutes_a_run: setting.minutes_a_run(),
            sigma_m: setting.sigma(),
            sigma_interval_m: request.sigma_interval.map(|i| [i.low, i.high]),
            e_max_sys_m: setting.e_max_sys(),
            with_heading: setting.with_heading,
            power: request.power,
            size: request.options.size,
            draws: request.options.draws,
            seed: request.options.seed,
            see: findings.answers.iter().map(Sought::from).collect(),
            by_runs: findings.by_runs.iter().map(of_runs).collect(),
            invisible: findings.unseen.iter().map(|u| u.effect).collect(),
            alternatives: findings.alternatives.iter().map(|a| Alternative::new(&findings.compared, a)).collect(),
            extended: findings.extended.map(extended),
            order: findings.drifts.iter().map(Drift::from).collect(),
            assumed: assumed.to_vec(),
            partial: findings.partial,
            version: crate::VERSION,
        }
    }
}

/// Experiments that separate two effects, the most informative per minute first.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Separation {
    /// The two effects.
    pub separates: (String, String),
    /// The data to which the experiments are added.
    pub beside: String,
    /// The experiments, each with its separation in standard deviations and its duration.
    pub next_experiments: Vec<Experiment>,
    /// Seed of the simulated tests.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Separation {
    /// The experiments that were `ranked`, on top of what is `beside` them.
    pub fn new([a, b]: [&str; 2], beside: &str, ranked: &[diagnose::Experiment], options: &Options) -> Separation {
        Separation {
            separates: (a.to_owned(), b.to_owned()),
            beside: beside.to_owned(),
            next_experiments: experiments(ranked),
            seed: options.seed,
            version: crate::VERSION,
        }
    }
}
