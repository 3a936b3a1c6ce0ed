//! What a dataset offers the exact fit: believed travel and observed poses, run by run.

use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::evidence::{Drive, FitError, Level, end_poses, is_possible, tracked};
use crate::likelihood::{FAR, Taken, of_reference, ratios};
use crate::run::TickLog;
use crate::setup::{Mounting, RunSetup, Setup};
use nalgebra::Matrix3;
use std::borrow::Cow;

/// Observations farther from START than this share of the way driven show E_s.
const AWAY: f64 = 0.05;

/// A run with fewer poses is left out where others of its poses are wrong.
const FEWEST: usize = 3;

/// All runs of the regular test that can be predicted.
#[derive(Clone, Debug)]
pub(crate) struct Observations {
    pub level: Level,
    pub drives: Vec<Drive>,
    /// Metres that a radian of heading error counts as, on tracks.
    pub heading_arm: f64,
    /// Whether some observation lies away from START, so that the scale shows.
    pub scale_shows: bool,
    /// What is known of the reference by the motion alone, on tracks.
    pub taken: Vec<Taken>,
    /// E_d, E_b, E_s by the motion alone, where they are far from 1.
    pub by_motion: Option<[f64; 3]>,
}

impl Observations {
    pub(crate) fn new(data: &Dataset, robot: &Robot, heading_arm: Option<f64>) -> Result<Observations, FitError> {
        let runs: Vec<&Run> = data.runs.iter().filter(|run| run.test == TestKind::Systematic).collect();
        let mut drives = Vec::with_capacity(runs.len());
        for run in &runs {
            drives.extend(tracked(run, robot)?);
        }
        let level =
            if drives.len() == runs.len() && drives.iter().any(|d| stops(d) > 1) { Level::Tracks } else { Level::Ends };
        if level == Level::Ends {
            drives = end_poses(data, robot)?;
        }
        let arm = heading_arm.unwrap_or_else(|| mean_distance(&drives));
        if level == Level::Tracks {
            let weight = Matrix3::from_diagonal(&[1.0, 1.0, arm].into());
            drives.iter_mut().for_each(|drive| drive.weight = weight);
        }
        let scale_shows = drives.iter().any(|d| {
            let far = d.seen.iter().map(|s| libm::hypot(s.x, s.y)).fold(0.0, f64::max);
            far > AWAY * d.track.length()
        });
        Ok(Observations { level, drives, heading_arm: arm, scale_shows, taken: Vec::new(), by_motion: None })
    }

    /// Whether the reference of every regular run tells motion or headings only, which is nothing that is offered here.
    pub(super) fn are_steps(data: &Dataset) -> bool {
        let mut runs = data.runs.iter().filter(|run| run.test == TestKind::Systematic).peekable();
        let tells_less = |log: &TickLog| log.relative || log.headings_only;
        let steps = |run: &Run| run.returned.is_none() && run.log.as_ref().is_some_and(tells_less);
        runs.peek().is_some() && runs.all(steps)
    }

    /// Those of a dataset that offers none.
    pub(super) fn none() -> Observations {
        let (level, drives, taken) = (Level::Tracks, Vec::new(), Vec::new());
        Observations { level, drives, heading_arm: 1.0, scale_shows: false, taken, by_motion: None }
    }

    /// On tracks, takes what the motion alone says of the reference and, where it is far from nominal, of the robot.
    pub(super) fn begin_with(&mut self, mounting: &Mounting, robot: &Robot) {
        if self.level == Level::Tracks {
            let sights = self.drives.iter().filter_map(|drive| drive.track.sights().last());
            self.taken = of_reference(mounting, sights.map(|sight| sight.time).fold(0.0, f64::max));
            let [e_s, e_b, e_d] = ratios(mounting, robot.drive.wheelbase()).map(|(_, _, value)| value.unwrap_or(1.0));
            let by_motion = [e_d, e_b, e_s];
            let is_far = by_motion.iter().any(|ratio| (ratio - 1.0).abs() > FAR);
            self.by_motion = (is_far && by_motion.into_iter().all(is_possible)).then_some(by_motion);
        }
    }
}

/// A dataset without what is wrong with its tracks: wrong poses are left out, and each run ends before its first jump; its return
/// error is then not known. With a sentence for each run that lost something.
pub(super) fn mended<'a>(data: &'a Dataset, setup: &Setup) -> (Cow<'a, Dataset>, Vec<String>) {
    let is_off = |run: &RunSetup| !(run.relative || run.wrong.is_empty() && run.jumps.is_empty());
    if !setup.runs.iter().any(is_off) {
        return (Cow::Borrowed(data), Vec::new());
    }
    let (mut mended, mut said) = (data.clone(), Vec::new());
    for run in &mut mended.runs {
        let found = setup.of_run(&run.name).filter(|found| run.test == TestKind::Systematic && is_off(found));
        let (Some(found), Some(log)) = (found, run.log.as_mut()) else { continue };
        let last = log.reference.len().saturating_sub(1);
        let jump = found.jumps.iter().min_by_key(|jump| jump.pose);
        let is_kept = |pose: usize| jump.is_none_or(|jump| pose < jump.pose) && !found.is_lost(pose);
        if !is_kept(last) {
            run.returned = None;
        }
        let mut pose = 0;
        log.reference.retain(|_| {
            pose += 1;
            is_kept(pose - 1)
        });
        if let Some(jump) = jump {
            said.push(format!("Run {} is used up to {:.1} s, where its track jumps.", run.name, jump.time));
        }
    }
    let is_left = |run: &Run| {
        run.log.as_ref().is_none_or(|log| {
            log.reference.len() >= FEWEST || setup.of_run(&run.name).is_none_or(|found| !is_off(found))
        })
    };
    said.extend(
        mended
            .runs
            .iter()
            .filter(|run| !is_left(run))
            .map(|run| format!("Run {} is left out: too few of its poses are right before its first jump.", run.name)),
    );
    mended.runs.retain(is_left);
    (Cow::Owned(mended), said)
}

/// How many observations were made at different places on the way.
fn stops(drive: &Drive) -> usize {
    let mut places: Vec<usize> = drive.track.seen_after().iter().copied().filter(|made| *made > 0).collect();
    places.dedup();
    places.len()
}

/// Root mean square distance of the observations from START \[m\].
fn mean_distance(drives: &[Drive]) -> f64 {
    let squares: Vec<f64> = drives.iter().flat_map(|d| &d.seen).map(|s| s.x * s.x + s.y * s.y).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}
