//! Effects of the user's own, from the simulator to the fit.

#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;
use umbmark_core::compare::compare;
use umbmark_core::dataset::{Dataset, ModelFile, Run};
use umbmark_core::diagnose::{Options, diagnose};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Formula, Model, Target, TestKind};
use umbmark_core::engine::Update;
use umbmark_core::learn::{Fit, fit};
use umbmark_core::monte_carlo::{Metric, Study};
use umbmark_core::path::{Direction, Path};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

/// A carpet, with the example's own numbers: a size and a shape.
const NAP: &str = "k * sin(heading - h0)";

fn model(text: &str, values: &[(&str, f64)]) -> Model {
    let (names, values): (Vec<&str>, Vec<f64>) = values.iter().copied().unzip();
    let mut model = Model::new(&Robot::labmate());
    let formula = Formula::new("nap", Target::HeadingPerMetre, text, &names).unwrap();
    model.add_formula(formula, &values).unwrap().free = true;
    model
}

/// Four runs each way round the paper's square under `truth` and some wheel noise, with their tracks or without.
fn driven(mut truth: Model, tracked: bool) -> Dataset {
    let (robot, path) = (truth.robot().clone(), Path::umbmark());
    truth.set("wheel_noise", "k_sqrt_m", 5e-5).unwrap();
    let odometry = Odometry::Sampled { rate: 50.0, update: Update::Arc };
    let mut simulator = Simulator::new(&robot, &path, odometry, Phase::Random).unwrap();
    let mut truth = Truth::new(&truth);
    simulator.open(&mut truth, 5, 0);
    let mut runs = Vec::new();
    for direction in Direction::BOTH {
        for number in 1..=4 {
            let name = format!("{}_{number}", direction.name());
            let recorded = simulator.record(&mut truth, direction, TestKind::Systematic, [50.0, 10.0]).unwrap();
            let (log, returned) = (tracked.then_some(recorded.log), Some(recorded.returned));
            runs.push(Run { name, number, direction: Some(direction), test: TestKind::Systematic, log, returned });
        }
    }
    Dataset { robot: Some(robot), path: Some(path), runs, ..Dataset::default() }
}

#[test]
fn a_fit_finds_size_and_shape_of_a_formula_from_nothing_on_tracks_and_on_return_poses() {
    let truth = model(NAP, &[("k", 4e-3), ("h0", 0.7)]);
    for (tracked, most) in [(true, [2e-4, 0.03]), (false, [4e-4, 0.06])] {
        let data = driven(truth.clone(), tracked);
        let Fit { model: fitted, estimates, .. } = fit(&data, &model(NAP, &[("k", 0.0), ("h0", 0.5)])).unwrap();
        let found = ["k", "h0"].map(|name| fitted.get("nap", name).unwrap());
        assert!((found[0] - 4e-3).abs() < most[0] && (found[1] - 0.7).abs() < most[1], "{found:?}");
        for (estimate, true_value) in estimates.iter().zip([4e-3, 0.7]) {
            let off = (estimate.value - true_value) / estimate.standard_error;
            assert!(off.abs() < 4.0, "{estimate:?}");
        }
        assert_eq!(estimates.len(), 2);
        // What was written is what was fitted, and fits as well.
        let text = ModelFile::new(fitted.clone()).text();
        let read = ModelFile::parse("model.toml", &text, Some(&Robot::labmate())).unwrap().model;
        assert_eq!(read, fitted);
        let again = fit(&data, &read).unwrap().model;
        let moved = (again.get("nap", "k").unwrap() - found[0]) / estimates[0].standard_error;
        // Which weights are taken depends on the start; the values are the same within their error.
        assert!(moved.abs() < 1.0, "{moved} standard errors, {:?}", estimates[0]);
    }
}

#[test]
fn a_formula_that_explains_the_runs_is_told_so_and_nothing_is_missing() {
    let data = driven(model(NAP, &[("k", 4e-3), ("h0", 0.7)]), true);
    let start = model(NAP, &[("k", 1e-3), ("h0", 0.5)]);
    let diagnosis = diagnose(&data, &start, &Options::default()).unwrap();
    assert_eq!(diagnosis.certified().len(), 0, "{:?}", diagnosis.certified());
    let fitted = fit(&data, &start).unwrap().model;
    let models = [("nominal".into(), Model::new(&Robot::labmate())), ("nap".into(), fitted)];
    let judged = compare(&data, &models, &Options::default()).unwrap().models;
    assert!(!judged[0].explains(0.05) && judged[1].rmse < 0.3 * judged[0].rmse, "{judged:?}");
}

#[test]
fn whole_tests_under_a_formula_are_those_under_the_same_law_of_the_catalogue() {
    let mut listed = Model::new(&Robot::labmate());
    listed.set("floor_slope_yaw", "cosine_rad_per_m", 2e-3).unwrap();
    listed.set("floor_slope_yaw", "sine_rad_per_m", -1e-3).unwrap();
    let own = model("c * cos(heading) + s * sin(heading)", &[("c", 2e-3), ("s", -1e-3)]);
    let mean = |mut model: Model| {
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        let ensemble = Study::new(model, 50, 3).run(|_| ControlFlow::Continue(())).unwrap();
        [Metric::EMaxSys, Metric::CentroidCwY, Metric::ReturnHeadingCcw].map(|m| ensemble.get(m).unwrap().mean())
    };
    for (own, listed) in mean(own).into_iter().zip(mean(listed)) {
        // Means are sums of whole numbers of 2^-32 m.
        assert!((own - listed).abs() < 1e-9, "{own} {listed}");
    }
}

#[test]
fn a_formula_that_breaks_down_on_the_way_is_refused_before_anything_is_computed() {
    let mut broken = Model::new(&Robot::labmate());
    let formula = Formula::new("slip", Target::ForwardScale, "k / since_turn", &["k"]).unwrap();
    broken.add_formula(formula, &[1e-4]).unwrap().free = true;
    let said = "slip: \"k / since_turn\", or its derivative, is not finite";
    let begins = |error: String| assert!(error.starts_with(said), "{error}");
    begins(Study::new(broken.clone(), 10, 1).run(|_| ControlFlow::Continue(())).unwrap_err().to_string());
    for tracked in [true, false] {
        let data = driven(Model::new(&Robot::labmate()), tracked);
        begins(fit(&data, &broken).unwrap_err().to_string());
        begins(diagnose(&data, &broken, &Options::default()).unwrap_err().to_string());
        begins(compare(&data, &[("slip".into(), broken.clone())], &Options::default()).unwrap_err().to_string());
    }
}
