//! Intervals of thresholds by the ratio of likelihoods.
//!
//! An interval by standard errors takes the logarithm of the likelihood for a parabola. By a threshold below the speeds that were driven it is
//! none: towards zero it falls more slowly than near its maximum, and what goes with the threshold (E_s) seems surer than it is. No threshold
//! is farther from zero, in standard errors, than the square root of the deviance that a fit without it leaves more.

use super::Alone;
use crate::effect::ModelError;
use crate::evidence::Evidence;
use crate::likelihood::Fitted;
use nalgebra::DVector;

/// A fit whose shapes are no surer to differ from zero than the likelihood of a fit with zero in their place.
///
/// Of a shape θ that is more than two standard errors from zero, with deviance D(θ), the standard error is at least |θ| / √(D(0) - D(θ)), and
/// |θ| where that is more. The other values differ by d per unit of θ between both fits: their covariance, given θ, is kept, and that of θ is
/// handed on along d.
pub(crate) fn no_surer(mut fitted: Fitted) -> Result<Fitted, ModelError> {
    let values: Vec<f64> = fitted.model.values().collect();
    for own in 0..fitted.free.len() {
        let place = fitted.free[own];
        let (value, Some(covariance)) = (values[place], &fitted.covariance) else { continue };
        let variance = covariance[(own, own)];
        let is_sure = value * value > SURE * SURE * variance;
        if fitted.usual_noise || !is_sure || fitted.model.usual_shape(place).is_none() {
            continue;
        }
        let Some(nothing) = without(&fitted, place) else { continue };
        let more = Alone::new(nothing.clone()).deviance() - Alone::new(fitted.clone()).deviance();
        let least = value * value / more.max(1.0);
        if least <= variance {
            continue;
        }
        let at_zero: Vec<f64> = nothing.model.values().collect();
        let along = fitted.free.iter().map(|place| (values[*place] - at_zero[*place]) / value);
        let along = DVector::from_iterator(fitted.free.len(), along);
        let column = covariance.column(own).into_owned();
        let mut wider = covariance.clone();
        wider.ger(-1.0 / variance, &column, &column, 1.0);
        wider.ger(least, &along, &along, 1.0);
        fitted.covariance = Some(wider);
    }
    Ok(fitted)
}

/// A shape is said to differ from zero where it is more than this many standard errors from it.
const SURE: f64 = 2.0;

/// The same fit with zero in place of a value, under the same noise; `None` where it cannot be zero, or where nothing of its effect is left then.
fn without(fitted: &Fitted, place: usize) -> Option<Fitted> {
    let model = fitted.model.with_values(&[place], &[0.0]).ok()?;
    fitted.observed.check(&model).ok()?;
    let free: Vec<usize> = fitted.free.iter().copied().filter(|own| *own != place).collect();
    let moving = fitted.observed.free_values(&model);
    if !free.iter().all(|own| moving.contains(own)) {
        return None;
    }
    let mut nothing = Fitted { observed: fitted.observed.along(&model), model, free, ..fitted.clone() };
    nothing.refit().ok()?;
    Some(nothing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::first_model;
    use crate::diagnose::tests::robot_with;
    use crate::drive::Robot;
    use crate::evidence::Estimate;
    use crate::evidence::tracks::{estimates, fit};
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched;

    const THRESHOLD: (&str, &str) = ("missed_counts", "threshold_m_s");
    const E_S: (&str, &str) = ("scale", "e_s");

    /// Counts missed above a threshold, fitted, and the same without it by a fit of its own.
    fn fitted(threshold: f64, seed: u64) -> [Fitted; 2] {
        let noise = ["position_sd_m", "heading_sd_rad"].map(|parameter| ("reference_noise", parameter, 2e-3));
        let missed = [("left_s_per_m", 0.3), ("right_s_per_m", 0.4)].map(|(name, k)| (THRESHOLD.0, name, k));
        let truth = robot_with(&[noise[0], noise[1], missed[0], missed[1], (THRESHOLD.0, THRESHOLD.1, threshold)]);
        let data = watched(&truth, 2, seed);
        let mut model = first_model(&data).unwrap();
        ["scale", THRESHOLD.0].iter().for_each(|effect| model.add(effect).unwrap().free = true);
        let observed = Observed::new(&data, &Robot::labmate()).unwrap();
        let with = fit(&observed, &model).unwrap();
        model.set(THRESHOLD.0, THRESHOLD.1, 0.0).unwrap();
        model.fix(THRESHOLD.0, THRESHOLD.1).unwrap();
        [with, fit(&observed, &model).unwrap()]
    }

    fn own(fitted: &Fitted, (effect, parameter): (&str, &str)) -> Estimate {
        estimates(fitted).into_iter().find(|own| (own.effect, own.parameter) == (effect, parameter)).unwrap()
    }

    /// Oracle: both fits by themselves, each with its own noise, from a covariance that claims to be 20 times as sure.
    #[test]
    fn a_threshold_and_what_goes_with_it_are_no_surer_than_the_ratio_of_likelihoods_says() {
        for (threshold, seed) in [(0.02, 1), (0.1, 4)] {
            let [with, zero] = fitted(threshold, seed);
            let sure = Fitted { covariance: with.covariance.clone().map(|own| own / 400.0), ..with.clone() };
            let more = Alone::new(zero.clone()).deviance() - Alone::new(with).deviance();
            let ours = no_surer(sure.clone()).unwrap();
            let [shape, e_s] = [THRESHOLD, E_S].map(|number| own(&ours, number));
            let apart = (shape.value / shape.standard_error).powi(2);
            assert!(apart < own(&sure, THRESHOLD).value.powi(2) / own(&sure, THRESHOLD).standard_error.powi(2));
            assert!((apart / more.max(1.0) - 1.0).abs() < 0.2, "{threshold}: {apart} {more}");
            // With its own scatter, E_s is no farther from that without a threshold than the threshold is from zero.
            let off = (e_s.value - own(&zero, E_S).value) / e_s.standard_error;
            assert!(off * off < 1.1 * apart, "{threshold}: {off} {apart}");
            assert!(ours.covariance.unwrap().cholesky().is_some());
        }
    }

    #[test]
    fn a_threshold_that_may_be_zero_keeps_its_interval() {
        let [with, _] = fitted(0.02, 1);
        let sure = (own(&with, THRESHOLD).value / own(&with, THRESHOLD).standard_error).abs();
        assert!(sure < SURE, "{sure}");
        assert_eq!(no_surer(with.clone()).unwrap().covariance, with.covariance);
    }
}
