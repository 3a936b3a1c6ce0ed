//! A fitted model by itself: its errors, in the runs it was fitted to and in runs left out, and how these runs are weighed.

use super::TELLING;
use super::errors::{Errors, Misses};
use super::system::{Projected, System};
use crate::effect::ModelError;
use crate::likelihood::{Column, Fitted, Noise, Weighing};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Steps of Gauss and Newton that fit whole tracks, from the fit of increments.
const STEPS: usize = 8;
/// Stops where no value changes by more than this share of its standard error.
const SMALL: f64 = 1e-3;

/// A fitted model, its residuals, and the columns of its free values and of the effects of the reference that are fitted along.
pub(crate) struct Alone {
    fitted: Fitted,
    columns: Vec<Vec<Column>>,
    system: System,
    errors: Errors,
}

impl Alone {
    /// A model as it was fitted.
    pub fn new(fitted: Fitted) -> Alone {
        let (observed, columns) = (&fitted.observed, fitted.all_columns());
        let system = System::new(observed, &fitted.noise, &columns);
        let errors = Errors::new(observed, &system, &columns, (0..system.width).collect());
        Alone { fitted, columns, system, errors }
    }

    /// Columns that are fitted together.
    fn together(&self) -> Vec<usize> {
        (0..self.system.residual()).collect()
    }

    /// The model's own part of the values of a fit.
    fn own(&self, values: &DVector<f64>) -> (Vec<usize>, DVector<f64>) {
        let own = self.fitted.free.len();
        ((0..own).collect(), values.rows(0, own).into_owned())
    }

    /// Errors of runs left out, the others fitted pose by pose or as whole tracks.
    fn left_out(&self, weighing: Weighing) -> Misses {
        self.errors.misses(|run| {
            self.own(&match weighing {
                Weighing::Increments => Projected::fit(&self.system.without(run), &self.together()),
                Weighing::Tracks => self.errors.fit(&self.together(), Some(run)),
            })
        })
    }

    /// What predicts runs left out better: the fit of what is new from pose to pose, which is the likeliest where nothing is
    /// missing from the model, or that of whole tracks, which does what can be done where something is. Whole tracks are weighed
    /// only where they are better by a tenth.
    pub fn weighing(&self) -> Weighing {
        let [increments, tracks] = [Weighing::Increments, Weighing::Tracks].map(|by| self.left_out(by).position);
        let better = !self.fitted.free.is_empty() && tracks < (1.0 - TELLING) * increments;
        if better { Weighing::Tracks } else { Weighing::Increments }
    }

    /// Errors inside and in runs left out, so weighed.
    pub fn misses(&self) -> (Misses, Misses) {
        let weighing = self.weighing();
        let inside = match weighing {
            Weighing::Increments => self.errors.in_sample(),
            Weighing::Tracks => {
                let all = self.errors.fit(&self.together(), None);
                self.errors.misses(|_| self.own(&all))
            }
        };
        (inside, self.left_out(weighing))
    }

    /// AICc, BIC and the root mean square of the whitened residuals, the effects of the reference fitted out.
    pub fn criteria(&self) -> (f64, f64, f64) {
        let residual = self.system.residual();
        let runs = self.fitted.observed.runs.par_iter().zip(&self.columns);
        let scales = runs.map(|(run, columns)| self.fitted.noise.whiten(run, &[&columns[residual]]).log_scale);
        let scales: Vec<f64> = scales.collect();
        let reference: Vec<usize> = (self.fitted.free.len()..residual).collect();
        let squares = Projected::new(&self.system.whole, &reference).products[(residual, residual)];
        let deviance = 2.0 * scales.iter().sum::<f64>() + squares;
        let (n, k) = (self.system.rows as f64, (residual + Noise::SIZES) as f64);
        let aicc = deviance + 2.0 * k * n / (n - k - 1.0).max(1.0);
        (aicc, deviance + k * libm::log(n), (squares / n).sqrt())
    }

    /// The model with the values that predict runs left out best. Where these are of whole tracks, their covariance comes from
    /// leaving out one run after the other.
    pub fn predicting(self) -> Result<Fitted, ModelError> {
        if self.weighing() == Weighing::Increments {
            return Ok(self.fitted);
        }
        let (mut now, mut covariance) = (self, None);
        for _ in 0..STEPS {
            let step = now.own(&now.errors.fit(&now.together(), None)).1;
            let values: Vec<f64> = now.fitted.model.values().collect();
            let moved: Vec<f64> = now.fitted.free.iter().zip(step.iter()).map(|(i, step)| values[*i] + step).collect();
            let model = now.fitted.model.with_values(&now.fitted.free, &moved)?;
            let observed = now.fitted.observed.along(&model);
            now = Alone::new(Fitted { model, observed, weighing: Weighing::Tracks, ..now.fitted });
            covariance = now.jackknife();
            let variance = |k: usize| covariance.as_ref().map_or(0.0, |covariance| covariance[(k, k)]);
            if step.iter().enumerate().all(|(k, step)| step * step <= SMALL * SMALL * variance(k)) {
                break;
            }
        }
        Ok(Fitted { covariance, ..now.fitted })
    }

    /// (n - 1)/n Σ Δ Δᵀ, with Δ the change of the values when one of n runs is left out.
    fn jackknife(&self) -> Option<DMatrix<f64>> {
        let (runs, own) = (self.fitted.observed.runs.len(), self.fitted.free.len());
        let mut sum = DMatrix::zeros(own, own);
        for run in 0..runs {
            let change = self.own(&self.errors.fit(&self.together(), Some(run))).1;
            sum += &change * change.transpose();
        }
        (runs > 1).then(|| sum * ((runs - 1) as f64 / runs as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::fitted;
    use super::*;

    /// BIC - AICc = k ln n - 2kn/(n - k - 1), here solved for k: the model's values, those of the reference and the sizes of the noise.
    #[test]
    fn criteria_count_everything_that_was_fitted_and_a_right_model_leaves_residuals_of_one() {
        let reference = |parameter| ("reference_noise", parameter, 2e-3);
        let alone = Alone::new(fitted(&["position_sd_m", "heading_sd_rad"].map(reference)));
        let (aicc, bic, residual) = alone.criteria();
        let (n, numbers) = (alone.system.rows as f64, alone.fitted.free.len() + alone.fitted.reference[0].len());
        let k = (numbers + Noise::SIZES) as f64;
        assert!((bic - aicc - (k * n.ln() - 2.0 * k * n / (n - k - 1.0))).abs() < 1e-6 * n, "{aicc} {bic}");
        assert!((residual - 1.0).abs() < 0.05, "{residual}");
        // Minus twice the logarithm of the likelihood.
        let runs = alone.fitted.observed.runs.iter().zip(&alone.columns);
        let scales = runs.map(|(run, columns)| alone.fitted.noise.whiten(run, &[&columns[numbers]]).log_scale);
        let deviance = 2.0 * scales.sum::<f64>() + n * residual * residual;
        assert!((bic - k * n.ln() - deviance).abs() < 1e-6 * n, "{bic} {deviance}");
    }

    /// Oracle: singular values of all whitened rows of the other runs, the columns of the reference beside the model's own.
    #[test]
    fn runs_left_out_are_predicted_by_values_that_were_fitted_together_with_those_of_the_reference() {
        let alone = Alone::new(fitted(&[("reference_delay", "delay_s", 0.03), ("marker_offset", "left_m", 0.02)]));
        let (residual, own) = (alone.system.residual(), alone.fitted.free.len());
        assert!(residual > own);
        let without = |left_out: usize| {
            let (mut rows, mut heights) = (Vec::new(), Vec::new());
            let runs = alone.fitted.observed.runs.iter().zip(&alone.columns).enumerate();
            for (_, (run, columns)) in runs.filter(|(index, _)| *index != left_out) {
                let columns: Vec<&[[f64; 3]]> = columns.iter().map(Vec::as_slice).collect();
                for row in alone.fitted.noise.whiten(run, &columns).rows() {
                    rows.extend_from_slice(&row[..residual]);
                    heights.push(row[residual]);
                }
            }
            let system = DMatrix::from_row_slice(heights.len(), residual, &rows);
            let values = system.svd(true, true).solve(&DVector::from_vec(heights), 0.0).unwrap();
            ((0..own).collect(), values.rows(0, own).into_owned())
        };
        let expected = alone.errors.misses(without);
        let found = alone.left_out(Weighing::Increments);
        assert!((found.position / expected.position - 1.0).abs() < 1e-6, "{found:?} {expected:?}");
        assert!((found.white / expected.white - 1.0).abs() < 1e-6, "{found:?} {expected:?}");
    }

    #[test]
    fn whole_tracks_are_weighed_where_they_predict_runs_left_out_better_by_a_tenth() {
        for effects in [&[][..], &[("floor_slope", "drift_x", 6e-3)]] {
            let alone = Alone::new(fitted(effects));
            let [increments, tracks] = [Weighing::Increments, Weighing::Tracks].map(|by| alone.left_out(by).position);
            assert_eq!(alone.weighing() == Weighing::Tracks, tracks < 0.9 * increments, "{tracks} {increments}");
        }
    }
}
