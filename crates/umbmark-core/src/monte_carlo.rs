//! Thousands of whole UMBmark tests, each with its own robot.
//!
//! A *trial* is one test: n runs in each direction, and where bumps are placed the same number of bumped runs again. Its
//! random numbers depend on the seed and its number alone, so trial 7 is the same whether it is run first, last, alone or
//! on another thread. Trials are gathered in chunks of a fixed size, and chunks are merged in their order: the same seed
//! gives the same bits for any number of threads.

mod distribution;
mod metric;
mod statistics;
mod trial;

use std::ops::{ControlFlow, Range};

use rayon::prelude::*;

use crate::dataset::ReturnError;
use crate::drive::Robot;
use crate::effect::{Model, ModelError};
use crate::parameter::ParameterError;
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::simulate::{self, Odometry, Phase, SimulateError};

pub use distribution::{Distribution, DistributionError, Draw};
pub use metric::Metric;
pub use statistics::Statistics;

pub use trial::draw_parameters;

use trial::Bench;

/// Trials per chunk. A part of every result: another size would round differently in the last bits.
pub const CHUNK: u64 = 1024;

/// The values of one trial's metrics, in the order of [`Study::metrics`].
pub type Row = [f64; Metric::COUNT];

/// What cannot be studied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The test cannot be driven.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The model is impossible.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A distribution is impossible.
    #[error(transparent)]
    Distribution(#[from] DistributionError),
    /// A parameter's distribution lies outside its bounds.
    #[error("{effect}: {problem}")]
    Bounds {
        /// The effect.
        effect: &'static str,
        /// The parameter, its value and its range.
        problem: ParameterError,
    },
    /// No trials, or a test without runs.
    #[error("{what} must be between {} and {}, got {value}", range.start, range.end - 1)]
    Count {
        /// What is counted.
        what: &'static str,
        /// What was asked for.
        value: u64,
        /// What is possible.
        range: Range<u64>,
    },
}

/// A Monte Carlo study, described.
#[derive(Clone, Debug)]
pub struct Study {
    /// The nominal robot.
    pub robot: Robot,
    /// The path of every run.
    pub path: Path,
    /// The effects at work, with the values of those parameters that are not drawn.
    pub model: Model,
    /// The parameters that are drawn anew for every trial.
    pub draws: Vec<Draw>,
    /// How the robot computes its pose.
    pub odometry: Odometry,
    /// Where its wheels rest within a tick.
    pub phase: Phase,
    /// Runs in the clockwise and in the counter-clockwise direction.
    pub runs: [usize; 2],
    /// Number of trials.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// What a study found.
#[derive(Clone, Debug)]
pub struct Ensemble {
    /// Trials done: all of them, unless the study was stopped.
    pub trials: u64,
    /// One for each metric of the study, in order.
    pub statistics: Vec<(Metric, Statistics)>,
}

impl Study {
    /// The paper's test: five runs each way on a 4 x 4 m square.
    pub fn new(model: Model, trials: u64, seed: u64) -> Study {
        Study {
            odometry: Odometry::of(model.robot()),
            robot: model.robot().clone(),
            path: Path::umbmark(),
            model,
            draws: Vec::new(),
            phase: Phase::Random,
            runs: [5, 5],
            trials,
            seed,
        }
    }

    /// Whether each trial includes the extended test, because bumps are placed in it.
    pub fn extended(&self) -> bool {
        self.model.get("placed_bumps", "count").is_some_and(|count| count > 0.0)
            || self.draws.iter().any(|draw| draw.effect() == "placed_bumps")
    }

    /// The metrics of a trial, in the order of its [`Row`]; those that the test does not have are left out.
    pub fn metrics(&self) -> Vec<Metric> {
        Metric::ALL.into_iter().filter(|metric| metric.exists(self.runs, self.extended())).collect()
    }

    /// The test without noise, bumps and quantisation, all drawn parameters in their middle: its return errors \[cw, ccw\]
    /// by exact kinematics.
    pub fn noise_free(&self) -> Result<[ReturnError; 2], StudyError> {
        let chain = trial::centred(&self.model, &self.draws)?.chain();
        Ok(Direction::BOTH.map(|direction| {
            let end = Track::from_path(&self.path, direction, &self.robot).end(&chain);
            simulate::return_error(&end, &self.path.end(direction))
        }))
    }

    /// Runs the study on the present rayon pool.
    ///
    /// `sink` receives the rows of every batch of trials in order, with the number of the first; it may stop the study
    /// between batches. Memory does not grow with the number of trials.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use umbmark_core::{drive::Robot, effect::Model, monte_carlo::{Metric, Study}};
    /// let mut model = Model::new(&Robot::labmate());
    /// model.set("wheel_diameter_ratio", "e_d", 1.00121)?;
    /// model.set("wheelbase", "e_b", 337.2 / 340.0)?;
    /// let ensemble = Study::new(model, 100, 1).run(|_, _| ControlFlow::Continue(()))?;
    /// let e_max = &ensemble.get(Metric::EMaxSys).unwrap();
    /// assert!((e_max.mean() - 0.3056).abs() < 1e-3);
    /// # Ok::<(), umbmark_core::monte_carlo::StudyError>(())
    /// ```
    pub fn run(&self, mut sink: impl FnMut(u64, &[Row]) -> ControlFlow<()>) -> Result<Ensemble, StudyError> {
        let metrics = self.metrics();
        self.check()?;
        let mut benches: Vec<Bench> =
            (0..rayon::current_num_threads()).map(|_| Bench::new(self)).collect::<Result<_, _>>()?;
        let mut statistics = vec![Statistics::new(); Metric::COUNT];
        let chunks = self.trials.div_ceil(CHUNK);
        let per_bench = BATCH.div_ceil(benches.len() as u64);
        let (mut chunk, mut done) = (0, 0);
        while chunk < chunks {
            // Each bench takes every k-th chunk of the batch; rows are put back in order.
            let batch = (per_bench * benches.len() as u64).min(chunks - chunk);
            let stride = benches.len();
            let parts: Vec<Vec<Vec<Row>>> = benches
                .par_iter_mut()
                .enumerate()
                .map(|(k, bench)| (k as u64..batch).step_by(stride).map(|i| self.chunk(chunk + i, bench)).collect())
                .collect();
            let mut parts: Vec<_> = parts.into_iter().map(Vec::into_iter).collect();
            let rows: Vec<Row> =
                (0..batch as usize).flat_map(|i| parts[i % stride].next().unwrap_or_default()).collect();
            statistics.par_iter_mut().enumerate().for_each(|(column, statistics)| {
                rows.chunks(CHUNK as usize).for_each(|chunk| statistics.take(chunk.iter().map(|row| row[column])));
            });
            let first = done;
            done += rows.len() as u64;
            chunk += batch;
            if sink(first, &rows).is_break() {
                break;
            }
        }
        let named = Metric::ALL.into_iter().zip(statistics).filter(|(metric, _)| metrics.contains(metric));
        Ok(Ensemble { trials: done, statistics: named.collect() })
    }

    fn chunk(&self, index: u64, bench: &mut Bench) -> Vec<Row> {
        let range = index * CHUNK..((index + 1) * CHUNK).min(self.trials);
        range.map(|trial| bench.trial(self.seed, trial)).collect()
    }

    fn check(&self) -> Result<(), StudyError> {
        let count = |what, value, range: Range<u64>| {
            if range.contains(&value) { Ok(()) } else { Err(StudyError::Count { what, value, range }) }
        };
        count("number of trials", self.trials, 1..MAX_TRIALS + 1)?;
        for (what, runs) in [("number of clockwise runs", self.runs[0]), ("number of ccw runs", self.runs[1])] {
            count(what, runs as u64, 1..MAX_RUNS + 1)?;
        }
        self.draws.iter().try_for_each(Draw::check)
    }
}

impl Ensemble {
    /// The statistics of one metric, if the study has it.
    pub fn get(&self, metric: Metric) -> Option<&Statistics> {
        self.statistics.iter().find(|(m, _)| *m == metric).map(|(_, s)| s)
    }
}

/// Chunks per batch, about.
const BATCH: u64 = 16;

/// The most trials of a study.
pub const MAX_TRIALS: u64 = 1_000_000_000_000;

/// The most runs in a direction.
pub const MAX_RUNS: u64 = 10_000;

#[cfg(test)]
mod tests {
    use super::*;

    fn study(trials: u64) -> Study {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_diameter_ratio", "e_d", 1.002).unwrap();
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        let mut study = Study::new(model, trials, 7);
        study.draws.push(Draw::new("wheelbase", "e_b", Distribution::Normal { mean: 1.01, sd: 0.002 }).unwrap());
        study
    }

    fn bits(study: &Study, threads: usize) -> (Vec<[u64; Metric::COUNT]>, Vec<u64>) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut rows = Vec::new();
        let ensemble = pool.install(|| {
            study.run(|first, batch| {
                assert_eq!(first as usize, rows.len());
                rows.extend(batch.iter().map(|row| row.map(f64::to_bits)));
                ControlFlow::Continue(())
            })
        });
        let ensemble = ensemble.unwrap();
        let moments = ensemble.statistics.iter().flat_map(|(_, s)| [s.mean().to_bits(), s.std_dev().to_bits()]);
        (rows, moments.collect())
    }

    #[test]
    fn one_two_and_eight_threads_give_the_same_bits() {
        let study = study(3000);
        let one = bits(&study, 1);
        assert_eq!(one.0.len(), 3000);
        assert_eq!(one, bits(&study, 2));
        assert_eq!(one, bits(&study, 8));
        let mut other = study.clone();
        other.seed = 8;
        assert_ne!(one.1, bits(&other, 1).1);
    }

    #[test]
    fn a_study_can_be_stopped_and_says_how_far_it_came() {
        let ensemble = study(100_000).run(|_, _| ControlFlow::Break(())).unwrap();
        assert!(ensemble.trials > 0 && ensemble.trials < 100_000);
        assert_eq!(ensemble.get(Metric::EMaxSys).unwrap().count(), ensemble.trials);
    }

    #[test]
    fn impossible_studies_are_refused() {
        let refuse = |change: fn(&mut Study)| {
            let mut study = study(10);
            change(&mut study);
            study.run(|_, _| ControlFlow::Continue(())).unwrap_err().to_string()
        };
        assert!(refuse(|s| s.trials = 0).starts_with("number of trials must be between 1"));
        assert!(refuse(|s| s.runs = [0, 5]).starts_with("number of clockwise runs must be between 1"));
    }
}
