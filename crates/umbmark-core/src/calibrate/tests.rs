use super::*;
use crate::dataset::Run;
use crate::effect::{Model, TestKind};
use crate::geometry::{Displacement2, Pose2, seeded};
use crate::path::{Direction, RECTANGLE, SPIN, STRAIGHT, SpeedProfile, WAYPOINTS};
use crate::replay::Track;
use crate::score::Cluster;

mod simulated;

/// The paper's Table I: nominal 340 mm; correction factors of the plain and of the taped LabMate.
const PLAIN: Correction = Correction { e_d: 1.00121, e_b: 337.2 / 340.0, e_s: 1.0 };
const TAPED: Correction = Correction { e_d: 1.00203, e_b: 337.1 / 340.0, e_s: 1.0 };

fn drive_back(truth: &Correction, applied: &Correction) -> [ReturnError; 2] {
    Direction::BOTH.map(|d| drive_again(&Robot::labmate(), &Path::umbmark(), d, truth, applied).unwrap())
}

/// Distance from START \[mm\], cw and ccw.
fn distances(truth: &Correction, applied: &Correction) -> [f64; 2] {
    drive_back(truth, applied).map(|e| 1e3 * libm::hypot(e.x, e.y))
}

fn e_max_sys(truth: &Correction, applied: &Correction) -> f64 {
    let [cw, ccw] = distances(truth, applied);
    cw.max(ccw)
}

fn dataset(robot: &Robot, path: &Path, errors: &[(Direction, ReturnError)]) -> Dataset {
    let run = |(i, (direction, error)): (usize, &(Direction, ReturnError))| Run {
        name: format!("run {i}"),
        number: i as u32 + 1,
        direction: Some(*direction),
        test: TestKind::Systematic,
        log: None,
        returned: Some(*error),
    };
    let runs = errors.iter().enumerate().map(run).collect();
    Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() }
}

fn noise_free(truth: &Correction) -> Dataset {
    let [cw, ccw] = drive_back(truth, &Correction::NONE);
    dataset(&Robot::labmate(), &Path::umbmark(), &[(Direction::Cw, cw), (Direction::Ccw, ccw)])
}

/// Published: 310 and 423 mm.
#[test]
fn table_i_comes_out_of_its_correction_factors() {
    let robot = Robot::labmate();
    for (truth, exact, first_order) in [(PLAIN, 305.6, 309.9), (TAPED, 417.0, 425.1)] {
        assert!((e_max_sys(&truth, &Correction::NONE) - exact).abs() < 0.05);
        let angles = Angles::of(&truth, 4.0, &robot.drive);
        let linear = Direction::BOTH.map(|d| angles.first_order_return(d, 4.0)).map(|e| 1e3 * libm::hypot(e.x, e.y));
        assert!((linear[0].max(linear[1]) - first_order).abs() < 0.05, "{linear:?}");
    }
}

/// What repeated rounds of a closed form leave \[mm\]: each round drives again with the corrections so far.
fn rounds(form: ClosedForm, wheelbase: RadiusWheelbase, truth: &Correction, count: usize) -> f64 {
    let robot = Robot::labmate();
    let mut applied = Correction::NONE;
    for _ in 0..count {
        let corrected = applied.apply(&robot).unwrap();
        let [cw, ccw] = drive_back(truth, &applied).map(|e| Cluster::of(&[e]).unwrap());
        let angles = form.angles(&cw, &ccw, 4.0).unwrap();
        let found = angles.correction(4.0, &corrected.drive, wheelbase).unwrap();
        applied = Correction { e_d: applied.e_d * found.e_d, e_b: applied.e_b * found.e_b, e_s: 1.0 };
    }
    e_max_sys(truth, &applied)
}

#[test]
fn one_round_of_a_closed_form_leaves_a_few_per_cent_and_three_leave_nothing() {
    for (truth, nominal, corrected) in
        [(PLAIN, [11.4, 18.1, 3.3], [10.0, 19.2, 4.6]), (TAPED, [21.7, 35.2, 6.8], [19.1, 37.1, 9.0])]
    {
        for (wheelbase, left) in [(RadiusWheelbase::Nominal, nominal), (RadiusWheelbase::Corrected, corrected)] {
            for (form, expected) in [ClosedForm::X, ClosedForm::Y, ClosedForm::Mean].into_iter().zip(left) {
                let one = rounds(form, wheelbase, &truth, 1);
                assert!((one - expected).abs() < 0.06, "{form:?} {wheelbase:?}: {one}");
                assert!(rounds(form, wheelbase, &truth, 3) < 0.2);
            }
        }
        assert!(rounds(ClosedForm::Heading, RadiusWheelbase::Corrected, &truth, 1) < 0.01);
    }
}

#[test]
fn the_exact_fit_of_noise_free_returns_leaves_nothing() {
    for truth in [PLAIN, TAPED, Correction { e_d: 0.97, e_b: 1.05, e_s: 1.0 }] {
        let calibration = calibrate(&noise_free(&truth), &Options::default()).unwrap();
        let exact = calibration.estimate(Method::Exact).unwrap();
        assert!(e_max_sys(&truth, &exact.correction) < 1e-6);
        assert!(exact.e_max_sys_after.unwrap() < 1e-9);
        let before = 1e3 * exact.e_max_sys_before.unwrap();
        assert!((before - e_max_sys(&truth, &Correction::NONE)).abs() < 1e-9);
        // The forecast of a closed form is the round really driven.
        let x = calibration.estimate(Method::ClosedForm(ClosedForm::X)).unwrap();
        let driven = e_max_sys(&truth, &x.correction);
        assert!((1e3 * x.e_max_sys_after.unwrap() - driven).abs() < 1e-6);
        assert_eq!((exact.ratio(Ratio::Scale), exact.covariance), (None, None));
        assert!(calibration.warnings.iter().any(|w| w.starts_with("E_s is not determined")));
    }
}

/// Section 3.1 of the paper; E_d as the share 1 % by which the wheels differ.
#[test]
fn the_closed_forms_are_warned_of_where_a_skid_steered_robot_is_out_of_their_depth() {
    let warned = |e_b: f64| {
        let truth = Correction { e_d: 1.003, e_b, e_s: 1.0 };
        let calibration = calibrate(&noise_free(&truth), &Options::default()).unwrap();
        let exact = calibration.estimate(Method::Exact).unwrap().correction;
        assert!((exact.e_b / e_b - 1.0).abs() < 1e-9, "{exact:?}");
        calibration.warnings.iter().any(|w| w.starts_with("The closed forms are of first order"))
    };
    assert!(warned(1.5) && warned(1.875));
    assert!(!warned(1.01) && !warned(0.97));
}

#[test]
fn a_square_driven_one_way_hides_two_large_errors_and_the_other_way_adds_them() {
    let share: f64 = 0.01;
    let e_d = (1.0 + 0.5 * share) / (1.0 - 0.5 * share);
    let alone = Correction { e_d, e_b: 1.0, e_s: 1.0 };
    assert!((distances(&alone, &Correction::NONE)[1] - 1247.0).abs() < 0.5);
    let e_b = 1.0 + share * 4.0 / 0.340 / std::f64::consts::FRAC_PI_2;
    assert!((e_b - 1.0749).abs() < 5e-5);
    let [cw, ccw] = distances(&Correction { e_d, e_b, e_s: 1.0 }, &Correction::NONE);
    assert!(ccw < 0.005 && (cw - 2708.0).abs() < 0.6, "{cw} {ccw}");
    // Fig. 3
    let [cw, ccw] = distances(&Correction { e_d: 1.00203, e_b: 1.01519, e_s: 1.0 }, &Correction::NONE);
    assert!(ccw < 0.05 && (cw - 543.9).abs() < 0.05, "{cw} {ccw}");
}

#[test]
fn one_direction_shows_one_combination_only_and_is_told_so() {
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    model.add("wheel_diameter_ratio").unwrap();
    model.add("wheelbase").unwrap();
    let track = Track::from_path(&Path::umbmark(), Direction::Ccw, &robot);
    let column = |i: usize| {
        let end = track.end(&model.chain_with(&seeded(model.values(), &[i])));
        [end.x, end.y, end.heading].map(|d| d.eps[0])
    };
    for (d, b) in column(0).into_iter().zip(column(1)) {
        assert!((d / b + 7.49).abs() < 5e-3, "{d} {b}");
    }
    let [_, ccw] = drive_back(&PLAIN, &Correction::NONE);
    let data = dataset(&robot, &Path::umbmark(), &[(Direction::Ccw, ccw), (Direction::Ccw, ccw)]);
    let calibration = calibrate(&data, &Options::default()).unwrap();
    assert!(calibration.estimates.is_empty());
    assert!(
        calibration.warnings.iter().any(|w| w.contains("E_d and E_b are not determined")),
        "{:?}",
        calibration.warnings
    );
    assert!(calibration.warnings.iter().any(|w| w.starts_with("No closed forms: they need runs in both")));
}

/// diagnosis.md 2.1: any displacement repeated on each side, on squares of both directions.
#[test]
fn errors_that_repeat_on_every_side_turn_the_end_about_the_centre_of_the_square() {
    for side in [0.75, 4.0] {
        for direction in Direction::BOTH {
            let s = direction.sign();
            for (forward, sideways, rotation) in [(1e-4, 2e-4, 3e-5), (0.0, 0.0, -2e-5), (-3e-4, 1e-4, 5e-5)] {
                let slip = Displacement2 { forward, sideways, rotation };
                let leg = Displacement2 { forward: side, sideways: 0.0, rotation: 0.0 };
                let turn = Displacement2 { forward: 0.0, sideways: 0.0, rotation: s * std::f64::consts::FRAC_PI_2 };
                let end = (0..4).fold(Pose2::IDENTITY, |p, _| p.moved(&leg).moved(&turn).moved(&slip));
                let angles = Angles { alpha: -s * rotation, beta: 0.0 };
                let theorem = angles.first_order_return(direction, side);
                let size = libm::hypot(theorem.x, theorem.y);
                let gap = libm::hypot(end.x - theorem.x, end.y - theorem.y);
                assert!(gap < 1e-3 * size, "{direction:?} {slip:?}: {end:?} {theorem:?}");
            }
        }
    }
    // The same through the effects, small enough that the second order is below 1e-3.
    for truth in [
        Correction { e_d: 1.0 + 1e-5, e_b: 1.0, e_s: 1.0 },
        Correction { e_d: 1.0, e_b: 1.0 - 1e-4, e_s: 1.0 },
        Correction { e_d: 1.0 - 2e-5, e_b: 1.0 + 1e-4, e_s: 1.0 },
    ] {
        for (direction, error) in Direction::BOTH.into_iter().zip(drive_back(&truth, &Correction::NONE)) {
            let theorem = Angles::of(&truth, 4.0, &Robot::labmate().drive).first_order_return(direction, 4.0);
            let gap = libm::hypot(error.x - theorem.x, error.y - theorem.y);
            assert!(gap < 1e-3 * libm::hypot(theorem.x, theorem.y), "{truth:?} {direction:?}");
            assert!((error.heading.unwrap() - theorem.heading.unwrap()).abs() < 1e-3 * theorem.heading.unwrap().abs());
        }
    }
}

#[test]
fn a_rectangle_has_no_closed_form_and_an_exact_fit() {
    let (robot, truth) = (Robot::labmate(), TAPED);
    let path = Path::new(&RECTANGLE, &[7.0, 4.0], SpeedProfile::default()).unwrap();
    let error = |d| (d, drive_again(&robot, &path, d, &truth, &Correction::NONE).unwrap());
    let calibration = calibrate(&dataset(&robot, &path, &Direction::BOTH.map(error)), &Options::default()).unwrap();
    assert_eq!(calibration.estimates.len(), 1);
    assert!((calibration.estimates[0].correction.e_d - truth.e_d).abs() < 1e-12);
    assert!(calibration.warnings[0].contains("made for a square, and the path is a rectangle"));
}

#[test]
fn an_open_path_shows_the_scale_and_a_spin_the_wheelbase() {
    let robot = Robot::labmate();
    let truth = Correction { e_d: 1.003, e_b: 0.98, e_s: 1.01 };
    let only = |shape, size: f64| {
        let path = Path::new(shape, &[size], SpeedProfile::default()).unwrap();
        let error = |d| (d, drive_again(&robot, &path, d, &truth, &Correction::NONE).unwrap());
        calibrate(&dataset(&robot, &path, &Direction::BOTH.map(error)), &Options::default()).unwrap()
    };
    let straight = only(&STRAIGHT, 10.0);
    let line = straight.estimate(Method::Exact).unwrap();
    assert_eq!(line.shown, [true, false, true]);
    assert!((line.correction.e_s - 1.01).abs() < 1e-4, "{line:?}");
    assert!(straight.warnings.iter().any(|w| w.contains("E_b is not determined")));
    let spin = only(&SPIN, 5.0);
    let turned = spin.estimate(Method::Exact).unwrap();
    assert!(turned.shown[1] && !turned.shown[2], "{:?}", turned.shown);
    assert!((turned.correction.e_b - 0.98 / 1.01).abs() < 1e-3, "{:?}", turned.correction);
}

#[test]
fn returns_without_headings_are_enough_for_all_but_the_heading_form() {
    let mut data = noise_free(&PLAIN);
    for run in &mut data.runs {
        run.returned.as_mut().unwrap().heading = None;
    }
    let calibration = calibrate(&data, &Options::default()).unwrap();
    assert!(calibration.estimate(Method::ClosedForm(ClosedForm::Heading)).is_none());
    assert!(calibration.warnings.iter().any(|w| w.starts_with("No heading: ")));
    let exact = calibration.estimate(Method::Exact).unwrap();
    assert!((exact.correction.e_b - PLAIN.e_b).abs() < 1e-12 && (exact.correction.e_d - PLAIN.e_d).abs() < 1e-12);
}

#[test]
fn the_delta_method_has_the_derivatives_of_the_closed_form() {
    let drive = Robot::labmate().drive;
    for wheelbase in [RadiusWheelbase::Corrected, RadiusWheelbase::Nominal] {
        for (alpha, beta) in [(0.02, -0.03), (-0.01, 0.0)] {
            let at = |a: f64, b: f64| {
                let c = Angles { alpha: a, beta: b }.correction(4.0, &drive, wheelbase).unwrap();
                nalgebra::Vector2::new(c.e_d, c.e_b)
            };
            let h = 1e-6;
            let numeric = [
                (at(alpha + h, beta) - at(alpha - h, beta)) / (2.0 * h),
                (at(alpha, beta + h) - at(alpha, beta - h)) / (2.0 * h),
            ];
            let exact = Angles { alpha, beta }.correction_jacobian(4.0, &drive, wheelbase);
            assert!((exact - Matrix2::from_columns(&numeric)).abs().max() < 1e-8, "{exact}");
        }
    }
}

#[test]
fn impossible_angles_data_and_options_are_refused_with_the_reason() {
    let error = |x: f64, y: f64| ReturnError { x, y, heading: Some(0.0) };
    let wild = dataset(
        &Robot::labmate(),
        &Path::umbmark(),
        &[(Direction::Cw, error(-200.0, 0.0)), (Direction::Ccw, error(-200.0, 0.0))],
    );
    let calibration = calibrate(&wild, &Options::default()).unwrap();
    assert!(calibration.warnings.iter().any(|w| w.contains("belong to no robot")), "{:?}", calibration.warnings);
    let mut data = noise_free(&PLAIN);
    data.path = None;
    assert_eq!(calibrate(&data, &Options::default()).unwrap_err(), CalibrateError::NothingObserved { runs: 2 });
    data.robot = None;
    assert_eq!(calibrate(&data, &Options::default()).unwrap_err(), CalibrateError::NoRobot);
    let options = Options { heading_arm: Some(-1.0), ..Options::default() };
    let message = calibrate(&noise_free(&PLAIN), &options).unwrap_err().to_string();
    assert_eq!(message, "the heading arm must be positive and finite, got -1 m");
}

/// A path that ends 2 % of its length from START: E_s moves the end a little, but no one should trust it.
#[test]
fn a_path_that_hardly_opens_does_not_show_the_scale() {
    let robot = Robot::labmate();
    let path = Path::new(&WAYPOINTS, &[1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.05, 0.05], SpeedProfile::default()).unwrap();
    let error = |d| (d, drive_again(&robot, &path, d, &TAPED, &Correction::NONE).unwrap());
    let calibration = calibrate(&dataset(&robot, &path, &Direction::BOTH.map(error)), &Options::default()).unwrap();
    let exact = calibration.estimate(Method::Exact).unwrap();
    assert_eq!(exact.shown, [true, true, false]);
    assert!((exact.correction.e_b - TAPED.e_b).abs() < 1e-12);
}

/// Return errors with something in them that no E_d and E_b make: 5 mm along each axis.
#[test]
fn what_the_kinematics_do_not_explain_stays_in_the_forecast() {
    let [mut cw, mut ccw] = drive_back(&PLAIN, &Correction::NONE);
    for error in [&mut cw, &mut ccw] {
        error.x += 5e-3;
        error.y += 5e-3;
    }
    let data = dataset(&Robot::labmate(), &Path::umbmark(), &[(Direction::Cw, cw), (Direction::Ccw, ccw)]);
    let calibration = calibrate(&data, &Options::default()).unwrap();
    let exact = calibration.estimate(Method::Exact).unwrap();
    let explained = drive_back(&exact.correction, &Correction::NONE);
    let left = [(cw, explained[0]), (ccw, explained[1])].map(|(e, f)| libm::hypot(e.x - f.x, e.y - f.y));
    assert!((exact.e_max_sys_after.unwrap() - left[0].max(left[1])).abs() < 1e-12);
    assert!(exact.e_max_sys_after.unwrap() > 4e-3);
}

/// Oracle: derivatives of the estimate by each run's return error, from fitting again, with the scatter of the runs.
#[test]
fn the_covariance_of_the_exact_fit_is_that_of_its_influence_on_each_run() {
    let [cw, ccw] = drive_back(&PLAIN, &Correction::NONE);
    // Strongly correlated between x, y and heading, and not of the shape of wheel noise.
    let scatter = [(9e-3, 8e-3, 2e-3), (-4e-3, -6e-3, -3e-3), (-5e-3, -2e-3, 1e-3)];
    let moved = |e: &ReturnError, s: f64, (x, y, h): (f64, f64, f64)| ReturnError {
        x: e.x + x,
        y: e.y + s * y,
        heading: e.heading.map(|heading| heading + s * h),
    };
    let errors: Vec<(Direction, ReturnError)> = [(Direction::Cw, cw), (Direction::Ccw, ccw)]
        .iter()
        .flat_map(|(d, e)| scatter.map(|by| (*d, moved(e, d.sign(), by))))
        .collect();
    let fitted = |errors: &[(Direction, ReturnError)]| {
        let data = dataset(&Robot::labmate(), &Path::umbmark(), errors);
        calibrate(&data, &Options::default()).unwrap().estimate(Method::Exact).unwrap().clone()
    };
    let of = |d| errors.iter().filter(move |(e, _)| *e == d).map(|(_, e)| *e).collect::<Vec<_>>();
    let pooled = Scatter::pooled(&of(Direction::Cw), &of(Direction::Ccw)).unwrap();
    let (mut expected, h) = (Matrix2::zeros(), 1e-6);
    for i in 0..errors.len() {
        let slope = |by: (f64, f64, f64)| {
            let at = |s: f64| {
                let mut changed = errors.clone();
                changed[i].1 = moved(&errors[i].1, 1.0, (s * by.0, s * by.1, s * by.2));
                let c = fitted(&changed).correction;
                nalgebra::Vector2::new(c.e_d, c.e_b)
            };
            (at(h) - at(-h)) / (2.0 * h)
        };
        let influence = nalgebra::Matrix2x3::from_columns(&[
            slope((1.0, 0.0, 0.0)),
            slope((0.0, 1.0, 0.0)),
            slope((0.0, 0.0, 1.0)),
        ]);
        expected += influence * pooled.of(errors[i].0) * influence.transpose();
    }
    let covariance = fitted(&errors).covariance.unwrap();
    for i in 0..2 {
        for j in 0..2 {
            let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
            assert!((covariance[(i, j)] - expected[(i, j)]).abs() < 0.01 * scale, "{covariance} {expected}");
        }
    }
}
