//! Calibration of any drive: its first effects fitted, and the robot that follows.

use crate::calibrate::Correction;
use crate::dataset::{Dataset, ReturnError};
use crate::diagnose::{Identifiability, first_model, identifiability};
use crate::drive::{DriveError, Robot};
use crate::effect::{Model, TestKind};
use crate::evidence::{Estimate, Fit, FitError, fit, robot_of};
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::score::summarise;

/// A robot of any drive, calibrated by its [first effects](crate::drive::Drive::first_effects).
#[derive(Clone, Debug)]
pub struct GearCalibration {
    /// What was fitted.
    pub estimates: Vec<Estimate>,
    /// Effects that the data does not determine, alone or separately from the others; they keep their values.
    pub not_shown: Vec<&'static str>,
    /// The nominal robot with the effects, fitted.
    pub model: Model,
    /// The robot with its odometry corrected.
    pub corrected: Robot,
    /// What return poses of the path determine; `None` if the path is unknown.
    pub identifiability: Option<Identifiability>,
    /// E_max,sys of the test as driven \[m\].
    pub e_max_sys_before: Option<f64>,
    /// E_max,sys expected after the correction \[m\]: that of the measured returns minus the fitted ones.
    pub e_max_sys_after: Option<f64>,
}

impl GearCalibration {
    /// The numbers of the `nominal` robot that the correction changes: key, nominal, corrected.
    pub fn changes(&self, nominal: &Robot) -> Vec<(&'static str, f64, f64)> {
        let keys = nominal.drive.kind().parameters().iter().map(|p| p.name);
        let values = nominal.drive.values().into_iter().zip(self.corrected.drive.values());
        keys.zip(values).filter(|(_, (a, b))| a != b).map(|(key, (a, b))| (key, a, b)).collect()
    }
}

/// Why a robot cannot be calibrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GearError {
    /// The fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The corrected robot would be impossible.
    #[error("the fitted values belong to no robot ({0}); are signs, units and directions right?")]
    Drive(#[from] DriveError),
}

/// Calibrates a robot of any drive from its regular runs.
pub fn calibrate_gears(data: &Dataset) -> Result<GearCalibration, GearError> {
    let robot = robot_of(data)?;
    let asked = first_model(data)?;
    let Fit { model, estimates, .. } = fit(data, &asked)?;
    let shown = |effect: &str| estimates.iter().any(|e| e.effect == effect);
    let corrected = Correction::of(&model).apply(robot)?;
    let directions: Vec<Direction> = Direction::BOTH
        .into_iter()
        .filter(|direction| data.returns(TestKind::Systematic, *direction).next().is_some())
        .collect();
    let with_heading =
        directions.iter().all(|d| data.returns(TestKind::Systematic, *d).all(|error| error.heading.is_some()));
    let identified = data.path.as_ref().filter(|_| !directions.is_empty());
    let identified = identified.map(|path| identifiability(&asked, path, &directions, with_heading)).transpose()?;
    Ok(GearCalibration {
        not_shown: asked.parts().iter().map(|part| part.effect.name()).filter(|name| !shown(name)).collect(),
        estimates,
        corrected,
        identifiability: identified,
        e_max_sys_before: e_max_sys(data, |_| Some(ReturnError::default())),
        e_max_sys_after: data.path.as_ref().and_then(|path| e_max_sys(data, |d| explained(&model, path, d))),
        model,
    })
}

/// The return error that a model makes on a path.
fn explained(model: &Model, path: &Path, direction: Direction) -> Option<ReturnError> {
    let track = if model.varies() { Track::in_pieces } else { Track::from_path };
    let end = track(path, direction, model.robot()).end(&model.chain());
    let told = path.end(direction);
    Some(ReturnError { x: end.x - told.x, y: end.y - told.y, heading: None })
}

/// E_max,sys of the measured returns minus the explained part of them.
fn e_max_sys(data: &Dataset, explained: impl Fn(Direction) -> Option<ReturnError>) -> Option<f64> {
    let left = |direction: Direction| -> Option<Vec<ReturnError>> {
        let known = explained(direction)?;
        let less = |error: ReturnError| ReturnError { x: error.x - known.x, y: error.y - known.y, heading: None };
        Some(data.returns(TestKind::Systematic, direction).map(less).collect())
    };
    summarise(&left(Direction::Cw)?, &left(Direction::Ccw)?).e_max_sys()
}
