//! Before the robot is driven: what a test would show, and how many runs it takes.
//!
//! | question | answered by |
//! |---|---|
//! | how many runs show this much of that effect; what do n runs show? | [`Planned`], by the tests of `calibrate` and `diagnose` |
//! | how wide is the interval of E_max,sys with n runs? | [`intervals`] |
//! | another side, another speed, one direction only, bumps? | [`alternatives`], [`extended_test`] |
//! | in which order are the runs best driven? | [`drifts`] |
//! | all of these at once | [`Request`] |
//! | what is done, step by step? | [`Protocol`] |
//!
//! A planned test is a dataset whose runs scatter about their means exactly as much as they are expected to. The fits and
//! tests of measured robots then say what they would say of it, and their non-central distributions how often.

mod alternatives;
mod expected;
mod findings;
mod intervals;
mod order;
mod power;
mod protocol;
mod sheet;

use crate::dataset::{Dataset, ReturnError};
use crate::diagnose::{base_model, experiments};
use crate::drive::Robot;
use crate::effect::{Model, ModelError, TestKind};
use crate::evidence::ends::{Ends, Fitted};
use crate::evidence::{FitError, robot_of};
use crate::monte_carlo::{Study, StudyError};
use crate::path::{Direction, Path, PathError};
use crate::score::{Scatter, score};
use crate::simulate::{Odometry, Phase, SimulateError, Simulator, Truth};
use crate::stats::Interval;
use nalgebra::Matrix3;
use rayon::prelude::*;

pub use crate::diagnose::Options;
pub use alternatives::{Alternative, ExtendedTest, alternatives, extended_test};
pub use expected::expected_dataset;
pub use findings::{Answer, Findings, OfRuns, Request};
pub use intervals::{ExpectedInterval, intervals};
pub use order::{Drift, Order, drifts};
pub use power::{MOST_RUNS, Planned, Shown, Sought, runs_needed};
pub use protocol::{Protocol, ProtocolRun};

/// What cannot be planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The robot or its path cannot be simulated.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The data cannot be used.
    #[error(transparent)]
    Diagnose(#[from] FitError),
    /// Invalid path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// Runs that do not scatter.
    #[error("the runs of this robot do not scatter, so one run shows everything; say what makes them scatter")]
    NoScatter,
    /// Data without a path.
    #[error("the path is not known: put a [path] into robot.toml")]
    NoPath,
    /// Data with too little scatter to plan by.
    #[error(
        "the runs of the data do not show their scatter: 3 or more in each direction are needed, each as it was measured"
    )]
    TooFewRuns,
    /// Too few runs to plan.
    #[error("runs a direction must be between {} and {}, got {value}", crate::score::FEWEST_RUNS, power::MOST_RUNS)]
    Runs {
        /// The name that was given.
        value: usize,
    },
    /// A size that no effect has.
    #[error("no effect has a size \"{name}\"{}", nearest.map(|n| format!("; did you mean \"{n}\"?")).unwrap_or_default())]
    UnknownSize {
        /// The name that was given.
        name: String,
        /// The most similar known name.
        nearest: Option<&'static str>,
    },
    /// A size at which its effect does nothing.
    #[error("{name} = {value} has no effect: there is nothing to detect")]
    NoSize {
        /// The parameter's flag.
        name: &'static str,
        /// The name that was given.
        value: f64,
    },
}

impl From<ModelError> for PlanError {
    fn from(error: ModelError) -> PlanError {
        PlanError::Study(error.into())
    }
}

impl From<SimulateError> for PlanError {
    fn from(error: SimulateError) -> PlanError {
        PlanError::Study(error.into())
    }
}

/// Tests that the expected scatter is taken from; fewer where effects vary along the way or two trucks steer by their odometry,
/// which makes a run a hundred times slower. Its standard deviations are then known to 0.3 % and 1.6 %.
const SCATTER_TESTS: [u64; 2] = [8192, 256];
/// Tests that a thread simulates at a time.
const CHUNK: u64 = 64;
/// Runs a direction of each of them.
const SCATTER_RUNS: usize = 5;

/// A robot on its path: where its runs end, and how they scatter.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The path.
    pub path: Path,
    /// The nominal robot with its errors, and with what makes its runs scatter.
    pub truth: Model,
    /// Mean return error, clockwise and counter-clockwise.
    pub means: [ReturnError; 2],
    /// Covariance of one counter-clockwise run \[m, m, rad\]; that of a clockwise one is its mirror image.
    pub covariance: Matrix3<f64>,
    /// Whether headings are measured.
    pub with_heading: bool,
    /// By how much the variance of the runs exceeds that of `truth`.
    widened: f64,
    seed: u64,
}

impl Setting {
    /// A robot as `truth` has it; the scatter is that of simulated tests.
    ///
    /// ```
    /// use umbmark_core::{drive::Robot, effect::Model, path::Path, plan::Setting};
    /// let mut truth = Model::new(&Robot::labmate());
    /// truth.set("wheel_noise", "k_sqrt_m", 1e-3)?;
    /// let setting = Setting::new(&Path::umbmark(), &truth, 1)?;
    /// assert!((setting.sigma() - 0.044).abs() < 0.001);
    /// assert!((setting.with_sigma(0.050).sigma() - 0.050).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(path: &Path, truth: &Model, seed: u64) -> Result<Setting, PlanError> {
        let setting = Setting {
            path: path.clone(),
            truth: truth.clone(),
            means: means(path, truth)?,
            covariance: scatter(path, truth, seed)?,
            with_heading: true,
            widened: 1.0,
            seed,
        };
        if setting.covariance.cholesky().is_none() {
            return Err(PlanError::NoScatter);
        }
        Ok(setting)
    }

    /// The same robot, its runs scattering so that σ (one coordinate, [`score`](crate::score)) is as given \[m\].
    pub fn with_sigma(mut self, sigma: f64) -> Setting {
        let factor = (sigma / self.sigma()).powi(2);
        self.covariance *= factor;
        self.widened *= factor;
        self
    }

    /// A robot whose runs scatter with σ \[m\] as it is expected. Where its model has no wheel noise, they scatter as those of
    /// evenly noisy wheels, and the phrase that says so is given too.
    pub fn expecting(
        path: &Path,
        truth: &Model,
        sigma: Option<f64>,
        seed: u64,
    ) -> Result<(Setting, Option<&'static str>), PlanError> {
        let Some(sigma) = sigma else { return Ok((Setting::new(path, truth, seed)?, None)) };
        if truth.get("wheel_noise", "k_sqrt_m").is_some_and(|k| k > 0.0) {
            return Ok((Setting::new(path, truth, seed)?.with_sigma(sigma), None));
        }
        let mut noisy = truth.clone();
        noisy.set("wheel_noise", "k_sqrt_m", 1e-3)?;
        let setting = Setting::new(path, &noisy, seed)?.with_sigma(sigma);
        Ok((setting, Some("the runs scatter as with equal white noise on both wheels")))
    }

    /// The same robot, with or without its return headings measured.
    pub fn with_heading(self, with_heading: bool) -> Setting {
        Setting { with_heading, ..self }
    }

    /// The same robot on another path.
    pub fn on(&self, path: &Path) -> Result<Setting, PlanError> {
        let other = Setting::new(path, &self.truth, self.seed)?;
        Ok(Setting {
            covariance: other.covariance * self.widened,
            widened: self.widened,
            with_heading: self.with_heading,
            ..other
        })
    }

    /// σ: standard deviation of one coordinate of a return position \[m\].
    pub fn sigma(&self) -> f64 {
        (0.5 * (self.covariance[(0, 0)] + self.covariance[(1, 1)])).sqrt()
    }

    /// E_max,sys of the robot itself \[m\].
    pub fn e_max_sys(&self) -> f64 {
        self.means.iter().map(|mean| libm::hypot(mean.x, mean.y)).fold(0.0, f64::max)
    }

    /// Bumps of the test; 0 without any.
    pub fn bumps(&self) -> f64 {
        self.truth.get("placed_bumps", "count").unwrap_or(0.0)
    }

    /// The nominal robot.
    pub fn robot(&self) -> &Robot {
        self.truth.robot()
    }

    /// Time that one run takes, carrying the robot to START and writing down where it ended included \[min\].
    pub fn minutes_a_run(&self) -> f64 {
        experiments::MINUTES_A_RUN + experiments::minutes(&self.path, self.robot())
    }
}

/// The robot of some measurements.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Its path.
    pub path: Path,
    /// E_d and E_b as fitted to its return poses, and the wheel noise that scatters as they do.
    pub truth: Model,
    /// Whether return headings were measured.
    pub with_heading: bool,
    /// Where σ lies with probability 95 % \[m\], by the scatter of its runs.
    pub sigma_interval: Option<Interval>,
}

impl Measured {
    /// From its runs: 3 or more a direction.
    pub fn new(data: &Dataset) -> Result<Measured, PlanError> {
        let robot = robot_of(data)?;
        let path = data.path.clone().ok_or(PlanError::NoPath)?;
        let ends = Ends::new(data)?;
        let fitted = Fitted::new(&ends, &base_model(robot)?)?;
        let k = experiments::wheel_noise(&ends, &fitted).filter(|_| ends.enough()).ok_or(PlanError::TooFewRuns)?;
        let mut truth = fitted.model;
        truth.set("wheel_noise", "k_sqrt_m", k)?;
        let sigma_interval = score(&data.runs, 0.95).ok().and_then(|score| score.intervals).map(|i| i.sigma_axis);
        Ok(Measured { path, truth, with_heading: ends.with_heading, sigma_interval })
    }
}

/// Return errors without noise \[cw, ccw\].
fn means(path: &Path, truth: &Model) -> Result<[ReturnError; 2], PlanError> {
    Ok(Study { path: path.clone(), ..Study::new(truth.clone(), 1, 0) }.noise_free()?)
}

/// Covariance of a counter-clockwise run about the mean of its direction, over many simulated tests.
fn scatter(path: &Path, truth: &Model, seed: u64) -> Result<Matrix3<f64>, PlanError> {
    let robot = truth.robot();
    let slow = truth.varies() || !robot.drive.kind().has_tick_logs();
    let tests = SCATTER_TESTS[usize::from(slow)];
    let chunks: Vec<u64> = (0..tests).step_by(CHUNK as usize).collect();
    let of_chunk = |first: &u64| -> Result<Matrix3<f64>, PlanError> {
        let mut simulator = Simulator::new(robot, path, Odometry::of(robot), Phase::Random)?;
        let mut truth = Truth::new(truth);
        let mut sum = Matrix3::zeros();
        for test in *first..first + CHUNK {
            let mut returned = Direction::BOTH.map(|_| vec![ReturnError::default(); SCATTER_RUNS]);
            simulator.open(&mut truth, seed, test);
            simulator.test(&mut truth, TestKind::Systematic, returned.each_mut().map(Vec::as_mut_slice));
            let [cw, ccw] = &returned;
            sum += Scatter::pooled(cw, ccw).map_or(Matrix3::zeros(), |scatter| scatter.covariance);
        }
        Ok(sum)
    };
    let sums: Vec<Matrix3<f64>> = chunks.par_iter().map(of_chunk).collect::<Result<_, PlanError>>()?;
    Ok(sums.into_iter().sum::<Matrix3<f64>>() / tests as f64)
}

#[cfg(test)]
mod tests;
