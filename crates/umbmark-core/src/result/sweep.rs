//! `mc --sweep`.

use schemars::JsonSchema;
use serde::Serialize;

use super::Keyed;
use crate::monte_carlo::{self, SweepPoint};

/// Equally spaced values of a parameter.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Axis {
    /// Full name of the parameter.
    pub name: String,
    /// Its flag.
    pub flag: &'static str,
    /// First value.
    pub first: f64,
    /// Last value.
    pub last: f64,
    /// Number of values.
    pub count: u64,
}

impl From<&monte_carlo::Axis> for Axis {
    fn from(axis: &monte_carlo::Axis) -> Self {
        Axis {
            name: axis.quantity.key(),
            flag: axis.quantity.parameter().flag,
            first: axis.first,
            last: axis.last,
            count: axis.count,
        }
    }
}

/// Statistics of a metric over the trials of a point, in its unit.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Summary {
    /// Mean; null if no trial has the metric.
    pub mean: Option<f64>,
    /// Standard deviation; null for fewer than two trials.
    pub std_dev: Option<f64>,
    /// Standard error of the mean; null for fewer than two trials.
    pub std_error: Option<f64>,
    /// Quantiles, by the share that lies below.
    pub quantiles: Keyed<Option<f64>>,
}

impl From<&monte_carlo::MetricSummary> for Summary {
    fn from(s: &monte_carlo::MetricSummary) -> Self {
        Summary {
            mean: s.mean,
            std_dev: s.std_dev,
            std_error: s.std_error,
            quantiles: SweepPoint::QUANTILES.iter().zip(s.quantiles).map(|(q, v)| (q.to_string(), v)).collect(),
        }
    }
}

/// A point of the grid.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Point {
    /// The values of the axes.
    pub values: Vec<f64>,
    /// The metrics there.
    pub metrics: Keyed<Summary>,
}

impl From<&SweepPoint> for Point {
    fn from(point: &SweepPoint) -> Self {
        let metrics = point.metrics.iter().map(|s| (s.metric.clone(), s.into())).collect();
        Point { values: point.values.clone(), metrics }
    }
}

/// A study on every point of a grid.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Sweep {
    /// What is swept; the last axis varies fastest.
    pub axes: Vec<Axis>,
    /// Trials of each point. Trial i has the same noise at every point.
    pub n: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether it was stopped before all points were done.
    pub partial: bool,
    /// The points, in order.
    pub points: Vec<Point>,
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Sweep {
    /// The points of a sweep that are done; `assumed` is what was assumed, a phrase each.
    pub fn new(sweep: &monte_carlo::Sweep, points: &[SweepPoint], assumed: &[String]) -> Sweep {
        Sweep {
            axes: sweep.axes().iter().map(Axis::from).collect(),
            n: sweep.study().trials,
            seed: sweep.study().seed,
            partial: (points.len() as u64) < sweep.points(),
            points: points.iter().map(Point::from).collect(),
            assumed: assumed.to_vec(),
            version: crate::VERSION,
        }
    }
}
