//! One answer: how far off the robot is, which numbers to write into it, what remains, and what to do next.
//!
//! The model is [`learn`](crate::learn)'s. Its first effects are numbers of the robot, and become new values of them. The other effects are
//! known but no number of a robot holds them; those of the reference are not the robot's at all. What each is worth is told in metres of the
//! error of the recorded runs:
//!
//! ```text
//! as driven → without the reference's effects → with the new numbers → with all that is known
//! ```
//!
//! Each step is the fall of one [`Measure`] when the recorded runs are computed again, so the steps add up to the whole. Within a step, what
//! one effect is worth depends on which others are there already: it is the mean over all orders (the Shapley value), so that these add up
//! too. They are falls in the runs that the model was fitted to; on another path they differ.
//!
//! Source: Shapley (1953), A value for n-person games.

mod numbers;
mod off;
mod others;
mod words;

pub use numbers::Change;
pub(crate) use numbers::{Own, deviation};
pub(crate) use off::Meter;
pub use off::{Measure, Off, Part};
pub use others::Other;

use crate::action::Wording;
use crate::calibrate::{self, CalibrateError, Calibration, Correction, Estimate};
use crate::dataset::Dataset;
use crate::diagnose::{Options, Verdict};
use crate::drive::{DriveError, Robot};
use crate::effect::Model;
use crate::evidence::{AnyEvidence, FitError, robot_of};
use crate::learn::{Learnt, learn_from};
use crate::setup::Fault;
use crate::watch::Watch;

/// A length is vague where its interval reaches farther than this share of it either way: any tape measures nearer.
const VAGUE: f64 = 0.1;

/// The one answer about a measured robot.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The model, and how it was learnt.
    pub learnt: Learnt,
    /// Effects with which these runs are about as likely, and the fitted numbers are others: the intervals of these allow for them.
    pub others: Vec<Other>,
    /// Numbers of the robot that these runs show, with their new values.
    pub changes: Vec<Change>,
    /// Whether the new values differ from the old ones by more than chance.
    pub needed: bool,
    /// How far off the robot is, and what of it is what; `None` where nothing is known of the robot yet.
    pub off: Option<Off>,
    /// The largest error that one number of the robot leaves at an end of its interval, the others as they are \[m\]: so large an error of the
    /// numbers these runs do not see.
    pub unseen: Option<f64>,
    /// First effects of the robot's drive that these runs do not show; the numbers are as if these did nothing.
    pub not_shown: Vec<&'static str>,
}

/// Answers for a dataset. Once stopped, it ends with the current step of learning.
///
/// ```
/// use umbmark_core::{dataset::{Dataset, ReturnError, Run}, diagnose::Options, drive::Robot, path::{Direction, Path}};
/// use umbmark_core::{calibrate::{Correction, drive_again}, effect::{Model, TestKind}, solve::solve, watch::Watch};
/// let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let truth = Correction { e_d: 1.002, e_b: 0.99, e_s: 1.0 };
/// let run = |number: u32| {
///     let direction = Direction::BOTH[number as usize % 2];
///     let error = drive_again(&robot, &path, direction, &truth, &Correction::NONE).unwrap();
///     let scatter = 1e-3 * f64::from(number * number % 7);
///     let returned = Some(ReturnError { x: error.x + scatter, y: error.y - scatter, ..error });
///     Run { name: format!("run {number}"), number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
/// };
/// let (robot, path) = (Some(robot.clone()), Some(path.clone()));
/// let data = Dataset { robot, path, runs: (0..10).map(run).collect(), ..Dataset::default() };
/// let start = Model::new(data.nominal_robot()?);
/// let answer = Watch::nobody(|watch| solve(&data, &start, &Options::default(), watch))?;
/// let wheelbase = answer.change("wheelbase_m").unwrap();
/// assert!(answer.needed && (wheelbase.new - 0.99 * wheelbase.old).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve(data: &Dataset, start: &Model, options: &Options, watch: &Watch) -> Result<Solution, FitError> {
    let learnt = learn_from(data, start, options, watch)?;
    Solution::of(data, learnt, options)
}

/// Calibrates by every method, the learnt model's numbers as one more row, which is the one to write; with the answer that says why, where
/// a model could be learnt.
pub fn calibrate_beside(
    data: &Dataset,
    options: &calibrate::Options,
    testing: &Options,
    watch: &Watch,
) -> Result<(Calibration, Option<Solution>), CalibrateError> {
    let learnt = solve(data, &Model::new(robot_of(data)?), testing, watch);
    let answer = learnt.as_ref().ok();
    let mut calibration = calibrate::calibrate_beside(data, options, answer.and_then(Solution::estimate))?;
    if let Err(error) = &learnt {
        calibration
            .warnings
            .push(format!("No model could be learnt from these runs ({error}): the exact fit is exported."));
    }
    let doubt = answer.and_then(words::doubt);
    calibration.doubts.extend(doubt.clone());
    calibration.warnings.extend(doubt.or_else(|| answer.and_then(words::beyond_wheels)));
    Ok((calibration, learnt.ok()))
}

impl Solution {
    /// The answer that a learnt model gives about the robot of its data.
    pub fn of(data: &Dataset, mut learnt: Learnt, options: &Options) -> Result<Solution, FitError> {
        let robot = robot_of(data)?;
        let not_shown: Vec<&str> = {
            let has = |effect: &&str| learnt.model.parts().iter().any(|part| part.effect.name() == *effect);
            robot.drive.first_effects().into_iter().filter(|effect| !has(effect)).collect()
        };
        if learnt.diagnosis.setup.all_faults().next().is_some() {
            return Ok(Solution {
                learnt,
                others: Vec::new(),
                changes: Vec::new(),
                needed: false,
                off: None,
                unseen: None,
                not_shown,
            });
        }
        let evidence = AnyEvidence::of(data, options.level(data))?;
        let meter = Meter::new(data, &evidence);
        let off = meter.as_ref().map(|meter| Off::of(meter, &learnt));
        let others = if learnt.partial { Vec::new() } else { others::of(&evidence, &learnt, options.size) };
        others::widen(&mut learnt.diagnosis, &others, 1.0 - options.size);
        let (mut changes, needed) = numbers::of(&learnt, options.size);
        if let Some(off) = &off {
            numbers::share(&mut changes, off, &learnt.model);
        }
        let unseen = meter.map(|meter| off::at_ends_of_intervals(&meter, &learnt, 1.0 - options.size));
        Ok(Solution { learnt, others, changes, needed, off, unseen, not_shown })
    }

    /// A number of the robot, by its key in robot.toml.
    pub fn change(&self, key: &str) -> Option<&Change> {
        self.changes.iter().find(|change| change.key == key)
    }

    /// What is wrong with the data and has to be corrected before anything else.
    pub fn faults(&self) -> Vec<&Fault> {
        self.learnt.diagnosis.setup.all_faults().collect()
    }

    /// Whether the new numbers may be written: the model explains the runs, the data are in order, and they neither
    /// [mislead alone](Solution::misleads_alone) nor [make it worse](Solution::makes_worse) nor are [vague](Solution::vague) or
    /// [outweighed](Solution::outweighed).
    pub fn is_trusted(&self) -> bool {
        let is_good = !self.misleads_alone() && !self.makes_worse();
        !self.learnt.is_in_doubt() && is_good && self.vague().next().is_none() && self.outweighed().is_none()
    }

    /// What laws outside the catalogue are worth in these runs, and what the new numbers are \[m\], where the laws are worth more: their
    /// cause is not known, and a part of it may be in the numbers.
    pub fn outweighed(&self) -> Option<[f64; 2]> {
        let off = self.off.as_ref().filter(|_| self.needed)?;
        let is_law =
            |part: &&Part| self.learnt.steps.iter().any(|step| step.added == Some(part.name) && step.law.is_some());
        let laws: f64 = off.known.iter().filter(is_law).map(|part| part.worth).sum();
        let numbers = off.driven - off.reference.iter().map(|part| part.worth).sum::<f64>() - off.with_numbers;
        (laws > words::TOLD * off.driven && laws > numbers).then_some([laws, numbers])
    }

    /// New lengths with intervals so wide that a tape tells more.
    pub fn vague(&self) -> impl Iterator<Item = &Change> {
        let is_length = |change: &&Change| change.key.ends_with("_m") && !change.key.ends_with("_per_m");
        let half = |change: &Change| change.interval.map_or(0.0, |interval| 0.5 * (interval.high - interval.low));
        let is_vague = move |change: &&Change| half(change) > VAGUE * change.new.abs();
        self.changes.iter().filter(|_| self.needed).filter(is_length).filter(is_vague)
    }

    /// Whether the new numbers, of a model without further effects, leave a larger error in these runs than there is.
    pub fn makes_worse(&self) -> bool {
        self.off.as_ref().is_some_and(|off| {
            self.needed && off.known.is_empty() && off.with_numbers > (1.0 + words::WORSE) * off.driven
        })
    }

    /// Whether the new numbers alone leave a larger error in these runs than there is, and more than chance makes. They hold only beside
    /// effects that the robot takes along to every path, and that no number of it holds. Effects of the floor stay there.
    pub fn misleads_alone(&self) -> bool {
        self.off.as_ref().is_some_and(|off| {
            let is_worse = off.with_numbers > (1.0 + words::TOLD) * off.driven;
            self.needed
                && is_worse
                && !off.is_chance(off.with_numbers)
                && off.known.iter().any(|part| self.travels(part))
        })
    }

    /// Whether the robot takes an effect along to every path. One of the floor stays there.
    fn travels(&self, part: &Part) -> bool {
        let law = self.learnt.model.parts().iter().find(|own| own.effect.name() == part.name);
        law.and_then(|own| own.effect.entry()).is_none_or(|entry| !entry.is_of_floor)
    }

    /// Whether these runs would have shown numbers that make the error that there is, or more than chance makes.
    pub fn tells_numbers(&self) -> bool {
        let Some((off, unseen)) = self.off.as_ref().zip(self.unseen) else { return false };
        unseen <= off.driven.max(off.chance.unwrap_or(0.0))
    }

    /// Why the model, or its numbers alone, should not be used; `None` where nothing speaks against it.
    pub fn doubt(&self) -> Option<String> {
        words::doubt(self)
    }

    /// Whether the lengths, and their intervals, hold only if the wheels are right on the whole, which these runs do not show.
    pub fn assumes_scale(&self) -> bool {
        !self.changes.is_empty() && self.not_shown.iter().any(|effect| ["scale", "drive_scale"].contains(effect))
    }

    /// Whether the robot has an error source that the model does not have: nothing is known to be complete then.
    pub fn misses_something(&self) -> bool {
        match self.learnt.verdict {
            Verdict::Explained | Verdict::NotEnoughData => false,
            Verdict::UnlistedEffect => self.learnt.diagnosis.dependence.is_some(),
            Verdict::MissingEffect | Verdict::SeveralMissing | Verdict::NotExplained => true,
        }
    }

    /// E_d, E_b and E_s of the model, as far as it shows them; `None` of a drive that has others, or where nothing was fitted.
    pub fn estimate(&self) -> Option<Estimate> {
        let has_wheels = self.learnt.model.robot().drive.kind().has_axle_wheels();
        has_wheels.then(|| numbers::estimate(&self.learnt)).flatten()
    }

    /// The correction of the robot's odometry.
    pub fn correction(&self) -> Correction {
        Correction::of(&self.learnt.model)
    }

    /// The robot with the new numbers.
    pub fn corrected(&self) -> Result<Robot, DriveError> {
        self.learnt.model.corrected_robot()
    }

    /// The answer in one or two sentences for people.
    pub fn sentence(&self) -> String {
        words::sentence(self)
    }

    /// What to do next, a sentence each, the most urgent first, with what an edge calls its actions.
    pub fn next(&self, words: Wording) -> Vec<String> {
        words::next(self, words)
    }
}

#[cfg(test)]
mod tests;
