//! Weighted non-linear least squares: minimise Σ r_i(p)², with residuals r = (observed - predicted)/standard deviation.
//!
//! Levenberg (1944) and Marquardt (1963): Gauss-Newton steps damped in units of the Jacobian's column lengths, each solved by an orthogonal
//! factorisation of \[J; √λ D\], never by normal equations. A parameter, or a combination of parameters, that the data does not determine
//! keeps its start value and is named by [`null_directions`]. Steps end at the bounds of parameters; an earlier measurement of one is one more
//! residual ([`Known`]). A fit that stops early is a [`Fit`] that says so, not an error.

mod covariance;
mod descent;
mod known;
mod memory;
mod outcome;
mod problem;
mod search;

pub use covariance::{RANK_TOLERANCE, jackknife_covariance, null_directions};
pub use descent::least_squares;
pub use known::{Known, Prior};
pub use outcome::{Fit, Termination};
pub use problem::{Options, Problem};
pub(crate) use search::{Searched, search};

#[cfg(test)]
mod tests;
