//! The runs as they were driven, kept so that the paths of one model after the other can be drawn beside them.

use umbmark_core::dataset::{Dataset, ReferencePose, Run, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Model, RunContext, TestKind};
use umbmark_core::geometry::Pose2;
use umbmark_core::path::{Direction, Path};
use umbmark_core::replay::Track;

use super::Absent;
use crate::thin::thin;

/// Places of one figure, over all runs.
const PLACES: usize = 8000;
/// Places of one run, at least and at most.
const OF_RUN: (usize, usize) = (40, 800);
/// A run with more measured poses than this is drawn as a line.
const DENSE: usize = 40;

/// All runs of a dataset, without a model.
#[derive(Clone, Debug)]
pub struct Drives {
    /// In the order of the dataset.
    pub runs: Vec<Driven>,
    /// Whether the robot's own paths were recorded; if not, they are those that it was told to drive.
    pub recorded: bool,
}

/// A run that was driven.
#[derive(Clone, Debug)]
pub struct Driven {
    /// Its index in the dataset.
    pub run: usize,
    /// Its sense.
    pub direction: Option<Direction>,
    /// Time of each place since the first \[s\]; empty where no time is known.
    pub time: Vec<f64>,
    /// How far the wheels had rolled at each place, on average and whatever way \[m\].
    pub rolled: Vec<f64>,
    /// As the robot computed it.
    pub computed: Vec<Pose2>,
    /// As measured, each with the place among those computed where the robot then was.
    pub measured: Vec<([f64; 2], usize)>,
    /// Whether the measured places make a line.
    pub dense: bool,
    track: Track,
    kept: Vec<usize>,
}

impl Driven {
    /// The poses that a model has, beside the computed ones.
    pub fn modelled(&self, model: &Model) -> Vec<Pose2> {
        let poses = self.track.poses(&model.chain());
        self.kept.iter().map(|place| poses[*place]).collect()
    }
}

impl Drives {
    /// Those of a dataset.
    pub fn of(data: &Dataset) -> Result<Drives, Absent> {
        let robot = data.nominal_robot().map_err(Absent::because)?;
        let regular = || data.runs.iter().enumerate().filter(|(_, run)| run.test == TestKind::Systematic);
        let logs = regular().filter(|(_, run)| run.log.is_some()).count();
        if logs == 0 {
            let path = data.path.as_ref();
            let path = path.ok_or_else(|| Absent("Neither ticks nor the path are known.".into()))?;
            let runs = regular().filter_map(|(index, run)| told(index, run, path, robot)).collect();
            return Ok(Drives { runs, recorded: false });
        }
        let most = (PLACES / logs).clamp(OF_RUN.0, OF_RUN.1);
        let (mut runs, mut session_distance) = (Vec::new(), 0.0);
        for (index, run) in regular() {
            let Some(log) = &run.log else { continue };
            let place = RunContext { run: runs.len(), session_distance, direction: run.direction };
            let driven = driven(log, robot, place, most)?;
            session_distance += driven.track.length();
            runs.push(Driven { run: index, ..driven });
        }
        Ok(Drives { runs, recorded: true })
    }
}

/// A run of which the end alone was measured.
fn told(index: usize, run: &Run, path: &Path, robot: &Robot) -> Option<Driven> {
    let (direction, error) = (run.direction?, run.returned?);
    let track = Track::watched(path, direction, robot);
    let computed = track.poses(&Model::new(robot).chain());
    let column = |of: fn(&Pose2) -> f64| computed.iter().map(of).collect::<Vec<f64>>();
    let kept = thin(&[&column(|pose| pose.x), &column(|pose| pose.y)], 4 * OF_RUN.0);
    let computed: Vec<Pose2> = kept.iter().map(|place| computed[*place]).collect();
    let rolled = rolled(&track);
    let rolled = kept.iter().map(|place| rolled[*place]).collect();
    let end = path.end(direction);
    let last = computed.len().saturating_sub(1);
    Some(Driven {
        run: index,
        direction: Some(direction),
        time: Vec::new(),
        rolled,
        computed,
        measured: vec![([end.x + error.x, end.y + error.y], last)],
        dense: false,
        track,
        kept,
    })
}

/// A run with its ticks.
fn driven(log: &TickLog, robot: &Robot, place: RunContext, most: usize) -> Result<Driven, Absent> {
    let column = |of: fn(&ReferencePose) -> f64| log.reference.iter().map(of).collect::<Vec<f64>>();
    let seen = thin(&[&column(|r| r.x), &column(|r| r.y)], most);
    let mut watched: Vec<(ReferencePose, bool)> = seen.iter().map(|i| (log.reference[*i], true)).collect();
    let between = (0..most).map(|i| i * log.time.len().saturating_sub(1) / most);
    watched.extend(between.map(|sample| (ReferencePose { sample, x: 0.0, y: 0.0, heading: None }, false)));
    watched.sort_by_key(|(pose, _)| pose.sample);
    let reference = watched.iter().map(|(pose, _)| *pose).collect();
    let begin = log.time.first().copied().unwrap_or(0.0);
    let time = watched.iter().map(|(pose, _)| log.time.get(pose.sample).map_or(0.0, |time| time - begin)).collect();
    let log = TickLog { reference, ..log.clone() };
    let track = Track::from_log_at(&log, robot, place).map_err(Absent::because)?;
    let computed = track.poses(&Model::new(robot).chain());
    let places = watched.iter().enumerate().filter(|(_, (_, seen))| *seen);
    let measured = places.map(|(place, (pose, _))| ([pose.x, pose.y], place)).collect();
    let (dense, kept, rolled) = (seen.len() >= DENSE, (0..computed.len()).collect(), rolled(&track));
    Ok(Driven { run: 0, direction: place.direction, time, rolled, computed, measured, dense, track, kept })
}

/// How far the wheels had rolled at each observation \[m\], as [`TrackResiduals`](umbmark_core::compare::tracks::TrackResiduals) count it.
fn rolled(track: &Track) -> Vec<f64> {
    let before = track.rolled();
    track.seen_after().iter().map(|made| before[*made]).collect()
}
