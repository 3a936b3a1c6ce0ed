//! Effects of the user's own, from the simulator to the fit.

use std::ops::ControlFlow;
use umbmark_core::compare::compare_returns;
use umbmark_core::dataset::{Dataset, Run, TickLog};
use umbmark_core::diagnose::{Options, diagnose};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Formula, Model, Target, TestKind};
use umbmark_core::engine::Update;
use umbmark_core::evidence::{Fit, fit};
use umbmark_core::geometry::{Pose2, seeded};
use umbmark_core::monte_carlo::{Metric, Study};
use umbmark_core::path::{CIRCLE, Direction, Move, Path, SQUARE, SpeedProfile};
use umbmark_core::replay::{Track, check_on_path};
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};
use umbmark_io::ModelFile;

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
    let judged = compare_returns(&data, &models, &Options::default()).unwrap().models;
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
        begins(
            compare_returns(&data, &[("slip".into(), broken.clone())], &Options::default()).unwrap_err().to_string(),
        );
    }
}

/// A model with one formula of any target.
fn acting(target: Target, text: &str, values: &[(&str, f64)]) -> Model {
    let (names, values): (Vec<&str>, Vec<f64>) = values.iter().copied().unzip();
    let mut model = Model::new(&Robot::labmate());
    model.add_formula(Formula::new("own", target, text, &names).unwrap(), &values).unwrap().free = true;
    model
}

fn gap(a: &Pose2, b: &Pose2) -> f64 {
    libm::hypot(a.x - b.x, a.y - b.y).max((a.heading - b.heading).abs())
}

/// Where a robot ends that goes through a path from `start` while its motion ahead is scaled by 1 + `ahead`(x, y) and it turns by
/// `turn`(x, y) per metre besides: the differential equation by Runge and Kutta's rule, a thousand steps a move.
fn integrated(
    path: &Path,
    direction: Direction,
    start: Pose2,
    ahead: impl Fn(f64, f64) -> f64,
    turn: impl Fn(f64, f64) -> f64,
) -> Pose2 {
    let mut state = [start.x, start.y, start.heading];
    for one in path.moves(direction) {
        let (length, rotation) = match one {
            Move::Straight { length } => (length, 0.0),
            Move::Turn { angle } => (0.0, angle),
            Move::Arc { radius, angle } => (radius * angle.abs(), angle),
            Move::Slide { .. } => panic!("a differential drive does not move sideways"),
        };
        let rate = |[x, y, heading]: [f64; 3]| {
            let way = length * (1.0 + ahead(x, y));
            [way * heading.cos(), way * heading.sin(), rotation + length.abs() * turn(x, y)]
        };
        let h = 1e-3;
        for _ in 0..1000 {
            let on = |by: f64, slope: [f64; 3]| [0, 1, 2].map(|i| state[i] + by * slope[i]);
            let a = rate(state);
            let b = rate(on(0.5 * h, a));
            let c = rate(on(0.5 * h, b));
            let d = rate(on(h, c));
            state = [0, 1, 2].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
    }
    Pose2::new(state[0], state[1], state[2])
}

/// Oracle: forward_scale = k x means dx/ds = 1 + k x, so x = (e^(ks) - 1)/k on a straight. On the square's second leg the scale is
/// 1 + k x = e^(kL), on the third x comes back to 0, and the fourth is as long as it should be: it ends (0, ±(e^(kL) - 1) L) away.
/// The middle of a piece of h = 1 cm is taken half of the motion ahead that the formula has not yet changed: k h/2 of the effect is off.
#[test]
fn a_scale_in_proportion_to_x_is_the_exponential_on_a_straight_and_opens_a_square() {
    for (k, direction) in
        [(0.02, Direction::Ccw), (0.02, Direction::Cw), (-0.05, Direction::Ccw), (-0.05, Direction::Cw)]
    {
        let model = acting(Target::ForwardScale, "k * x", &[("k", k)]);
        let (path, length) = (Path::umbmark(), 4.0);
        let most = 1.1 * (0.5 * k * 0.01 * k * length * length).abs();
        let stops = Track::with_stops(&path, direction, &Robot::labmate()).poses(&model.chain());
        assert!((stops[0].x - libm::expm1(k * length) / k).abs() < most, "{:?}", stops[0]);
        let off = direction.sign() * libm::expm1(k * length) * length;
        let end = Pose2::new(0.0, off, direction.sign() * std::f64::consts::TAU);
        assert!(gap(stops.last().unwrap(), &end) < most, "{:?} {end:?}", stops.last());
        // Driven: return errors are absolute less computed, and the odometry believes to be back.
        let mut simulator = Simulator::new(model.robot(), &path, Odometry::Continuous, Phase::Random).unwrap();
        let mut truth = Truth::new(&model);
        simulator.open(&mut truth, 1, 0);
        for _ in 0..2 {
            let returned = simulator.run(&mut truth, direction, TestKind::Systematic);
            assert!(returned.x.abs() < most && (returned.y - off).abs() < most, "{returned:?} {off}");
        }
    }
}

#[test]
fn laws_of_x_and_y_lead_where_their_differential_equation_does_from_any_start() {
    let square = Path::new(&SQUARE, &[1.5], SpeedProfile::default()).unwrap();
    let circle = Path::new(&CIRCLE, &[1.2, 1.0], SpeedProfile::default()).unwrap();
    let ahead = |x: f64, y: f64| 0.05 * x - 0.03 * y * y + 0.02 * (2.0 * x).sin();
    let turn = |x: f64, y: f64| 0.04 * y + 0.02 * x * y;
    let mut model =
        acting(Target::ForwardScale, "0.05 * x + q * y^2 + 0.02 * sin(2 * x / m)", &[("q", -0.03), ("m", 1.0)]);
    let yaw = Formula::new("yaw", Target::HeadingPerMetre, "a * y + b * x * y", &["a", "b"]).unwrap();
    model.add_formula(yaw, &[0.04, 0.02]).unwrap();
    for start in [Pose2::IDENTITY, Pose2::new(2.0, -1.0, 0.7), Pose2::new(-0.5, 1.5, -2.5)] {
        for (path, direction) in
            [&square, &circle].into_iter().flat_map(|path| Direction::BOTH.map(|direction| (path, direction)))
        {
            let expected = integrated(path, direction, start, ahead, turn);
            let track = Track::in_pieces(path, direction, &Robot::labmate());
            let end = track.clone().beginning_at(start).end(&model.chain());
            assert!(gap(&end, &expected) < 1e-3, "{start:?} {direction:?}: {end:?} {expected:?}");
            // It differs from a robot that is elsewhere.
            assert!(gap(&track.end(&model.chain()), &expected) > 1e-2 || start == Pose2::IDENTITY);
            let mut placed = model.clone();
            for (name, value) in [("x_m", start.x), ("y_m", start.y), ("heading_rad", start.heading)] {
                placed.set("start_pose", name, value).unwrap();
            }
            let mut simulator = Simulator::new(model.robot(), path, Odometry::Continuous, Phase::Random).unwrap();
            let mut truth = Truth::new(&placed);
            simulator.open(&mut truth, 1, 0);
            let returned = simulator.run(&mut truth, direction, TestKind::Systematic);
            let believed = path.end(direction);
            let driven = Pose2::new(returned.x + believed.x, returned.y + believed.y, expected.heading);
            assert!(gap(&driven, &expected) < 1e-3, "{start:?} {direction:?}: {driven:?} {expected:?}");
        }
    }
}

/// Recorded in pieces of 1 cm and of 1 mm: the middle is of first order, so what is off falls to a tenth.
#[test]
fn what_a_law_of_the_place_is_off_falls_with_the_length_of_the_pieces() {
    let (robot, start) = (Robot::labmate(), Pose2::new(2.0, -1.0, 0.7));
    let path = Path::new(&CIRCLE, &[1.2, 1.0], SpeedProfile::default()).unwrap();
    let mut model = acting(Target::ForwardScale, "k * x", &[("k", 0.05)]);
    model.add_formula(Formula::new("yaw", Target::HeadingPerMetre, "q * y", &["q"]).unwrap(), &[0.04]).unwrap();
    let expected = integrated(&path, Direction::Ccw, start, |x, _| 0.05 * x, |_, y| 0.04 * y);
    let travel = path.moves(Direction::Ccw)[0].wheel_travel(&robot.drive);
    let off = [754, 7540].map(|pieces: usize| {
        let ticks =
            |whole: f64, per_tick: f64| (0..=pieces).map(|k| whole * k as f64 / pieces as f64 / per_tick).collect();
        let per_tick = robot.metres_per_tick();
        let log = TickLog {
            time: (0..=pieces).map(|k| 60.0 * k as f64 / pieces as f64).collect(),
            left: ticks(travel.left, per_tick.left),
            right: ticks(travel.right, per_tick.right),
            ..TickLog::default()
        };
        gap(&Track::from_log(&log, &robot).unwrap().beginning_at(start).end(&model.chain()), &expected)
    });
    assert!(off[0] > 1e-5 && (off[0] / off[1] / 10.0 - 1.0).abs() < 0.05, "{off:?}");
}

#[test]
fn derivatives_through_the_place_are_those_of_finite_differences_from_a_start_off_the_origin() {
    for (target, text) in [
        (Target::ForwardScale, "k * x + q * y"),
        (Target::LeftWheelScale, "k * sin(x / q) * y / q"),
        (Target::TurnScale, "k * x * y / q^2"),
        (Target::SidewaysPerMetre, "k * exp(-(x^2 + y^2) / q^2) * cos(heading)"),
        (Target::HeadingPerSecond, "k * q * x / 5"),
    ] {
        let mut model = acting(target, text, &[("k", 0.05), ("q", 1.5)]);
        for (effect, parameter, value) in [
            ("wheelbase", "e_b", 1.02),
            ("start_pose", "x_m", 0.3),
            ("start_pose", "y_m", -0.2),
            ("start_pose", "heading_rad", 0.4),
        ] {
            model.set(effect, parameter, value).unwrap();
        }
        let values: Vec<f64> = model.values().collect();
        for direction in Direction::BOTH {
            let square = Path::new(&SQUARE, &[1.0], SpeedProfile::default()).unwrap();
            let track = Track::with_stops(&square, direction, model.robot()).beginning_at(Pose2::new(2.0, 1.0, -0.8));
            let mut told = 0;
            for i in 0..values.len() {
                let exact = track.poses(&model.chain_with(&seeded(values.iter().copied(), &[i])));
                let at = |step: f64| {
                    let mut moved = values.clone();
                    moved[i] += step;
                    track.poses(&model.chain_with(&moved))
                };
                let h = 1e-5;
                for (exact, (high, low)) in exact.iter().zip(at(h).iter().zip(at(-h))) {
                    let numeric = [high.x - low.x, high.y - low.y, high.heading - low.heading].map(|d| d / (2.0 * h));
                    let column = [exact.x, exact.y, exact.heading].map(|d| d.eps[0]);
                    told += usize::from(numeric.iter().any(|n| n.abs() > 1e-6));
                    for (c, n) in column.iter().zip(numeric) {
                        assert!((c - n).abs() < 1e-6 * (1.0 + n.abs()), "{text}, value {i}: {c} {n}");
                    }
                }
            }
            assert!(told > 30, "{told}");
        }
    }
}

#[test]
fn a_fit_finds_a_law_of_the_place_on_tracks_and_on_return_poses() {
    let law = |k: f64| acting(Target::HeadingPerMetre, "k * x + q * y", &[("k", k), ("q", -0.5 * k)]);
    for (tracked, most) in [(true, 2e-4), (false, 4e-4)] {
        let data = driven(law(2e-3), tracked);
        let Fit { model: fitted, .. } = fit(&data, &law(0.0)).unwrap();
        let found = ["k", "q"].map(|name| fitted.get("own", name).unwrap());
        assert!((found[0] - 2e-3).abs() < most && (found[1] + 1e-3).abs() < most, "{found:?}");
    }
}

#[test]
fn a_law_is_asked_along_the_predicted_way_for_places_where_it_breaks_down() {
    let path = Path::umbmark();
    let refused = |model: &Model| check_on_path(model, &path).map_err(|error| error.to_string());
    // Clockwise the square lies at y < 0; with a START far to the left all of it lies at y > 0.
    let mut model = acting(Target::ForwardScale, "k * sqrt(y + 1)", &[("k", 1e-3)]);
    let said = refused(&model).unwrap_err();
    assert!(
        said.starts_with("own: \"sqrt(y + 1)\", or its derivative, is not finite") && said.contains("y = -1.0"),
        "{said}"
    );
    model.set("start_pose", "y_m", 4.0).unwrap();
    assert_eq!(refused(&model), Ok(()));
    let track = Track::in_pieces(&path, Direction::Cw, model.robot());
    assert!(track.clone().beginning_at(Pose2::new(0.0, -1.0, 0.0)).check(&model).is_err());
    assert!(track.beginning_at(Pose2::new(0.0, 3.0, 0.0)).check(&model).is_ok());
}
