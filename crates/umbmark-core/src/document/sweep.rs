//! `mc --sweep`.

use crate::monte_carlo::{Axis, MetricSummary, Sweep, SweepPoint};
use serde_json::{Map, Value, json};

/// The points of a sweep that are done; `assumed` is what nobody said, a phrase each.
pub fn sweep(sweep: &Sweep, points: &[SweepPoint], assumed: &[String]) -> Value {
    let axis = |axis: &Axis| {
        json!({ "name": axis.quantity.key(), "flag": axis.quantity.parameter().flag, "first": axis.first,
                "last": axis.last, "count": axis.count })
    };
    let summary = |s: &MetricSummary| {
        let quantiles: Map<String, Value> =
            SweepPoint::QUANTILES.iter().zip(s.quantiles).map(|(q, v)| (q.to_string(), json!(v))).collect();
        let value = json!({ "mean": s.mean, "std_dev": s.std_dev, "std_error": s.std_error, "quantiles": quantiles });
        (s.metric.clone(), value)
    };
    let point = |point: &SweepPoint| {
        let metrics: Map<String, Value> = point.metrics.iter().map(summary).collect();
        json!({ "values": point.values, "metrics": metrics })
    };
    json!({
        "axes": sweep.axes().iter().map(axis).collect::<Value>(),
        "n": sweep.study().trials,
        "seed": sweep.study().seed,
        "partial": (points.len() as u64) < sweep.points(),
        "points": points.iter().map(point).collect::<Value>(),
        "assumed": assumed,
        "version": crate::VERSION,
    })
}
