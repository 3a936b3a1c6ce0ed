//! How probable the observed tracks are: residuals of a whole run, made independent and of unit variance.
//!
//! The pose error of a run is a random walk: every metre and every radian driven adds heading and position noise, START is
//! placed by hand, and the reference adds noise of its own. So the covariance of all residuals of a run is full, but its inverse
//! is banded: a Kalman filter along the run turns residuals, and Jacobian columns alike, into independent ones in one pass
//! ([`Noise::whiten`]). The sizes of the noise are found from the data by restricted maximum likelihood ([`Noise::estimate`]).
//!
//! Source: error growth along a path, Chong & Kleeman (1997) and Kelly (2004); innovations as whitened residuals, Kailath (1968);
//! REML, Patterson & Thompson (1971).

mod beginning;
mod descent;
mod fitted;
mod fitting;
mod knowledge;
mod noise;
mod observed;
mod outliers;
mod products;
#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
pub(crate) mod watched;
mod whiten;

pub use beginning::Taken;
pub(crate) use beginning::{FAR, of_reference, ratios, stands_for_the_reference};
pub use fitted::{Ended, Fitted, Outlier};
pub use fitting::{NUISANCE, USUAL_NOISE};
pub use knowledge::{Knowledge, KnowledgeError, KnownNumber};
pub use noise::Noise;
pub(crate) use observed::BLOCK;
pub use observed::{Block, Column, Growth, Gyro, Observed, ObservedRun, Stretch};
pub(crate) use products::{ABSORBED, ScaledCholesky, gram, scaled_cholesky, share_left, solver};
pub use whiten::{Disturbance, Whitened};
