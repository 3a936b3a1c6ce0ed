//! Models compared with tracks: where along the way the error is made, and what it depends on.
//!
//! The error of each step between two measurements is expressed in the robot's frame: the measured motion as seen from the end of the
//! predicted one. So earlier errors do not count again. Steps are summed by move, direction, speed and run, and in bins of everything that
//! an error may depend on. All intervals and tests rest on the scatter from run to run, and on the resolution of the encoders; they need no
//! noise model.

mod covariate;
mod followed;
mod mean;
mod mounted;
mod parts;
mod rates;
mod sentences;
#[cfg(test)]
mod tests;
mod worth;

use crate::dataset::Dataset;
use crate::diagnose::tracks::doubts_as_written;
use crate::diagnose::{Options, Reason, Remains};
use crate::effect::Model;
use crate::evidence::{self, Evidence, FitError};
use crate::geometry::Pose2;
use crate::inspect::moves_of;
use crate::likelihood::{Noise, Observed, Taken};
use crate::path::Direction;
use crate::setup::Setup;
use followed::{Followed, MeasuredBlock};
use std::sync::Arc;

pub use covariate::{COVARIATES, Covariate, Rate, Span};
pub use mean::Mean;
pub(crate) use mounted::{Mounted, fixed, mounted};
pub use parts::{By, Part, Share};
pub use rates::{Against, Bin, Overall};
pub use worth::Test;

/// What was taken from the motion is left out again where it multiplies the error along the way by this.
const ASTRAY: f64 = 2.0;

/// Root mean square errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rms {
    /// Distance of measured from predicted positions \[m\].
    pub position: f64,
    /// Measured less predicted headings \[rad\]; `None` where none were measured.
    pub heading: Option<f64>,
}

/// The error of one run along its way.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackResiduals {
    /// The run's name.
    pub run: String,
    /// Its sense.
    pub direction: Option<Direction>,
    /// Mean unsigned travel of the wheels until each measurement \[m\].
    pub rolled: Vec<f64>,
    /// Predicted poses, in the frame of START.
    pub predicted: Vec<Pose2>,
    /// Measured poses, moved so that the first agrees with the prediction where it was taken at START.
    pub measured: Vec<Pose2>,
    /// True pose relative to the predicted one: forward, to the left \[m\], rotation to the left \[rad\].
    pub errors: Vec<[f64; 3]>,
}

/// Errors of one model on tracks: where they are made, and what they depend on.
#[derive(Clone, Debug)]
pub struct TrackErrors {
    /// The model's name.
    pub name: String,
    /// Errors along the way: measurements within 3 cm and 3 degrees count as one.
    pub along: Rms,
    /// Errors at the ends of the runs.
    pub end: Rms,
    /// Errors in proportion to the distance or rotation driven.
    pub overall: Vec<Overall>,
    /// What they depend on.
    pub against: Vec<Against>,
    /// Number of tests among these.
    pub tests: usize,
    /// p of the whole model: the smallest of those that [matter](Test::matters), times the number of all (Bonferroni); `None` where the
    /// runs are too few for any.
    pub p: Option<f64>,
    /// Where the error is made.
    pub parts: Vec<Part>,
    /// The errors themselves.
    pub residuals: Vec<TrackResiduals>,
    /// Effects of the reference that were taken from the motion: they are large, and the model does not have them.
    pub taken: Vec<Taken>,
}

/// Result of one model on tracks.
#[derive(Clone, Debug)]
pub struct TracksJudged {
    /// Its errors, and the tests of what they depend on.
    pub errors: TrackErrors,
    /// Reasons why the model does not explain the runs, regardless of the tests.
    pub reasons: Vec<Reason>,
    /// The remaining error: how much of it is the same in every run, and how much is noise.
    pub remains: Option<Remains>,
    /// What is explained and what not, a sentence each.
    pub sentences: Vec<String>,
}

/// Models side by side, on tracks.
#[derive(Clone, Debug)]
pub struct TrackComparison {
    /// Number of runs clockwise, counter-clockwise, and of neither sense.
    pub runs: [usize; 3],
    /// Number of measured poses.
    pub poses: usize,
    /// What was found of the experiment before anything was predicted.
    pub setup: Arc<Setup>,
    /// In the order in which they were given.
    pub models: Vec<TracksJudged>,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
}

impl TracksJudged {
    /// Whether no test rejects the model at this size of all tests together; `None` where there is no test.
    pub fn explains(&self, size: f64) -> Option<bool> {
        if self.reasons.is_empty() { self.errors.p.map(|p| p >= size) } else { Some(false) }
    }
}

/// Compares the predictions of models, with the values that they have, with tracks.
///
/// ```no_run
/// use umbmark_core::{compare::compare_tracks, dataset::Dataset, diagnose::Options, effect::Model};
/// # let data = Dataset::default();
/// let nominal = Model::new(data.nominal_robot()?);
/// let comparison = compare_tracks(&data, &[("nominal".into(), nominal)], &Options::default())?;
/// for part in &comparison.models[0].errors.parts {
///     println!("{}: {:.1} mm forward, {:.0} %", part.name, 1e3 * part.mean[0].value, 100.0 * part.share.position);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_tracks(
    data: &Dataset,
    models: &[(String, Model)],
    options: &Options,
) -> Result<TrackComparison, FitError> {
    compare(&evidence::tracks::of(data)?, data, models, options)
}

/// The errors of models, with the values that they have, on tracks, without a judgement whether they explain them, which takes simulations.
pub fn track_errors(
    data: &Dataset,
    models: &[(String, Model)],
    options: &Options,
) -> Result<Vec<TrackErrors>, FitError> {
    let observed = evidence::tracks::of(data)?;
    check(&observed, models)?;
    let errors = |(name, model): &(String, Model)| {
        let (model, taken) = with_reference(&observed, model)?;
        Ok(TrackErrors { taken, ..errors(name, data, &observed.along(&model), &model, options) })
    };
    models.iter().map(errors).collect()
}

/// Compares models with the tracks of a dataset.
pub(super) fn compare(
    observed: &Observed,
    data: &Dataset,
    models: &[(String, Model)],
    options: &Options,
) -> Result<TrackComparison, FitError> {
    check(observed, models)?;
    let mut remarks = remarks(observed);
    let mut judge = |(name, model): &(String, Model)| {
        let (model, taken) = with_reference(observed, model)?;
        let observed = observed.along(&model);
        let judge = |model: &Model| {
            let (reasons, remains) = doubts_as_written(&observed, model, options);
            let errors = errors(name, data, &observed.along(model), model, options);
            TracksJudged { errors, reasons, remains, sentences: Vec::new() }
        };
        let mut judged = judge(&model);
        if judged.reasons.is_empty()
            && judged.explains(options.size) == Some(false)
            && let Some(Mounted { model, words }) = mounted(&observed, &model, &Noise::default(), options)?
        {
            let beside = judge(&model);
            if beside.explains(options.size) == Some(true) {
                judged = beside;
                remarks.push(format!("{name} is judged with a mounting of the reference that it lacks. {words}"));
            }
        }
        judged.errors.taken = taken;
        Ok(TracksJudged { sentences: sentences::of(&judged, options.size), ..judged })
    };
    let judged = models.iter().map(&mut judge).collect::<Result<_, FitError>>()?;
    let of = |direction| observed.runs.iter().filter(|run| run.direction == direction).count();
    Ok(TrackComparison {
        runs: [of(Some(Direction::Cw)), of(Some(Direction::Ccw)), of(None)],
        poses: observed.runs.iter().map(|run| run.seen.len()).sum(),
        models: judged,
        remarks,
        setup: Arc::clone(&observed.setup),
    })
}

/// Whether models are of the robot that is observed, and what was measured is enough for them.
fn check(observed: &Observed, models: &[(String, Model)]) -> Result<(), FitError> {
    for (_, model) in models {
        model.check_robot(&observed.robot)?;
        observed.check(model)?;
    }
    Ok(())
}

/// The model with clock and mounting of the reference as estimated from the motion, if the model does not set them. Values that make the
/// steps between measurements worse are removed again: an apparent lever arm may be a sideways motion that the model already has. All
/// values are added before any is removed, because offset and rate of a clock help only together.
fn with_reference(observed: &Observed, model: &Model) -> Result<(Model, Vec<Taken>), FitError> {
    let with = |taken: &[Taken]| {
        let mut with = model.clone();
        taken.iter().try_for_each(|found| found.put_on(&mut with))?;
        Ok::<_, FitError>(with)
    };
    let mut taken = observed.reference_beside(model);
    let mut best = with(&taken)?;
    for found in taken.clone() {
        let rest: Vec<Taken> = taken.iter().filter(|other| **other != found).copied().collect();
        let less = with(&rest)?;
        if step_errors(observed, &less) <= step_errors(observed, &best) {
            (best, taken) = (less, rest);
        }
    }
    // A drive that hardly shows the clock may fit single steps by one that carries whole runs away.
    if error_along(observed, &best) > ASTRAY * error_along(observed, model) {
        return Ok((model.clone(), Vec::new()));
    }
    Ok((best, taken))
}

/// Sum of the squared errors of position that single steps add \[m²\].
fn step_errors(observed: &Observed, model: &Model) -> f64 {
    let (observed, chain) = (observed.along(model), model.chain());
    followed::all(&observed, &chain)
        .into_iter()
        .flat_map(|run| run.steps)
        .map(|step| step.own[0].powi(2) + step.own[1].powi(2))
        .sum()
}

/// The errors of a model that the runs lie along.
fn errors(name: &str, data: &Dataset, observed: &Observed, model: &Model, options: &Options) -> TrackErrors {
    let runs = followed::all(observed, &model.chain());
    TrackErrors { parts: parts(data, observed, &runs, 1.0 - options.size), ..tested(name, observed, &runs, options) }
}

/// The tests of what repeats, and the errors that they are of.
fn tested(name: &str, observed: &Observed, runs: &[Followed], options: &Options) -> TrackErrors {
    let confidence = 1.0 - options.size;
    let overall = rates::overall(runs, &observed.robot, confidence);
    let against = rates::against(runs, &overall, &observed.robot, confidence);
    let tests: Vec<Test> = overall.iter().map(|o| o.test).chain(against.iter().map(|a| a.test)).flatten().collect();
    let smallest = tests.iter().filter(|test| test.matters()).fold(1.0, |least, test| test.p.min(least));
    TrackErrors {
        name: name.to_owned(),
        along: rms(runs, |_| 0),
        end: rms(runs, |run| run.places.len() - 1),
        tests: tests.len(),
        p: (!tests.is_empty()).then(|| (smallest * tests.len() as f64).min(1.0)),
        overall,
        against,
        parts: Vec::new(),
        residuals: runs.iter().map(residuals).collect(),
        taken: Vec::new(),
    }
}

/// What the tests of `compare` have against a model as it is written: p of all of them, and what repeats, in words.
pub(crate) fn against_as_written(observed: &Observed, model: &Model, options: &Options) -> Option<Reason> {
    let (observed, chain) = (observed.along(model), model.chain());
    let runs = followed::all(&observed, &chain);
    let judged = tested("", &observed, &runs, options);
    let p = judged.p.filter(|p| *p < options.size)?;
    let what = sentences::accused(&judged, options.size);
    (!what.is_empty()).then(|| Reason::Depends { p, what: what.join("; ") })
}

/// Root mean square error \[m\] of the positions along the way that a model leaves as it is, START fitted.
pub(crate) fn error_along(observed: &Observed, model: &Model) -> f64 {
    let (observed, chain) = (observed.along(model), model.chain());
    let runs = followed::all(&observed, &chain);
    rms(&runs, |_| 0).position
}

/// The same of each run.
pub(crate) fn errors_along(observed: &Observed, model: &Model) -> Vec<f64> {
    let (observed, chain) = (observed.along(model), model.chain());
    followed::all(&observed, &chain).chunks(1).map(|run| rms(run, |_| 0).position).collect()
}

/// The logs of a dataset whose runs are observed, in the order of these.
fn parts(data: &Dataset, observed: &Observed, runs: &[Followed], confidence: f64) -> Vec<Part> {
    let mut logs = data.runs.iter().filter_map(|run| Some((&run.name, run.log.as_ref()?)));
    let made: Vec<parts::Made> = runs
        .iter()
        .enumerate()
        .filter_map(|(index, run)| {
            // The moves of a whole log do not apply to a piece of it.
            let (_, log) = logs.find(|(name, _)| **name == run.observed.name)?;
            Some(parts::made(index, run, &moves_of(log, &observed.robot), &log.time))
        })
        .flatten()
        .collect();
    parts::gathered(runs, &made, confidence)
}

/// Of all places from the `first` of each run on, but for those that START is fitted at.
fn rms(runs: &[Followed], first: impl Fn(&Followed) -> usize) -> Rms {
    let (mut squares, mut count) = ([0.0; 2], 0);
    for place in runs.iter().flat_map(|run| &run.places[first(run)..]).filter(|place| !place.starts) {
        let [dx, dy] = [place.measured.x - place.predicted.x, place.measured.y - place.predicted.y];
        squares[0] += dx * dx + dy * dy;
        squares[1] += (place.measured.heading - place.predicted.heading).powi(2);
        count += 1;
    }
    let root = |square: f64| (square / count.max(1) as f64).sqrt();
    let with_heading = runs.iter().all(|run| run.with_heading);
    Rms { position: root(squares[0]), heading: with_heading.then(|| root(squares[1])) }
}

fn residuals(run: &Followed) -> TrackResiduals {
    let seen = |place: &MeasuredBlock| {
        let error = place.predicted.between(&place.measured);
        [error.x, error.y, error.heading]
    };
    TrackResiduals {
        run: run.observed.name.clone(),
        direction: run.direction,
        rolled: run.places.iter().map(|place| place.rolled).collect(),
        predicted: run.places.iter().map(|place| place.predicted).collect(),
        measured: run.places.iter().map(|place| place.measured).collect(),
        errors: run.places.iter().map(seen).collect(),
    }
}

fn remarks(observed: &Observed) -> Vec<String> {
    let mut remarks = Vec::new();
    let runs = observed.runs.len();
    if runs < 5 {
        remarks.push(format!(
            "Few runs, {runs} in all: intervals and p-values rest on the scatter between runs and are uncertain."
        ));
    }
    if observed.runs.iter().any(|run| !run.start_seen) {
        remarks.push("START was not measured in every run: there it is assumed to be exact.".into());
    }
    if observed.runs.iter().any(|run| run.blocks.iter().all(|block| block.headings == 0)) {
        remarks.push(
            "Headings were not measured in every run: sideways errors then contain the result of earlier heading errors, and are \
             not tested."
                .into(),
        );
    }
    remarks
}
