//! From measured squares (or any runs) to the true wheel diameters and wheelbase.
//!
//! | method | uses | paths |
//! |---|---|---|
//! | closed form from x, y, their mean | mean return position (Borenstein & Feng) | the square, both directions |
//! | heading form | mean return heading (Jung & Chung) | the square, both directions |
//! | exact | everything measured, full kinematics | any |
//! | model | the same, with all other effects that the runs show; learnt by [`solve`](crate::solve) | any |
//!
//! The closed forms are small-angle estimates from part of the data, kept because they are published and can be worked by
//! hand; their disagreement shows effects outside E_d and E_b. The learnt model is the one to use, and the exact fit where the runs are
//! too few to learn from.

mod closed_form;
mod correction;
mod error;
mod estimate;
mod exact;
mod lengths;
mod observations;
mod outcome;
mod square;
mod warning;

use crate::dataset::Dataset;
use crate::drive::Robot;
use crate::evidence::{FitError, Level, robot_of};
use crate::likelihood::Taken;
use crate::score::{sentence, summarise};
use crate::setup::{Fault, Setup, Suspicion};
use observations::Observations;
use outcome::Forecast;
use square::Square;
use std::sync::Arc;

pub use closed_form::{Angles, ClosedForm, RadiusWheelbase};
pub use correction::{Correction, Ratio};
pub use error::CalibrateError;
pub use estimate::{Estimate, Method};
pub use lengths::Lengths;
pub use outcome::{Replayed, drive_again};

/// How to calibrate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Metres that a radian of heading error counts as in whole-track fits; by default the root mean square distance of
    /// the observed poses from START, the displacement that a radian makes there.
    pub heading_arm: Option<f64>,
    /// The wheelbase in the closed forms' E_d.
    pub radius_wheelbase: RadiusWheelbase,
}

/// A calibration by every method that the data allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// In the order of [`Method::ALL`], without those that do not apply.
    pub estimates: Vec<Estimate>,
    /// How much of the way was observed.
    pub level: Level,
    /// Metres that a radian of heading counted as, in a whole-track fit.
    pub heading_arm: Option<f64>,
    /// What could not be determined, and why. What was found of the data stands first.
    pub warnings: Vec<String>,
    /// Reasons not to write the lengths to a robot, a sentence each; empty if there are none.
    pub doubts: Vec<String>,
    /// What was found of the experiment before the fit.
    pub setup: Arc<Setup>,
    /// What of that was taken into the prediction of the poses.
    pub taken: Vec<Taken>,
}

impl Calibration {
    /// The estimate to write into a robot: that of the learnt model, or of the exact fit where no model shows both E_d and E_b.
    pub fn to_write(&self) -> Option<&Estimate> {
        let both = |estimate: &&Estimate| estimate.shown[0] && estimate.shown[1];
        [Method::Model, Method::Exact].into_iter().find_map(|method| self.estimate(method).filter(both))
    }

    /// The estimate of a method.
    pub fn estimate(&self, method: Method) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.method == method)
    }
}

/// Calibrates a robot from its regular runs by every method that applies.
///
/// ```
/// use umbmark_core::calibrate::{Correction, Method, Options, calibrate, drive_again};
/// use umbmark_core::dataset::{Dataset, Run};
/// use umbmark_core::{drive::Robot, effect::TestKind, path::{Direction, Path}};
/// let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let truth = Correction { e_d: 1.00203, e_b: 337.1 / 340.0, e_s: 1.0 };
/// let run = |direction: Direction| Run {
///     name: direction.name().into(),
///     number: 1,
///     direction: Some(direction),
///     test: TestKind::Systematic,
///     log: None,
///     returned: drive_again(&robot, &path, direction, &truth, &Correction::NONE),
/// };
/// let runs = Direction::BOTH.map(run).to_vec();
/// let data = Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() };
/// let calibration = calibrate(&data, &Options::default())?;
/// let exact = calibration.estimate(Method::Exact).unwrap();
/// assert!((exact.correction.e_d - 1.00203).abs() < 1e-12);
/// assert!(exact.e_max_sys_after.unwrap() < 1e-9 && exact.e_max_sys_before.unwrap() > 0.4);
/// # Ok::<(), umbmark_core::calibrate::CalibrateError>(())
/// ```
pub fn calibrate(data: &Dataset, options: &Options) -> Result<Calibration, CalibrateError> {
    calibrate_beside(data, options, None)
}

/// [`calibrate`] with one estimate more, that of a model which was learnt.
pub fn calibrate_beside(
    data: &Dataset,
    options: &Options,
    learnt: Option<Estimate>,
) -> Result<Calibration, CalibrateError> {
    if let Some(value) = options.heading_arm.filter(|arm| !(*arm > 0.0 && arm.is_finite())) {
        return Err(CalibrateError::HeadingArm { value });
    }
    let robot = robot_of(data)?;
    if !robot.drive.kind().has_axle_wheels() {
        return Err(CalibrateError::OtherDrive { drive: robot.drive.kind().name() });
    }
    let setup = Setup::of(&data.runs, robot, data.path.as_ref());
    let faults: Vec<Fault> = setup.all_faults().cloned().collect();
    if !faults.is_empty() {
        return Err(FitError::Faulty { faults }.into());
    }
    let (mended, lost) = observations::mended(data, &setup);
    let data = mended.as_ref();
    let steps = learnt.is_some() && Observations::are_steps(data);
    let mut observed = if steps { Observations::none() } else { Observations::new(data, robot, options.heading_arm)? };
    if let Some(mounting) = &setup.mounting {
        observed.begin_with(mounting, robot);
    }
    let (cw, ccw) = outcome::summary_of(data);
    let mut warnings: Vec<String> = setup.notices().iter().map(|notice| sentence(notice)).collect();
    warnings.extend(lost);
    let mut doubts = doubts_of_data(&setup, observed.level, robot);
    let square = Square::new(data.path.as_ref(), robot, &cw, &ccw, &mut warnings);
    let fitted = if steps { None } else { exact_estimate(&observed, robot, &mut warnings, &mut doubts) };
    if steps {
        warnings.push(STEPS.to_owned());
    }
    let mut estimates: Vec<Estimate> =
        square.map(|s| s.estimates(options.radius_wheelbase, &mut warnings)).unwrap_or_default();
    let truth = fitted.as_ref().filter(|e| e.shown[0] && e.shown[1]).map(|e| e.correction);
    estimates.extend(fitted.into_iter().chain(learnt));
    let summary = summarise(&cw, &ccw);
    let forecast = truth.zip(data.path.as_ref()).map(|(truth, path)| Forecast { robot, path, truth, summary });
    for estimate in &mut estimates {
        estimate.e_max_sys_before = summary.e_max_sys();
        estimate.e_max_sys_after = forecast.as_ref().and_then(|f| f.e_max_sys(&estimate.correction));
        estimate.replayed_before = outcome::replayed(&observed, robot, &Correction::NONE);
        estimate.replayed_after = outcome::replayed(&observed, robot, &estimate.correction);
    }
    warning::of_large_errors(&estimates, &mut warnings);
    warning::of_few_runs(&cw, &ccw, &mut warnings);
    let heading_arm = (observed.level == Level::Tracks).then_some(observed.heading_arm);
    let (level, taken, setup) = (observed.level, observed.taken, Arc::new(setup));
    Ok(Calibration { estimates, level, heading_arm, warnings, doubts, setup, taken })
}

/// Why there is one estimate only.
const STEPS: &str = "The reference tells steps or headings, and no poses in the room. The closed forms and the exact fit need poses, so only the \
                     model is fitted.";

/// Doubts about the data: counts that are a factor off; for return errors, outlying runs; for tracks, very many jumps, and headings that
/// two different robots would have.
fn doubts_of_data(setup: &Setup, level: Level, robot: &Robot) -> Vec<String> {
    let reasons = match level {
        Level::Ends => {
            let outlying = setup.outlying().cloned().map(Suspicion::OutlyingReturn);
            setup.doubts.iter().cloned().chain(outlying).collect()
        }
        Level::Tracks => setup.suspicions_of_tracks(robot),
    };
    reasons.iter().map(|reason| sentence(&reason.sentence())).collect()
}

fn exact_estimate(
    observed: &Observations,
    robot: &Robot,
    warnings: &mut Vec<String>,
    doubts: &mut Vec<String>,
) -> Option<Estimate> {
    let exact = exact::exact(observed, robot);
    if let Some(rival) = &exact.rival {
        let [own, other] = [&exact.correction, rival].map(|c| format!("E_d {:.4}, E_b {:.4}", c.e_d, c.e_b));
        let words = format!(
            "Two robots fit these poses about equally well: {own}, and {other}. Measure the wheelbase by tape, and correct it in robot.toml."
        );
        warnings.push(words.clone());
        doubts.push(words);
    }
    warning::of_what_does_not_show(&exact.shown, observed, warnings);
    if !exact.fit.termination.converged() {
        let words = format!("The exact fit {}: do not use it.", exact.fit.termination.name());
        warnings.push(words.clone());
        doubts.push(words);
    }
    if let Err(error) = exact.correction.model(robot) {
        warnings.push(format!("No exact fit: it ran out of bounds ({error}). Are signs, units and directions right?"));
        return None;
    }
    exact.shown.contains(&true).then(|| Estimate {
        shown: exact.shown,
        covariance: exact.covariance,
        termination: Some(exact.fit.termination),
        ..Estimate::new(Method::Exact, exact.correction, exact.degrees_of_freedom)
    })
}

#[cfg(test)]
mod tests;
