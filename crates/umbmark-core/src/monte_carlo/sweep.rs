//! Ensembles over a grid of values.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Ensemble, Quantity, Shard, Statistics, Study, StudyError};

/// Equally spaced values of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// What is varied.
    pub quantity: Quantity,
    /// Its first value.
    pub first: f64,
    /// Its last value.
    pub last: f64,
    /// How many values there are.
    pub count: u64,
}

impl Axis {
    /// Value number `index`: both ends to the last bit.
    pub fn value(&self, index: u64) -> f64 {
        if index + 1 >= self.count && self.count > 1 {
            return self.last;
        }
        self.first + (self.last - self.first) * index as f64 / (self.count.max(2) - 1) as f64
    }
}

/// What cannot be swept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A point that cannot be studied.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The same quantity on two axes.
    #[error("{name} is swept twice; keep one of its axes")]
    Twice {
        /// The quantity.
        name: &'static str,
    },
    /// No points, or too many.
    #[error("a sweep has between 1 and {most} points, got {got}")]
    Points {
        /// The most points.
        most: u64,
        /// The name that was given.
        got: u128,
    },
}

/// A study repeated on every point of a grid.
///
/// Every point has the same seed, so that trial i has the same noise everywhere: what differs between points is what the
/// values make of it (common random numbers).
#[derive(Clone, Debug)]
pub struct Sweep {
    study: Study,
    axes: Vec<Axis>,
}

/// What a metric was over the trials of a point; none for what so few trials do not show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MetricSummary {
    /// Its name in files.
    pub metric: String,
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation, with n - 1.
    pub std_dev: Option<f64>,
    /// Standard error of the mean.
    pub std_error: Option<f64>,
    /// The quantiles [`SweepPoint::QUANTILES`].
    pub quantiles: [Option<f64>; 5],
}

/// One point of a grid, done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepPoint {
    /// The values of the axes.
    pub values: Vec<f64>,
    /// The metrics that the test has there.
    pub metrics: Vec<MetricSummary>,
}

impl SweepPoint {
    /// Which quantiles of a metric are kept.
    pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

    fn of(values: Vec<f64>, ensemble: &Ensemble) -> SweepPoint {
        let known = |value: f64| value.is_finite().then_some(value);
        let summary = |(metric, s): (super::Metric, &Statistics)| MetricSummary {
            metric: metric.name().to_owned(),
            mean: known(s.mean()),
            std_dev: known(s.std_dev()),
            std_error: known(s.std_error()),
            quantiles: Self::QUANTILES.map(|q| known(s.quantile(q))),
        };
        SweepPoint { values, metrics: ensemble.statistics().map(summary).collect() }
    }

    /// One of its metrics, by its name in files.
    pub fn metric(&self, name: &str) -> Option<&MetricSummary> {
        self.metrics.iter().find(|summary| summary.metric == name)
    }
}

impl Sweep {
    /// The most points of a grid.
    pub const MAX_POINTS: u64 = 10_000_000;

    /// A grid of studies; the last axis varies fastest.
    pub fn new(study: &Study, axes: &[Axis]) -> Result<Sweep, SweepError> {
        for (place, axis) in axes.iter().enumerate() {
            if axes[..place].iter().any(|other| other.quantity.key() == axis.quantity.key()) {
                return Err(SweepError::Twice { name: axis.quantity.parameter().flag });
            }
        }
        let points = axes.iter().map(|axis| u128::from(axis.count)).product();
        if axes.is_empty() || !(1..=u128::from(Self::MAX_POINTS)).contains(&points) {
            return Err(SweepError::Points { most: Self::MAX_POINTS, got: if axes.is_empty() { 0 } else { points } });
        }
        let sweep = Sweep { study: study.clone(), axes: axes.to_vec() };
        // The corners show whether values are possible before any work is done.
        [0, sweep.points() - 1].into_iter().try_for_each(|corner| sweep.at(corner).and_then(|study| study.check()))?;
        Ok(sweep)
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The study that is repeated.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// How many points the grid has.
    pub fn points(&self) -> u64 {
        self.axes.iter().map(|axis| axis.count).product()
    }

    /// The values of the axes at a point.
    pub fn values(&self, point: u64) -> Vec<f64> {
        let mut rest = point;
        let mut values: Vec<f64> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let index = rest % axis.count;
                rest /= axis.count;
                axis.value(index)
            })
            .collect();
        values.reverse();
        values
    }

    /// Everything that decides the numbers, in words: two sweeps with the same identity have the same points.
    pub fn identity(&self) -> String {
        let axis = |a: &Axis| format!("{} {:?} to {:?} in {}", a.quantity.key(), a.first, a.last, a.count);
        let axes: Vec<String> = self.axes.iter().map(axis).collect();
        format!("{} trials of {}; swept [{}]", self.study.trials, self.study.identity(), axes.join(", "))
    }

    /// The study at a point.
    fn at(&self, point: u64) -> Result<Study, StudyError> {
        let mut study = self.study.clone();
        let mut pairs = self.axes.iter().zip(self.values(point));
        pairs.try_for_each(|(axis, value)| axis.quantity.set(&mut study, value))?;
        Ok(study)
    }

    /// Does the points from number `first` on, on the present rayon pool, and gives them to `sink` in order, some at a time.
    ///
    /// Once `stop` is set, or `sink` breaks, no further points are begun; those before the first that is not done are kept.
    pub fn run(
        &self,
        first: u64,
        stop: &AtomicBool,
        mut sink: impl FnMut(Vec<SweepPoint>) -> ControlFlow<()>,
    ) -> Result<(), SweepError> {
        // Some points at a time, and fewer where they take long; no number depends on it.
        let some = (TRIALS_AT_A_TIME / self.study.trials.max(1)).clamp(4, 256);
        let mut next = first;
        while next < self.points() {
            let batch = next..(next + some).min(self.points());
            let count = batch.end - batch.start;
            let done: Result<Vec<Option<SweepPoint>>, StudyError> =
                batch.into_par_iter().map(|point| self.point(point, stop)).collect();
            let done: Vec<SweepPoint> = done?.into_iter().map_while(|point| point).collect();
            next += done.len() as u64;
            let whole = done.len() as u64 == count;
            if sink(done).is_break() || !whole {
                break;
            }
        }
        Ok(())
    }

    fn point(&self, point: u64, stop: &AtomicBool) -> Result<Option<SweepPoint>, StudyError> {
        let study = self.at(point)?;
        let mut ensemble = Ensemble::new(&study, Shard::WHOLE);
        study.resume(&mut ensemble, stop, |_| ControlFlow::Continue(()))?;
        let whole = ensemble.trials() == study.trials;
        Ok(whole.then(|| SweepPoint::of(self.values(point), &ensemble)))
    }
}

/// Trials of the points that are done at a time.
const TRIALS_AT_A_TIME: u64 = 65_536;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::monte_carlo::Metric;

    fn sweep(axes: &[(&str, f64, f64, u64)]) -> Result<Sweep, SweepError> {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        let study = Study::new(model, 20, 5);
        let axis = |(name, first, last, count): &(&str, f64, f64, u64)| {
            let quantity = Quantity::find(name, &study).unwrap();
            Axis { quantity, first: *first, last: *last, count: *count }
        };
        Sweep::new(&study, &axes.iter().map(axis).collect::<Vec<_>>())
    }

    fn all(sweep: &Sweep, first: u64) -> Vec<SweepPoint> {
        let mut points = Vec::new();
        let stop = AtomicBool::new(false);
        sweep
            .run(first, &stop, |done| {
                points.extend(done);
                ControlFlow::Continue(())
            })
            .unwrap();
        points
    }

    #[test]
    fn each_point_is_the_study_with_its_values_and_the_last_axis_varies_fastest() {
        let sweep = sweep(&[("ed", 1.0, 1.004, 3), ("runs", 2.0, 5.0, 2)]).unwrap();
        let points = all(&sweep, 0);
        let expected = [[1.0, 2.0], [1.0, 5.0], [1.002, 2.0], [1.002, 5.0], [1.004, 2.0], [1.004, 5.0]];
        assert_eq!(points.iter().map(|point| point.values.clone()).collect::<Vec<_>>(), expected);
        let mut by_hand = sweep.study().clone();
        by_hand.model.set("wheel_diameter_ratio", "e_d", 1.004).unwrap();
        by_hand.runs = [2, 2];
        let ensemble = by_hand.run(|_| ControlFlow::Continue(())).unwrap();
        let known = points[4].metric("e_max_sys_m").unwrap();
        assert_eq!(known.mean, Some(ensemble.get(Metric::EMaxSys).unwrap().mean()));
        assert_eq!(all(&sweep, 4), points[4..]);
    }

    #[test]
    fn impossible_sweeps_are_refused() {
        let refuse = |axes: &[(&str, f64, f64, u64)]| sweep(axes).unwrap_err().to_string();
        assert_eq!(refuse(&[("ed", 1.0, 1.1, 3), ("ed", 1.0, 1.1, 3)]), "ed is swept twice; keep one of its axes");
        assert_eq!(refuse(&[("ed", 1.0, 1.1, 0)]), "a sweep has between 1 and 10000000 points, got 0");
        assert_eq!(refuse(&[("ed", 1.0, 9.0, 3)]), "wheel_diameter_ratio: e_d must be between 0.5 and 2, got 9");
        assert!(refuse(&[("ed", 1.0, 1.1, 10_000), ("eb", 1.0, 1.1, 10_000)]).ends_with("got 100000000"));
    }
}
