//! What a dataset offers the fit: believed travel and observed poses, run by run.

use super::exact::is_possible;
use super::{CalibrateError, noise_shape};
use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::{Model, TestKind};
use crate::geometry::Pose2;
use crate::likelihood::{FAR, Taken, of_reference, ratios};
use crate::path::Direction;
use crate::replay::Track;
use crate::setup::{Mounting, RunSetup, Setup};
use nalgebra::Matrix3;
use std::borrow::Cow;

/// Observations farther from START than this share of the way driven show E_s.
const AWAY: f64 = 0.05;

/// A run with fewer poses is left out where others of its poses are wrong.
const FEWEST: usize = 3;

/// How much of the way was observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// End poses only.
    Ends,
    /// Poses on the way: at stops, or all along.
    Tracks,
}

/// An absolute pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub x: f64,
    pub y: f64,
    pub heading: Option<f64>,
}

/// One run, ready to be predicted.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    pub direction: Option<Direction>,
    pub track: Track,
    pub seen: Vec<Seen>,
    /// Multiplies observed minus predicted (x, y, heading); lower triangular.
    pub weight: Matrix3<f64>,
    /// Whether the ticks were recorded, and not only the path known.
    pub recorded: bool,
}

/// All runs of the regular test that can be predicted.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
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

impl Evidence {
    pub(crate) fn new(data: &Dataset, robot: &Robot, heading_arm: Option<f64>) -> Result<Evidence, CalibrateError> {
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
        Ok(Evidence { level, drives, heading_arm: arm, scale_shows, taken: Vec::new(), by_motion: None })
    }
}

impl Evidence {
    /// The evidence with what the motion alone says of the reference and, where it is far from nominal, of the robot; on tracks.
    pub(super) fn beginning_with(mut self, mounting: &Mounting, robot: &Robot) -> Evidence {
        if self.level == Level::Tracks {
            let sights = self.drives.iter().filter_map(|drive| drive.track.sights().last());
            self.taken = of_reference(mounting, sights.map(|sight| sight.time).fold(0.0, f64::max));
            let [e_s, e_b, e_d] = ratios(mounting, robot.drive.wheelbase()).map(|(_, _, value)| value.unwrap_or(1.0));
            let by_motion = [e_d, e_b, e_s];
            let is_far = by_motion.iter().any(|ratio| (ratio - 1.0).abs() > FAR);
            self.by_motion = (is_far && by_motion.into_iter().all(is_possible)).then_some(by_motion);
        }
        self
    }
}

/// A dataset without what is wrong with its tracks: wrong poses are left out, and each run ends before its first jump; its return
/// error is then not known. With a sentence for each run that lost something.
pub(super) fn mended<'a>(data: &'a Dataset, setup: &Setup) -> (Cow<'a, Dataset>, Vec<String>) {
    let is_off = |run: &RunSetup| !(run.wrong.is_empty() && run.jumps.is_empty());
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

/// The end poses of the regular test, weighted by the shape of their scatter; headings only where every run has one.
pub(crate) fn end_poses(data: &Dataset, robot: &Robot) -> Result<Vec<Drive>, CalibrateError> {
    check_path(data, robot)?;
    let mut drives = Vec::with_capacity(data.runs.len());
    let mut commanded = [None, None];
    for run in data.runs.iter().filter(|run| run.test == TestKind::Systematic) {
        drives.extend(ended(run, data, robot, &mut commanded)?);
    }
    if drives.is_empty() {
        return Err(CalibrateError::NothingObserved { runs: data.runs.len() });
    }
    if drives.iter().any(|d| d.seen.iter().any(|s| s.heading.is_none())) {
        drives.iter_mut().flat_map(|d| &mut d.seen).for_each(|s| s.heading = None);
    }
    for i in 0..drives.len() {
        let alike = (0..i).find(|j| drives[*j].track == drives[i].track);
        drives[i].weight = alike.map_or_else(|| end_weight(&drives[i], robot), |j| drives[j].weight);
    }
    Ok(drives)
}

/// Refuses a path that the robot is known to have driven and cannot drive.
fn check_path(data: &Dataset, robot: &Robot) -> Result<(), CalibrateError> {
    match &data.path {
        Some(path) if !robot.drive.kind().has_tick_logs() && !path.suits(robot) => {
            Err(CalibrateError::Path { drive: robot.drive.kind().name(), shape: path.shape().name })
        }
        _ => Ok(()),
    }
}

/// A run with its recorded track, if it has one.
fn tracked(run: &Run, robot: &Robot) -> Result<Option<Drive>, CalibrateError> {
    let Some(log) = run.log.as_ref().filter(|log| !log.reference.is_empty()) else { return Ok(None) };
    let track = track_of(run, robot)?;
    let seen = log.reference.iter().map(|r| Seen { x: r.x, y: r.y, heading: r.heading }).collect();
    Ok(track.map(|track| Drive { direction: run.direction, track, seen, weight: Matrix3::identity(), recorded: true }))
}

fn track_of(run: &Run, robot: &Robot) -> Result<Option<Track>, CalibrateError> {
    let replayed =
        |log| Track::from_log(log, robot).map_err(|source| CalibrateError::Log { run: run.name.clone(), source });
    run.log.as_ref().map(replayed).transpose()
}

/// How many observations were made at different places on the way.
fn stops(drive: &Drive) -> usize {
    let mut places: Vec<usize> = drive.track.seen_after().iter().copied().filter(|made| *made > 0).collect();
    places.dedup();
    places.len()
}

/// A run with its return error, as the absolute pose at the end of what was recorded or, without ticks, of the path.
/// Tracks of the path are made once a direction, in `commanded`.
fn ended(
    run: &Run,
    data: &Dataset,
    robot: &Robot,
    commanded: &mut [Option<Track>; 2],
) -> Result<Option<Drive>, CalibrateError> {
    let Some(error) = run.returned else { return Ok(None) };
    let recorded = track_of(run, robot)?;
    let is_recorded = recorded.is_some();
    let from_path = || {
        let (path, direction) = (data.path.as_ref()?, run.direction.unwrap_or(Direction::Ccw));
        let track = commanded[direction as usize].get_or_insert_with(|| Track::from_path(path, direction, robot));
        Some(track.clone())
    };
    let Some(track) = recorded.map(Track::cut_at_last).or_else(from_path) else { return Ok(None) };
    let computed: Pose2 = track.end(&Model::new(robot).chain());
    let heading = error.heading.map(|h| computed.heading + h);
    let seen = vec![Seen { x: computed.x + error.x, y: computed.y + error.y, heading }];
    Ok(Some(Drive { direction: run.direction, track, seen, weight: Matrix3::identity(), recorded: is_recorded }))
}

/// The inverse Cholesky factor of the scatter's shape.
fn end_weight(drive: &Drive, robot: &Robot) -> Matrix3<f64> {
    let mut shape = noise_shape::end_covariance(&drive.track, &robot.drive);
    if drive.seen.iter().any(|s| s.heading.is_none()) {
        // An unmeasured heading is one of its own, unrelated to the position.
        shape.fixed_view_mut::<2, 1>(0, 2).fill(0.0);
        shape.fixed_view_mut::<1, 2>(2, 0).fill(0.0);
    }
    shape.cholesky().and_then(|c| c.l().try_inverse()).unwrap_or_else(Matrix3::identity)
}

/// Root mean square distance of the observations from START \[m\].
fn mean_distance(drives: &[Drive]) -> f64 {
    let squares: Vec<f64> = drives.iter().flat_map(|d| &d.seen).map(|s| s.x * s.x + s.y * s.y).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::ReturnError;
    use crate::path::{CIRCLE, Path, SQUARE, SpeedProfile};
    use crate::preset::Preset;

    /// Two runs each way that return a little off.
    fn returned(robot: &Robot, path: Path, heading: Option<f64>) -> Dataset {
        let run = |number: u32| Run {
            name: format!("run {number}"),
            number,
            direction: Some(Direction::BOTH[number as usize % 2]),
            test: TestKind::Systematic,
            log: None,
            returned: Some(ReturnError { x: 0.01 * f64::from(number), y: 0.0, heading }),
        };
        let runs = (0..4).map(run).collect();
        Dataset { robot: Some(robot.clone()), path: Some(path), runs, ..Dataset::default() }
    }

    #[test]
    fn the_weights_make_the_scatter_of_every_run_round_and_alike() {
        let robot = Robot::labmate();
        for heading in [Some(0.01), None] {
            let drives = end_poses(&returned(&robot, Path::umbmark(), heading), &robot).unwrap();
            assert_eq!(drives.len(), 4);
            for drive in drives {
                let scatter =
                    drive.weight * noise_shape::end_covariance(&drive.track, &robot.drive) * drive.weight.transpose();
                let measured = if heading.is_some() { 3 } else { 2 };
                let round = Matrix3::identity();
                let gap = (scatter - round).view((0, 0), (measured, measured)).abs().max();
                assert!(gap < 1e-12, "{:?}: {scatter}", drive.direction);
            }
        }
    }

    #[test]
    fn a_path_with_arcs_is_refused_of_two_trucks_with_a_link_and_of_no_other_robot() {
        let trucks = Preset::find("clapper").unwrap().robot();
        let square = || Path::new(&SQUARE, &[4.0], SpeedProfile::default()).unwrap();
        let circle = || Path::new(&CIRCLE, &[2.0, 1.0], SpeedProfile::default()).unwrap();
        let ends = |robot: &Robot, path| end_poses(&returned(robot, path, None), robot).map(|drives| drives.len());
        assert_eq!(ends(&trucks, circle()), Err(CalibrateError::Path { drive: "clapper", shape: "circle" }));
        assert_eq!(ends(&trucks, square()), Ok(4));
        assert_eq!(ends(&Robot::labmate(), circle()), Ok(4));
    }
}
