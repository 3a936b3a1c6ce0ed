//! Where a fit stopped, and why.

use super::covariance::{self, RANK_TOLERANCE, null_directions};
use nalgebra::{DMatrix, DVector};

/// Why a fit stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The last step was negligibly small.
    SmallStep,
    /// The last step lowered the sum of squares negligibly, or no shorter step lowers it at all.
    SmallDecrease,
    /// The limit of steps was reached: the values are the best so far.
    IterationLimit,
    /// The residuals are not finite at the start.
    NotFinite,
}

impl Termination {
    /// Whether the values are a minimum.
    pub fn converged(self) -> bool {
        matches!(self, Termination::SmallStep | Termination::SmallDecrease)
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Termination::SmallStep => "converged: the step is negligible",
            Termination::SmallDecrease => "converged: the decrease is negligible",
            Termination::IterationLimit => "stopped at the limit of iterations",
            Termination::NotFinite => "the residuals are not finite at the start values",
        }
    }
}

/// Where a fit stopped, and everything there.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The parameters.
    pub values: Vec<f64>,
    /// r at the parameters.
    pub residuals: DVector<f64>,
    /// ∂r/∂p at the parameters. Both have a row for each prior, behind the others.
    pub jacobian: DMatrix<f64>,
    /// Parameters that ended at a bound beyond which the sum of squares falls.
    pub held: Vec<bool>,
    /// Steps tried.
    pub iterations: usize,
    /// Why it stopped.
    pub termination: Termination,
}

impl Fit {
    /// Σ r².
    pub fn cost(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Combinations of parameters that the data does not determine; see [`null_directions`].
    pub fn null_directions(&self) -> Vec<DVector<f64>> {
        null_directions(&self.jacobian, RANK_TOLERANCE)
    }

    /// Covariance of the parameters, (JᵀJ)⁻¹, for independent residuals of unit variance; `None` where the data leaves
    /// a combination of parameters open. Those that are held at a bound have none; that of the others holds with these at their bounds.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let free: Vec<usize> = (0..self.values.len()).filter(|k| !self.held[*k]).collect();
        if free.len() == self.values.len() {
            return covariance::inverse_information(&self.jacobian);
        }
        let own = covariance::inverse_information(&self.jacobian.select_columns(&free))?;
        let mut all = DMatrix::zeros(self.values.len(), self.values.len());
        for (i, row) in free.iter().enumerate() {
            free.iter().enumerate().for_each(|(j, column)| all[(*row, *column)] = own[(i, j)]);
        }
        Some(all)
    }

    /// s² = Σ r²/(N - p), the variance of the residuals; `None` without spare residuals.
    pub fn residual_variance(&self) -> Option<f64> {
        let spare = self.residuals.len().checked_sub(self.values.len())?;
        (spare > 0).then(|| self.cost() / spare as f64)
    }
}
