//! `solve`.

use schemars::JsonSchema;
use serde::Serialize;

use super::diagnosis::Confounder;
use super::fitted::{Estimate, estimates, meaning};
use super::{Keyed, Leaves, Model, Setup, finite, reasons};
use crate::action::Wording;
use crate::diagnose::Options;
use crate::solve;

/// A number of the robot, old and new.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Change {
    /// As the robot has it now.
    pub old: f64,
    /// As it should be.
    pub new: f64,
    /// Lower end of the interval of the new value; null where the runs are too few.
    pub low: Option<f64>,
    /// Upper end of it; null where the runs are too few.
    pub high: Option<f64>,
    /// By how much writing it lowers the error in the recorded runs, in m: these add up to the fall by all new numbers; null where the error
    /// is not known.
    pub worth_m: Option<f64>,
}

/// The new numbers of a robot by their keys in robot.toml.
pub type Changes = Keyed<Change>;

/// The new numbers of an answer.
pub(super) fn changes(changes: &[solve::Change]) -> Changes {
    let one = |change: &solve::Change| {
        let [low, high] = [change.interval.map(|i| i.low), change.interval.map(|i| i.high)];
        (change.key, Change { old: change.old, new: change.new, low, high, worth_m: change.worth.and_then(finite) })
    };
    changes.iter().map(one).collect()
}

/// How far off a robot is, and what of it is what. Each list of parts adds up to the fall between the errors before and after it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Off {
    /// What is measured: "e_max_sys" (mean returns of both directions), "end_rmse" (ends of runs), "rmse_along" (all measured
    /// poses) or "rmse_steps" (all measured steps).
    pub measure: &'static str,
    /// Error as driven, in m.
    pub driven_m: Option<f64>,
    /// Parts of it that are the reference's and not the robot's, by effect, in m.
    pub reference_m: Keyed<Option<f64>>,
    /// Parts of it that new numbers take away, by effect, in m.
    pub written_m: Keyed<Option<f64>>,
    /// Parts of it that are known and that no number of the robot holds, by effect, in m.
    pub known_m: Keyed<Option<f64>>,
    /// What all of the model leaves of it, in m.
    pub rest_m: Option<f64>,
    /// What chance alone stays below in 95 % of tests, in m; null where that is not known.
    pub chance_m: Option<f64>,
}

impl From<&solve::Off> for Off {
    fn from(off: &solve::Off) -> Self {
        let parts = |parts: &[solve::Part]| parts.iter().map(|part| (part.name, finite(part.worth))).collect();
        Off {
            measure: off.measure.name(),
            driven_m: finite(off.driven),
            reference_m: parts(&off.reference),
            written_m: parts(&off.written),
            known_m: parts(&off.known),
            rest_m: finite(off.rest),
            chance_m: off.chance.and_then(finite),
        }
    }
}

/// The one answer about a measured robot: what is wrong, what to write into it, what remains, and what to do next.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Solution {
    /// What the last diagnosis of the model says, in the words of `Diagnosis`.
    pub verdict: &'static str,
    /// The answer in words.
    pub sentence: String,
    /// The new numbers of the robot by their keys in robot.toml; empty where these runs show none. Where `not_shown` has "scale", lengths and
    /// their intervals hold if the mean wheel diameter is right.
    pub correction: Changes,
    /// Whether the new numbers differ from the old ones by more than chance.
    pub needed: bool,
    /// Whether the new numbers may be written: the model explains the runs, and the data are in order.
    pub trusted: bool,
    /// Error that remains with the new numbers in the robot, in m; null where it is not known.
    pub remains_m: Option<f64>,
    /// How far off the robot is, and what of it is what; null where it is not known.
    pub off: Option<Off>,
    /// What to do next, a sentence each.
    pub next: Vec<String>,
    /// What these runs do not show of the robot: effects that become numbers of it.
    pub not_shown: Vec<&'static str>,
    /// Effects that the model lacks, of sizes that these runs allow, that would bias its first numbers, the worst first.
    pub confounders: Vec<Confounder>,
    /// Why the verdict is not "explained", a sentence each.
    pub reasons: Vec<String>,
    /// The model that was learnt.
    pub model: Model,
    /// Its free parameters.
    pub fitted: Vec<Estimate>,
    /// Their correlations, a row each; empty where the data does not determine them.
    pub correlations: Vec<Vec<f64>>,
    /// Meaning of each fitted effect for the robot, a sentence each.
    pub meaning: Keyed<String>,
    /// Findings about the data before any fit: faults, clock and mounting of the reference, jumps, wrong poses, outlying runs.
    pub setup: Setup,
    /// Whether learning was stopped before the search for missing effects ended.
    pub partial: bool,
    /// Probability with which an effect is added to a complete model; intervals hold with the rest.
    pub size: f64,
    /// Simulated tests for p-values that have no closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
    /// The remaining error of the model.
    #[serde(flatten)]
    pub leaves: Leaves,
}

impl Solution {
    /// An answer that was found with `options`, with what an edge calls its actions.
    pub fn new(solution: &solve::Solution, options: &Options, words: Wording) -> Solution {
        let learnt = &solution.learnt;
        let diagnosis = &learnt.diagnosis;
        Solution {
            verdict: learnt.verdict.name(),
            sentence: solution.sentence(),
            correction: changes(&solution.changes),
            needed: solution.needed,
            trusted: solution.is_trusted(),
            remains_m: solution.off.as_ref().and_then(|off| finite(off.with_numbers)),
            off: solution.off.as_ref().map(Off::from),
            next: solution.next(words),
            not_shown: solution.not_shown.clone(),
            confounders: diagnosis.confounders.iter().map(Confounder::from).collect(),
            reasons: reasons(&diagnosis.reasons),
            model: Model::with_noise(&learnt.model, learnt.noise.as_ref()),
            fitted: estimates(&diagnosis.fitted, 1.0 - options.size),
            correlations: diagnosis.correlations.clone(),
            meaning: meaning(&diagnosis.fitted, &learnt.model),
            setup: diagnosis.setup.as_ref().into(),
            partial: learnt.partial,
            size: options.size,
            draws: options.draws,
            seed: options.seed,
            version: crate::VERSION,
            leaves: diagnosis.remains.as_ref().into(),
        }
    }
}
