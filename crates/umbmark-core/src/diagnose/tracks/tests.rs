//! Diagnoses of simulated tracks, whose cause is known.

use super::*;
use crate::diagnose::first_model;
use crate::diagnose::tests::robot_with;
use crate::drive::Robot;
use crate::effect::{Formula, Model, Target};
use crate::likelihood::watched::watched;
use std::sync::LazyLock;

/// The first model fitted to three squares each way of a robot like the paper's, with more causes.
pub(super) fn fitted(effects: &[(&str, &str, f64)]) -> Fitted {
    fitted_to(&robot_with(effects))
}

/// What a complete model is asked.
pub(super) fn complete() -> &'static Examination {
    static EXAMINATION: LazyLock<Examination> = LazyLock::new(|| Examination::new(fitted(&[])).unwrap());
    &EXAMINATION
}

fn fitted_to(truth: &Model) -> Fitted {
    let data = watched(truth, 3, 5);
    let observed = Observed::new(&data, &Robot::labmate()).unwrap();
    fit(&observed, &first_model(&data).unwrap()).unwrap()
}

#[test]
fn a_slope_that_is_hidden_in_tracks_is_certified_with_its_size() {
    let diagnosis = diagnose(fitted(&[("floor_slope", "drift_x", 6e-3)]), &Options::default()).unwrap();
    assert_eq!((diagnosis.verdict, diagnosis.certified), (Verdict::MissingEffect, 1));
    let found = &diagnosis.ranking[0];
    assert_eq!((found.best, &found.class[..]), ("floor_slope", &["floor_slope", "carpet_nap"][..]));
    assert!(found.p < 1e-20 && found.p_adjusted < 1e-3, "{found:?}");
    for estimate in &found.estimate {
        let truth = if estimate.parameter == "drift_x" { 6e-3 } else { 0.0 };
        assert!((estimate.value - truth).abs() < 6e-5, "{estimate:?}");
    }
    assert!(diagnosis.dependence.is_none());
    // A body that crabs and a marker that is turned are the same to a track, and so are slip and a wheelbase in turns of one speed.
    let absorbed = |name| diagnosis.invisible.iter().find(|unseen| unseen.effect == name).unwrap().why.clone();
    assert_eq!(absorbed("crab"), Why::Absorbed(vec!["marker_yaw"]));
    assert_eq!(absorbed("turn_slip"), Why::Absorbed(vec!["wheelbase"]));
}

#[test]
fn of_a_complete_model_nothing_is_said_to_be_missing() {
    let diagnosis = diagnose(fitted(&[]), &Options::default()).unwrap();
    assert_eq!((diagnosis.verdict, diagnosis.certified), (Verdict::Explained, 0));
    assert!(diagnosis.dependence.is_none() && diagnosis.ranking[0].p_adjusted > 0.05, "{:?}", diagnosis.ranking[0]);
}

/// A floor that turns the robot one way along two sides of the square and the other way along the others.
#[test]
fn what_no_effect_does_is_told_as_unlisted_with_its_curve_and_a_formula() {
    let mut truth = robot_with(&[]);
    let law = Formula::new("grain", Target::HeadingPerMetre, "k * cos(2 * heading)", &["k"]).unwrap();
    truth.add_formula(law, &[0.02]).unwrap();
    let diagnosis = diagnose(fitted_to(&truth), &Options::default()).unwrap();
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
