//! What is to be minimised, and when to stop.

use super::known::Known;
use nalgebra::{DMatrix, DVector};

/// Residuals to be minimised.
pub trait Problem {
    /// r(p): observed minus predicted, each in units of its standard deviation.
    fn residuals(&self, parameters: &[f64]) -> DVector<f64>;

    /// ∂r_i/∂p_j, one row a residual.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64>;

    /// Residuals and Jacobian together, for problems that compute both at once more cheaply.
    fn both(&self, parameters: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        (self.residuals(parameters), self.jacobian(parameters))
    }

    /// What is known of the parameters besides the residuals; nothing of those beyond the end of the list.
    fn known(&self) -> Vec<Known> {
        Vec::new()
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The largest number of steps tried.
    pub iterations: usize,
    /// Stops where a step changes each parameter by less than this share of its size.
    pub step_tolerance: f64,
    /// Stops where a step lowers the sum of squares by less than this share of it.
    pub decrease_tolerance: f64,
    /// Whether the first steps are damped: needed where the start may be far from the end.
    pub cautious: bool,
    /// Whether points are expensive: steps then learn from those before them, and a step with a negligible expected decrease is not
    /// evaluated.
    pub frugal: bool,
}

impl Default for Options {
    /// 100 steps, 1e-14, 1e-15: converges to full precision, also from distant start values.
    fn default() -> Self {
        Options { iterations: 100, step_tolerance: 1e-14, decrease_tolerance: 1e-15, cautious: true, frugal: false }
    }
}
