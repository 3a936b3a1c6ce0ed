//! Thousands of whole UMBmark tests, each with its own robot.
//!
//! A *trial* is one test: n runs in each direction, and where bumps are placed the same number of bumped runs again. Its
//! random numbers depend on the seed and its number alone, so trial 7 is the same whether it is run first, last, alone or
//! on another thread; and statistics do not depend on the order of their numbers. So the same seed gives the same bits for
//! any number of threads, for a study resumed after a crash, and for one put together from shards.

mod distribution;
mod ensemble;
mod metric;
mod noise_free;
mod quantity;
mod shard;
mod statistics;
mod sweep;
mod trial;

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::dataset::ReturnError;
use crate::drive::Robot;
use crate::effect::{Model, ModelError};
use crate::engine::Instructions;
use crate::parameter::ParameterError;
use crate::path::Path;
use crate::replay::check_on_path;
use crate::simulate::{Odometry, Phase, SimulateError};

pub use distribution::{Distribution, DistributionError, Draw};
pub use ensemble::{Ensemble, MergeError};
pub use metric::{Metric, UnknownMetric};
pub use quantity::{Quantity, QuantityError};
pub use shard::{Shard, ShardError};
pub use statistics::Statistics;
pub use sweep::{Axis, MetricSummary, Sweep, SweepError, SweepPoint};
pub use trial::draw_parameters;

pub(crate) use noise_free::NoiseFree;
pub(crate) use trial::{Bench, row};

/// Trials that one thread runs at a time. Shards begin and end at multiples of it.
pub const CHUNK: u64 = 256;

/// Trials between two looks at whether a study is precise enough: a fixed number, so that where it stops does not depend on
/// the number of threads.
pub const BATCH: u64 = 16_384;

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
    /// A quantity that cannot be set.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// No trials, or a test without runs.
    #[error("{what} must be between {} and {}, got {value}", range.start, range.end - 1)]
    Count {
        /// What is counted.
        what: &'static str,
        /// The name that was given.
        value: u64,
        /// What is possible.
        range: Range<u64>,
    },
}

/// A Monte Carlo study, described.
#[derive(Clone, Debug)]
pub struct Study {
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
    /// Runs in the clockwise and in the counter-clockwise direction; without runs in one of them, the uni-directional test
    /// of section 3.1 of the paper, which has no E_max,sys.
    pub runs: [usize; 2],
    /// Number of trials.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The widest registers that may be used: those of the machine, unless paths are to be compared. No number depends on
    /// it.
    pub instructions: Instructions,
}

/// What a sink is told after every batch.
#[derive(Debug)]
pub struct Batch<'a> {
    /// Number of the first trial.
    pub first: u64,
    /// The metrics of its trials, in order.
    pub rows: &'a [Row],
    /// The ensemble with this batch in it.
    pub ensemble: &'a Ensemble,
}

impl Study {
    /// The paper's test: five runs each way on a 4 x 4 m square.
    pub fn new(model: Model, trials: u64, seed: u64) -> Study {
        Study {
            odometry: Odometry::of(model.robot()),
            path: Path::umbmark(),
            model,
            draws: Vec::new(),
            phase: Phase::Random,
            runs: [5, 5],
            trials,
            seed,
            instructions: Instructions::best(),
        }
    }

    /// The nominal robot.
    pub fn robot(&self) -> &Robot {
        self.model.robot()
    }

    /// Whether each trial includes the extended test, because bumps are placed in it.
    pub fn extended(&self) -> bool {
        let placed = |draw: &Draw| draw.effect() == "placed_bumps" && draw.parameter().name == "count";
        self.model.get("placed_bumps", "count").is_some_and(|count| count > 0.0) || self.draws.iter().any(placed)
    }

    /// The metrics of a trial, in the order of its [`Row`]; those that the test does not have are left out.
    pub fn metrics(&self) -> Vec<Metric> {
        Metric::ALL.into_iter().filter(|metric| metric.exists(self.runs, self.extended())).collect()
    }

    /// Everything that decides the numbers of a trial, in words: two studies with the same identity have the same trials.
    pub fn identity(&self) -> String {
        let effects = self.model.parts().iter().map(|part| format!("{} {:?}", part.effect, part.values));
        let draws = self.draws.iter().map(|d| format!("{}.{} {:?}", d.effect(), d.parameter().name, d.distribution()));
        format!(
            "umbmark {}, seed {}, {:?}, {} {:?} {:?}, {:?} {:?}, {:?} runs, effects [{}], drawn [{}]",
            crate::VERSION,
            self.seed,
            self.robot(),
            self.path.shape().name,
            self.path.values(),
            self.path.speed,
            self.odometry,
            self.phase,
            self.runs,
            effects.collect::<Vec<_>>().join(", "),
            draws.collect::<Vec<_>>().join(", "),
        )
    }

    /// The test without noise, bumps and quantisation, all drawn parameters in their middle: its return errors \[cw, ccw\]
    /// by exact kinematics.
    pub fn noise_free(&self) -> Result<[ReturnError; 2], StudyError> {
        if !self.robot().drive.kind().has_tick_logs() && !self.path.suits(self.robot()) {
            let (drive, what) = (self.robot().drive.kind().name(), "paths with arcs");
            return Err(SimulateError::Unsupported { drive, what }.into());
        }
        let drive = self.robot().drive.kind();
        if let Some(index) = self.path.first_slide().filter(|_| !drive.moves_sideways()) {
            return Err(SimulateError::Sideways { drive: drive.name(), index: index + 1 }.into());
        }
        let model = trial::centred(&self.model, &self.draws)?;
        Ok(NoiseFree::new(&model, &self.path, model.varies()).returned())
    }

    /// Runs the study on the present rayon pool.
    ///
    /// `sink` is told of every batch of trials, in order, and may stop the study between batches. Memory does not grow with
    /// the number of trials.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use umbmark_core::{drive::Robot, effect::Model, monte_carlo::{Metric, Study}};
    /// let mut model = Model::new(&Robot::labmate());
    /// model.set("wheel_diameter_ratio", "e_d", 1.00121)?;
    /// model.set("wheelbase", "e_b", 337.2 / 340.0)?;
    /// let ensemble = Study::new(model, 100, 1).run(|_| ControlFlow::Continue(()))?;
    /// let e_max = &ensemble.get(Metric::EMaxSys).unwrap();
    /// assert!((e_max.mean() - 0.3056).abs() < 1e-3);
    /// # Ok::<(), umbmark_core::monte_carlo::StudyError>(())
    /// ```
    pub fn run(&self, sink: impl FnMut(&Batch) -> ControlFlow<()>) -> Result<Ensemble, StudyError> {
        let mut ensemble = Ensemble::new(self, Shard::WHOLE);
        self.resume(&mut ensemble, &AtomicBool::new(false), sink)?;
        Ok(ensemble)
    }

    /// Runs what is left of an ensemble's shard, as [`Study::run`].
    ///
    /// Once `stop` is set, no further chunk is begun, and trials that are done up to the first gap are kept.
    pub fn resume(
        &self,
        ensemble: &mut Ensemble,
        stop: &AtomicBool,
        mut sink: impl FnMut(&Batch) -> ControlFlow<()>,
    ) -> Result<(), StudyError> {
        self.check()?;
        let mut benches: Vec<Bench> =
            (0..rayon::current_num_threads()).map(|_| Bench::new(self)).collect::<Result<_, _>>()?;
        let all = ensemble.shard().trials(self.trials);
        let mut next = ensemble.next_trial(self.trials);
        while next < all.end {
            let batch = next..(next + BATCH).min(all.end);
            let rows = self.batch(batch.clone(), &mut benches, stop);
            let whole = rows.len() as u64 == batch.end - batch.start;
            ensemble.take(next, &rows);
            let told = Batch { first: next, rows: &rows, ensemble };
            if sink(&told).is_break() || !whole {
                break;
            }
            next = batch.end;
        }
        Ok(())
    }

    /// The rows of some trials: each bench takes every k-th chunk, and rows are put back in order. Where `stop` left a chunk
    /// out, those before it.
    fn batch(&self, trials: Range<u64>, benches: &mut [Bench], stop: &AtomicBool) -> Vec<Row> {
        let stride = benches.len();
        let chunks: Vec<Range<u64>> =
            trials.clone().step_by(CHUNK as usize).map(|first| first..(first + CHUNK).min(trials.end)).collect();
        let parts: Vec<Vec<Vec<Row>>> = benches
            .par_iter_mut()
            .enumerate()
            .map(|(k, bench)| {
                let mine = chunks.iter().skip(k).step_by(stride).cloned();
                mine.take_while(|_| !stop.load(Ordering::Relaxed))
                    .map(|chunk| chunk.map(|trial| bench.trial(self.seed, trial)).collect())
                    .collect()
            })
            .collect();
        let mut parts: Vec<_> = parts.into_iter().map(Vec::into_iter).collect();
        let in_order = (0..chunks.len()).map_while(|i| parts[i % stride].next());
        in_order.flatten().collect()
    }

    fn check(&self) -> Result<(), StudyError> {
        let count = |what, value, range: Range<u64>| {
            if range.contains(&value) { Ok(()) } else { Err(StudyError::Count { what, value, range }) }
        };
        count("number of trials", self.trials, 1..MAX_TRIALS + 1)?;
        for (what, runs) in [("number of clockwise runs", self.runs[0]), ("number of ccw runs", self.runs[1])] {
            count(what, runs as u64, 0..MAX_RUNS + 1)?;
        }
        count("number of runs", (self.runs[0] + self.runs[1]) as u64, 1..2 * MAX_RUNS + 1)?;
        self.model.check_drive()?;
        check_on_path(&self.model, &self.path)?;
        self.draws.iter().try_for_each(Draw::check)
    }
}

/// The most trials of a study.
pub const MAX_TRIALS: u64 = 1_000_000_000_000;

/// The most runs in a direction.
pub const MAX_RUNS: u64 = 10_000;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Update;
    use crate::path::{FIGURE_EIGHT, SpeedProfile};

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
            study.run(|batch| {
                assert_eq!(batch.first as usize, rows.len());
                rows.extend(batch.rows.iter().map(|row| row.map(f64::to_bits)));
                ControlFlow::Continue(())
            })
        });
        (rows, moments(&ensemble.unwrap()))
    }

    fn moments(ensemble: &Ensemble) -> Vec<u64> {
        let of = |s: &Statistics| [s.mean(), s.std_dev(), s.quantile(0.05), s.quantile(0.5)].map(f64::to_bits);
        ensemble.statistics().flat_map(|(_, s)| of(s)).collect()
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

    /// Wheel noise, bumps of both kinds, misplacement at START and errors of the measurement, on the square and on a path of
    /// whole circles, each with every kind of odometry.
    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let mut model = Model::new(&Robot::labmate());
        for (effect, parameter, value) in [
            ("wheel_noise", "k_sqrt_m", 1e-3),
            ("bumps", "rate_per_m", 0.5),
            ("placed_bumps", "count", 3.0),
            ("start_pose", "position_sd_m", 1e-3),
            ("reference_noise", "position_sd_m", 1e-3),
        ] {
            model.set(effect, parameter, value).unwrap();
        }
        let sampled = Odometry::Sampled { rate: 50.0, update: Update::Arc };
        let figure_eight = Path::new(&FIGURE_EIGHT, &[0.5], SpeedProfile::default()).unwrap();
        for path in [Path::umbmark(), figure_eight] {
            for odometry in [Odometry::EveryTick, sampled, Odometry::Continuous] {
                let on = |instructions| {
                    let mut study =
                        Study { model: model.clone(), odometry, path: path.clone(), instructions, ..study(60) };
                    study.runs = [3, 4];
                    bits(&study, 1)
                };
                let portable = on(Instructions::Portable);
                assert_eq!(on(Instructions::Avx2), portable, "{odometry:?}");
                assert_eq!(on(Instructions::Avx512), portable, "{odometry:?}");
            }
        }
    }

    #[test]
    fn a_study_can_be_stopped_and_goes_on_to_the_same_bits() {
        let study = study(40_000);
        let whole = study.run(|_| ControlFlow::Continue(())).unwrap();
        let mut broken = study.run(|_| ControlFlow::Break(())).unwrap();
        assert_eq!(broken.trials(), BATCH);
        assert_eq!(broken.get(Metric::EMaxSys).unwrap().count(), BATCH);
        let never = AtomicBool::new(false);
        study.resume(&mut broken, &never, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!((broken.trials(), moments(&broken)), (40_000, moments(&whole)));
    }

    #[test]
    fn a_wish_to_stop_is_heard_within_a_chunk_and_what_is_done_is_kept() {
        let study = study(40_000);
        let stop = AtomicBool::new(true);
        let mut ensemble = Ensemble::new(&study, Shard::WHOLE);
        study.resume(&mut ensemble, &stop, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(ensemble.trials(), 0);
    }

    #[test]
    fn shards_merge_in_any_order_to_the_bits_of_the_whole() {
        let study = study(5000);
        let whole = study.run(|_| ControlFlow::Continue(())).unwrap();
        let shard = |index| {
            let mut ensemble = Ensemble::new(&study, Shard::new(index, 3).unwrap());
            study.resume(&mut ensemble, &AtomicBool::new(false), |_| ControlFlow::Continue(())).unwrap();
            ensemble
        };
        let mut merged = shard(2);
        merged.merge(&shard(0)).unwrap();
        assert_eq!((merged.missing().len(), merged.missing()[0].clone()), (1, 1536..3328));
        assert!(matches!(merged.merge(&shard(2)), Err(MergeError::Twice { .. })));
        merged.merge(&shard(1)).unwrap();
        assert_eq!((merged.missing(), merged.trials()), (Vec::new(), 5000));
        assert_eq!(moments(&merged), moments(&whole));
        let other = self::study(6000).run(|_| ControlFlow::Continue(())).unwrap();
        assert!(matches!(merged.merge(&other), Err(MergeError::Study { .. })));
    }

    #[test]
    fn a_uni_directional_test_has_the_metrics_of_its_direction_and_no_e_max_sys() {
        let one_way = Study { runs: [0, 5], ..study(100) };
        let names: Vec<&str> = one_way.metrics().iter().map(|metric| metric.name()).collect();
        assert_eq!(names, ["sigma_m", "centroid_ccw_x_m", "centroid_ccw_y_m", "return_heading_ccw_rad"]);
        let ensemble = one_way.run(|_| ControlFlow::Continue(())).unwrap();
        assert!(ensemble.statistics().all(|(_, s)| s.mean().is_finite() && s.std_dev().is_finite()));
    }

    #[test]
    fn impossible_studies_are_refused() {
        let refuse = |change: fn(&mut Study)| {
            let mut study = study(10);
            change(&mut study);
            study.run(|_| ControlFlow::Continue(())).unwrap_err().to_string()
        };
        assert!(refuse(|s| s.trials = 0).starts_with("number of trials must be between 1"));
        assert!(refuse(|s| s.runs = [0, 0]).starts_with("number of runs must be between 1"));
        assert!(refuse(|s| s.runs = [99_999, 5]).starts_with("number of clockwise runs must be between 0"));
    }
}
