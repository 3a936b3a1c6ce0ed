//! A model fitted to evidence, and how sure its numbers are.

use super::{AnyEvidence, Ends, Evidence, FitError, Level, robot_of};
use crate::dataset::Dataset;
use crate::effect::Model;
use crate::likelihood::{Ended, Knowledge, KnownNumber, Noise, Outlier, Taken};
use crate::setup::Setup;
use crate::stats::{Interval, student_t_quantile};
use nalgebra::DMatrix;
use std::sync::Arc;

/// A number of an effect with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The effect.
    pub effect: &'static str,
    /// The parameter, as in files: its unit stands in the name.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// ν of Student's t for its interval.
    pub degrees_of_freedom: f64,
}

impl Estimate {
    /// Its interval with probability `level`, Student's t; `None` where it is not finite.
    pub fn interval(&self, level: f64) -> Option<Interval> {
        let half = student_t_quantile(0.5 + 0.5 * level, self.degrees_of_freedom) * self.standard_error;
        half.is_finite().then(|| Interval::around(self.value, half))
    }
}

/// A model with its free parameters fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// What was fitted.
    pub estimates: Vec<Estimate>,
    /// Their correlations, a row each; empty where the data does not determine them.
    pub correlations: Vec<Vec<f64>>,
    /// The sizes of the noise under which the runs are likeliest; from tracks only.
    pub noise: Option<Noise>,
    /// Where runs were disturbed; the fit leaves these places out. From tracks only.
    pub outliers: Vec<Outlier>,
    /// Whether the values were fitted with noise of the usual sizes; see [`USUAL_NOISE`](crate::likelihood::USUAL_NOISE).
    pub usual_noise: bool,
    /// What was found of the experiment before the fit.
    pub setup: Arc<Setup>,
    /// The part of it that was added to the model.
    pub taken: Vec<Taken>,
    /// How the fit ended.
    pub ended: Ended,
    /// What it leaves.
    pub leaves: Leaves,
    /// What was known of some numbers besides the runs.
    pub knowledge: Arc<Knowledge>,
    /// Which of the model's [values](Model::values) ended at a bound.
    pub held: Vec<usize>,
    /// What the runs say without earlier measurements, where there were any.
    pub without_priors: Vec<Estimate>,
}

/// What a fit leaves, and its criteria.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leaves {
    /// Root mean square distance of observed from predicted positions \[m\].
    pub position: f64,
    /// The same of headings \[rad\]; `None` where none were measured.
    pub heading: Option<f64>,
    /// Σ r² of the residuals in units of their standard deviations, those of earlier measurements included; from tracks only.
    pub chi2: Option<f64>,
    /// How many residuals these are, those of the runs; from tracks only.
    pub residuals: Option<usize>,
    /// Akaike's criterion with its small-sample correction; `None` for too few runs.
    pub aicc: Option<f64>,
    /// Bayes' criterion; `None` for too few runs.
    pub bic: Option<f64>,
}

/// A number of which something was known before a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownBefore<'a> {
    /// What was known.
    pub number: &'a KnownNumber,
    /// Its value by the fit.
    pub value: f64,
    /// Whether it is held at a bound; it has no interval then.
    pub held: bool,
    /// How far the runs alone are from the earlier measurement, in standard deviations of the difference; `None` where they do not tell.
    pub contradiction: Option<f64>,
}

impl Fit {
    /// The numbers of which something was known before the fit.
    pub fn known(&self) -> impl Iterator<Item = KnownBefore<'_>> {
        self.knowledge.numbers().iter().filter_map(|number| {
            let KnownNumber { effect, parameter, known } = number;
            let value = self.model.get(effect, parameter)?;
            let held = self.model.place_of(effect, parameter).is_some_and(|place| self.held.contains(&place));
            let alone = self.without_priors.iter().find(|e| e.effect == effect && e.parameter == parameter);
            let contradiction = known
                .prior
                .zip(alone)
                .map(|(prior, alone)| (alone.value - prior.mean) / libm::hypot(alone.standard_error, prior.sd));
            let contradiction = contradiction.filter(|off| off.is_finite());
            Some(KnownBefore { number, value, held, contradiction })
        })
    }
}

/// Correlations from a covariance; none where it is not known.
pub(crate) fn correlations(covariance: Option<&DMatrix<f64>>) -> Vec<Vec<f64>> {
    let Some(c) = covariance.filter(|c| (0..c.nrows()).all(|i| c[(i, i)] > 0.0)) else { return Vec::new() };
    let of = |i: usize, j: usize| (c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt()).clamp(-1.0, 1.0);
    (0..c.nrows()).map(|i| (0..c.nrows()).map(|j| of(i, j)).collect()).collect()
}

/// Fits a model's free parameters to a dataset.
pub fn fit(data: &Dataset, model: &Model) -> Result<Fit, FitError> {
    fit_knowing(data, model, Knowledge::default())
}

/// [`fit`] within bounds, and with earlier measurements beside the runs.
pub fn fit_knowing(data: &Dataset, model: &Model, knowledge: Knowledge) -> Result<Fit, FitError> {
    model.check_robot(robot_of(data)?)?;
    knowledge.check(model)?;
    let mut evidence = AnyEvidence::of(data, Level::of(data))?;
    let bounds = knowledge.has_priors().then(|| knowledge.without_priors());
    evidence.know(knowledge);
    let mut fit = evidence.fit(model)?;
    if let Some(bounds) = bounds {
        evidence.know(bounds);
        // What the runs do not determine alone contradicts nothing.
        fit.without_priors = evidence.fit(model).map_or(Vec::new(), |alone| alone.estimates);
    }
    Ok(fit)
}

/// [`fit`] to the return poses alone, even where the runs were observed on the way.
pub fn fit_to_returns(data: &Dataset, model: &Model) -> Result<(Model, Vec<Estimate>), FitError> {
    let fit = Ends::new(data)?.fit(model)?;
    Ok((fit.model, fit.estimates))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::first_model;
    use crate::diagnose::tests::{robot_with, simulated};
    use crate::likelihood::KnowledgeError;
    use crate::likelihood::watched::watched;
    use crate::path::Path;
    use crate::random::Stream;

    const E_B: (&str, &str) = ("wheelbase", "e_b");

    fn estimate(fit: &Fit, (effect, parameter): (&str, &str)) -> Option<Estimate> {
        fit.estimates.iter().find(|e| (e.effect, e.parameter) == (effect, parameter)).cloned()
    }

    fn knowing(data: &Dataset, know: impl Fn(&mut Knowledge) -> Result<(), KnowledgeError>) -> Result<Fit, FitError> {
        let mut knowledge = Knowledge::default();
        know(&mut knowledge)?;
        fit_knowing(data, &first_model(data).unwrap(), knowledge)
    }

    /// Oracle: the mean of the fit without it and of the measurement, weighted by their information. Of tracks the noise is fitted too, and hardly
    /// changes.
    #[test]
    fn an_earlier_measurement_is_weighed_against_what_the_runs_say() {
        let noise = [("reference_noise", "position_sd_m", 1e-3), ("wheel_noise", "k_sqrt_m", 2e-4)];
        let truth = robot_with(&[noise[0], noise[1], ("wheelbase", "e_b", 1.01)]);
        let of_returns = simulated(&truth, &Path::umbmark(), 5, 3, 0..1).remove(0);
        for data in [watched(&truth, 3, 4), of_returns] {
            let alone = estimate(&fit(&data, &first_model(&data).unwrap()).unwrap(), E_B).unwrap();
            let sd = 0.5 * alone.standard_error;
            let mean = alone.value + 2.0 * alone.standard_error;
            let fit = knowing(&data, |knowledge| knowledge.measured(E_B.0, E_B.1, mean, sd)).unwrap();
            let both = estimate(&fit, E_B).unwrap();
            let (value, error) = (alone.value + 1.6 * alone.standard_error, 0.2_f64.sqrt() * alone.standard_error);
            // Scatter of returns has another shape than their weights.
            assert!((both.value - value).abs() < 0.2 * alone.standard_error, "{both:?} {alone:?}");
            assert!((both.standard_error / error - 1.0).abs() < 0.1, "{both:?} {alone:?}");
            // 2 standard errors from it, of sqrt(1 + 1/4) of them.
            let [known] = &fit.known().collect::<Vec<_>>()[..] else { panic!() };
            let off = known.contradiction.unwrap();
            assert!(!known.held && (off + 2.0 / 1.25_f64.sqrt()).abs() < 0.2, "{off}");
        }
    }

    /// Measurements are drawn about the truth. 95 % of 400 sets, within 2.7 standard deviations of that share.
    #[test]
    fn intervals_with_an_earlier_measurement_hold_as_often_as_they_say() {
        let truth = robot_with(&[("wheelbase", "e_b", 1.01), ("wheel_noise", "k_sqrt_m", 1e-3)]);
        let (sets, sd) = (400, 1e-3);
        let mut random = Stream::new(5, 0, 0);
        let data = simulated(&truth, &Path::umbmark(), 5, 17, 0..sets);
        let held = data.iter().filter(|data| {
            let mean = 1.01 + sd * random.normal();
            let fit = knowing(data, |knowledge| knowledge.measured(E_B.0, E_B.1, mean, sd)).unwrap();
            estimate(&fit, E_B).unwrap().interval(0.95).unwrap().contains(1.01)
        });
        let share = held.count() as f64 / sets as f64;
        assert!((share - 0.95).abs() < 0.03, "{share}");
    }

    #[test]
    fn a_number_that_ends_at_a_bound_has_no_interval_and_the_others_are_fitted_with_it_there() {
        let noise = [("reference_noise", "position_sd_m", 1e-3), ("wheel_noise", "k_sqrt_m", 2e-4)];
        let truth = robot_with(&[noise[0], noise[1], ("wheelbase", "e_b", 1.02)]);
        let of_returns = simulated(&truth, &Path::umbmark(), 5, 3, 0..1).remove(0);
        for data in [watched(&truth, 3, 4), of_returns] {
            let model = first_model(&data).unwrap();
            let mut fixed = model.clone();
            fixed.set(E_B.0, E_B.1, 1.01).unwrap();
            fixed.fix(E_B.0, E_B.1).unwrap();
            let [asked, wide] =
                [1.01, 1.5].map(|high| knowing(&data, |knowledge| knowledge.bound(E_B.0, E_B.1, 0.5, high)).unwrap());
            let e_d = |fit: &Fit| estimate(fit, ("wheel_diameter_ratio", "e_d")).unwrap();
            let (ours, theirs) = (e_d(&asked), e_d(&fit(&data, &fixed).unwrap()));
            assert_eq!((asked.model.get(E_B.0, E_B.1), estimate(&asked, E_B)), (Some(1.01), None));
            assert!(asked.known().all(|known| known.held) && wide.known().all(|known| !known.held));
            assert!((ours.value - theirs.value).abs() < 0.05 * theirs.standard_error, "{ours:?} {theirs:?}");
            assert!((ours.standard_error / theirs.standard_error - 1.0).abs() < 0.05, "{ours:?} {theirs:?}");
            let plain = fit(&data, &model).unwrap();
            let [ours, theirs] = [&wide, &plain].map(|fit| estimate(fit, E_B).unwrap());
            assert!((ours.value - theirs.value).abs() < 1e-3 * theirs.standard_error, "{ours:?} {theirs:?}");
        }
    }

    /// Return poses do not tell turns that slip by a share from E_b.
    #[test]
    fn what_the_runs_do_not_show_is_known_as_well_as_it_was_before() {
        let data = simulated(&robot_with(&[("wheel_noise", "k_sqrt_m", 1e-3)]), &Path::umbmark(), 5, 3, 0..1).remove(0);
        let mut model = first_model(&data).unwrap();
        model.add("turn_slip").unwrap().free = true;
        let without = fit(&data, &model).unwrap();
        let open = ("turn_slip", "share");
        assert_eq!(estimate(&without, open), None);
        // What is not shown is not held, though it stays at the bound, or beyond it.
        for (low, high) in [(0.0, 1.0), (0.1, 1.0)] {
            let mut knowledge = Knowledge::default();
            knowledge.bound(open.0, open.1, low, high).unwrap();
            let bounded = fit_knowing(&data, &model, knowledge).unwrap();
            assert!(bounded.known().all(|known| !known.held && known.value == 0.0));
        }
        let mut knowledge = Knowledge::default();
        knowledge.measured(open.0, open.1, 0.01, 1e-5).unwrap();
        let with = estimate(&fit_knowing(&data, &model, knowledge).unwrap(), open).unwrap();
        assert!((with.value - 0.01).abs() < 1e-5 && (with.standard_error / 1e-5 - 1.0).abs() < 0.01, "{with:?}");
    }

    #[test]
    fn knowledge_that_means_nothing_is_refused_with_the_reason() {
        let truth = robot_with(&[("wheel_noise", "k_sqrt_m", 1e-3)]);
        let data = simulated(&truth, &Path::umbmark(), 5, 3, 0..1).remove(0);
        let said =
            |know: fn(&mut Knowledge) -> Result<(), KnowledgeError>| knowing(&data, know).unwrap_err().to_string();
        assert_eq!(
            said(|knowledge| knowledge.bound(E_B.0, E_B.1, 1.1, 0.9)),
            "the bounds of wheelbase.e_b must be LOW and HIGH with LOW < HIGH, got 1.1 and 0.9"
        );
        assert!(said(|knowledge| knowledge.bound(E_B.0, E_B.1, f64::NAN, 0.9)).contains("got NaN and 0.9"));
        assert!(
            said(|knowledge| knowledge.measured(E_B.0, E_B.1, 1.0, 0.0))
                .contains("a standard deviation above 0, got 1 and 0")
        );
        assert!(
            said(|knowledge| knowledge.measured("scale", "e_s", 1.0, 0.1))
                .contains("the model lacks its effect; add it")
        );
        assert!(said(|knowledge| knowledge.bound("wheelbase", "e_d", 0.9, 1.1)).contains("wheelbase has no parameter"));
        let few = simulated(&truth, &Path::umbmark(), 1, 3, 0..1).remove(0);
        let refused = knowing(&few, |knowledge| knowledge.measured(E_B.0, E_B.1, 1.0, 0.1)).unwrap_err();
        assert_eq!(refused, FitError::Knowledge(KnowledgeError::NoScatter));
    }

    #[test]
    fn correlations_have_ones_on_the_diagonal_and_need_a_covariance() {
        let covariance = DMatrix::from_row_slice(2, 2, &[4.0, -1.0, -1.0, 1.0]);
        assert_eq!(correlations(Some(&covariance)), [[1.0, -0.5], [-0.5, 1.0]]);
        assert!(correlations(None).is_empty());
        assert!(correlations(Some(&DMatrix::from_element(1, 1, f64::NAN))).is_empty());
    }
}
