//! `learn`.

use schemars::JsonSchema;
use serde::Serialize;

use super::diagnosis::{Experiment, Unlisted, experiments};
use super::fitted::{Estimate, Outlier, estimates, meaning};
use super::law::Repeated;
use super::solution::{Changes, changes};
use super::{Keyed, Leaves, Model, Setup, Taken, finite, reasons, taken};
use crate::diagnose::Options;
use crate::learn;
use crate::solve::Solution;

/// One line of the story of a learnt model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Step {
    /// The effect that was added; null for the nominal robot.
    pub added: Option<&'static str>,
    /// Effects that this data cannot tell from it, itself among them.
    pub class: Vec<&'static str>,
    /// p of it, corrected for all classes that were asked; null where nothing was asked.
    pub p_adjusted: Option<f64>,
    /// The law of a step which no effect of the catalogue makes: how it was found, what else it may be, and its formula as it was fitted.
    pub law: Option<Repeated>,
    /// Error of positions in the runs that the model was fitted to, in m.
    pub rmse_m: Option<f64>,
    /// The same of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
    /// Error of positions in runs left out, in m.
    pub heldout_rmse_m: Option<f64>,
    /// The same of headings, in rad; null where none were measured.
    pub heldout_heading_rmse_rad: Option<f64>,
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
            aicc: s.aicc,
            bic: s.bic,
        }
    }
}

/// What was learnt, from the nominal robot to the model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Learnt {
    /// The nominal robot, and each effect that was added.
    pub steps: Vec<Step>,
    /// What the last diagnosis says, in the words of `Diagnosis`.
    pub verdict: &'static str,
    /// What is missing and not in the catalogue; null where nothing is.
    pub unlisted: Option<Unlisted>,
    /// What to measure next, the most telling per minute first.
    pub next_experiments: Vec<Experiment>,
    /// The model that was learnt.
    pub model: Model,
    /// Its free parameters.
    pub fitted: Vec<Estimate>,
    /// What each fitted effect means for the robot, a sentence each.
    pub meaning: Keyed<String>,
    /// Jumps of tracks that are beyond noise.
    pub outliers: Vec<Outlier>,
    /// What was found of the data before anything was fitted: faults, clock and mounting of the reference, jumps, wrong poses, runs far from
    /// the others.
    pub setup: Setup,
    /// Effects of the reference whose values were taken from the motion.
    pub taken: Vec<Taken>,
    /// Why the model is not called explained, a sentence each.
    pub reasons: Vec<String>,
    /// What repeats most beside the model, whether it counts or not; null without tracks.
    pub repeats: Option<Repeated>,
    /// The new numbers of the robot by their keys in robot.toml, as of `solve`; empty where these runs show none.
    pub correction: Changes,
    /// The answer in words, as of `solve`.
    pub sentence: String,
    /// What else should be said.
    pub remarks: Vec<String>,
    /// Whether it was stopped while an effect was still missing.
    pub partial: bool,
    /// Probability with which an effect is added to a complete model.
    pub size: f64,
    /// Simulated tests for p-values that have no closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
    /// What the model leaves.
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
            next_experiments: experiments(&diagnosis.next_experiments),
            model: Model::with_noise(&learnt.model, learnt.noise.as_ref()),
            fitted: estimates(&diagnosis.fitted, 1.0 - options.size),
            meaning: meaning(&diagnosis.fitted, &learnt.model),
            outliers: diagnosis.outliers.iter().map(Outlier::from).collect(),
            setup: diagnosis.setup.as_ref().into(),
            taken: taken(&diagnosis.taken),
            reasons: reasons(&diagnosis.reasons),
            repeats: diagnosis.repeats.as_ref().map(Repeated::from),
            correction: changes(&solution.changes),
            sentence: solution.sentence(),
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
