//! What a diagnosis found.

use super::confounder::{Confounder, sentence};
use super::ends::contrasts::{Contrast, OnCircle};
use super::experiments::Experiment;
use super::identifiability::Identifiability;
use super::likeness::Likeness;
use super::reason::Reason;
use super::remains::Remains;
use super::suspect::Suspect;
use super::tracks::dependence::Dependence;
use super::tracks::repeats::Repeated;
use super::unseen::{Detectable, Unseen, Why};
use crate::effect::Model;
use crate::evidence::{Estimate, Evidence, Level};
use crate::likelihood::{Outlier, Taken};
use crate::setup::Setup;
use std::sync::Arc;

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// These runs show no further effect.
    Explained,
    /// One class of effects is missing.
    MissingEffect,
    /// More than one class is missing.
    SeveralMissing,
    /// An effect outside the catalogue is missing.
    UnlistedEffect,
    /// Too few runs, or of one direction only.
    NotEnoughData,
    /// No further effect is certified, but the model does not explain the data; the reasons say why.
    NotExplained,
}

impl Verdict {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Explained => "explained",
            Verdict::MissingEffect => "missing_effect",
            Verdict::SeveralMissing => "several_missing",
            Verdict::UnlistedEffect => "unlisted_effect",
            Verdict::NotEnoughData => "not_enough_data",
            Verdict::NotExplained => "not_explained",
        }
    }
}

/// A test of the whole model against its residuals.
#[derive(Clone, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Which test.
    pub name: &'static str,
    /// Its statistic.
    pub statistic: f64,
    /// Degrees of freedom, where it is an F; none where p comes from simulation.
    pub degrees_of_freedom: Option<[f64; 2]>,
    /// Probability of a statistic this large if the model is complete.
    pub p: f64,
}

/// What a diagnosis found.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// What was observed.
    pub level: Level,
    /// In one word.
    pub verdict: Verdict,
    /// The model, its free parameters fitted to this data.
    pub model: Model,
    /// Those parameters.
    pub fitted: Vec<Estimate>,
    /// Their correlations, a row each; empty where unknown.
    pub correlations: Vec<Vec<f64>>,
    /// Tests of the model as a whole.
    pub goodness_of_fit: Vec<GoodnessOfFit>,
    /// All classes that were tested: those that may be certified first, the likeliest of them first.
    pub ranking: Vec<Suspect>,
    /// Number of classes at the head of the ranking that are certified as missing.
    pub certified: usize,
    /// What this data cannot see.
    pub invisible: Vec<Unseen>,
    /// Likeness of the effects that this data can see.
    pub likeness: Likeness,
    /// Minimum detectable sizes.
    pub minimum_detectable: Vec<Detectable>,
    /// Effects that the model lacks and that would bias its first numbers, the worst first; from tracks only.
    pub confounders: Vec<Confounder>,
    /// What to measure next, the most informative per minute first.
    pub next_experiments: Vec<Experiment>,
    /// Closure contrasts of a square driven both ways, after the fit.
    pub contrasts: Vec<Contrast>,
    /// End points beside the circle through START, direction by direction; for squares.
    pub circle: Vec<OnCircle>,
    /// What this experiment determines of the model.
    pub identifiability: Identifiability,
    /// What an effect outside the catalogue acts on and depends on; from tracks only.
    pub dependence: Option<Dependence>,
    /// Where runs were disturbed; the fit leaves these places out. From tracks only.
    pub outliers: Vec<Outlier>,
    /// What was found of the experiment before anything was fitted.
    pub setup: Arc<Setup>,
    /// The part of it that was added to the model.
    pub taken: Vec<Taken>,
    /// Reasons against the verdict "explained".
    pub reasons: Vec<Reason>,
    /// The strongest repeating pattern that the model leaves, significant or not; from tracks only.
    pub repeats: Option<Repeated>,
    /// The remaining error; `None` if columns contradict their names.
    pub remains: Option<Remains>,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
}

impl Diagnosis {
    /// The diagnosis of an experiment whose columns contradict their names: the robot is not judged.
    pub(crate) fn of_faults(evidence: &dyn Evidence, model: &Model) -> Diagnosis {
        Diagnosis {
            level: evidence.level(),
            verdict: Verdict::NotExplained,
            model: model.clone(),
            fitted: Vec::new(),
            correlations: Vec::new(),
            goodness_of_fit: Vec::new(),
            ranking: Vec::new(),
            certified: 0,
            invisible: Vec::new(),
            likeness: Likeness::default(),
            minimum_detectable: Vec::new(),
            confounders: Vec::new(),
            next_experiments: Vec::new(),
            contrasts: Vec::new(),
            circle: Vec::new(),
            identifiability: Identifiability { shares: Vec::new(), rank: 0, hidden: Vec::new() },
            dependence: None,
            outliers: Vec::new(),
            setup: Arc::clone(evidence.setup()),
            taken: Vec::new(),
            reasons: evidence.faults().into_iter().map(Reason::Fault).collect(),
            repeats: None,
            remains: None,
            remarks: Vec::new(),
        }
    }

    /// The suspects that are certified as missing.
    pub fn certified(&self) -> &[Suspect] {
        &self.ranking[..self.certified]
    }

    /// Minimum detectable sizes, effect by effect: of each parameter the smallest of all shapes that were tried.
    pub fn least_sizes(&self) -> Vec<Vec<&Detectable>> {
        let mut effects: Vec<Vec<&Detectable>> = Vec::new();
        for size in &self.minimum_detectable {
            let Some(own) = effects.iter_mut().find(|own| own[0].effect == size.effect) else {
                effects.push(vec![size]);
                continue;
            };
            match own.iter_mut().find(|known| known.parameter == size.parameter) {
                Some(known) if known.size <= size.size => {}
                Some(known) => *known = size,
                None => own.push(size),
            }
        }
        effects
    }

    /// The effects that this data cannot show because parts of the model absorb them, grouped by these parts.
    pub fn absorbed(&self) -> Vec<(&[&'static str], Vec<&'static str>)> {
        let mut parts: Vec<(&[&str], Vec<&str>)> = Vec::new();
        for unseen in &self.invisible {
            let Why::Absorbed(by) = &unseen.why else { continue };
            match parts.iter_mut().find(|(own, _)| own == by) {
                Some((_, names)) => names.push(unseen.effect),
                None => parts.push((by, vec![unseen.effect])),
            }
        }
        parts
    }

    /// What effects that the model lacks would do to its first numbers, in words; `None` where none that these runs allow moves one beyond
    /// its interval.
    pub fn confounding(&self) -> Option<String> {
        sentence(&self.confounders, self.verdict)
    }

    /// The effects that at their usual size stay below the noise.
    pub fn below_noise(&self) -> Vec<&'static str> {
        self.invisible.iter().filter(|unseen| unseen.why == Why::BelowNoise).map(|unseen| unseen.effect).collect()
    }
}
