//! `calibrate`.

use super::ends;
use super::setup::{setup, taken};
use crate::calibrate::{Calibration, Estimate, Method, Ratio, Replayed};
use crate::drive::Robot;
use serde_json::{Map, Value, json};

/// A calibration of a robot; intervals hold with probability `level`.
pub fn calibration(robot: &Robot, calibration: &Calibration, level: f64) -> Value {
    let methods: Map<String, Value> = Method::ALL
        .into_iter()
        .map(|m| (m.name().to_owned(), json!(calibration.estimate(m).map(|e| estimate_json(robot, e, level)))))
        .collect();
    json!({
        "methods": methods,
        "observed": calibration.level.name(),
        "heading_arm_m": calibration.heading_arm,
        "level": level,
        "setup": setup(&calibration.setup),
        "taken": taken(&calibration.taken),
        "doubts": calibration.doubts,
        "warnings": calibration.warnings,
        "version": crate::VERSION,
    })
}

fn estimate_json(robot: &Robot, estimate: &Estimate, level: f64) -> Value {
    let shown: Vec<Ratio> = Ratio::ALL.into_iter().filter(|r| estimate.ratio(*r).is_some()).collect();
    let covariance = estimate.covariance.map(|c| {
        let row = |i: &Ratio| shown.iter().map(|j| c[(*i as usize, *j as usize)]).collect::<Vec<f64>>();
        shown.iter().map(row).collect::<Vec<_>>()
    });
    let interval = |ratio: Ratio| estimate.interval(ratio, level).and_then(ends);
    let lengths = estimate.lengths(robot);
    let replayed = |r: Option<Replayed>| r.map(|r| json!({ "e_max_sys_m": r.e_max_sys, "largest_m": r.largest }));
    json!({
        "e_d": estimate.ratio(Ratio::Diameters),
        "e_b": estimate.ratio(Ratio::Wheelbase),
        "e_s": estimate.ratio(Ratio::Scale),
        "wheelbase_m": lengths.wheelbase,
        "wheel_diameter_left_m": lengths.left,
        "wheel_diameter_right_m": lengths.right,
        "covariance": covariance,
        "covariance_of": shown.iter().map(|r| r.name()).collect::<Vec<_>>(),
        "degrees_of_freedom": estimate.covariance.map(|_| estimate.degrees_of_freedom),
        "e_d_interval": interval(Ratio::Diameters),
        "e_b_interval": interval(Ratio::Wheelbase),
        "e_s_interval": interval(Ratio::Scale),
        "e_max_sys_before_m": estimate.e_max_sys_before,
        "e_max_sys_after_m": estimate.e_max_sys_after,
        "replayed_before": replayed(estimate.replayed_before),
        "replayed_after": replayed(estimate.replayed_after),
        "termination": estimate.termination.map(|t| t.name()),
    })
}
