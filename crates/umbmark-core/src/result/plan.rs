//! `plan`.

use schemars::JsonSchema;
use serde::Serialize;

use super::diagnosis::{Experiment, experiments};
use super::{Keyed, Runs};
use crate::diagnose::{self, Options};
use crate::plan::{self, Findings, Request, Setting, Shown};

/// A size that is to be seen, and how many runs a direction show it.
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
    /// The effects of the model that make up for it; null where it is not "never" seen.
    pub absorbed_by: Option<Vec<&'static str>>,
    /// Runs a direction that show it; null where 1000 do not.
    pub runs: Option<usize>,
    /// The same at both ends of the interval of the scatter; null where that is not from data.
    pub runs_at_sigma_interval: Option<[Option<usize>; 2]>,
    /// Probability with which the planned runs show it.
    pub power: f64,
    /// Experiments that would show it where return poses do not.
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

/// The least size of an effect that is seen with the wanted power.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LeastSize {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// The size, in the unit of the parameter; null where none is seen.
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

/// E_max,sys as tests would read it, and how well.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ExpectedEMaxSys {
    /// Mean over tests, in m.
    pub mean: f64,
    /// Standard deviation over tests, in m.
    pub std_dev: f64,
    /// Half the width of its interval, in m.
    pub interval_half_width_m: f64,
    /// The share of tests whose interval holds the true value.
    pub coverage: f64,
    /// Number of simulated tests.
    pub tests: u32,
    /// E_max,sys that a robot without systematic error stays below, in m.
    pub noise_band_m: f64,
}

/// What a number of runs a direction shows.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OfRuns {
    /// Runs in each direction.
    pub runs: usize,
    /// How long they take, in min.
    pub minutes: f64,
    /// E_max,sys as they would read it.
    pub e_max_sys_m: ExpectedEMaxSys,
    /// The least sizes that they show.
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
    /// How long it takes, in min.
    pub minutes: f64,
    /// Scatter of the return positions, one coordinate, in m.
    pub sigma_m: f64,
    /// Half the width of the interval of E_max,sys, in m; null where the test does not give one.
    pub e_max_sys_interval_half_width_m: Option<f64>,
    /// The least sizes that it shows.
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
    /// How long they take, in min.
    pub minutes: f64,
    /// Average absolute orientation error (Eq. 5), in rad.
    pub nonsys_orientation_rad: f64,
    /// Half the width of its interval, in rad.
    pub interval_half_width_rad: f64,
}

/// A change over the session, and the error that it makes in an order of the runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Drift {
    /// The effect that changes.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// By how much it changes, in the unit of the parameter.
    pub change: f64,
    /// "mirrored", "alternating" or "blocks".
    pub order: &'static str,
    /// The error that it makes, of each quantity.
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
    /// How long a run takes, in min.
    pub minutes_a_run: f64,
    /// Scatter of the return positions, one coordinate, in m.
    pub sigma_m: f64,
    /// Its interval, in m; null where it is not from data.
    pub sigma_interval_m: Option<[f64; 2]>,
    /// E_max,sys of the robot on its path, in m.
    pub e_max_sys_m: f64,
    /// Whether return headings are measured.
    pub with_heading: bool,
    /// Probability with which a size is to be seen.
    pub power: f64,
    /// False-alarm rate: probability with which a robot without it is accused.
    pub size: f64,
    /// Simulated tests behind every figure that has no closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// The sizes that are to be seen, with the runs that they take.
    pub see: Vec<Sought>,
    /// What each number of runs a direction shows.
    pub by_runs: Vec<OfRuns>,
    /// Effects that no number of runs shows.
    pub invisible: Vec<&'static str>,
    /// Another size, another speed, one direction only.
    pub alternatives: Vec<Alternative>,
    /// The extended test; null without bumps.
    pub extended: Option<ExtendedTest>,
    /// What a drift of the session does in each order of the runs.
    pub order: Vec<Drift>,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// Whether it was stopped before all was looked at.
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

/// Experiments that tell two effects apart, the most telling per minute first.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Separation {
    /// The two effects.
    pub separates: (String, String),
    /// What the experiments come on top of.
    pub beside: String,
    /// How many standard deviations apart each puts them, and how long it takes.
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
