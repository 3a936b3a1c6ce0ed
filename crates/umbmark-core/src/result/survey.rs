//! `survey`.

use schemars::JsonSchema;
use serde::Serialize;

use super::fitted::{Estimate, estimates};
use super::{ends, finite};
use crate::diagnose::Options;
use crate::survey;

/// A number in which a robot stands out from the others.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct StandsOut {
    /// The number, EFFECT.PARAMETER.
    pub key: String,
    /// p adjusted for all robots and numbers.
    pub p_adjusted: f64,
}

/// What was found of one robot.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SurveyedRobot {
    /// Its name.
    pub robot: String,
    /// Number of runs.
    pub runs: usize,
    /// Its numbers: E_d, E_b and, of tracks, E_s, or those of its drive.
    pub fitted: Vec<Estimate>,
    /// E_max,sys in m; null where not both directions returned.
    pub e_max_sys_m: Option<f64>,
    /// Whether these numbers explain the runs, in the words of `Diagnosis`; null where no robot was diagnosed.
    pub verdict: Option<&'static str>,
    /// The class of effects that is missing.
    pub missing: Vec<&'static str>,
    /// Numbers in which it stands out from the others.
    pub stands_out: Vec<StandsOut>,
}

/// A robot of which nothing was found.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FailedRobot {
    /// Its name.
    pub robot: String,
    /// Why.
    pub reason: String,
}

/// How far robots are apart in one number.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AmongRobots {
    /// The number, EFFECT.PARAMETER.
    pub key: String,
    /// Number of robots that show it and do not stand out.
    pub robots: usize,
    /// Their mean.
    pub mean: f64,
    /// Its interval.
    pub interval: Option<[f64; 2]>,
    /// Standard deviation between robots, without the errors of their tests (restricted maximum likelihood).
    pub sd_between: f64,
    /// Its interval; an end is null where the robots leave it open.
    pub sd_between_interval: [Option<f64>; 2],
    /// Standard error of one robot's number, root mean square.
    pub standard_error: f64,
}

/// Many robots of one kind.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Survey {
    /// A row for each robot of which something was found.
    pub robots: Vec<SurveyedRobot>,
    /// Robots of which nothing was found.
    pub failed: Vec<FailedRobot>,
    /// How far they are apart.
    pub among: Vec<AmongRobots>,
    /// False-alarm rate: of the verdict on one robot, and of all robots that stand out together; intervals hold with the rest.
    pub size: f64,
    /// Whether the work was stopped before all robots were asked.
    pub partial: bool,
    /// Simulated tests for p-values that have no closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Survey {
    /// Robots that were asked with `options`.
    pub fn new(found: &survey::Survey, options: &Options) -> Survey {
        let robot = |row: &survey::Row| SurveyedRobot {
            robot: row.robot.clone(),
            runs: row.runs,
            fitted: estimates(&row.numbers, 1.0 - found.size),
            e_max_sys_m: row.e_max_sys.and_then(finite),
            verdict: row.verdict.map(|verdict| verdict.name()),
            missing: row.missing.clone(),
            stands_out: row
                .stands_out
                .iter()
                .map(|(number, p_adjusted)| StandsOut { key: number.key(), p_adjusted: *p_adjusted })
                .collect(),
        };
        let failed = |(robot, reason): &(String, String)| FailedRobot { robot: robot.clone(), reason: reason.clone() };
        let among = |among: &survey::Among| AmongRobots {
            key: among.number.key(),
            robots: among.robots,
            mean: among.mean,
            interval: ends(among.interval),
            sd_between: among.deviation,
            sd_between_interval: [finite(among.deviation_interval.low), finite(among.deviation_interval.high)],
            standard_error: among.error,
        };
        Survey {
            robots: found.rows.iter().map(robot).collect(),
            failed: found.failed.iter().map(failed).collect(),
            among: found.among.iter().map(among).collect(),
            size: found.size,
            partial: found.partial,
            draws: options.draws,
            seed: options.seed,
            version: crate::VERSION,
        }
    }
}
