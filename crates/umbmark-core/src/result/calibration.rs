//! `calibrate`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Keyed, Setup, Taken, ends, taken};
use crate::calibrate::{self, Method, Ratio};
use crate::drive::Robot;
use crate::solve::Solution;

/// Return errors of the recorded runs, their ticks computed again.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Replayed {
    /// E_max,sys, in m; null without runs of both directions.
    pub e_max_sys_m: Option<f64>,
    /// The largest distance of a return position from START, in m.
    pub largest_m: f64,
}

impl From<calibrate::Replayed> for Replayed {
    fn from(r: calibrate::Replayed) -> Self {
        Replayed { e_max_sys_m: r.e_max_sys, largest_m: r.largest }
    }
}

/// The corrections by one method; null for what the data does not determine.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Correction {
    /// Ratio of the wheel diameters, right to left.
    pub e_d: Option<f64>,
    /// Ratio of the wheelbase to its nominal value.
    pub e_b: Option<f64>,
    /// Ratio of the mean wheel diameter to its nominal value.
    pub e_s: Option<f64>,
    /// Corrected wheelbase, in m.
    pub wheelbase_m: Option<f64>,
    /// Corrected diameter of the left wheel, in m.
    pub wheel_diameter_left_m: Option<f64>,
    /// Corrected diameter of the right wheel, in m.
    pub wheel_diameter_right_m: Option<f64>,
    /// Covariance of the ratios named in `covariance_of`.
    pub covariance: Option<Vec<Vec<f64>>>,
    /// The ratios that the data determines.
    pub covariance_of: Vec<&'static str>,
    /// Degrees of freedom of the covariance.
    pub degrees_of_freedom: Option<f64>,
    /// Interval of E_d.
    pub e_d_interval: Option<[f64; 2]>,
    /// Interval of E_b.
    pub e_b_interval: Option<[f64; 2]>,
    /// Interval of E_s.
    pub e_s_interval: Option<[f64; 2]>,
    /// E_max,sys as driven, in m.
    pub e_max_sys_before_m: Option<f64>,
    /// E_max,sys that remains with the correction, in m.
    pub e_max_sys_after_m: Option<f64>,
    /// Return errors of the recorded ticks with the nominal lengths.
    pub replayed_before: Option<Replayed>,
    /// Return errors of the recorded ticks with the corrected lengths.
    pub replayed_after: Option<Replayed>,
    /// How the fit ended; null for closed forms.
    pub termination: Option<&'static str>,
}

impl Correction {
    fn new(robot: &Robot, estimate: &calibrate::Estimate, level: f64) -> Correction {
        let shown: Vec<Ratio> = Ratio::ALL.into_iter().filter(|r| estimate.ratio(*r).is_some()).collect();
        let covariance = estimate.covariance.map(|c| {
            let row = |i: &Ratio| shown.iter().map(|j| c[(*i as usize, *j as usize)]).collect();
            shown.iter().map(row).collect()
        });
        let interval = |ratio: Ratio| estimate.interval(ratio, level).and_then(ends);
        let lengths = estimate.lengths(robot);
        Correction {
            e_d: estimate.ratio(Ratio::Diameters),
            e_b: estimate.ratio(Ratio::Wheelbase),
            e_s: estimate.ratio(Ratio::Scale),
            wheelbase_m: lengths.wheelbase,
            wheel_diameter_left_m: lengths.left,
            wheel_diameter_right_m: lengths.right,
            covariance,
            covariance_of: shown.iter().map(|r| r.name()).collect(),
            degrees_of_freedom: estimate.covariance.map(|_| estimate.degrees_of_freedom),
            e_d_interval: interval(Ratio::Diameters),
            e_b_interval: interval(Ratio::Wheelbase),
            e_s_interval: interval(Ratio::Scale),
            e_max_sys_before_m: estimate.e_max_sys_before,
            e_max_sys_after_m: estimate.e_max_sys_after,
            replayed_before: estimate.replayed_before.map(Replayed::from),
            replayed_after: estimate.replayed_after.map(Replayed::from),
            termination: estimate.termination.map(|t| t.name()),
        }
    }
}

/// A calibration by every method that the data allows.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Calibration {
    /// The corrections by "closed_form_x", "closed_form_y", "closed_form_mean", "heading", "exact" and "model"; null where the data does not
    /// allow it.
    pub methods: Keyed<Option<Correction>>,
    /// The method whose correction is to be written into the robot; null where none gives both E_d and E_b.
    pub exported: Option<&'static str>,
    /// The answer in words, as of `solve`; null where no model could be learnt.
    pub sentence: Option<String>,
    /// "end_poses" or "tracks".
    pub observed: &'static str,
    /// Weight of a heading error in m per rad if whole tracks were fitted; otherwise null.
    pub heading_arm_m: Option<f64>,
    /// Probability with which the intervals hold.
    pub level: f64,
    /// Findings about the data before any fit: faults, clock and mounting of the reference, jumps, wrong poses, outlying runs.
    pub setup: Setup,
    /// Effects of the reference whose values were estimated from the motion.
    pub taken: Vec<Taken>,
    /// Reasons to doubt the corrected lengths, a sentence each; if there are any, nothing is exported.
    pub doubts: Vec<String>,
    /// Warnings: first about the data, then what could not be determined, and why.
    pub warnings: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Calibration {
    /// A calibration of a robot, and the answer beside it; intervals hold with probability `level`.
    pub fn new(
        robot: &Robot,
        calibration: &calibrate::Calibration,
        answer: Option<&Solution>,
        level: f64,
    ) -> Calibration {
        let of = |method| calibration.estimate(method).map(|estimate| Correction::new(robot, estimate, level));
        Calibration {
            methods: Method::ALL.into_iter().map(|method| (method.name(), of(method))).collect(),
            exported: calibration.to_write().map(|estimate| estimate.method.name()),
            sentence: answer.map(Solution::sentence),
            observed: calibration.level.name(),
            heading_arm_m: calibration.heading_arm,
            level,
            setup: calibration.setup.as_ref().into(),
            taken: taken(&calibration.taken),
            doubts: calibration.doubts.clone(),
            warnings: calibration.warnings.clone(),
            version: crate::VERSION,
        }
    }
}
