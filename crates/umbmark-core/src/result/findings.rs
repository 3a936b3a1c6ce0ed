//! What both `diagnose` and `learn` report in addition to their verdict.

use schemars::JsonSchema;
use serde::Serialize;

use super::fitted::{Outlier, meaning};
use super::law::Repeated;
use super::{Keyed, Setup, Taken, reasons, taken};
use crate::diagnose;

/// Findings about the model and the data, as keys of a result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Findings {
    /// Meaning of each fitted effect for the robot, a sentence each.
    pub meaning: Keyed<String>,
    /// Jumps of tracks that exceed the noise.
    pub outliers: Vec<Outlier>,
    /// Findings about the data before any fit: faults, clock and mounting of the reference, jumps, wrong poses, outlying runs.
    pub setup: Setup,
    /// Effects of the reference whose values were estimated from the motion.
    pub taken: Vec<Taken>,
    /// Why the verdict is not "explained", a sentence each.
    pub reasons: Vec<String>,
    /// The strongest pattern that repeats in the residuals, significant or not; null without tracks.
    pub repeats: Option<Repeated>,
}

impl From<&diagnose::Diagnosis> for Findings {
    fn from(diagnosis: &diagnose::Diagnosis) -> Self {
        Findings {
            meaning: meaning(&diagnosis.fitted, &diagnosis.model),
            outliers: diagnosis.outliers.iter().map(Outlier::from).collect(),
            setup: diagnosis.setup.as_ref().into(),
            taken: taken(&diagnosis.taken),
            reasons: reasons(&diagnosis.reasons),
            repeats: diagnosis.repeats.as_ref().map(Repeated::from),
        }
    }
}
