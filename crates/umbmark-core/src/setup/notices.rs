//! What must be known of an experiment, in sentences.

use super::{Fault, Jump, RunSetup, Setup, Suspicion, WrongPose};
use crate::prose::counted;

/// Maximum number of notices of a kind that are listed.
pub const TOLD: usize = 5;

impl Setup {
    /// What must be known before the return errors are trusted, a sentence each without a full stop: faults and doubts, jumps and wrong poses of
    /// tracks, runs whose return is far from the others. Of many of a kind, the first [`TOLD`] are listed and the rest counted.
    pub fn notices(&self) -> Vec<String> {
        let told = |fault: &Fault| format!("{}; to correct it, {}", fault.sentence(), fault.remedy());
        let mut notices: Vec<String> = self.all_faults().map(told).collect();
        notices.extend(self.doubts.iter().map(Suspicion::sentence));
        let jumps = self.jumps().map(|(run, jump)| jump.notice(&run.run));
        notices.extend(shortened(jumps.collect(), "jumps of tracks"));
        notices.extend(self.wrong_steps());
        let wrong = self.runs.iter().filter(|run| !run.relative && !run.wrong.is_empty()).map(RunSetup::notice);
        notices.extend(shortened(wrong.collect(), "runs with wrong poses"));
        let outlying = self.returned.outlying.iter().map(|run| format!("{}; {}", run.sentence(), run.remedy()));
        notices.extend(shortened(outlying.collect(), "runs far from the others"));
        notices
    }

    /// By how much the poses of runs are later than those of the median run, where each run was laid on its own clock; of the [`TOLD`] that are farthest from it.
    pub fn clocks(&self) -> Option<String> {
        let mut own: Vec<&RunSetup> = self.runs.iter().filter(|run| run.own_clock != 0.0).collect();
        own.sort_by(|a, b| b.own_clock.abs().total_cmp(&a.own_clock.abs()));
        let told = |run: &&RunSetup| format!("{} by {:+.0} ms", run.run, 1e3 * run.own_clock);
        let told: Vec<String> = own.iter().take(TOLD).map(told).collect();
        let rest = match own.len() - told.len() {
            0 => String::new(),
            rest => format!(", and {}", counted(rest, "more run")),
        };
        (!told.is_empty()).then(|| {
            format!(
                "the poses of the runs are not equally late: against the median run, {}{rest}; each run is laid on its own clock",
                told.join(", ")
            )
        })
    }

    /// How many steps of references that tell motion only are wrong, in all runs together.
    pub fn wrong_steps(&self) -> Option<String> {
        let runs = || self.runs.iter().filter(|run| run.relative);
        let wrong: usize = runs().map(|run| run.jumps.len() + run.wrong.len()).sum();
        let steps: usize = runs().map(|run| run.poses.saturating_sub(1)).sum();
        (wrong > 0).then(|| {
            format!("{wrong} of {steps} steps of the reference are far from the motion of the wheels and were left out")
        })
    }
}

impl Jump {
    /// What it does to the run of this name.
    pub(crate) fn notice(&self, run: &str) -> String {
        let turned = self.turned.map(|t| format!(" and {:.0} deg", t.to_degrees())).unwrap_or_default();
        let (moved, when) = (self.moved, self.when(1));
        if let Some(seconds) = self.unrecorded {
            return format!(
                "run {run} has no rows for {seconds:.1} s {when}, and its wheels rolled: its return error is not the robot's"
            );
        }
        format!("the track of run {run} jumps by {moved:.2} m{turned} {when}: its return error is not the robot's")
    }

    /// "at 12.3 s" or "between 12.3 s and 13.1 s", with so many decimals.
    pub fn when(&self, decimals: usize) -> String {
        let Jump { since, time, .. } = self;
        if self.pose - self.from > 1 {
            format!("between {since:.decimals$} s and {time:.decimals$} s")
        } else {
            format!("at {time:.decimals$} s")
        }
    }
}

impl RunSetup {
    /// How many of its poses are wrong, and by how much at most: "3 of 1801 poses of run cw_01 are wrong, by up to 0.012 m and 1.6 deg".
    pub fn notice(&self) -> String {
        let most = |of: fn(&WrongPose) -> f64| self.wrong.iter().map(of).fold(0.0, f64::max);
        let (moved, turned) = (most(|wrong| wrong.moved), most(|wrong| wrong.turned.map_or(0.0, f64::abs)));
        let turned = if turned > 0.0 { format!(" and {:.1} deg", turned.to_degrees()) } else { String::new() };
        let (run, wrong, poses) = (&self.run, self.wrong.len(), self.poses);
        let are = if wrong == 1 { "is" } else { "are" };
        format!("{wrong} of {poses} poses of run {run} {are} wrong, by up to {moved:.3} m{turned}")
    }
}

/// The first notices, and how many more there are.
fn shortened(mut notices: Vec<String>, kind: &str) -> Vec<String> {
    if let rest @ 1.. = notices.len().saturating_sub(TOLD) {
        notices.truncate(TOLD);
        notices.push(format!("there are {rest} more {kind}"));
    }
    notices
}
