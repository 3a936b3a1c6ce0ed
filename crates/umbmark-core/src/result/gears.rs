//! `calibrate` of drives other than the differential one.

use schemars::JsonSchema;
use serde::Serialize;

use super::Keyed;
use super::fitted::{Estimate, estimates};
use crate::drive::Robot;
use crate::{diagnose, learn};

/// How many combinations of the sizes the return poses of the path determine.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReturnPosesDetermine {
    /// Number of combinations that are determined.
    pub rank: usize,
    /// Number of sizes.
    pub of: usize,
    /// Combinations that are not determined: the weight of each size.
    pub hidden: Vec<Keyed<f64>>,
}

impl From<&diagnose::Identifiability> for ReturnPosesDetermine {
    fn from(i: &diagnose::Identifiability) -> Self {
        let hidden = i.hidden.iter().map(|h| h.weights.iter().copied().collect());
        ReturnPosesDetermine { rank: i.rank, of: i.shares.len(), hidden: hidden.collect() }
    }
}

/// A robot of any drive, calibrated by the first effects of its drive.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct GearCalibration {
    /// "synchro", "ackermann", ...
    pub drive: &'static str,
    /// The sizes of its first effects.
    pub fitted: Vec<Estimate>,
    /// Effects that this data cannot separate from the rest; they keep their values.
    pub not_shown: Vec<&'static str>,
    /// The keys of robot.toml that change, with their new values.
    pub corrected: Keyed<f64>,
    /// What return poses can determine; null if the path is not known.
    pub return_poses_determine: Option<ReturnPosesDetermine>,
    /// E_max,sys as driven, in m; null without runs of both directions.
    pub e_max_sys_before_m: Option<f64>,
    /// The part of it that remains with the correction, in m.
    pub e_max_sys_after_m: Option<f64>,
    /// Probability with which the intervals hold.
    pub level: f64,
    /// Warnings about the data.
    pub warnings: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl GearCalibration {
    /// A calibration of a robot; intervals hold with probability `level`.
    pub fn new(
        robot: &Robot,
        calibration: &learn::GearCalibration,
        level: f64,
        warnings: &[String],
    ) -> GearCalibration {
        GearCalibration {
            drive: robot.drive.kind().name(),
            fitted: estimates(&calibration.estimates, level),
            not_shown: calibration.not_shown.clone(),
            corrected: calibration.changes(robot).into_iter().map(|(key, _, new)| (key, new)).collect(),
            return_poses_determine: calibration.identifiability.as_ref().map(Into::into),
            e_max_sys_before_m: calibration.e_max_sys_before,
            e_max_sys_after_m: calibration.e_max_sys_after,
            level,
            warnings: warnings.to_vec(),
            version: crate::VERSION,
        }
    }
}
