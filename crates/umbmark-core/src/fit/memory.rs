//! Anderson acceleration (1965) of Gauss-Newton steps: each step uses the earlier ones.

use super::covariance::RANK_TOLERANCE;
use nalgebra::{DMatrix, DVector};

/// Maximum number of earlier changes that a step uses.
const REMEMBERED: usize = 4;

/// The points of a fit and the Gauss-Newton step from each of them, in order.
#[derive(Default)]
pub struct Memory {
    values: Vec<DVector<f64>>,
    steps: Vec<DVector<f64>>,
}

impl Memory {
    /// Anderson-accelerated step: it uses the combination of earlier changes that leaves the least of this step, measured by what
    /// the step does to the residuals. Where large residuals are left, plain Gauss-Newton steps shrink only by a constant factor.
    /// `None` at the first point.
    pub fn learn(&mut self, values: &[f64], jacobian: &DMatrix<f64>, step: &DVector<f64>) -> Option<DVector<f64>> {
        let values = DVector::from_column_slice(values);
        if self.values.last() != Some(&values) {
            self.values.push(values);
            self.steps.push(step.clone());
        }
        let changes = (self.values.len() - 1).min(REMEMBERED).min(step.len());
        if changes == 0 {
            return None;
        }
        let change = |of: &[DVector<f64>]| {
            let last = &of[of.len() - changes - 1..];
            DMatrix::from_columns(&last.windows(2).map(|pair| &pair[1] - &pair[0]).collect::<Vec<_>>())
        };
        let (moved, turned) = (change(&self.values), change(&self.steps));
        let information = jacobian.tr_mul(jacobian);
        let products = turned.tr_mul(&(&information * &turned));
        let least = RANK_TOLERANCE * RANK_TOLERANCE * products.trace();
        let share = products.svd(true, true).solve(&turned.tr_mul(&(&information * step)), least).ok()?;
        Some(step - (moved + turned) * share)
    }
}
