//! What is known of parameters besides the residuals: bounds, and earlier measurements.

use nalgebra::{DMatrix, DVector};

/// Values that differ by this share of their size are the same.
const ROUNDING: f64 = 1e-14;

/// What is known of a parameter before a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Its least value.
    pub low: f64,
    /// Its greatest value.
    pub high: f64,
    /// An earlier measurement.
    pub prior: Option<Prior>,
}

impl Default for Known {
    /// Nothing.
    fn default() -> Self {
        Known { low: f64::NEG_INFINITY, high: f64::INFINITY, prior: None }
    }
}

/// An earlier measurement of a parameter: a Gaussian, and one more residual of a fit, (mean - p)/sd.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Its value.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// What is known of all parameters of a problem; those beyond the end of the list are free.
#[derive(Clone, Debug, Default)]
pub(super) struct AllKnown(pub Vec<Known>);

impl AllKnown {
    /// The nearest values within the bounds; at a bound where only rounding is between.
    pub fn nearest(&self, mut values: Vec<f64>) -> Vec<f64> {
        for (value, known) in values.iter_mut().zip(&self.0) {
            let rounding = ROUNDING * value.abs();
            if *value <= known.low + rounding {
                *value = known.low;
            } else if *value >= known.high - rounding {
                *value = known.high;
            }
        }
        values
    }

    /// Residuals and Jacobian with a row for each prior.
    pub fn with_priors(
        &self,
        values: &[f64],
        (residuals, jacobian): (DVector<f64>, DMatrix<f64>),
    ) -> (DVector<f64>, DMatrix<f64>) {
        let priors: Vec<(usize, Prior)> =
            self.0.iter().enumerate().filter_map(|(k, known)| Some((k, known.prior?))).collect();
        if priors.is_empty() {
            return (residuals, jacobian);
        }
        let rows = residuals.len();
        let mut residuals = residuals.resize_vertically(rows + priors.len(), 0.0);
        let mut jacobian = jacobian.resize_vertically(rows + priors.len(), 0.0);
        for (row, (k, prior)) in (rows..).zip(priors) {
            residuals[row] = (prior.mean - values[k]) / prior.sd;
            jacobian[(row, k)] = -1.0 / prior.sd;
        }
        (residuals, jacobian)
    }

    /// Parameters at a bound beyond which the sum of squares falls.
    pub fn held(&self, values: &[f64], residuals: &DVector<f64>, jacobian: &DMatrix<f64>) -> Vec<bool> {
        let is_held = |(k, value): (usize, &f64)| {
            let Some(known) = self.0.get(k) else { return false };
            let slope = jacobian.column(k).dot(residuals);
            (*value <= known.low && slope > 0.0) || (*value >= known.high && slope < 0.0)
        };
        values.iter().enumerate().map(is_held).collect()
    }

    /// Whether any parameter has a bound.
    pub fn is_bounded(&self) -> bool {
        self.0.iter().any(|known| known.low.is_finite() || known.high.is_finite())
    }
}
