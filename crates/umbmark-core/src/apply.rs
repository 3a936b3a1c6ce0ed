//! A model at work: corrected odometry, with its covariance, from the counts of a run that nobody measured.
//!
//! The poses are those that [`replay`](crate::replay) predicts, to the last bit. What belongs to a reference (its delay, its clock, where
//! its marker sits, how START was found) does nothing here.

mod compiled;

pub use compiled::{CompileError, compiled};
pub use umbmark_odometry::spread::Spread;

use crate::dataset::Dataset;
use crate::effect::{Model, ModelError, RunContext};
use crate::geometry::Pose2;
use crate::likelihood::Noise;
use crate::replay::{ReplayError, Track};
use crate::run::{Run, TickLog};

/// Corrected odometry of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    /// Time of each sample \[s\], as in the log.
    pub time: Vec<f64>,
    /// The recorder's clock at time 0 \[ns\], where that is of a calendar; else 0.
    pub begin_ns: i64,
    /// Pose at each sample.
    pub poses: Vec<Pose2>,
    /// How sure each pose is; `None` where no noise is known.
    pub spread: Option<Vec<Spread>>,
    /// Variances of the motion to each sample from the one before: forward and to the side \[m²\], and of the heading \[rad²\]; `None` where
    /// no noise is known.
    pub motion_variances: Option<Vec<[f64; 3]>>,
    /// Way that the axle's centre has driven \[m\].
    pub way: f64,
}

impl Corrected {
    /// Time of a sample on the recorder's clock \[ns\], where that is of a calendar: a double does not hold its nanoseconds.
    pub fn stamp_ns(&self, sample: usize) -> Option<i64> {
        (self.begin_ns > 0).then(|| self.begin_ns.saturating_add((self.time[sample] * 1e9).round() as i64))
    }
}

/// Why a model cannot be applied to a log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ApplyError {
    /// A log that cannot be replayed.
    #[error(transparent)]
    Log(#[from] ReplayError),
    /// A model that is not for this robot, or whose formulas are not finite somewhere on the way.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Corrects the odometry of a log, whose robot stands at `start` at its first sample.
///
/// `run` says which of a session it is. The covariance grows by the noise of the wheels; START is taken to be exact, and so are
/// the values of the model.
///
/// ```
/// use umbmark_core::{apply::apply, drive::Robot, effect::{Model, RunContext}, geometry::Pose2, run::TickLog};
/// let robot = Robot::labmate();
/// let log = TickLog { time: vec![0.0, 1.0], left: vec![0.0, 4244.0], right: vec![0.0, 4244.0], ..TickLog::default() };
/// let mut model = Model::new(&robot);
/// model.set("scale", "e_s", 1.01)?;
/// let corrected = apply(&log, &model, None, Pose2::IDENTITY, RunContext::default())?;
/// assert!((corrected.poses[1].x - 1.01).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn apply(
    log: &TickLog,
    model: &Model,
    noise: Option<&Noise>,
    start: Pose2,
    run: RunContext,
) -> Result<Corrected, ApplyError> {
    let track = Track::from_log_seen(log, model.robot(), run, 0..log.time.len())?.beginning_at(start);
    track.check(model)?;
    Ok(along(&track, log, model, noise, start))
}

/// Corrects the odometry of every run of a dataset that has a log, in their order; each begins at `start`.
pub fn apply_to_all<'d>(
    data: &'d Dataset,
    model: &Model,
    noise: Option<&Noise>,
    start: Pose2,
) -> Result<Vec<(&'d Run, Corrected)>, ApplyError> {
    let mut session = RunContext::default();
    let logs = data.runs.iter().filter_map(|run| Some((run, run.log.as_ref()?)));
    let of_run = |(run, log): (&'d Run, &TickLog)| {
        let context = RunContext { direction: run.direction, ..session };
        let track = Track::from_log_seen(log, model.robot(), context, 0..log.time.len())?.beginning_at(start);
        track.check(model)?;
        session =
            RunContext { run: session.run + 1, session_distance: session.session_distance + track.length(), ..session };
        Ok((run, along(&track, log, model, noise, start)))
    };
    logs.map(of_run).collect()
}

fn along(track: &Track, log: &TickLog, model: &Model, noise: Option<&Noise>, start: Pose2) -> Corrected {
    let chain = model.chain();
    let growth = noise.map(Noise::of_wheels);
    let (mut pose, mut spread, mut way) = (start, Spread::default(), 0.0);
    let mut pieces = track.travel().iter().zip(track.contexts());
    let (mut poses, mut spreads, mut variances) = (Vec::with_capacity(log.time.len()), Vec::new(), Vec::new());
    let mut made = 0;
    for after in track.seen_after() {
        let mut step = [0.0; 3];
        for (travel, at) in pieces.by_ref().take(after - made) {
            let from = pose;
            let motion = chain.displacement(&at.at_pose(&from), travel);
            pose.advance(&motion);
            way +=
                if at.aside.way == 0.0 { motion.forward.abs() } else { libm::hypot(motion.forward, motion.sideways) };
            if let Some(growth) = &growth {
                let rolled = travel.rolled().max(at.aside.way.abs());
                spread = spread.after(&from, &motion, rolled, &pose, growth);
                let grown = growth.of(&motion, rolled);
                step = std::array::from_fn(|k| step[k] + grown[k]);
            }
        }
        made = *after;
        poses.push(pose);
        if noise.is_some() {
            spreads.push(spread);
            variances.push(step);
        }
    }
    Corrected {
        time: log.time.clone(),
        begin_ns: log.begin_ns,
        poses,
        spread: noise.map(|_| spreads),
        motion_variances: noise.map(|_| variances),
        way,
    }
}

#[cfg(test)]
mod tests;
