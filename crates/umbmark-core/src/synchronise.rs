//! Two clocks set by one motion: how the clock of a tracking system runs against that of the wheel counters.
//!
//! Both see the same robot move. The wheel counts give the motion by the tick clock t, the track gives it by its own clock τ,
//! and τ = offset + rate · t is where the two motions agree: first by cross-correlation of speed and turn rate over every
//! offset and rates within 5 %, then by non-linear least squares over short windows. The same fit gives what stands between
//! the tracked point and the centre of the axle: the lever arm and the turned-in yaw of the markers.
//!
//! Windows overlap and a robot slips, so residuals are correlated. Standard errors come from leaving out one stretch of the
//! run after the other (jackknife over [`BLOCKS`] stretches), intervals from Student's t. No motion is taken to have happened, or not
//! to have happened, where either clock has a gap.

mod coarse;
mod motion;
mod windows;

use crate::drive::Robot;
use crate::fit::{Options, jackknife_covariance, least_squares};
use crate::geometry::Pose2;
use crate::run::dead_reckoning::computed_poses;
use crate::run::{PoseRow, ReferenceTrack, TickLog};
use crate::stats::{Interval, Measured, student_t_quantile};
use motion::Motion;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use windows::{OFFSET, RATE, Windows};

/// Stretches of a run that are left out in turn.
pub const BLOCKS: usize = 20;
/// Share of the motion that must agree before a fit is tried.
const LEAST_AGREEMENT: f64 = 0.6;
/// No robot's nominal sizes are wrong by more.
const BELIEVED: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Windows whose residual is so many times the median one are left out of a second fit: markers that were mistaken, poses that
/// froze.
const FAR_OFF: f64 = 12.0;

/// How a track lies against the wheel counts: τ = offset + rate · t, and from the axle to the tracked point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alignment {
    /// Clock of the track minus clock of the ticks, at the first sample of the ticks \[s\].
    pub offset: Measured,
    /// Seconds of the track's clock for each second of the ticks' clock.
    pub rate: Measured,
    /// Where the tracked point lies ahead of the centre of the axle \[m\], where turning shows it. Without headings it is the
    /// distance from it.
    pub lever_ahead: Option<Measured>,
    /// Where the tracked point lies to the left of the centre of the axle \[m\], where turning and headings show it.
    pub lever_left: Option<Measured>,
    /// Heading of the tracked body minus heading of the robot \[rad\], where driving and headings show it.
    pub yaw: Option<Measured>,
    /// Root mean square of what is left \[m\] in the displacement of a window of about half a second.
    pub misfit: f64,
    /// Windows compared.
    pub windows: usize,
    /// Windows left out because they do not fit the others at all.
    pub left_out: usize,
    /// Middle of the ticks' time, and the track's clock there \[s\].
    pub(super) middle: (f64, f64),
}

impl Alignment {
    /// The ticks' time of a time of the track \[s\].
    pub fn tick_time(&self, track_time: f64) -> f64 {
        self.middle.0 + (track_time - self.middle.1) / self.rate.value
    }

    /// The poses of the axle's centre, with the robot's headings, where the alignment shows how the tracked body sits on the
    /// robot. Without headings the tracked point stays what it is.
    pub fn of_axle(&self, track: &ReferenceTrack) -> Vec<PoseRow> {
        let positions = track.x.iter().zip(&track.y);
        let Some(headings) = &track.heading else { return positions.map(|(x, y)| (*x, *y, None)).collect() };
        let value = |measured: &Option<Measured>| measured.map_or(0.0, |m| m.value);
        let body = Pose2::new(value(&self.lever_ahead), value(&self.lever_left), value(&self.yaw));
        let axle = body.inverse();
        let poses = positions.zip(headings).map(|((x, y), heading)| Pose2::new(*x, *y, *heading).compose(&axle));
        poses.map(|pose| (pose.x, pose.y, Some(pose.heading))).collect()
    }
}

/// Why two clocks could not be aligned from the motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SynchroniseError {
    /// Too little of anything.
    #[error("it has {found}; at least {needed} are needed to align its clock from the motion")]
    TooShort {
        /// What there is.
        found: String,
        /// What is needed.
        needed: &'static str,
    },
    /// The two do not show the same motion.
    #[error(
        "its motion agrees with that of the ticks to {agreement:.2} of 1 at best, and 0.6 is needed; check whether both are of the same run, and whether the ticks' columns are named as they are"
    )]
    Disagree {
        /// Correlation at the best offset and rate.
        agreement: f64,
    },
    /// The same stops, but other turns or ways.
    #[error(
        "it agrees with the ticks only if they turn {gain:.2} and drive {scale:.2} times what they say; check whether left and right are exchanged or a counter runs backward, and at the robot's sizes"
    )]
    Scaled {
        /// Turning by the track over turning by the ticks.
        gain: f64,
        /// Way by the track over way by the ticks.
        scale: f64,
    },
    /// The motion does not show the clock.
    #[error("the motion does not show {what} of its clock; drive with stops and turns")]
    Unseen {
        /// Offset or rate.
        what: &'static str,
    },
}

/// Finds how the clock of a track runs against that of a log, and where the tracked point is on the robot.
///
/// The log's own poses are not used. The nominal robot turns counts into motion; its errors (scale, wheelbase and wheel
/// diameters wrong by per cents) are fitted along and do not move the clock.
///
/// # Errors
///
/// [`SynchroniseError`] where there is too little motion, or where the two motions do not agree.
pub fn synchronise(log: &TickLog, track: &ReferenceTrack, robot: &Robot) -> Result<Alignment, SynchroniseError> {
    for (rows, what) in [(log.time.len(), "rows of ticks beside it"), (track.time.len(), "poses")] {
        if rows < 20 {
            return Err(SynchroniseError::TooShort { found: format!("{rows} {what}"), needed: "20" });
        }
    }
    let arm = 0.5 * robot.drive.wheelbase();
    let ticks = Motion::new(&log.time, computed_poses(log, robot), true);
    let seen = Motion::of_track(track);
    let guess = coarse::search(&ticks, &seen, arm);
    if guess.agreement.is_nan() || guess.agreement < LEAST_AGREEMENT {
        let agreement = if guess.agreement.is_finite() { guess.agreement } else { 0.0 };
        return Err(SynchroniseError::Disagree { agreement });
    }
    let windows = Windows::new(&ticks, &seen, &guess, arm);
    if windows.len() < 2 * BLOCKS {
        let found = format!("{} windows in which both clocks run without a gap", windows.len());
        return Err(SynchroniseError::TooShort { found, needed: "40" });
    }
    refine(windows, &guess)
}

fn refine(mut windows: Windows, guess: &coarse::Guess) -> Result<Alignment, SynchroniseError> {
    let options =
        Options { iterations: 40, step_tolerance: 1e-9, decrease_tolerance: 1e-9, cautious: true, frugal: false };
    let start = windows.start(guess);
    let first = least_squares(&windows, &start, &options);
    let all = windows.len();
    windows.leave_out(&first.residuals, FAR_OFF);
    let left_out = all - windows.len();
    let fit = if left_out > 0 { least_squares(&windows, &first.values, &options) } else { first };
    for null in fit.null_directions() {
        for (place, what) in [(OFFSET, "the offset"), (RATE, "the rate")] {
            if null[place].abs() > 1e-3 {
                return Err(SynchroniseError::Unseen { what });
            }
        }
    }
    let [scale, gain] = windows.scales(&fit.values);
    if !(BELIEVED.contains(&scale) && BELIEVED.contains(&gain)) {
        return Err(SynchroniseError::Scaled { gain, scale });
    }
    let groups = windows.blocks(BLOCKS);
    let covariance = jackknife_covariance(&fit.jacobian, &fit.residuals, &groups);
    let covariance = covariance.ok_or(SynchroniseError::Unseen { what: "the rate" })?;
    let spread = student_t_quantile(0.975, (groups.len() - 1) as f64);
    let measured = |value: f64, weights: &[(usize, f64)]| {
        let std_error = standard_error(&covariance, weights);
        Measured { value, std_error, interval: Interval::around(value, spread * std_error) }
    };
    let fitted = |place: Option<usize>| place.map(|at| measured(fit.values[at], &[(at, 1.0)]));
    let (half, middle) = (windows.half_span(), (windows.middle(), fit.values[OFFSET]));
    let first_sample = middle.0 - half;
    let offset = middle.1 - fit.values[RATE] * half - first_sample;
    let [ahead, left, yaw] = windows.places();
    Ok(Alignment {
        offset: measured(offset, &[(OFFSET, 1.0), (RATE, -half)]),
        rate: measured(fit.values[RATE], &[(RATE, 1.0)]),
        lever_ahead: fitted(ahead),
        lever_left: fitted(left),
        yaw: fitted(yaw),
        misfit: (fit.cost() / fit.residuals.len() as f64).sqrt(),
        windows: windows.len(),
        left_out,
        middle,
    })
}

/// Standard error of a weighted sum of parameters.
fn standard_error(covariance: &DMatrix<f64>, weights: &[(usize, f64)]) -> f64 {
    let products = weights.iter().flat_map(|a| weights.iter().map(move |b| (a, b)));
    products.map(|((i, a), (j, b))| a * b * covariance[(*i, *j)]).sum::<f64>().max(0.0).sqrt()
}

#[cfg(test)]
mod tests;
