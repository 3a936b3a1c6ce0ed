//! `calibrate` of drives other than the differential one.

use super::fitted::estimates;
use crate::drive::Robot;
use crate::learn::GearCalibration;
use serde_json::{Map, Value, json};

/// A calibration of a robot by the first effects of its drive; intervals hold with probability `level`.
pub fn gears(robot: &Robot, calibration: &GearCalibration, level: f64, warnings: &[String]) -> Value {
    let corrected: Map<String, Value> =
        calibration.changes(robot).into_iter().map(|(key, _, new)| (key.to_owned(), json!(new))).collect();
    let determined = calibration.identifiability.as_ref().map(|i| {
        let named = |(name, weight): &(&str, f64)| ((*name).to_owned(), json!(weight));
        let hidden: Vec<Map<String, Value>> = i.hidden.iter().map(|h| h.weights.iter().map(named).collect()).collect();
        json!({ "rank": i.rank, "of": i.shares.len(), "hidden": hidden })
    });
    json!({
        "drive": robot.drive.kind().name(),
        "fitted": estimates(&calibration.estimates, level),
        "not_shown": calibration.not_shown,
        "corrected": corrected,
        "return_poses_determine": determined,
        "e_max_sys_before_m": calibration.e_max_sys_before,
        "e_max_sys_after_m": calibration.e_max_sys_after,
        "level": level,
        "warnings": warnings,
        "version": crate::VERSION,
    })
}
