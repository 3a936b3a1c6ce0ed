//! `apply`.

use schemars::JsonSchema;
use serde::Serialize;

use super::finite;
use crate::apply::Corrected;

/// Corrected odometry of one run, where it ends.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Applied {
    /// Name of the run.
    pub run: String,
    /// The file that was written.
    pub output: String,
    /// Number of poses.
    pub samples: usize,
    /// From the first to the last, in s.
    pub duration_s: f64,
    /// Way that was driven, in m.
    pub way_m: f64,
    /// The last pose: x, y in m, heading in rad.
    pub end: [f64; 3],
    /// Standard deviations of the last pose, in m, m and rad; null without noise.
    pub end_standard_deviation: Option<[f64; 3]>,
}

impl Applied {
    /// What was written of a run; nothing where its log is empty.
    pub fn new(run: &str, output: &str, corrected: &Corrected) -> Option<Applied> {
        let (first, last) = (corrected.time.first()?, corrected.time.last()?);
        let end = corrected.poses.last()?;
        let spread = corrected.spread.as_ref().and_then(|spread| spread.last());
        Some(Applied {
            run: run.to_owned(),
            output: output.to_owned(),
            samples: corrected.time.len(),
            duration_s: last - first,
            way_m: finite(corrected.way)?,
            end: [end.x, end.y, end.heading],
            end_standard_deviation: spread.map(|s| [s.xx.sqrt(), s.yy.sqrt(), s.heading.sqrt()]),
        })
    }
}
