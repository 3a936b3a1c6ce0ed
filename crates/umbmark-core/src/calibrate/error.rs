//! Why a robot cannot be calibrated.

use crate::evidence::FitError;

/// Why a dataset cannot be calibrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// Runs that nothing can be fitted to.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// A drive whose errors are others.
    #[error("E_d, E_b and E_s are of differential drives, and the robot has drive = \"{drive}\"")]
    OtherDrive {
        /// The kind of the drive.
        drive: &'static str,
    },
    /// An invalid weight.
    #[error("the heading arm must be positive and finite, got {value} m")]
    HeadingArm {
        /// \[m\]
        value: f64,
    },
}
