//! Diagnoses of simulated tracks, whose cause is known.

use super::missing::{explains, speaks_on};
use super::*;
use crate::diagnose::first_model;
use crate::diagnose::tests::robot_with;
use crate::diagnose::unseen::Why;
use crate::drive::Robot;
use crate::effect::{Formula, Model, Target};
use crate::evidence::tracks::{Projected, estimates, fit};
use crate::likelihood::Fitted;
use crate::likelihood::watched::watched;
use nalgebra::DMatrix;
use std::sync::LazyLock;

/// The first model fitted to three squares each way of a robot like the paper's, with more causes.
pub(crate) fn fitted(effects: &[(&str, &str, f64)]) -> Fitted {
    fitted_to(&robot_with(effects))
}

/// What a complete model is asked.
pub(super) fn complete() -> &'static Examination {
    static EXAMINATION: LazyLock<Examination> = LazyLock::new(|| Examination::new(fitted(&[])).unwrap());
    &EXAMINATION
}

pub(super) fn fitted_to(truth: &Model) -> Fitted {
    let (observed, model) = observed(truth);
    fit(&observed, &model).unwrap()
}

/// Three squares each way, and the first model of them.
fn observed(truth: &Model) -> (Observed, Model) {
    let data = watched(truth, 3, 5);
    (Observed::new(&data, &Robot::labmate()).unwrap(), first_model(&data).unwrap())
}

fn diagnosed(truth: &Model) -> Diagnosis {
    let (observed, model) = observed(truth);
    diagnose(&observed, &model, &Options::default()).unwrap()
}

/// Seeds 3 to 8. Of 40 such sets simulated, 38 give the slope and no reason for doubt, and 3 something else besides, which is chance.
#[test]
fn a_slope_that_is_hidden_in_tracks_is_certified_with_its_size() {
    let sloping = robot_with(&[("floor_slope", "drift_x", 6e-3)]);
    let mut alone = Vec::new();
    for seed in 3..9 {
        let data = watched(&sloping, 3, seed);
        let observed = Observed::new(&data, &Robot::labmate()).unwrap();
        let mut model = first_model(&data).unwrap();
        let diagnosis = diagnose(&observed, &model, &Options::default()).unwrap();
        let found = &diagnosis.ranking[0];
        let mut class = found.class.clone();
        class.sort_unstable();
        assert_eq!(class, ["carpet_nap", "floor_slope"]);
        assert!(found.p < 1e-20 && found.p_adjusted < 1e-3, "{found:?}");
        model.add("floor_slope").unwrap().free = true;
        let fitted = estimates(&fit(&observed, &model).unwrap());
        let of_slope: Vec<_> = fitted.iter().filter(|estimate| estimate.effect == "floor_slope").collect();
        assert!(of_slope.iter().any(|estimate| estimate.parameter == "drift_x"));
        for estimate in of_slope {
            let truth = if estimate.parameter == "drift_x" { 6e-3 } else { 0.0 };
            assert!((estimate.value - truth).abs() < 1e-4, "{estimate:?}");
        }
        if (diagnosis.verdict, diagnosis.certified) == (Verdict::MissingEffect, 1) {
            alone.push(diagnosis);
        }
    }
    assert!(alone.len() >= 4, "{}", alone.len());
    let diagnosis = &alone[0];
    assert!(diagnosis.dependence.is_none());
    // A body that crabs and a marker that is turned are the same to a track, and so are slip and a wheelbase in turns of one speed.
    let absorbed = |name| diagnosis.invisible.iter().find(|unseen| unseen.effect == name).unwrap().why.clone();
    assert_eq!(absorbed("crab"), Why::Absorbed(vec!["marker_yaw"]));
    assert_eq!(absorbed("turn_slip"), Why::Absorbed(vec!["wheelbase"]));
}

#[test]
fn of_a_complete_model_nothing_is_said_to_be_missing() {
    let diagnosis = diagnosed(&robot_with(&[]));
    assert_eq!((diagnosis.verdict, diagnosis.certified), (Verdict::Explained, 0));
    assert!(diagnosis.dependence.is_none() && diagnosis.ranking[0].p_adjusted > 0.05, "{:?}", diagnosis.ranking[0]);
}

/// Oracle: standard errors by the inverse of the products of the columns, scaled to a unit diagonal.
#[test]
fn what_is_told_from_e_b_by_ramps_alone_widens_it_and_a_slope_widens_nothing() {
    let exam = complete();
    let columns = |effect: &str| {
        let mut groups = exam.asked.iter();
        groups.find(|group| group.effect().is_some_and(|e| e.about.name == effect)).unwrap().columns.clone()
    };
    let products = &exam.system.whole;
    let errors = |columns: &[usize]| {
        let length = |k: usize| products[(columns[k], columns[k])].sqrt();
        let of = |i: usize, j: usize| products[(columns[i], columns[j])] / (length(i) * length(j));
        let inverse = DMatrix::from_fn(columns.len(), columns.len(), of).try_inverse().unwrap();
        (0..exam.free.len()).map(|k| inverse[(k, k)].sqrt()).collect::<Vec<_>>()
    };
    let base = exam.base(None);
    for (effect, range) in [("turn_slip_rate", 2.0..f64::INFINITY), ("floor_slope", 1.0..1.2)] {
        let own = columns(effect);
        let (with, without) = (errors(&[&base[..], &own].concat()), errors(&base));
        let expected = with.iter().zip(&without).map(|(with, without)| with / without).fold(1.0, f64::max);
        let widening = exam.widening(&own);
        assert!((widening / expected - 1.0).abs() < 1e-3, "{effect}: {widening} {expected}");
        assert!(range.contains(&widening), "{effect}: {widening}");
    }
}

/// A robot on a floor that turns it one way along two sides of the square and the other way along the others.
pub(super) fn on_grain() -> Model {
    let mut truth = robot_with(&[]);
    let law = Formula::new("grain", Target::HeadingPerMetre, "k * cos(2 * heading)", &["k"]).unwrap();
    truth.add_formula(law, &[0.02]).unwrap();
    truth
}

#[test]
fn what_no_effect_does_is_told_as_unlisted_with_its_curve_and_a_formula() {
    let diagnosis = diagnosed(&on_grain());
    assert_eq!(diagnosis.verdict, Verdict::UnlistedEffect);
    let told = diagnosis.dependence.unwrap();
    assert_eq!((told.depends_on, told.acts_on, &*told.curve.unit), ("heading", "yaw", "rad/m"));
    let at = |heading: f64| told.curve.points.iter().find(|point| (point.at - heading).abs() < 1e-9).unwrap();
    for (heading, expected) in [(0.0, 0.02), (std::f64::consts::FRAC_PI_2, -0.02)] {
        assert!((at(heading).value - expected).abs() < 2e-3, "{:?}", at(heading));
    }
    let suggestion = told.suggestion.unwrap();
    assert!((suggestion.model.get("unlisted", "a").unwrap() - 0.02).abs() < 1e-3 && suggestion.share > 0.9);
}

/// Oracle: by how much the residual sum of squares falls when both are fitted out.
#[test]
fn an_effect_explains_a_smooth_whose_fall_beside_the_same_it_reaches_to_85_percent() {
    let options = Options::default();
    let exam = Examination::new(fitted(&[("floor_slope", "drift_x", 6e-3)])).unwrap();
    let (effects, smooths) = (significance::effects(&exam, &options), significance::smooths(&exam, &options));
    let residual = exam.system.residual();
    let left = |columns: &[usize]| Projected::new(&exam.system.whole, columns).products[(residual, residual)];
    for smooth in smooths.iter().take(5) {
        assert!(!explains(&exam, None, smooth));
        for effect in &effects {
            let with: Vec<usize> = effect.base().iter().chain(&smooth.answer.columns).copied().collect();
            let fall = left(effect.base()) - left(&with);
            for (share, expected) in [(0.84, false), (0.86, true)] {
                let mut other = effect.clone();
                other.answer.drop = share * fall;
                assert_eq!(explains(&exam, Some(&other), smooth), expected, "{share} of {fall}");
            }
        }
    }
}

#[test]
fn a_smooth_speaks_on_while_some_certified_one_still_brings_more_than_15_percent_of_what_it_brought() {
    let options = Options::default();
    let exam = Examination::new(fitted_to(&on_grain())).unwrap();
    let now = significance::smooths(&exam, &options).iter().filter(|smooth| smooth.certified(&options));
    let now = now.max_by(|a, b| a.answer.drop.total_cmp(&b.answer.drop)).unwrap();
    for (times, expected) in [(1.0, true), (6.6, true), (6.7, false)] {
        let mut before = now.clone();
        before.answer.drop *= times;
        assert_eq!(speaks_on(&exam, &before, &options), expected, "{times}");
    }
    // Of a complete model no smooth is certified, however little it once brought.
    let mut faint = now.clone();
    faint.answer.drop = 0.0;
    assert!(!speaks_on(complete(), &faint, &options));
}
