//! Runs whose references have clocks of their own: two recorders that are started by hand before each run.

use super::{RunSetup, Setup};
use crate::drive::Robot;
use crate::path::Path;
use crate::run::{PoseRow, Run, TickLog, place};
use crate::stats::{Measured, robust};
use std::borrow::Cow;

/// Clocks differ where the delays of the runs scatter by more than this about their median \[s\]: what is less, the noise of the reference's
/// clock from run to run represents.
const APART: f64 = 0.02;
/// The delay of a run counts where it is known to this \[s\], and where it is so many standard errors from that of all.
const KNOWN: f64 = 0.02;
const SURELY: f64 = 4.0;

impl Setup {
    /// What was found of the runs, each laid on its own clock where clocks differ, and these runs.
    pub(crate) fn on_own_clocks<'a>(runs: &'a [Run], robot: &Robot, path: Option<&Path>) -> (Cow<'a, [Run]>, Setup) {
        let setup = Setup::of(runs, robot, path);
        let late = setup.own_clocks(runs);
        if late.is_empty() {
            return (Cow::Borrowed(runs), setup);
        }
        let late_of = |name: &str| late.iter().find(|(own, _)| *own == name).map(|(_, late)| *late);
        let laid = |run: &Run| match (&run.log, late_of(&run.name)) {
            (Some(log), Some(late)) => Run { log: Some(set_back(log, late)), ..run.clone() },
            _ => run.clone(),
        };
        let laid: Vec<Run> = runs.iter().map(laid).collect();
        let mut on_own = Setup::of(&laid, robot, path);
        // If the delays were those of clocks, they agree now.
        if on_own.mounting.is_none() || !on_own.own_clocks(&laid).is_empty() {
            return (Cow::Borrowed(runs), setup);
        }
        for run in &mut on_own.runs {
            run.own_clock = late_of(&run.run).unwrap_or(0.0);
        }
        (Cow::Owned(laid), on_own)
    }

    /// By how much later than those of all runs the poses of a run are stamped \[s\], for each run that has a clock of its own; empty where
    /// one clock does for all.
    fn own_clocks<'a>(&self, runs: &'a [Run]) -> Vec<(&'a str, f64)> {
        let rate = self.mounting.and_then(|all| all.rate).map_or(0.0, |rate| rate.value);
        // At the beginning of each run, if they have the same rate.
        let of_run = |own: &RunSetup| {
            let run = runs.iter().find(|run| run.name == own.run)?;
            let log = run.log.as_ref().filter(|log| can_be_set_back(log))?;
            let known = own.delay.filter(|delay| delay.std_error <= KNOWN)?;
            Some((run.name.as_str(), known.less(rate * middle(log)?)))
        };
        let known: Vec<(&str, Measured)> = self.runs.iter().filter_map(of_run).collect();
        let all = robust::median(known.iter().map(|(_, own)| own.value));
        let off = known.iter().map(|(name, own)| (*name, own.less(all)));
        let off: Vec<(&str, f64)> =
            off.filter(|(_, off)| off.is_beyond(SURELY)).map(|(name, off)| (name, off.value)).collect();
        let square = off.iter().map(|(_, off)| off * off).sum::<f64>() / known.len().max(1) as f64;
        if square.sqrt() > APART { off } else { Vec::new() }
    }
}

/// Not where poses are motions or counted ways, nor where the time of each row is known by the motion. Without headings, turns that the robot
/// believes wrongly look like delays.
fn can_be_set_back(log: &TickLog) -> bool {
    let is_absolute = !log.relative && !log.headings_only && log.clock_excess_along.is_empty();
    is_absolute && log.reference.iter().all(|pose| pose.heading.is_some())
}

/// The middle of the poses, since the log began \[s\].
fn middle(log: &TickLog) -> Option<f64> {
    let (first, last) = (log.reference.first()?, log.reference.last()?);
    Some(0.5 * (log.time[first.sample] + log.time[last.sample]) - log.time[0])
}

/// A log whose poses were measured earlier than it says, by so much \[s\].
fn set_back(log: &TickLog, late: f64) -> TickLog {
    let rows: Vec<usize> = (0..log.time.len()).filter(|sample| !log.is_put_in(*sample)).collect();
    let of_rows = |all: &[f64]| rows.iter().map(|row| all[*row]).collect::<Vec<f64>>();
    let mut moved = TickLog {
        time: of_rows(&log.time),
        left: of_rows(&log.left),
        right: of_rows(&log.right),
        rollers: log.rollers.iter().map(|counts| of_rows(counts)).collect(),
        ..log.clone()
    };
    let poses = log.reference.iter().map(|pose| (log.time[pose.sample] - late, (pose.x, pose.y, pose.heading)));
    let (times, poses): (Vec<f64>, Vec<PoseRow>) = poses.unzip();
    place(&mut moved, &times, &poses);
    moved
}
