//! How a model was learnt, step by step.

use crate::dataset::stated::{Levels, PATH};
use crate::diagnose::{Diagnosis, Reason, Repeated, Verdict};
use crate::effect::Model;
use crate::evidence::Evidence;
use crate::likelihood::Noise;
use crate::setup::SIDES;
use crate::watch::{Reached, Watch};

/// Maximum number of effects of a learnt model.
pub(super) const MOST_EFFECTS: usize = 6;

/// Root mean square errors of predicted poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Distance of observed from predicted positions \[m\].
    pub position: f64,
    /// Observed minus predicted headings \[rad\], where they were measured.
    pub heading: Option<f64>,
    /// Both together, weighted by the shape of the noise; an effect is kept only if this falls.
    pub weighted: f64,
}

/// One step of learning.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The effect that was added; `None` for the nominal robot.
    pub added: Option<&'static str>,
    /// All effects that the data cannot distinguish from it, itself included.
    pub class: Vec<&'static str>,
    /// p of its class, corrected for all classes that were tested; `None` for an effect that was fitted without a test.
    pub p_adjusted: Option<f64>,
    /// For a law outside the catalogue: how it was found, the alternatives, and its fitted formula.
    pub law: Option<Box<Repeated>>,
    /// In the runs that the model was fitted to.
    pub error: Error,
    /// In held-out runs.
    pub held_out: Error,
    /// In the runs of each level of a condition, predicted by the model fitted to those of the other levels: one for each of the
    /// [conditions](Learnt::conditions).
    pub elsewhere: Vec<Error>,
    /// Akaike's criterion with its small-sample correction; `None` for too few runs.
    pub aicc: Option<f64>,
    /// Bayes' criterion.
    pub bic: Option<f64>,
}

impl Step {
    /// Tells the last of some steps to who watches.
    pub(super) fn reach(steps: &[Step], watch: &Watch) {
        let Some((step, before)) = steps.split_last() else { return };
        watch.reach(|| Reached {
            after: before.len(),
            added: step.added,
            p_adjusted: step.p_adjusted,
            rmse: step.error.position,
            heldout_rmse: step.held_out.position,
        });
    }
}

/// A condition whose levels were left out, one after the other: a floor, a load, a path, a day.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossed {
    /// Its name, and those of others that divide the runs in the same way.
    pub names: Vec<String>,
    /// Its levels.
    pub levels: Vec<String>,
    /// Effects of the model that the runs of one level alone tell, with that level.
    pub only: Vec<(&'static str, String)>,
}

impl Crossed {
    pub(super) fn new(levels: &Levels, only: Vec<(&'static str, usize)>) -> Crossed {
        let only = only.into_iter().map(|(effect, level)| (effect, levels.levels[level].clone())).collect();
        Crossed { names: levels.names.clone(), levels: levels.levels.clone(), only }
    }
}

/// What was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Learnt {
    /// From the nominal robot to the final model.
    pub steps: Vec<Step>,
    /// The verdict of the last diagnosis.
    pub verdict: Verdict,
    /// The model with its fitted parameters.
    pub model: Model,
    /// The sizes of the noise under which the runs are likeliest; from tracks only.
    pub noise: Option<Noise>,
    /// The last diagnosis: of the model that was learnt.
    pub diagnosis: Diagnosis,
    /// The conditions whose levels were left out, one after the other.
    pub conditions: Vec<Crossed>,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// Whether it was stopped before the search for missing effects ended.
    pub partial: bool,
}

impl Learnt {
    /// Whether the model must not be used as it is: it does not explain the runs, or a reason against it forbids that.
    pub fn is_in_doubt(&self) -> bool {
        self.verdict == Verdict::NotExplained || self.diagnosis.reasons.iter().any(Reason::forbids_writing)
    }

    /// What the model was not tested on, in words; `None` where nothing was fitted.
    pub fn untested(&self) -> Option<String> {
        let named = |word: &str| self.conditions.iter().flat_map(|own| &own.names).any(|name| name.contains(word));
        let all = [(PATH, "paths"), ("speed", "speeds"), ("floor", "floors"), ("load", "loads")];
        let others: Vec<&str> = all.iter().filter(|(word, _)| !named(word)).map(|(_, others)| *others).collect();
        let (last, first) = others.split_last()?;
        let others = if first.is_empty() { (*last).to_owned() } else { format!("{} and {last}", first.join(", ")) };
        let straight = self.diagnosis.setup.mounting.is_some_and(|mounting| !mounting.turns);
        let sides = if straight { format!("; {SIDES}") } else { String::new() };
        (!self.diagnosis.fitted.is_empty()).then(|| format!("other {others} than those of these runs{sides}"))
    }

    /// If columns contradict their names, nothing is learnt about the robot.
    pub(super) fn of_faults(evidence: &dyn Evidence, steps: Vec<Step>) -> Learnt {
        let model = Model::new(evidence.robot());
        let diagnosis = Diagnosis::of_faults(evidence, &model);
        Learnt {
            steps,
            verdict: diagnosis.verdict,
            model,
            noise: None,
            diagnosis,
            conditions: Vec::new(),
            remarks: Vec::new(),
            partial: false,
        }
    }
}
