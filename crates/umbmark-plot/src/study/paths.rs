//! Where the runs went: as measured, as computed by the robot, and as a model has it.

use umbmark_core::dataset::{ReferencePose, Run, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Model, RunContext, TestKind};
use umbmark_core::geometry::Pose2;
use umbmark_core::path::{Direction, Path};
use umbmark_core::replay::Track;

use super::{Absent, Study};
use crate::thin::thin;

/// Places of one figure, over all runs.
const PLACES: usize = 8000;
/// Places of one run, at least and at most.
const OF_RUN: (usize, usize) = (40, 800);
/// A run with more measured poses than this is drawn as a line.
const DENSE: usize = 40;

/// The paths of all runs.
#[derive(Clone, Debug)]
pub struct Paths {
    /// In the order of the dataset.
    pub runs: Vec<RunPath>,
    /// Whether the robot's own paths were recorded; if not, they are those that it was told to drive.
    pub recorded: bool,
}

/// The path of a run.
#[derive(Clone, Debug)]
pub struct RunPath {
    /// Its index in the dataset.
    pub run: usize,
    /// Its sense.
    pub direction: Option<Direction>,
    /// As the robot computed it.
    pub computed: Vec<[f64; 2]>,
    /// As the model has it, beside the computed places.
    pub modelled: Vec<[f64; 2]>,
    /// As measured, each with where the robot computed to be.
    pub measured: Vec<([f64; 2], [f64; 2])>,
    /// Whether the measured places make a line.
    pub dense: bool,
}

impl Paths {
    pub(super) fn new(study: &Study) -> Result<Paths, Absent> {
        let robot = study.data.nominal_robot().map_err(Absent::because)?;
        let model = study.model()?;
        let regular = || study.data.runs.iter().enumerate().filter(|(_, run)| run.test == TestKind::Systematic);
        let logs = regular().filter(|(_, run)| run.log.is_some()).count();
        if logs == 0 {
            let path = study.data.path.as_ref();
            let path = path.ok_or_else(|| Absent("Neither ticks nor the path are known.".into()))?;
            let runs = regular().filter_map(|(index, run)| told(index, run, path, model)).collect();
            return Ok(Paths { runs, recorded: false });
        }
        let most = (PLACES / logs).clamp(OF_RUN.0, OF_RUN.1);
        let (mut runs, mut session_distance) = (Vec::new(), 0.0);
        for (index, run) in regular() {
            let Some(log) = &run.log else { continue };
            let place = RunContext { run: runs.len(), session_distance, direction: run.direction };
            let (path, length) = driven(log, robot, model, place, most)?;
            session_distance += length;
            runs.push(RunPath { run: index, ..path });
        }
        Ok(Paths { runs, recorded: true })
    }
}

fn xy(poses: &[Pose2]) -> Vec<[f64; 2]> {
    poses.iter().map(|pose| [pose.x, pose.y]).collect()
}

/// A run of which the end alone was measured.
fn told(index: usize, run: &Run, path: &Path, model: &Model) -> Option<RunPath> {
    let (direction, error) = (run.direction?, run.returned?);
    let track = Track::watched(path, direction, model.robot());
    let computed = xy(&track.poses(&Model::new(model.robot()).chain()));
    let modelled = xy(&track.poses(&model.chain()));
    let column = |i: usize| computed.iter().map(|p| p[i]).collect::<Vec<f64>>();
    let kept = thin(&[&column(0), &column(1)], 4 * OF_RUN.0);
    let pick = |places: &[[f64; 2]]| kept.iter().map(|i| places[*i]).collect::<Vec<_>>();
    let end = path.end(direction);
    Some(RunPath {
        run: index,
        direction: Some(direction),
        computed: pick(&computed),
        modelled: pick(&modelled),
        measured: vec![([end.x + error.x, end.y + error.y], [end.x, end.y])],
        dense: false,
    })
}

/// A run with its ticks, and the way driven \[m\].
fn driven(
    log: &TickLog,
    robot: &Robot,
    model: &Model,
    place: RunContext,
    most: usize,
) -> Result<(RunPath, f64), Absent> {
    let column = |of: fn(&ReferencePose) -> f64| log.reference.iter().map(of).collect::<Vec<f64>>();
    let seen = thin(&[&column(|r| r.x), &column(|r| r.y)], most);
    let mut watched: Vec<(ReferencePose, bool)> = seen.iter().map(|i| (log.reference[*i], true)).collect();
    let between = (0..most).map(|i| i * log.time.len().saturating_sub(1) / most);
    watched.extend(between.map(|sample| (ReferencePose { sample, x: 0.0, y: 0.0, heading: None }, false)));
    watched.sort_by_key(|(pose, _)| pose.sample);
    let reference = watched.iter().map(|(pose, _)| *pose).collect();
    let log = TickLog { reference, ..log.clone() };
    let track = Track::from_log_at(&log, robot, place).map_err(Absent::because)?;
    let computed = xy(&track.poses(&Model::new(robot).chain()));
    let modelled = xy(&track.poses(&model.chain()));
    let places = watched.iter().zip(&computed).filter(|((_, seen), _)| *seen);
    let measured = places.map(|((pose, _), computed)| ([pose.x, pose.y], *computed)).collect();
    let dense = seen.len() >= DENSE;
    Ok((RunPath { run: 0, direction: place.direction, computed, modelled, measured, dense }, track.length()))
}
