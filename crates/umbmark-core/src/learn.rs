//! The whole loop: fit, diagnose, add what is certified as missing, fit again, until nothing is.
//!
//! An effect is added when both hold: its class is certified among all that were asked
//! ([`Diagnosis::certified`](crate::diagnose::Diagnosis::certified)), and the error of runs that were left out falls. Leaving out is
//! nested: without each run in turn, the choice of the effect is made anew and the model fitted anew. AICc and BIC are told and
//! decide nothing: with many effects on offer they accept a false one in half of all tests.

mod ends;
mod gears;
mod tracks;

pub use gears::{GearCalibration, GearError, calibrate_gears};

use crate::calibrate::CalibrateError;
use crate::dataset::Dataset;
use crate::diagnose::ends::Ends;
use crate::diagnose::{self, DiagnoseError, Diagnosis, Estimate, Level, Repeated, Suspect, Verdict};
use crate::effect::{Model, Part};
use crate::likelihood::{Fitted, Outlier, Taken};
use crate::setup::Setup;
use crate::watch::Watch;
use rayon::prelude::*;
use std::sync::Arc;

/// No model is given more effects than this.
const MOST: usize = 6;

/// Root mean square errors of predicted poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Distance of observed from predicted positions \[m\].
    pub position: f64,
    /// Observed less predicted headings \[rad\], where they were measured.
    pub heading: Option<f64>,
    /// Both together, in units of the noise's shape: what has to fall for an effect to stay.
    pub weighted: f64,
}

/// One line of the story.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The effect that was added; `None` for the nominal robot.
    pub added: Option<&'static str>,
    /// All effects that the data could not tell from it, itself included.
    pub class: Vec<&'static str>,
    /// p of its class among all that were asked; `None` for what was not asked but fitted.
    pub p_adjusted: Option<f64>,
    /// Of a law that no catalogue lists: how it was found, what else it may be, and its formula as it was fitted.
    pub law: Option<Box<Repeated>>,
    /// In the runs that the model was fitted to.
    pub error: Error,
    /// In runs that were left out.
    pub held_out: Error,
    /// Akaike's criterion with its small-sample correction; `None` for too few runs.
    pub aicc: Option<f64>,
    /// Bayes' criterion.
    pub bic: Option<f64>,
}

/// What was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Learnt {
    /// From the nominal robot to the model.
    pub steps: Vec<Step>,
    /// What the last diagnosis says.
    pub verdict: Verdict,
    /// The model, its free parameters fitted.
    pub model: Model,
    /// The last diagnosis: of the model that was learnt.
    pub diagnosis: Diagnosis,
    /// What else should be said, a sentence each.
    pub remarks: Vec<String>,
    /// Whether it was stopped while an effect was certified that may have been added.
    pub partial: bool,
}

/// Sums of squared errors of some poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Squares {
    pub positions: usize,
    pub position: f64,
    pub headings: usize,
    pub heading: f64,
    /// Σ |W r|² and the number of its terms.
    pub weighted: f64,
    pub weights: usize,
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

/// Runs that a model can be learnt from.
pub(crate) trait Evidence: Sized + Sync {
    /// The robot without any effect.
    fn nominal(&self) -> Model;

    /// Number of runs.
    fn runs(&self) -> usize;

    /// The same without one run.
    fn without(&self, run: usize) -> Self;

    /// Whether there is enough to learn E_d and E_b from.
    fn both_ways(&self) -> bool;

    /// The model with its free parameters fitted, and those with their uncertainty.
    fn fit(&self, model: &Model) -> Result<(Model, Vec<Estimate>), DiagnoseError>;

    /// What is missing.
    fn diagnose(&self, model: &Model, options: &diagnose::Options) -> Result<Diagnosis, DiagnoseError>;

    /// The effect that would be added, certified or not.
    fn likeliest(&self, model: &Model) -> Result<Option<&'static str>, DiagnoseError>;

    /// Errors of one run.
    fn squares(&self, model: &Model, run: usize) -> Squares;

    /// AICc and BIC, where there are runs enough.
    fn criteria(&self, model: &Model) -> Option<[f64; 2]>;
}

/// Learns which effects a robot has.
///
/// ```no_run
/// use umbmark_core::{dataset::Dataset, diagnose::Options, learn::learn};
/// # let data = Dataset::default();
/// let learnt = learn(&data, &Options::default())?;
/// for step in &learnt.steps {
///     println!("{:?}: {:.1} mm held out", step.added, 1e3 * step.held_out.position);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn learn(data: &Dataset, options: &diagnose::Options) -> Result<Learnt, DiagnoseError> {
    let robot = data.robot.as_ref().ok_or(CalibrateError::NoRobot)?;
    Watch::nobody(|watch| learn_from(data, &Model::new(robot), options, watch))
}

/// [`learn`], with the effects of a `start` model in the story from the beginning: a formula to try, say. They are fitted
/// where they are free, after E_d, E_b and (from tracks) E_s. Once stopped, it ends with the step that it is at.
pub fn learn_from(
    data: &Dataset,
    start: &Model,
    options: &diagnose::Options,
    watch: &Watch,
) -> Result<Learnt, DiagnoseError> {
    start.check_robot(data.robot.as_ref().ok_or(CalibrateError::NoRobot)?)?;
    match options.evidence(data) {
        Level::Ends => {
            let ends = Ends::examined(data)?;
            if ends.is_sound() { from_evidence(&ends, start, options, watch) } else { of_faults(&ends) }
        }
        Level::Tracks => tracks::learn(&diagnose::tracks_of(data)?, start, options, watch),
    }
}

/// Of return errors whose columns are not what they are called nothing is learnt.
fn of_faults(ends: &Ends) -> Result<Learnt, DiagnoseError> {
    let Story { steps, model, .. } = Story::new(ends, ends.nominal())?;
    let diagnosis = Diagnosis::of_faults(&ends.setup, &model, Level::Ends);
    Ok(Learnt { steps, verdict: diagnosis.verdict, model, diagnosis, remarks: Vec::new(), partial: false })
}

/// A model with its free parameters fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// What was fitted.
    pub estimates: Vec<Estimate>,
    /// Where runs were disturbed, and what happened there left out; from tracks only.
    pub outliers: Vec<Outlier>,
    /// Whether the values are those under noise of the usual sizes, as [`USUAL_NOISE`](crate::likelihood::USUAL_NOISE) says.
    pub usual_noise: bool,
    /// What was found of the experiment before the fit.
    pub setup: Arc<Setup>,
    /// What of that was taken into the model.
    pub taken: Vec<Taken>,
}

/// Fits a model's free parameters to a dataset.
pub fn fit(data: &Dataset, model: &Model) -> Result<Fit, DiagnoseError> {
    model.check_robot(data.robot.as_ref().ok_or(CalibrateError::NoRobot)?)?;
    match diagnose::level(data) {
        Level::Ends => {
            let ends = Ends::examined(data)?;
            ends.check_columns()?;
            let (model, estimates) = ends.fit(model)?;
            Ok(Fit { model, estimates, outliers: Vec::new(), usual_noise: false, setup: ends.setup, taken: Vec::new() })
        }
        Level::Tracks => {
            let fitted = diagnose::tracks::fit(&diagnose::tracks_of(data)?, model)?;
            let fitted = diagnose::tracks::trusted(fitted)?.into_fitted();
            let estimates = diagnose::tracks::estimates(&fitted);
            let Fitted { model, outliers, usual_noise, taken, observed, .. } = fitted;
            Ok(Fit { model, estimates, outliers, usual_noise, setup: observed.setup, taken })
        }
    }
}

/// [`fit`] to the return poses alone, even where the runs were observed on the way.
pub fn fit_to_returns(data: &Dataset, model: &Model) -> Result<(Model, Vec<Estimate>), DiagnoseError> {
    Ends::new(data)?.fit(model)
}

/// The loop, whatever was observed.
pub(crate) fn from_evidence<E: Evidence>(
    evidence: &E,
    start: &Model,
    options: &diagnose::Options,
    watch: &Watch,
) -> Result<Learnt, DiagnoseError> {
    let mut story = Story::new(evidence, evidence.nominal())?;
    if evidence.both_ways() {
        let first = story.model.robot().drive.first_effects();
        for effect in &first[..2] {
            story.add(&free_part(evidence, effect)?)?;
        }
    }
    for part in start.parts().iter().filter(|part| !story.has(part)).cloned().collect::<Vec<_>>() {
        story.add(&part)?;
    }
    let mut remarks = Vec::new();
    let mut diagnosis = evidence.diagnose(&story.model, options)?;
    let mut partial = false;
    while story.model.parts().len() < MOST {
        (watch.progress)(story.model.parts().len() as f64 / MOST as f64);
        let Some(suspect) = diagnosis.certified().first().cloned() else { break };
        partial = watch.is_stopped();
        if partial {
            break;
        }
        let why = match story.grown_by(&suspect, options) {
            Ok(Some(further)) => {
                (story, diagnosis) = further;
                continue;
            }
            Ok(None) => "runs that are left out are predicted no better with it".to_owned(),
            // A model that cannot be fitted, or not be asked what it lacks, is none to learn.
            Err(error @ (DiagnoseError::NotConverged { .. } | DiagnoseError::OutOfBounds { .. })) => error.to_string(),
            Err(error) => return Err(error),
        };
        let class = suspect.class.join(" or ");
        remarks.push(format!("{class} is certified (p = {:.3}) but was not added: {why}.", suspect.p_adjusted));
        break;
    }
    remarks.extend(diagnosis.remarks.iter().cloned());
    let (steps, model, verdict) = (story.steps, story.model, diagnosis.verdict);
    Ok(Learnt { steps, verdict, model, diagnosis, remarks, partial })
}

/// A model as it grows, on all runs and without each of them.
struct Story<'a, E> {
    evidence: &'a E,
    folds: Arc<Vec<E>>,
    model: Model,
    fold_models: Vec<Model>,
    steps: Vec<Step>,
}

impl<'a, E: Evidence> Story<'a, E> {
    fn new(evidence: &'a E, nominal: Model) -> Result<Story<'a, E>, DiagnoseError> {
        let folds: Vec<E> = (0..evidence.runs()).map(|run| evidence.without(run)).collect();
        let fold_models = vec![nominal.clone(); folds.len()];
        let folds = Arc::new(folds);
        let mut story = Story { evidence, folds, model: nominal, fold_models, steps: Vec::new() };
        story.tell(None, Vec::new(), None);
        Ok(story)
    }

    fn last(&self) -> &Step {
        &self.steps[self.steps.len() - 1]
    }

    /// Whether the model has an effect of this name.
    fn has(&self, part: &Part) -> bool {
        self.model.parts().iter().any(|own| own.effect.name() == part.effect.name())
    }

    /// Adds an effect everywhere, without asking.
    fn add(&mut self, part: &Part) -> Result<(), DiagnoseError> {
        let folds = self.folds.par_iter().zip(&self.fold_models);
        self.fold_models = folds.map(|(fold, model)| grown(fold, model, part)).collect::<Result<_, _>>()?;
        self.model = grown(self.evidence, &self.model, part)?;
        let effect = part.effect.name();
        self.tell(Some(effect), vec![effect], None);
        Ok(())
    }

    /// The story with a certified effect more, and what is then missing, where runs left out are predicted better with it.
    fn grown_by(
        &self,
        suspect: &Suspect,
        options: &diagnose::Options,
    ) -> Result<Option<(Story<'a, E>, Diagnosis)>, DiagnoseError> {
        let candidate = self.with_likeliest(suspect.best, suspect.class.clone(), suspect.p_adjusted)?;
        if candidate.last().held_out.weighted >= self.last().held_out.weighted {
            return Ok(None);
        }
        let diagnosis = self.evidence.diagnose(&candidate.model, options)?;
        Ok(Some((candidate, diagnosis)))
    }

    /// The story in which all runs add `effect`, and each fold what it finds likeliest on its own.
    fn with_likeliest(
        &self,
        effect: &'static str,
        class: Vec<&'static str>,
        p: f64,
    ) -> Result<Story<'a, E>, DiagnoseError> {
        let folds = self.folds.par_iter().zip(&self.fold_models);
        let choose = |(fold, model): (&E, &Model)| match fold.likeliest(model)? {
            Some(own) => match grown(fold, model, &free_part(fold, own)?) {
                // Without this run, that effect cannot be fitted.
                Err(DiagnoseError::NotConverged { .. } | DiagnoseError::OutOfBounds { .. }) => Ok(model.clone()),
                fitted => fitted,
            },
            None => Ok(model.clone()),
        };
        let mut further = Story {
            evidence: self.evidence,
            folds: self.folds.clone(),
            model: grown(self.evidence, &self.model, &free_part(self.evidence, effect)?)?,
            fold_models: folds.map(choose).collect::<Result<_, _>>()?,
            steps: self.steps.clone(),
        };
        further.tell(Some(effect), class, Some(p));
        Ok(further)
    }

    fn tell(&mut self, added: Option<&'static str>, class: Vec<&'static str>, p_adjusted: Option<f64>) {
        let total = |squares: &dyn Fn(usize) -> Squares| {
            (0..self.evidence.runs()).map(squares).fold(Squares::default(), Squares::add).error()
        };
        let criteria = self.evidence.criteria(&self.model);
        self.steps.push(Step {
            added,
            class,
            p_adjusted,
            law: None,
            error: total(&|run| self.evidence.squares(&self.model, run)),
            held_out: total(&|run| self.evidence.squares(&self.fold_models[run], run)),
            aicc: criteria.map(|c| c[0]),
            bic: criteria.map(|c| c[1]),
        });
    }
}

/// An effect of the catalogue, free, at the values where it does nothing.
fn free_part<E: Evidence>(evidence: &E, effect: &str) -> Result<Part, DiagnoseError> {
    let mut model = evidence.nominal();
    let part = model.add(effect).map_err(DiagnoseError::Model)?;
    part.free = true;
    Ok(part.clone())
}

/// A model with an effect more, fitted.
fn grown<E: Evidence>(evidence: &E, model: &Model, part: &Part) -> Result<Model, DiagnoseError> {
    let mut grown = model.clone();
    grown.adopt(part);
    Ok(evidence.fit(&grown)?.0)
}

#[cfg(test)]
mod tests;
