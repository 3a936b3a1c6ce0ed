//! Single runs, ready to be predicted: what the wheels did, and the absolute poses that were measured.

use super::{FitError, noise_shape};
use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::{Chain, Evaluate, Model, TestKind};
use crate::geometry::Pose2;
use crate::path::Direction;
use crate::replay::Track;
use nalgebra::Matrix3;
use std::sync::Arc;

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
    /// The run's name.
    pub name: String,
    pub direction: Option<Direction>,
    /// What its wheels did. Drives of which only the path is known share the track of their direction.
    pub track: Arc<Track>,
    pub seen: Vec<Seen>,
    /// Multiplies observed minus predicted (x, y, heading); lower triangular.
    pub weight: Matrix3<f64>,
    /// Whether the ticks were recorded, and not only the path known.
    pub recorded: bool,
}

impl Drive {
    /// Whether the wheels did the same as in another one.
    pub fn rolls_as(&self, track: &Arc<Track>) -> bool {
        Arc::ptr_eq(&self.track, track) || *self.track == **track
    }
}

/// Calls `seen` with each drive, the number of each of its observations, and the pose predicted for it. A track that drives share is replayed
/// once.
pub(crate) fn predict<T: Evaluate>(drives: &[Drive], chain: &Chain<T>, mut seen: impl FnMut(&Drive, usize, &Pose2<T>)) {
    let mut shared: Vec<(&Arc<Track>, Vec<Pose2<T>>)> = Vec::new();
    for drive in drives {
        if drive.recorded {
            drive.track.replay(chain, |observation, pose| seen(drive, observation, pose));
            continue;
        }
        let known = shared.iter().position(|(track, _)| Arc::ptr_eq(track, &drive.track));
        let known = known.unwrap_or_else(|| {
            shared.push((&drive.track, drive.track.poses(chain)));
            shared.len() - 1
        });
        shared[known].1.iter().enumerate().for_each(|(observation, pose)| seen(drive, observation, pose));
    }
}

/// The end poses of the regular test, weighted by the shape of their scatter; headings only where every run has one.
pub(crate) fn end_poses(data: &Dataset, robot: &Robot) -> Result<Vec<Drive>, FitError> {
    check_path(data, robot)?;
    let mut drives = Vec::with_capacity(data.runs.len());
    let mut commanded = Commanded::default();
    for run in data.runs.iter().filter(|run| run.test == TestKind::Systematic) {
        drives.extend(ended(run, data, robot, &mut commanded)?);
    }
    if drives.is_empty() {
        return Err(FitError::NothingObserved { runs: data.runs.len() });
    }
    if drives.iter().any(|d| d.seen.iter().any(|s| s.heading.is_none())) {
        drives.iter_mut().flat_map(|d| &mut d.seen).for_each(|s| s.heading = None);
    }
    for i in 0..drives.len() {
        let alike = (0..i).find(|j| drives[*j].rolls_as(&drives[i].track));
        drives[i].weight = alike.map_or_else(|| end_weight(&drives[i], robot), |j| drives[j].weight);
    }
    Ok(drives)
}

/// Refuses a path that the robot is known to have driven and cannot drive.
fn check_path(data: &Dataset, robot: &Robot) -> Result<(), FitError> {
    let drive = robot.drive.kind();
    match &data.path {
        Some(path) if path.slides() && !drive.moves_sideways() => {
            Err(FitError::Sideways { drive: drive.name(), shape: path.shape().name })
        }
        Some(path) if !robot.drive.kind().has_tick_logs() && !path.suits(robot) => {
            Err(FitError::Path { drive: robot.drive.kind().name(), shape: path.shape().name })
        }
        _ => Ok(()),
    }
}

/// A run with its recorded track, if it has one.
pub(crate) fn tracked(run: &Run, robot: &Robot) -> Result<Option<Drive>, FitError> {
    let in_room = |log: &&crate::run::TickLog| !log.reference.is_empty() && !log.relative && !log.headings_only;
    let Some(log) = run.log.as_ref().filter(in_room) else { return Ok(None) };
    let track = track_of(run, robot)?;
    let seen = log.reference.iter().map(|r| Seen { x: r.x, y: r.y, heading: r.heading }).collect();
    Ok(track.map(|track| Drive {
        name: run.name.clone(),
        direction: run.direction,
        track: Arc::new(track),
        seen,
        weight: Matrix3::identity(),
        recorded: true,
    }))
}

fn track_of(run: &Run, robot: &Robot) -> Result<Option<Track>, FitError> {
    let replayed = |log| Track::from_log(log, robot).map_err(|source| FitError::Log { run: run.name.clone(), source });
    run.log.as_ref().map(replayed).transpose()
}

/// The tracks of a path, by its direction, and where the nominal robot ends on them.
type Commanded = [Option<(Arc<Track>, Pose2)>; 2];

/// A run with its return error, as the absolute pose at the end of what was recorded or, without ticks, of the path.
/// Tracks of the path are made once a direction, in `commanded`.
fn ended(run: &Run, data: &Dataset, robot: &Robot, commanded: &mut Commanded) -> Result<Option<Drive>, FitError> {
    let Some(error) = run.returned else { return Ok(None) };
    let with_end = |track: Track| {
        let end = track.end(&Model::new(robot).chain());
        (Arc::new(track), end)
    };
    let recorded = track_of(run, robot)?;
    let is_recorded = recorded.is_some();
    let from_path = || {
        let (path, direction) = (data.path.as_ref()?, run.direction.unwrap_or(Direction::Ccw));
        let made = || with_end(Track::from_path(path, direction, robot));
        Some(commanded[direction as usize].get_or_insert_with(made).clone())
    };
    let own = recorded.map(|track| with_end(track.cut_at_last()));
    let Some((track, computed)) = own.or_else(from_path) else { return Ok(None) };
    let heading = error.heading.map(|h| computed.heading + h);
    let seen = vec![Seen { x: computed.x + error.x, y: computed.y + error.y, heading }];
    Ok(Some(Drive {
        name: run.name.clone(),
        direction: run.direction,
        track,
        seen,
        weight: Matrix3::identity(),
        recorded: is_recorded,
    }))
}

/// The inverse Cholesky factor of the scatter's shape.
fn end_weight(drive: &Drive, robot: &Robot) -> Matrix3<f64> {
    let mut shape = noise_shape::end_covariance(&drive.track, &robot.drive);
    if drive.seen.iter().any(|s| s.heading.is_none()) {
        // A heading that was not measured gets unit weight, uncorrelated with the position.
        shape.fixed_view_mut::<2, 1>(0, 2).fill(0.0);
        shape.fixed_view_mut::<1, 2>(2, 0).fill(0.0);
    }
    shape.cholesky().and_then(|c| c.l().try_inverse()).unwrap_or_else(Matrix3::identity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::ReturnError;
    use crate::path::{CIRCLE, Path, SQUARE, SpeedProfile};
    use crate::preset::Preset;

    /// Two runs in each direction with small return errors.
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
        assert_eq!(ends(&trucks, circle()), Err(FitError::Path { drive: "clapper", shape: "circle" }));
        assert_eq!(ends(&trucks, square()), Ok(4));
        assert_eq!(ends(&Robot::labmate(), circle()), Ok(4));
    }
}
