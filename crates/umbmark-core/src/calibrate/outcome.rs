//! What a correction is worth: the test driven again, and the recorded runs computed again.

use super::correction::Correction;
use super::exact::set_taken;
use super::observations::Observations;
use crate::dataset::ReturnError;
use crate::drive::Robot;
use crate::effect::{Model, TestKind};
use crate::geometry::wrap;
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::score::{Cluster, Summary, summarise};

/// The return error of a robot that truly differs from nominal by `truth` and drives a path with its odometry
/// corrected by `applied`, without noise.
///
/// `None` for ratios out of the bounds of their effects.
///
/// ```
/// use umbmark_core::{calibrate::{Correction, drive_again}, drive::Robot, path::{Direction, Path}};
/// let labmate = Correction { e_d: 1.00121, e_b: 337.2 / 340.0, e_s: 1.0 };
/// let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let before = drive_again(&robot, &path, Direction::Ccw, &labmate, &Correction::NONE).unwrap();
/// assert!((before.x.hypot(before.y) - 0.3056).abs() < 1e-4);
/// let after = drive_again(&robot, &path, Direction::Ccw, &labmate, &labmate).unwrap();
/// assert!(after.x.hypot(after.y) < 1e-12);
/// ```
pub fn drive_again(
    robot: &Robot,
    path: &Path,
    direction: Direction,
    truth: &Correction,
    applied: &Correction,
) -> Option<ReturnError> {
    let corrected = applied.apply(robot).ok()?;
    let model = truth.after(applied).model(&corrected).ok()?;
    let (end, told) = (Track::from_path(path, direction, &corrected).end(&model.chain()), path.end(direction));
    Some(ReturnError { x: end.x - told.x, y: end.y - told.y, heading: Some(wrap(end.heading - told.heading)) })
}

/// Predicts E_max,sys of the same test after a correction.
///
/// The kinematic part of the return errors is driven again; what the exact fit leaves of each centre of gravity
/// (floor, caster, chance) is added as it was.
#[derive(Clone, Debug)]
pub(super) struct Forecast<'a> {
    pub robot: &'a Robot,
    pub path: &'a Path,
    /// The exact fit.
    pub truth: Correction,
    pub summary: Summary,
}

impl Forecast<'_> {
    /// E_max,sys \[m\] once `applied` is in the odometry.
    pub fn e_max_sys(&self, applied: &Correction) -> Option<f64> {
        let distance = |cluster: Option<Cluster>, direction| {
            let cluster = cluster?;
            let explained = drive_again(self.robot, self.path, direction, &self.truth, &Correction::NONE)?;
            let again = drive_again(self.robot, self.path, direction, &self.truth, applied)?;
            Some(libm::hypot(cluster.x - explained.x + again.x, cluster.y - explained.y + again.y))
        };
        Some(distance(self.summary.cw, Direction::Cw)?.max(distance(self.summary.ccw, Direction::Ccw)?))
    }
}

/// Return errors of the recorded runs, their ticks computed with other lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replayed {
    /// E_max,sys \[m\]; `None` for one direction.
    pub e_max_sys: Option<f64>,
    /// The largest position error of a single run's end \[m\].
    pub largest: f64,
}

/// Computes the recorded runs again with a correction; `None` where no ticks were recorded.
pub(super) fn replayed(observed: &Observations, robot: &Robot, applied: &Correction) -> Option<Replayed> {
    let mut model: Model = applied.model(robot).ok()?;
    set_taken(&mut model, &observed.taken);
    let chain = model.chain();
    let mut errors: [Vec<ReturnError>; 2] = Default::default();
    let mut largest: Option<f64> = None;
    for drive in observed.drives.iter().filter(|d| d.recorded) {
        let (Some(seen), Some(pose)) = (drive.seen.last(), drive.track.poses(&chain).pop()) else { continue };
        let error = ReturnError { x: seen.x - pose.x, y: seen.y - pose.y, heading: None };
        let distance = libm::hypot(error.x, error.y);
        largest = Some(largest.map_or(distance, |l| l.max(distance)));
        if let Some(direction) = drive.direction {
            errors[direction as usize].push(error);
        }
    }
    Some(Replayed { e_max_sys: summarise(&errors[0], &errors[1]).e_max_sys(), largest: largest? })
}

/// The clusters of a dataset's regular test.
pub(super) fn summary_of(data: &crate::dataset::Dataset) -> (Vec<ReturnError>, Vec<ReturnError>) {
    let [cw, ccw] = Direction::BOTH.map(|d| data.returns(TestKind::Systematic, d).collect());
    (cw, ccw)
}
