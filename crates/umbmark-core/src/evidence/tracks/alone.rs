//! A fitted model by itself: its errors, in the runs it was fitted to and in runs left out, and its criteria.

use super::errors::{Errors, Misses};
use super::system::{Projected, System, Unit};
use crate::dataset::Levels;
use crate::effect::ModelError;
use crate::evidence::Leaves;
use crate::likelihood::{Column, Fitted, Noise};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// With fewer folds it cannot be decided which of two fits predicts better.
const FEWEST_FOLDS: usize = 6;
/// The values fitted with usual noise are used if they predict held-out runs better by this share.
const NEARER: f64 = 0.1;

/// Some runs determine a number if they hold this share of the information that all runs have of it.
const TOLD: f64 = 0.1;

/// How well runs are predicted by those of other levels of a condition.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elsewhere {
    /// Errors of the runs of each level, the model fitted to those of the others.
    pub misses: Misses,
    /// Effects that runs of one level alone tell, with that level: for its runs they are taken to do nothing.
    pub only: Vec<(&'static str, usize)>,
}

/// A fitted model, its residuals, and the columns of its free values and of the effects of the reference that are fitted along.
#[derive(Clone)]
pub(crate) struct Alone {
    fitted: Fitted,
    columns: Vec<Vec<Column>>,
    system: System,
    /// If the values were fitted with noise of the usual sizes: the products of columns for that fit.
    usual: Option<System>,
    errors: Errors,
}

impl Alone {
    /// A model as it was fitted.
    pub fn new(fitted: Fitted) -> Alone {
        let (observed, columns) = (&fitted.observed, fitted.all_columns());
        let of_noise = |noise: &Noise| System::new(observed, noise, &columns).with_priors(&fitted.priors());
        let system = of_noise(&fitted.noise);
        let usual = fitted.usual_noise.then(|| of_noise(&Noise::default()));
        // These are the errors that any user of the model gets: a run restarts where its track jumps, but not at the smaller outliers of
        // this fit.
        let which = (0..system.width).collect();
        let disturbed = observed.runs.iter().flat_map(|run| &run.blocks).any(|block| block.afresh && !block.jumped);
        let errors = if disturbed || observed.runs.iter().any(|run| run.linear) {
            let (whole, chain) = (observed.whole().along(&fitted.model), fitted.model.chain());
            let mut columns = columns.clone();
            for (run, columns) in whole.runs.iter().zip(&mut columns) {
                columns[system.residual()] = run.residuals_along(&chain);
            }
            Errors::new(&whole, &system, &columns, which)
        } else {
            Errors::new(observed, &system, &columns, which)
        };
        Alone { fitted, columns, system, usual, errors }
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

    /// What was fitted.
    pub fn fitted(&self) -> &Fitted {
        &self.fitted
    }

    /// What was fitted, by itself.
    pub fn into_fitted(self) -> Fitted {
        self.fitted
    }

    /// Errors of held-out runs, with the model fitted to the others.
    pub fn left_out(&self) -> Misses {
        let fitted_by = self.usual.as_ref().unwrap_or(&self.system);
        self.errors.misses(|fold| self.own(&Projected::fit(&fitted_by.without(fold), &self.together())))
    }

    /// Errors in the fitted runs and in held-out runs.
    pub fn misses(&self) -> (Misses, Misses) {
        (self.errors.in_sample(), self.left_out())
    }

    /// Errors of the runs of each level of a condition, with the model fitted to those of the other levels.
    pub fn elsewhere(&self, levels: &Levels) -> Elsewhere {
        let system = self.usual.as_ref().unwrap_or(&self.system);
        let level_of = |unit: &Unit| levels.of_run(&self.fitted.observed.runs[unit.run].log);
        let without = |level: usize| {
            let mut products = DMatrix::zeros(system.width, system.width);
            let others = system.units.iter().filter(|unit| level_of(unit) != Some(level));
            others.for_each(|unit| products += &unit.white);
            self.fitted_to(system, products)
        };
        let by_level: Vec<_> = (0..levels.levels.len()).into_par_iter().map(without).collect();
        let misses = self.errors.misses(|fold| match system.of_fold(fold).find_map(level_of) {
            Some(level) => by_level[level].0.clone(),
            None => self.own(&Projected::fit(&system.without(fold), &self.together())),
        });
        let of_level = |(level, (_, untold)): (usize, &(_, Vec<&'static str>))| {
            untold.iter().map(move |effect| (*effect, level)).collect::<Vec<_>>()
        };
        Elsewhere { misses, only: by_level.iter().enumerate().flat_map(of_level).collect() }
    }

    /// The columns that products of some runs determine, those of the reference first, and those of the model that they do not.
    fn told_by(&self, system: &System, products: &DMatrix<f64>) -> (Vec<usize>, Vec<usize>) {
        let (own, residual) = (self.fitted.free.len(), system.residual());
        let (mut told, mut untold): (Vec<usize>, Vec<usize>) = ((own..residual).collect(), Vec::new());
        for column in 0..own {
            let left = |products: &DMatrix<f64>| Projected::new(products, &told).products[(column, column)];
            let is_told = left(products) >= TOLD * left(&system.whole);
            if is_told { told.push(column) } else { untold.push(column) }
        }
        (told, untold)
    }

    /// Whether every number of the model is determined without any one of the folds.
    pub fn is_told_without_any_fold(&self) -> bool {
        let system = self.usual.as_ref().unwrap_or(&self.system);
        (0..system.folds()).into_par_iter().all(|fold| self.told_by(system, &system.without(fold)).1.is_empty())
    }

    /// The model's own values by products of some runs, and the effects of which these say next to nothing: they are taken to do nothing, and
    /// what they explain falls to the others.
    fn fitted_to(
        &self,
        system: &System,
        mut products: DMatrix<f64>,
    ) -> ((Vec<usize>, DVector<f64>), Vec<&'static str>) {
        let (own, residual) = (self.fitted.free.len(), system.residual());
        let (told, untold) = self.told_by(system, &products);
        for column in &untold {
            let added = products.column(residual) + products.column(*column) * self.fitted.departure(*column);
            products.set_column(residual, &added);
        }
        let values = Projected::fit(&products, &told);
        let fitted = told.iter().copied().zip(values.iter().copied()).filter(|(column, _)| *column < own);
        let nothing = untold.iter().map(|column| (*column, -self.fitted.departure(*column)));
        let (columns, values): (Vec<usize>, Vec<f64>) = fitted.chain(nothing).unzip();
        let is_size = |column: &&usize| self.fitted.model.nothing(self.fitted.free[**column]).is_some();
        let mut effects: Vec<&'static str> = untold.iter().filter(is_size).map(|column| self.effect(*column)).collect();
        effects.dedup();
        ((columns, DVector::from_vec(values)), effects)
    }

    /// The effect that a free value belongs to.
    fn effect(&self, column: usize) -> &'static str {
        let parts = self.fitted.model.parts().iter();
        let mut names = parts.flat_map(|part| part.values.iter().map(move |_| part.effect.name()));
        names.nth(self.fitted.free[column]).unwrap_or_default()
    }

    /// The model's own values, fitted without each fold in turn.
    fn by_fold(&self) -> Vec<DVector<f64>> {
        let values: Vec<f64> = self.fitted.model.values().collect();
        let now = DVector::from_iterator(self.fitted.free.len(), self.fitted.free.iter().map(|place| values[*place]));
        let of = |fold| &now + self.own(&Projected::fit(&self.system.without(fold), &self.together())).1;
        (0..self.system.folds()).into_par_iter().map(of).collect()
    }

    /// What the model leaves of the runs it was fitted to.
    pub fn leaves(&self) -> Leaves {
        let (aicc, bic, root) = self.criteria();
        let (rows, Misses { position, heading, .. }) = (self.system.rows, self.errors.in_sample());
        let chi2 = Some(root * root * rows as f64);
        Leaves { position, heading, chi2, residuals: Some(rows), aicc: Some(aicc), bic: Some(bic) }
    }

    /// AICc, BIC and the root mean square of the whitened residuals, the effects of the reference fitted out.
    pub fn criteria(&self) -> (f64, f64, f64) {
        let (deviance, squares) = self.deviance_and_squares();
        let (n, k) = (self.system.rows as f64, (self.system.residual() + Noise::SIZES) as f64);
        let aicc = deviance + 2.0 * k * n / (n - k - 1.0).max(1.0);
        (aicc, deviance + k * libm::log(n), (squares / n).sqrt())
    }

    /// Minus twice the logarithm of the likelihood, but for a constant, the effects of the reference fitted out.
    pub fn deviance(&self) -> f64 {
        self.deviance_and_squares().0
    }

    /// The deviance, and the squares of the whitened residuals in it.
    fn deviance_and_squares(&self) -> (f64, f64) {
        let residual = self.system.residual();
        let runs = self.fitted.observed.runs.par_iter().zip(&self.columns);
        let scales = runs.map(|(run, columns)| self.fitted.noise.whiten(run, &[&columns[residual]]).log_scale);
        let scales: Vec<f64> = scales.collect();
        let reference: Vec<usize> = (self.fitted.free.len()..residual).collect();
        let squares = Projected::new(&self.system.whole, &reference).products[(residual, residual)];
        (2.0 * scales.iter().sum::<f64>() + squares, squares)
    }
}

/// Jackknife covariance (n - 1)/n Σ Δ Δᵀ: Δ is the deviation of one of n leave-one-fold-out values from their mean.
fn jackknife(values: &[DVector<f64>]) -> DMatrix<f64> {
    let n = values.len() as f64;
    let width = values.first().map_or(0, DVector::len);
    let mean = values.iter().fold(DVector::zeros(width), |sum, v| sum + v) / n;
    let sum = values.iter().fold(DMatrix::zeros(width, width), |sum, v| sum + (v - &mean) * (v - &mean).transpose());
    sum * ((n - 1.0) / n)
}

/// The covariance, with each variance raised to at least that of the maximum-likelihood values.
fn no_sharper(covariance: DMatrix<f64>, sharpest: &DMatrix<f64>) -> DMatrix<f64> {
    let wider = |k: usize| (sharpest[(k, k)] / covariance[(k, k)]).max(1.0).sqrt();
    let wider: Vec<f64> = (0..covariance.ncols()).map(wider).collect();
    DMatrix::from_fn(wider.len(), wider.len(), |i, j| covariance[(i, j)] * wider[i] * wider[j])
}

/// The fit that is reported: with the maximum-likelihood values, or with the values fitted with noise of the usual sizes if these predict
/// held-out runs better by a tenth.
///
/// If the model is complete, both are right and the maximum-likelihood values are more precise. If it is not, the fitted noise has absorbed
/// part of the missing effect, and the weights of the data are wrong. In that case the covariance is that of the jackknife over folds.
pub(crate) fn trusted(fitted: Fitted) -> Result<Alone, ModelError> {
    let likeliest = Alone::new(fitted);
    if likeliest.fitted.free.is_empty() || likeliest.system.folds() < FEWEST_FOLDS {
        return Ok(likeliest);
    }
    let mut usual = Fitted { noise: Noise::default(), ..likeliest.fitted.clone() };
    usual.refit()?;
    let other = Alone::new(usual.clone());
    let [left_out, by_likeliest] = [&other, &likeliest].map(|alone| alone.left_out().position);
    if left_out.is_nan() || left_out >= (1.0 - NEARER) * by_likeliest {
        return Ok(likeliest);
    }
    let covariance =
        likeliest.fitted.covariance.as_ref().map(|sharpest| no_sharper(jackknife(&other.by_fold()), sharpest));
    Ok(Alone::new(Fitted { covariance, usual_noise: true, noise: likeliest.fitted.noise, ..usual }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tracks::tests::fitted;
    use nalgebra::DMatrix;

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

    /// If the model lacks a caster kick, the fitted noise becomes too large, and the values fitted with usual noise predict held-out runs
    /// better by 18 %. With a missing leg kick, and with a complete model, they predict worse.
    #[test]
    fn values_under_usual_noise_are_taken_where_they_predict_runs_left_out_nearer_and_nowhere_else() {
        for (effects, taken) in [
            (&[("caster_kick", "kick_rad", 0.1)][..], true),
            (&[("leg_kick", "kick_rad", 0.1)][..], false),
            (&[][..], false),
        ] {
            let likeliest = fitted(effects);
            let mut usual = Fitted { noise: Noise::default(), ..likeliest.clone() };
            usual.refit().unwrap();
            let written = trusted(likeliest.clone()).unwrap();
            let expected = if taken { &usual } else { &likeliest };
            assert_eq!((written.fitted.usual_noise, &written.fitted.model), (taken, &expected.model), "{effects:?}");
            let [by_usual, by_likeliest] =
                [usual, likeliest.clone()].map(|fitted| Alone::new(fitted).left_out().position);
            assert_eq!(taken, by_usual < 0.9 * by_likeliest, "{effects:?}");
            assert!(!taken || (written.left_out().position / by_usual - 1.0).abs() < 1e-9, "{effects:?}");
            let [ours, sharpest] =
                [&written.fitted, &likeliest].map(|fitted| fitted.covariance.clone().unwrap().diagonal());
            assert!(
                ours.iter().zip(&sharpest).all(|(ours, sharpest)| *ours >= sharpest * (1.0 - 1e-12)),
                "{effects:?}"
            );
        }
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
        let found = alone.left_out();
        assert!((found.position / expected.position - 1.0).abs() < 1e-6, "{found:?} {expected:?}");
        assert!((found.white / expected.white - 1.0).abs() < 1e-6, "{found:?} {expected:?}");
    }
}
