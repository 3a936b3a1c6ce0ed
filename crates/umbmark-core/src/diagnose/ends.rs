//! Diagnosis from return poses.
//!
//! The noise of a robot's wheels mirrors with its path, so clockwise runs are mirrored (M = diag(1, -1, -1)) and the scatter
//! of both directions is pooled, with ν = n_cw + n_ccw - 2 degrees of freedom.

pub(super) mod asked;
pub(super) mod contrasts;
mod exact;
mod family;
mod flips;
mod moments;
mod verdict;

pub(crate) use asked::{Asked, Unit};
pub use contrasts::{Contrast, OnCircle};
pub(crate) use contrasts::{circle, contrasts};
pub(crate) use family::{Family, statistics};
pub(crate) use moments::Moments;
pub(crate) use verdict::{Beside, contradiction, diagnose, likeliest, remains};
