//! From measured squares (or any runs) to the true wheel diameters and wheelbase.
//!
//! | method | uses | paths |
//! |---|---|---|
//! | closed form from x, y, their mean | mean return position (Borenstein & Feng) | the square, both directions |
//! | heading form | mean return heading (Jung & Chung) | the square, both directions |
//! | exact | everything measured, full kinematics | any |
//!
//! The closed forms are small-angle estimates from part of the data, kept because they are published and can be worked by
//! hand; their disagreement shows effects outside E_d and E_b. The exact fit is the one to use.

mod closed_form;
mod correction;
pub(crate) mod evidence;
mod exact;
mod lengths;
pub(crate) mod noise_shape;
mod outcome;

use crate::dataset::{Dataset, ReturnError, Run};
use crate::drive::{Kind, Robot};
use crate::effect::TestKind;
use crate::fit::Termination;
use crate::likelihood::Taken;
use crate::path::{Direction, Path, SQUARE};
use crate::replay::ReplayError;
use crate::score::{FEWEST_RUNS, Scatter, Summary, sentence, summarise};
use crate::setup::{Fault, Setup};
use crate::stats::{Interval, student_t_quantile};
use evidence::Evidence;
use nalgebra::{Matrix2, Matrix3};
use outcome::Forecast;
use std::sync::Arc;

pub use closed_form::{Angles, ClosedForm, RadiusWheelbase};
pub use correction::{Correction, Ratio};
pub use evidence::Level;
pub(crate) use exact::{FAR_FIT, STARTS, is_possible};
pub use lengths::Lengths;
pub use outcome::{Replayed, drive_again};

/// What leaves nothing to calibrate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// No nominal robot.
    #[error("the nominal robot is not known: put a robot.toml beside the data (`umbmark init` writes one)")]
    NoRobot,
    /// A drive whose errors are others.
    #[error("E_d, E_b and E_s are of differential drives, and the robot has drive = \"{drive}\"")]
    OtherDrive {
        /// The kind of the drive.
        drive: &'static str,
    },
    /// A path that no robot of the drive can drive.
    #[error(
        "a robot with drive = \"{drive}\" cannot drive the path, shape = \"{shape}\": it makes legs and turns on the spot, no arcs"
    )]
    Path {
        /// The kind of the drive.
        drive: &'static str,
        /// The shape of the path.
        shape: &'static str,
    },
    /// No run with an observation that can be predicted.
    #[error(
        "none of {runs} runs can be predicted: each needs a return error and a path in robot.toml, \
         or ticks with absolute poses"
    )]
    NothingObserved {
        /// How many runs there are.
        runs: usize,
    },
    /// A log that cannot be replayed.
    #[error("run {run}: {source}")]
    Log {
        /// Name of the run.
        run: String,
        /// What is wrong.
        source: ReplayError,
    },
    /// Columns, units or frames that are not what they are called.
    #[error("{}", Fault::refusal(.faults))]
    Faulty {
        /// Which.
        faults: Vec<Fault>,
    },
    /// A weight that is none.
    #[error("the heading arm must be positive and finite, got {value} m")]
    HeadingArm {
        /// \[m\]
        value: f64,
    },
}

/// How to calibrate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Metres that a radian of heading error counts as in whole-track fits; by default the root mean square distance of
    /// the observed poses from START, the displacement that a radian makes there.
    pub heading_arm: Option<f64>,
    /// The wheelbase in the closed forms' E_d.
    pub radius_wheelbase: RadiusWheelbase,
}

/// How an estimate was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// A published closed form.
    ClosedForm(ClosedForm),
    /// The non-linear fit of the full kinematics.
    Exact,
}

impl Method {
    /// All, in the order in which they are listed.
    pub const ALL: [Method; 5] = [
        Method::ClosedForm(ClosedForm::X),
        Method::ClosedForm(ClosedForm::Y),
        Method::ClosedForm(ClosedForm::Mean),
        Method::ClosedForm(ClosedForm::Heading),
        Method::Exact,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Method::ClosedForm(ClosedForm::X) => "closed_form_x",
            Method::ClosedForm(ClosedForm::Y) => "closed_form_y",
            Method::ClosedForm(ClosedForm::Mean) => "closed_form_mean",
            Method::ClosedForm(ClosedForm::Heading) => "heading",
            Method::Exact => "exact",
        }
    }
}

/// The ratios by one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The method.
    pub method: Method,
    /// The ratios; 1 where the data does not show one.
    pub correction: Correction,
    /// Which of E_d, E_b, E_s the data shows.
    pub shown: [bool; 3],
    /// Covariance of E_d, E_b, E_s, zero where not shown; `None` for single runs.
    pub covariance: Option<Matrix3<f64>>,
    /// ν of Student's t for intervals.
    pub degrees_of_freedom: f64,
    /// E_max,sys of the test as driven \[m\].
    pub e_max_sys_before: Option<f64>,
    /// E_max,sys predicted for the same test, driven with the correction \[m\].
    pub e_max_sys_after: Option<f64>,
    /// The recorded ticks computed with the nominal lengths; `None` without ticks.
    pub replayed_before: Option<Replayed>,
    /// The recorded ticks computed with the correction; `None` without ticks.
    pub replayed_after: Option<Replayed>,
    /// Why the fit stopped; `None` for closed forms.
    pub termination: Option<Termination>,
}

impl Estimate {
    /// A ratio, where the data shows it.
    pub fn ratio(&self, ratio: Ratio) -> Option<f64> {
        self.shown[ratio as usize].then(|| self.correction.values()[ratio as usize])
    }

    /// Its standard error.
    pub fn std_error(&self, ratio: Ratio) -> Option<f64> {
        let i = ratio as usize;
        self.covariance.filter(|_| self.shown[i]).map(|c| c[(i, i)].max(0.0).sqrt())
    }

    /// Its interval with probability `level`: Student's t.
    pub fn interval(&self, ratio: Ratio, level: f64) -> Option<Interval> {
        let t = student_t_quantile(0.5 + 0.5 * level, self.degrees_of_freedom);
        Some(Interval::around(self.ratio(ratio)?, t * self.std_error(ratio)?))
    }
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
    /// Why the lengths are not to be written to a robot, a sentence each; empty where nothing speaks against them.
    pub doubts: Vec<String>,
    /// What was found of the experiment before the fit.
    pub setup: Arc<Setup>,
    /// What of that was taken into the prediction of the poses.
    pub taken: Vec<Taken>,
}

impl Calibration {
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
    if let Some(value) = options.heading_arm.filter(|arm| !(*arm > 0.0 && arm.is_finite())) {
        return Err(CalibrateError::HeadingArm { value });
    }
    let robot = data.robot.as_ref().ok_or(CalibrateError::NoRobot)?;
    if robot.drive.kind() != Kind::Differential {
        return Err(CalibrateError::OtherDrive { drive: robot.drive.kind().name() });
    }
    let setup = Setup::of(&data.runs, robot, data.path.as_ref());
    let faults: Vec<Fault> = setup.all_faults().cloned().collect();
    if !faults.is_empty() {
        return Err(CalibrateError::Faulty { faults });
    }
    let (mended, lost) = evidence::mended(data, &setup);
    let data = mended.as_ref();
    let evidence = Evidence::new(data, robot, options.heading_arm)?;
    let evidence = setup.mounting.iter().fold(evidence, |evidence, mounting| evidence.beginning_with(mounting, robot));
    let (cw, ccw) = outcome::summary_of(data);
    let mut warnings: Vec<String> = setup.notices().iter().map(|notice| sentence(notice)).collect();
    warnings.extend(lost);
    let mut doubts = doubts_of_data(&setup, evidence.level, robot);
    let square = Square::new(data.path.as_ref(), robot, &cw, &ccw, &mut warnings);
    let fitted = exact_estimate(&evidence, robot, &mut warnings, &mut doubts);
    let mut estimates: Vec<Estimate> =
        square.map(|s| s.estimates(options.radius_wheelbase, &mut warnings)).unwrap_or_default();
    let truth = fitted.as_ref().filter(|e| e.shown[0] && e.shown[1]).map(|e| e.correction);
    estimates.extend(fitted);
    let summary = summarise(&cw, &ccw);
    let forecast = truth.zip(data.path.as_ref()).map(|(truth, path)| Forecast { robot, path, truth, summary });
    for estimate in &mut estimates {
        estimate.e_max_sys_before = summary.e_max_sys();
        estimate.e_max_sys_after = forecast.as_ref().and_then(|f| f.e_max_sys(&estimate.correction));
        estimate.replayed_before = outcome::replayed(&evidence, robot, &Correction::NONE);
        estimate.replayed_after = outcome::replayed(&evidence, robot, &estimate.correction);
    }
    warn_of_large_errors(&estimates, &mut warnings);
    warn_of_few_runs(&cw, &ccw, &mut warnings);
    let heading_arm = (evidence.level == Level::Tracks).then_some(evidence.heading_arm);
    let (level, taken, setup) = (evidence.level, evidence.taken, Arc::new(setup));
    Ok(Calibration { estimates, level, heading_arm, warnings, doubts, setup, taken })
}

/// Why data itself is not to be believed: from return errors, those that are far from the others; from tracks, jumps without number, and headings that
/// two robots have.
fn doubts_of_data(setup: &Setup, level: Level, robot: &Robot) -> Vec<String> {
    let outlying = || setup.outlying().map(|run| sentence(&format!("{}; {}", run.sentence(), run.remedy())));
    match level {
        Level::Ends => outlying().collect(),
        Level::Tracks => {
            let reasons = setup.tail_first(robot).into_iter().chain(setup.many_jumps());
            reasons.map(|reason| sentence(&reason.sentence())).collect()
        }
    }
}

/// Return headings \[rad\], clockwise and counter-clockwise, that a robot has whose E_d and E_b explain the median return positions;
/// `None` where these do not show both.
pub(crate) fn by_positions(returns: &[Vec<ReturnError>; 2], robot: &Robot, path: &Path) -> Option<[f64; 2]> {
    if robot.drive.kind() != Kind::Differential {
        return None;
    }
    let median = |of: fn(&ReturnError) -> f64, own: &[ReturnError]| {
        let mut values: Vec<f64> = own.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let run = |direction: Direction| {
        let own = &returns[direction as usize];
        let returned = ReturnError { x: median(|e| e.x, own)?, y: median(|e| e.y, own)?, heading: None };
        let (name, direction, test) = (direction.name().to_owned(), Some(direction), TestKind::Systematic);
        Some(Run { name, number: 1, direction, test, log: None, returned: Some(returned) })
    };
    let runs = Direction::BOTH.map(run).into_iter().collect::<Option<Vec<_>>>()?;
    let data = Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() };
    let exact = exact::exact(&Evidence::new(&data, robot, None).ok()?, robot);
    let headings = Direction::BOTH.map(|direction| {
        drive_again(robot, path, direction, &exact.correction, &Correction::NONE).and_then(|returned| returned.heading)
    });
    (exact.shown[0] && exact.shown[1]).then_some(headings[0].zip(headings[1])?.into())
}

fn exact_estimate(
    evidence: &Evidence,
    robot: &Robot,
    warnings: &mut Vec<String>,
    doubts: &mut Vec<String>,
) -> Option<Estimate> {
    let exact = exact::exact(evidence, robot);
    if let Some(rival) = &exact.rival {
        let [own, other] = [&exact.correction, rival].map(|c| format!("E_d {:.4}, E_b {:.4}", c.e_d, c.e_b));
        let words = format!(
            "Two robots fit these poses about equally well: {own}, and {other}. Measure the wheelbase by tape, and correct it in robot.toml."
        );
        warnings.push(words.clone());
        doubts.push(words);
    }
    warn_of_what_does_not_show(&exact.shown, evidence, warnings);
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

impl Estimate {
    /// E_d and E_b alone, nothing known of their worth.
    fn new(method: Method, correction: Correction, degrees_of_freedom: f64) -> Estimate {
        Estimate {
            method,
            correction,
            shown: [true, true, false],
            covariance: None,
            degrees_of_freedom,
            e_max_sys_before: None,
            e_max_sys_after: None,
            replayed_before: None,
            replayed_after: None,
            termination: None,
        }
    }
}

/// A square driven both ways, for the closed forms.
struct Square<'a> {
    robot: &'a Robot,
    side: f64,
    summary: Summary,
    scatter: Option<Scatter>,
}

impl<'a> Square<'a> {
    fn new(
        path: Option<&Path>,
        robot: &'a Robot,
        cw: &[ReturnError],
        ccw: &[ReturnError],
        warnings: &mut Vec<String>,
    ) -> Option<Square<'a>> {
        let refused = match path {
            None => "the path is not known; they need the side of the square".to_owned(),
            Some(path) if !std::ptr::eq(path.shape(), &SQUARE) => {
                format!("they are made for a square, and the path is a {}", path.shape().name.replace('_', " "))
            }
            Some(_) if cw.is_empty() || ccw.is_empty() => {
                "they need runs in both directions: in one alone, E_d and E_b cannot be told apart".to_owned()
            }
            Some(path) => {
                let summary = summarise(cw, ccw);
                return Some(Square { robot, side: path.values()[0], summary, scatter: Scatter::pooled(cw, ccw) });
            }
        };
        warnings.push(format!("No closed forms: {refused}."));
        None
    }

    fn estimates(&self, wheelbase: RadiusWheelbase, warnings: &mut Vec<String>) -> Vec<Estimate> {
        let (Some(cw), Some(ccw)) = (self.summary.cw, self.summary.ccw) else { return Vec::new() };
        let estimate = |form: ClosedForm| {
            let name = Method::ClosedForm(form).name();
            let Some(angles) = form.angles(&cw, &ccw, self.side) else {
                warnings.push(format!("No {name}: return headings were not measured in both directions."));
                return None;
            };
            let Some(correction) = angles.correction(self.side, &self.robot.drive, wheelbase) else {
                warnings.push(format!(
                    "No {name}: its angles, {:.1} deg a turn and {:.1} deg a leg, belong to no robot. Are signs and units right?",
                    angles.alpha.to_degrees(),
                    angles.beta.to_degrees()
                ));
                return None;
            };
            let scatter = self.scatter.filter(|s| form != ClosedForm::Heading || s.with_heading);
            let covariance = scatter.map(|scatter| {
                let by_angles = angles.correction_jacobian(self.side, &self.robot.drive, wheelbase);
                let of_angles = form.covariance(&scatter, cw.n, ccw.n, self.side);
                widen(by_angles * of_angles * by_angles.transpose())
            });
            let freedom = scatter.map_or(0.0, |s| s.degrees_of_freedom as f64);
            Some(Estimate { covariance, ..Estimate::new(Method::ClosedForm(form), correction, freedom) })
        };
        ClosedForm::ALL.into_iter().filter_map(estimate).collect()
    }
}

fn widen(covariance: Matrix2<f64>) -> Matrix3<f64> {
    let mut wide = Matrix3::zeros();
    wide.fixed_view_mut::<2, 2>(0, 0).copy_from(&covariance);
    wide
}

fn warn_of_what_does_not_show(shown: &[bool; 3], evidence: &Evidence, warnings: &mut Vec<String>) {
    let [e_d, e_b, e_s] = *shown;
    if e_b && !e_s {
        warnings.push(
            "E_s is not determined: end poses of a closed path show E_b/E_s only. E_s = 1 is assumed; the wheelbase and the \
             wheel diameters in metres are right only if the mean wheel diameter is. Measure one straight leg by tape, or \
             a pose on the way."
                .into(),
        );
    }
    if !(e_d && e_b) {
        let (missing, verb) = match (e_d, e_b) {
            (false, false) => ("E_d and E_b are", "them"),
            (false, true) => ("E_d is", "it"),
            _ => ("E_b is", "it"),
        };
        let directions: Vec<_> = evidence.drives.iter().map(|d| d.direction).collect();
        let one_way = directions.iter().all(|d| *d == directions[0]);
        let advice = if one_way { "Drive the path in the other direction too" } else { "Drive a square both ways" };
        warnings
            .push(format!("{missing} not determined: this experiment does not tell {verb} from the rest. {advice}."));
    }
}

/// Where a fifth of E_max,sys would be left, and twice what the exact fit leaves, the closed forms are out of their depth: their
/// own scatter does not leave so much of an error that shows at all.
fn warn_of_large_errors(estimates: &[Estimate], warnings: &mut Vec<String>) {
    let of = |method| estimates.iter().find(|estimate| estimate.method == method);
    let left = |estimate: &Estimate| estimate.e_max_sys_after.zip(estimate.e_max_sys_before);
    let (Some((mean, before)), Some((exact, _))) =
        (of(Method::ClosedForm(ClosedForm::Mean)).and_then(left), of(Method::Exact).and_then(left))
    else {
        return;
    };
    if mean > 0.2 * before && mean > 2.0 * exact {
        warnings.push(format!(
            "The closed forms are of first order in the errors, and these are large: their mean would leave {:.0} of {:.0} mm. Use the \
             exact fit.",
            1e3 * mean,
            1e3 * before
        ));
    }
}

fn warn_of_few_runs(cw: &[ReturnError], ccw: &[ReturnError], warnings: &mut Vec<String>) {
    if [cw.len(), ccw.len()].iter().any(|n| (1..FEWEST_RUNS).contains(n)) {
        warnings.push(format!(
            "Few runs: {} cw and {} ccw. {FEWEST_RUNS} or more a direction are needed to trust the intervals; the paper drives 5.",
            cw.len(),
            ccw.len()
        ));
    }
}

#[cfg(test)]
mod tests;
