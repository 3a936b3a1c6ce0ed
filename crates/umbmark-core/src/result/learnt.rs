//! `learn`.

use schemars::JsonSchema;
use serde::Serialize;

use super::diagnosis::{Confounder, Experiment, Unlisted, experiments};
use super::fitted::{Estimate, estimates};
use super::law::Repeated;
use super::solution::{Changes, changes};
use super::{Findings, Leaves, Model, finite};
use crate::diagnose::Options;
use crate::learn;
use crate::solve::Solution;

/// One step of learning.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Step {
    /// The effect that was added; null for the nominal robot.
    pub added: Option<&'static str>,
    /// Effects that this data cannot separate from it, including itself.
    pub class: Vec<&'static str>,
    /// Its p, corrected for all classes that were tested; null if nothing was tested.
    pub p_adjusted: Option<f64>,
    /// For a law outside the catalogue: how it was found, its alternatives, and its fitted formula.
    pub law: Option<Repeated>,
    /// Error of positions in the runs that the model was fitted to, in m.
    pub rmse_m: Option<f64>,
    /// The same of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
    /// Error of positions in held-out runs, in m.
    pub heldout_rmse_m: Option<f64>,
    /// The same of headings, in rad; null where none were measured.
    pub heldout_heading_rmse_rad: Option<f64>,
    /// Error of positions of the runs of each level of a condition, predicted by the model fitted to those of the other levels, in m: one for each
    /// of the conditions.
    pub elsewhere_rmse_m: Vec<Option<f64>>,
    /// The same of headings, in rad; null where none were measured.
    pub elsewhere_heading_rmse_rad: Vec<Option<f64>>,
    /// Akaike's information criterion, corrected for few runs; null where these are too few.
    pub aicc: Option<f64>,
    /// Schwarz's information criterion; null where the runs are too few.
    pub bic: Option<f64>,
}

impl From<&learn::Step> for Step {
    fn from(s: &learn::Step) -> Self {
        Step {
            added: s.added,
            class: s.class.clone(),
            p_adjusted: s.p_adjusted,
            law: s.law.as_deref().map(Repeated::from),
            rmse_m: finite(s.error.position),
            heading_rmse_rad: s.error.heading,
            heldout_rmse_m: finite(s.held_out.position),
            heldout_heading_rmse_rad: s.held_out.heading,
            elsewhere_rmse_m: s.elsewhere.iter().map(|error| finite(error.position)).collect(),
            elsewhere_heading_rmse_rad: s.elsewhere.iter().map(|error| error.heading).collect(),
            aicc: s.aicc,
            bic: s.bic,
        }
    }
}

/// An effect that the runs of one level of a condition alone tell.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ToldOnlyBy {
    /// The effect.
    pub effect: &'static str,
    /// The level.
    pub level: String,
}

/// A condition whose levels were left out, one after the other.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CrossedCondition {
    /// Its name, and those of others that divide the runs in the same way.
    pub names: Vec<String>,
    /// Its levels.
    pub levels: Vec<String>,
    /// Effects of the model that the runs of one level alone tell.
    pub told_only_by: Vec<ToldOnlyBy>,
}

impl From<&learn::Crossed> for CrossedCondition {
    fn from(own: &learn::Crossed) -> Self {
        let only = |(effect, level): &(&'static str, String)| ToldOnlyBy { effect, level: level.clone() };
        CrossedCondition {
            names: own.names.clone(),
            levels: own.levels.clone(),
            told_only_by: own.only.iter().map(only).collect(),
        }
    }
}

/// What was learnt, from the nominal robot to the model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Learnt {
    /// The nominal robot, and each effect that was added.
    pub steps: Vec<Step>,
    /// Verdict of the last diagnosis; see `Diagnosis`.
    pub verdict: &'static str,
    /// A missing effect that is not in the catalogue; null if there is none.
    pub unlisted: Option<Unlisted>,
    /// Effects that the model lacks, of sizes that these runs allow, that would bias its first numbers, the worst first.
    pub confounders: Vec<Confounder>,
    /// What to measure next, the most informative per minute first.
    pub next_experiments: Vec<Experiment>,
    /// The model that was learnt.
    pub model: Model,
    /// Its free parameters.
    pub fitted: Vec<Estimate>,
    /// Their correlations, a row each; empty where the data does not determine them.
    pub correlations: Vec<Vec<f64>>,
    /// Findings about the model and the data.
    #[serde(flatten)]
    pub findings: Findings,
    /// The new numbers of the robot by their keys in robot.toml, as of `solve`; empty where these runs show none.
    pub correction: Changes,
    /// The answer in words, as of `solve`.
    pub sentence: String,
    /// The conditions whose levels were left out, one after the other.
    pub conditions: Vec<CrossedCondition>,
    /// What the model was not tested on, in words; null where nothing was fitted.
    pub untested: Option<String>,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// Whether it was stopped before the search for missing effects ended.
    pub partial: bool,
    /// False-alarm rate: probability that an effect is added to a complete model.
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

impl Learnt {
    /// What was learnt with `options`, and the answer that it gives.
    pub fn new(solution: &Solution, options: &Options) -> Learnt {
        let learnt = &solution.learnt;
        let diagnosis = &learnt.diagnosis;
        Learnt {
            steps: learnt.steps.iter().map(Step::from).collect(),
            verdict: learnt.verdict.name(),
            unlisted: diagnosis.dependence.as_ref().map(Unlisted::from),
            confounders: diagnosis.confounders.iter().map(Confounder::from).collect(),
            next_experiments: experiments(&diagnosis.next_experiments),
            model: Model::with_noise(&learnt.model, learnt.noise.as_ref()),
            fitted: estimates(&diagnosis.fitted, 1.0 - options.size),
            correlations: diagnosis.correlations.clone(),
            findings: diagnosis.into(),
            correction: changes(&solution.changes),
            sentence: solution.sentence(),
            conditions: learnt.conditions.iter().map(CrossedCondition::from).collect(),
            untested: learnt.untested(),
            remarks: learnt.remarks.clone(),
            partial: learnt.partial,
            size: options.size,
            draws: options.draws,
            seed: options.seed,
            version: crate::VERSION,
            leaves: diagnosis.remains.as_ref().into(),
        }
    }
}
