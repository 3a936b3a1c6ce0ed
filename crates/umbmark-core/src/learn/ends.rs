//! Learning from return poses: the model is fitted to all runs, and again without each of them.

use super::misfits::elsewhere;
use super::story::{Crossed, Error, Learnt, MOST_EFFECTS, Step};
use crate::dataset::Levels;
use crate::diagnose::ends;
use crate::diagnose::{Diagnosis, Options, Reason, Suspect, Verdict};
use crate::drive::Robot;
use crate::effect::{Model, Part};
use crate::evidence::ends::{End, Fitted};
use crate::evidence::{Ends, Evidence, Fit, FitError};
use crate::watch::Watch;
use rayon::prelude::*;
use std::sync::Arc;

/// Learns which effects the robot of some return poses has, beside those of a `start`.
pub(super) fn learn(ends: &Ends, start: &Model, options: &Options, watch: &Watch) -> Result<Learnt, FitError> {
    let mut story = Story::new(ends);
    Step::reach(&story.steps, watch);
    if !ends.is_sound() {
        return Ok(Learnt::of_faults(ends, story.steps));
    }
    if ends.counts().iter().all(|n| *n > 1) {
        let first = story.model.robot().drive.first_effects();
        for effect in &first[..2] {
            story.add(&free_part(&ends.robot, effect)?)?;
            Step::reach(&story.steps, watch);
        }
    }
    for part in start.parts().iter().filter(|part| !story.has(part)).cloned().collect::<Vec<_>>() {
        story.add(&part)?;
        Step::reach(&story.steps, watch);
    }
    let mut remarks = Vec::new();
    let mut diagnosis = ends::diagnose(ends, &story.model, options)?;
    let mut partial = false;
    while story.model.parts().len() < MOST_EFFECTS {
        (watch.progress)(story.model.parts().len() as f64 / MOST_EFFECTS as f64);
        let Some(suspect) = diagnosis.certified().first().cloned() else { break };
        partial = watch.is_stopped();
        if partial {
            diagnosis.reasons.push(Reason::Stopped);
            break;
        }
        let why = match story.grown_by(&suspect, options) {
            Ok(Some(further)) => {
                (story, diagnosis) = further;
                Step::reach(&story.steps, watch);
                continue;
            }
            Ok(None) => "it does not lower the cross-validated error".to_owned(),
            // A model that cannot be fitted or tested is skipped.
            Err(error @ (FitError::NotConverged { .. } | FitError::OutOfBounds { .. })) => error.to_string(),
            Err(error) => return Err(error),
        };
        let class = suspect.class.join(" or ");
        remarks.push(format!("{class} is certified (p = {:.3}) but was not added: {why}.", suspect.p_adjusted));
        break;
    }
    remarks.extend(diagnosis.remarks.iter().cloned());
    let conditions: Vec<Crossed> = ends.conditions.iter().map(|levels| Crossed::new(levels, Vec::new())).collect();
    let against = elsewhere(&story.steps, &conditions, ends.runs.len(), 0.0);
    if diagnosis.verdict == Verdict::Explained && !against.is_empty() {
        diagnosis.verdict = Verdict::NotExplained;
    }
    diagnosis.reasons.extend(against);
    let (steps, model, verdict) = (story.steps, story.model, diagnosis.verdict);
    Ok(Learnt { steps, verdict, model, noise: None, conditions, diagnosis, remarks, partial })
}

/// The error of a model with the values that it has.
pub(super) fn error(ends: &Ends, model: &Model) -> Error {
    squares(ends, model, |_| true).error()
}

/// The step that a model is with the values that it has.
pub(super) fn as_it_is(ends: &Ends, model: &Model) -> Step {
    let mut story = Story { model: model.clone(), ..Story::new(ends) };
    story.fold_models = vec![model.clone(); story.folds.len()];
    story.tell(None, Vec::new(), None);
    story.last().clone()
}

/// A model fitted to all runs, and again without those of each fold.
pub(super) fn fit(ends: &Ends, model: &Model) -> Result<(Fit, Step), FitError> {
    let fit = ends.fit(model)?;
    let mut story = Story { model: fit.model.clone(), ..Story::new(ends) };
    let of_fold = |fold: &Ends| {
        Ok(fitted_if_it_can_be(Fitted::new(fold, &fit.model).map(|own| own.model))?
            .unwrap_or_else(|| fit.model.clone()))
    };
    story.fold_models = story.folds.par_iter().map(of_fold).collect::<Result<_, FitError>>()?;
    story.tell(None, Vec::new(), None);
    let step = story.last().clone();
    Ok((fit, step))
}

/// At most so many folds: with more runs than these, each fold leaves out several.
const MOST_FOLDS: usize = 60;

/// A model as it grows, on all runs and without those of each fold: one run, where there are not more than [`MOST_FOLDS`].
pub(super) struct Story<'a> {
    ends: &'a Ends,
    folds: Arc<Vec<Ends>>,
    model: Model,
    fold_models: Vec<Model>,
    steps: Vec<Step>,
}

impl<'a> Story<'a> {
    pub fn new(ends: &'a Ends) -> Story<'a> {
        let nominal = Model::new(&ends.robot);
        let count = ends.runs.len().min(MOST_FOLDS);
        let folds: Vec<Ends> = (0..count).map(|fold| without(ends, fold, count)).collect();
        let fold_models = vec![nominal.clone(); folds.len()];
        let folds = Arc::new(folds);
        let mut story = Story { ends, folds, model: nominal, fold_models, steps: Vec::new() };
        story.tell(None, Vec::new(), None);
        story
    }

    pub fn last(&self) -> &Step {
        &self.steps[self.steps.len() - 1]
    }

    /// Whether the model has an effect of this name.
    fn has(&self, part: &Part) -> bool {
        self.model.parts().iter().any(|own| own.effect.name() == part.effect.name())
    }

    /// Adds an effect everywhere, without asking; not where it cannot be fitted.
    pub fn add(&mut self, part: &Part) -> Result<(), FitError> {
        let Some(whole) = fitted_if_it_can_be(grown(self.ends, &self.model, part))? else { return Ok(()) };
        let folds = self.folds.par_iter().zip(&self.fold_models);
        let of_fold = |(fold, model): (&Ends, &Model)| {
            Ok(fitted_if_it_can_be(grown(fold, model, part))?.unwrap_or_else(|| model.clone()))
        };
        self.fold_models = folds.map(of_fold).collect::<Result<_, FitError>>()?;
        self.model = whole;
        let effect = part.effect.name();
        self.tell(Some(effect), vec![effect], None);
        Ok(())
    }

    /// The story with one more certified effect, and the diagnosis of the new model; nothing if held-out runs are not predicted better with
    /// it.
    fn grown_by(&self, suspect: &Suspect, options: &Options) -> Result<Option<(Story<'a>, Diagnosis)>, FitError> {
        let candidate = self.with_likeliest(suspect.best, suspect.class.clone(), suspect.p_adjusted)?;
        if candidate.last().held_out.weighted >= self.last().held_out.weighted {
            return Ok(None);
        }
        let diagnosis = ends::diagnose(self.ends, &candidate.model, options)?;
        Ok(Some((candidate, diagnosis)))
    }

    /// The story in which the fit to all runs adds `effect`, and each fold adds the effect that is likeliest in that fold.
    fn with_likeliest(&self, effect: &'static str, class: Vec<&'static str>, p: f64) -> Result<Story<'a>, FitError> {
        let folds = self.folds.par_iter().zip(&self.fold_models);
        let choose = |(fold, model): (&Ends, &Model)| match ends::likeliest(fold, model)? {
            Some(own) => {
                let fitted = fitted_if_it_can_be(grown(fold, model, &free_part(&fold.robot, own)?))?;
                Ok(fitted.unwrap_or_else(|| model.clone()))
            }
            None => Ok(model.clone()),
        };
        let mut further = Story {
            ends: self.ends,
            folds: self.folds.clone(),
            model: grown(self.ends, &self.model, &free_part(&self.ends.robot, effect)?)?,
            fold_models: folds.map(choose).collect::<Result<_, FitError>>()?,
            steps: self.steps.clone(),
        };
        further.tell(Some(effect), class, Some(p));
        Ok(further)
    }

    fn tell(&mut self, added: Option<&'static str>, class: Vec<&'static str>, p_adjusted: Option<f64>) {
        let folds = self.folds.len();
        let held_out = self
            .fold_models
            .iter()
            .enumerate()
            .map(|(fold, model)| squares(self.ends, model, |run| run % folds == fold));
        let criteria = criteria(self.ends, &self.model);
        let conditions = self.ends.conditions.iter();
        let elsewhere = conditions.map(|levels| of_other_levels(self.ends, &self.model, levels).error()).collect();
        self.steps.push(Step {
            added,
            class,
            p_adjusted,
            law: None,
            error: squares(self.ends, &self.model, |_| true).error(),
            held_out: held_out.fold(Squares::default(), Squares::add).error(),
            elsewhere,
            aicc: criteria.map(|c| c[0]),
            bic: criteria.map(|c| c[1]),
        });
    }
}

/// A free effect of the catalogue, at the values where it has no influence.
pub(super) fn free_part(robot: &Robot, effect: &str) -> Result<Part, FitError> {
    let mut model = Model::new(robot);
    let part = model.add(effect).map_err(FitError::Model)?;
    part.free = true;
    Ok(part.clone())
}

/// A model, unless the runs allow no fit of it.
fn fitted_if_it_can_be(fitted: Result<Model, FitError>) -> Result<Option<Model>, FitError> {
    match fitted {
        Err(FitError::NotConverged { .. } | FitError::OutOfBounds { .. }) => Ok(None),
        fitted => fitted.map(Some),
    }
}

/// A model with one more effect, fitted.
fn grown(ends: &Ends, model: &Model, part: &Part) -> Result<Model, FitError> {
    let mut grown = model.clone();
    grown.adopt(part);
    Ok(Fitted::new(ends, &grown)?.model)
}

/// Sums of squared errors of some poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Squares {
    positions: usize,
    position: f64,
    headings: usize,
    heading: f64,
    /// Σ |W r|² and the number of its terms.
    weighted: f64,
    weights: usize,
}

impl Squares {
    fn add(self, other: Squares) -> Squares {
        Squares {
            positions: self.positions + other.positions,
            position: self.position + other.position,
            headings: self.headings + other.headings,
            heading: self.heading + other.heading,
            weighted: self.weighted + other.weighted,
            weights: self.weights + other.weights,
        }
    }

    fn error(&self) -> Error {
        let root = |sum: f64, count: usize| (sum / count.max(1) as f64).sqrt();
        Error {
            position: root(self.position, self.positions),
            heading: (self.headings > 0).then(|| root(self.heading, self.headings)),
            weighted: root(self.weighted, self.weights),
        }
    }
}

/// The same return poses without those of one of some folds.
fn without(ends: &Ends, fold: usize, folds: usize) -> Ends {
    let mut rest = ends.clone();
    let mut run = 0;
    rest.runs.retain(|_| {
        run += 1;
        (run - 1) % folds != fold
    });
    rest
}

/// Errors of the runs of each level of a condition, by a model that is fitted to the others. Where these allow no fit, it is the nominal robot.
fn of_other_levels(ends: &Ends, model: &Model, levels: &Levels) -> Squares {
    let level_of = |run: usize| levels.of_run(&ends.runs[run].name);
    let of_level = |level: usize| {
        let others: Vec<usize> = (0..ends.runs.len()).filter(|run| level_of(*run) != Some(level)).collect();
        let fitted = Fitted::new(&ends.only(&others), model).map(|fitted| fitted.model);
        squares(ends, &fitted.unwrap_or_else(|_| Model::new(&ends.robot)), |run| level_of(run) == Some(level))
    };
    (0..levels.levels.len()).map(of_level).fold(Squares::default(), Squares::add)
}

/// Errors of some runs.
fn squares(ends: &Ends, model: &Model, of: impl Fn(usize) -> bool) -> Squares {
    let runs = ends.runs.iter().zip(ends.residuals(model)).enumerate().filter(|(run, _)| of(*run));
    let of_run = |(_, (run, residual)): (usize, (&End, nalgebra::Vector3<f64>))| Squares {
        positions: 1,
        position: residual.xy().norm_squared(),
        headings: usize::from(ends.with_heading),
        heading: residual.z * residual.z,
        weighted: (run.weight * residual).rows(0, ends.coordinates()).norm_squared(),
        weights: ends.coordinates(),
    };
    runs.map(of_run).fold(Squares::default(), Squares::add)
}

/// AICc and BIC of a model that is fitted to the return poses, if there are enough runs.
pub(crate) fn criteria(ends: &Ends, model: &Model) -> Option<[f64; 2]> {
    Fitted::new(ends, model).ok()?.criteria(ends)
}
