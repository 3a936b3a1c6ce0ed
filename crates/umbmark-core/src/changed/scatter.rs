//! Whether runs scatter more than before.

use super::quantities::{Of, Quantity};
use super::{Learned, Moved, Value};
use crate::compare::tracks::errors_along;
use crate::dataset::Dataset;
use crate::evidence::{AnyEvidence, Fit};
use crate::stats::Interval;

/// Fewer runs do not determine how they scatter.
const FEWEST: usize = 3;
/// Errors are of one path where the ways differ by no more than this share.
const SAME_WAY: f64 = 0.05;

/// The runs' own errors that both fits leave, compared by their logarithms; `None` where the runs are too few, or of two paths.
pub(super) fn of(tests: &[Learned; 2], fits: &[Fit; 2], size: f64) -> Option<Moved> {
    let ways = [0, 1].map(|k| way(tests[k].data));
    let alike = matches!(ways, [Some(a), Some(b)] if (a / b - 1.0).abs() < SAME_WAY) || ways == [None, None];
    let same_path = tests[0].data.path == tests[1].data.path;
    if !(alike && same_path) {
        return None;
    }
    let [before, after] = [0, 1].map(|k| logarithm(&errors(&tests[k].evidence, &fits[k]), fits[k].estimates.len()));
    let quantity = Quantity {
        of: Of::Scatter,
        key: "scatter".into(),
        meaning: "what the runs leave, root mean square of the median run".into(),
    };
    let moved = Moved::of(quantity, before?, after?, size)?;
    let back = |v: Value| Value { value: libm::exp(v.value), ..v };
    let Interval { low, high } = moved.interval;
    Some(Moved {
        before: back(moved.before),
        after: back(moved.after),
        change: libm::exp(moved.change),
        interval: Interval { low: libm::exp(low), high: libm::exp(high) },
        ..moved
    })
}

/// Mean way of the runs by their counts \[m\]; `None` where none was recorded.
fn way(data: &Dataset) -> Option<f64> {
    let robot = data.robot.as_ref()?;
    let per_tick = robot.metres_per_tick();
    let rolled = |counts: &[f64]| counts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>();
    let ways: Vec<f64> = data
        .runs
        .iter()
        .filter_map(|run| run.log.as_ref())
        .map(|log| 0.5 * (per_tick.left.abs() * rolled(&log.left) + per_tick.right.abs() * rolled(&log.right)))
        .collect();
    (!ways.is_empty()).then(|| ways.iter().sum::<f64>() / ways.len() as f64)
}

/// Root mean square error of each run \[m\].
fn errors(evidence: &AnyEvidence, fit: &Fit) -> Vec<f64> {
    match evidence {
        AnyEvidence::Ends(ends) => ends.residuals(&fit.model).iter().map(|left| libm::hypot(left.x, left.y)).collect(),
        AnyEvidence::Tracks(observed) => errors_along(observed, &fit.model),
    }
}

/// Mean logarithm of the errors. The `fitted` values took up a part of them.
fn logarithm(errors: &[f64], fitted: usize) -> Option<Value> {
    let logarithms: Vec<f64> = errors.iter().filter(|error| **error > 0.0).map(|error| libm::log(*error)).collect();
    let n = logarithms.len();
    if n < FEWEST {
        return None;
    }
    let mean = logarithms.iter().sum::<f64>() / n as f64;
    let variance = logarithms.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
    let left = 1.0 - fitted as f64 / (3 * n).max(fitted + 1) as f64;
    Some(Value {
        value: mean - 0.5 * libm::log(left),
        standard_error: (variance / n as f64).sqrt(),
        degrees_of_freedom: (n - 1) as f64,
    })
}
