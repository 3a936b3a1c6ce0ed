use super::*;
use crate::dataset::{ReturnError, Run};
use crate::drive::DifferentialDrive;
use crate::effect::{Model, TestKind};
use crate::geometry::{Displacement2, Pose2, seeded};
use crate::path::{Direction, Path, RECTANGLE, SPIN, SQUARE, STRAIGHT, SpeedProfile, WAYPOINTS};
use crate::replay::Track;
use crate::score::{Cluster, Scatter};
use nalgebra::Matrix2;

mod found;
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
        assert!(calibration.warnings.iter().any(|w| w.starts_with("Few runs: 1 cw and 1 ccw.")));
        assert!(
            exact.termination.unwrap().converged()
                && !calibration.warnings.iter().any(|w| w.starts_with("The exact fit"))
        );
        assert_eq!((calibration.level, calibration.heading_arm), (Level::Ends, None));
    }
}

/// Section 3.1 of the paper; E_d as the share 1 % by which the wheels differ.
#[test]
fn the_closed_forms_are_warned_of_where_a_skid_steered_robot_is_out_of_their_depth() {
    let warned = |e_b: f64, size: f64| {
        let truth = Correction { e_d: 1.003, e_b, e_s: 1.0 };
        let drive = DifferentialDrive::new(0.34 * size, 0.15 * size, 0.15 * size).unwrap();
        let robot = Robot { drive: drive.into(), ..Robot::labmate() };
        let path = Path::new(&SQUARE, &[4.0 * size], SpeedProfile::default()).unwrap();
        let error = |d| (d, drive_again(&robot, &path, d, &truth, &Correction::NONE).unwrap());
        let calibration = calibrate(&dataset(&robot, &path, &Direction::BOTH.map(error)), &Options::default()).unwrap();
        let exact = calibration.estimate(Method::Exact).unwrap().correction;
        assert!((exact.e_b / e_b - 1.0).abs() < 1e-9, "{exact:?}");
        calibration.warnings.iter().any(|w| w.starts_with("The closed forms are of first order"))
    };
    for size in [0.1, 1.0, 5.0] {
        assert!(warned(1.5, size) && warned(1.875, size));
        assert!(!warned(1.01, size) && !warned(0.97, size));
    }
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
        calibration
            .warnings
            .iter()
            .any(|w| w.contains("E_d and E_b are not determined") && w.contains("other direction too")),
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
    assert!(straight.warnings.iter().any(|w| w.contains("E_b is not determined") && w.contains("a square both ways")));
    assert_eq!((line.e_max_sys_after, line.std_error(Ratio::Wheelbase)), (None, None));
    let spin = only(&SPIN, 5.0);
    let turned = spin.estimate(Method::Exact).unwrap();
    assert_eq!(turned.shown, [false, true, false]);
    assert!(spin.warnings.iter().any(|w| w.starts_with("E_d is not determined")), "{:?}", spin.warnings);
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
        &[(Direction::Cw, error(-15.0, 0.0)), (Direction::Ccw, error(-15.0, 0.0))],
    );
    let calibration = calibrate(&wild, &Options::default()).unwrap();
    assert!(calibration.warnings.iter().any(|w| w.contains("belong to no robot")), "{:?}", calibration.warnings);
    let mut data = noise_free(&PLAIN);
    data.path = None;
    assert_eq!(
        calibrate(&data, &Options::default()).unwrap_err(),
        CalibrateError::Fit(FitError::NothingObserved { runs: 2 })
    );
    data.robot = None;
    assert_eq!(calibrate(&data, &Options::default()).unwrap_err(), CalibrateError::Fit(FitError::NoRobot));
    for (arm, told) in [(-1.0, "-1"), (0.0, "0"), (f64::INFINITY, "inf")] {
        let options = Options { heading_arm: Some(arm), ..Options::default() };
        let message = calibrate(&noise_free(&PLAIN), &options).unwrap_err().to_string();
        assert_eq!(message, format!("the heading arm must be positive and finite, got {told} m"));
    }
}

#[test]
fn a_quarter_turn_lost_and_a_leg_curved_about_a_wheel_belong_to_no_robot() {
    let drive = DifferentialDrive::new(4.0, 0.15, 0.15).unwrap();
    let correction = |alpha: f64, beta: f64| Angles { alpha, beta }.correction(4.0, &drive, RadiusWheelbase::Nominal);
    let quarter = std::f64::consts::FRAC_PI_2;
    for (alpha, beta) in [(quarter, 0.0), (1.1 * quarter, 0.0), (0.0, 2.0 * quarter), (0.0, -2.0 * quarter)] {
        assert_eq!(correction(alpha, beta), None);
    }
    assert!(correction(0.9 * quarter, 1.8 * quarter).is_some());
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
    for estimate in &calibration.estimates {
        let again = drive_back(&exact.correction, &estimate.correction);
        let left = [cw, ccw].into_iter().zip(explained).zip(again);
        let left = left.map(|((e, f), g)| libm::hypot(e.x - f.x + g.x, e.y - f.y + g.y)).fold(0.0, f64::max);
        assert!((estimate.e_max_sys_after.unwrap() - left).abs() < 1e-12, "{:?}", estimate.method);
    }
    assert!(exact.e_max_sys_after.unwrap() > 4e-3);
}

/// Three runs each way whose scatter is strongly correlated between x, y and heading, and not of the shape of wheel noise.
fn scattered() -> Vec<(Direction, ReturnError)> {
    let scatter = [(9e-3, 8e-3, 2e-3), (-4e-3, -6e-3, -3e-3), (-5e-3, -2e-3, 1e-3)];
    let both = Direction::BOTH.into_iter().zip(drive_back(&PLAIN, &Correction::NONE));
    both.flat_map(|(d, e)| scatter.map(|(x, y, h)| (d, moved(&e, (x, d.sign() * y, d.sign() * h))))).collect()
}

fn moved(e: &ReturnError, (x, y, h): (f64, f64, f64)) -> ReturnError {
    ReturnError { x: e.x + x, y: e.y + y, heading: e.heading.map(|heading| heading + h) }
}

fn calibrated(errors: &[(Direction, ReturnError)]) -> Calibration {
    calibrate(&dataset(&Robot::labmate(), &Path::umbmark(), errors), &Options::default()).unwrap()
}

/// What the closed forms leave out does not shrink with the scatter of the runs: of a robot that repeats well it is more than a standard error.
#[test]
fn closed_forms_are_warned_of_where_what_they_leave_out_is_beyond_their_intervals() {
    let warned = |scale: f64| {
        let truth = Correction { e_d: 1.001, e_b: 0.985, e_s: 1.0 };
        let exact = drive_back(&truth, &Correction::NONE);
        let scatter = [(9e-3, 8e-3, 2e-3), (-4e-3, -6e-3, -3e-3), (-5e-3, -2e-3, 1e-3)];
        let runs = Direction::BOTH.into_iter().zip(exact).flat_map(|(d, e)| {
            scatter.map(|(x, y, h)| (d, moved(&e, (scale * x, scale * d.sign() * y, scale * d.sign() * h))))
        });
        let told = calibrated(&runs.collect::<Vec<_>>()).warnings;
        told.into_iter().find(|warning| warning.starts_with("Of first order in the errors,"))
    };
    assert!(warned(0.1).unwrap().contains("closed_form_y"));
    assert_eq!(warned(10.0), None);
}

/// Oracle: derivatives of the estimate by each run's return error, from calibrating again, with the scatter of the runs.
#[test]
fn the_covariance_of_every_method_is_that_of_its_influence_on_each_run() {
    let errors = scattered();
    let of = |d| errors.iter().filter(move |(e, _)| *e == d).map(|(_, e)| *e).collect::<Vec<_>>();
    let pooled = Scatter::pooled(&of(Direction::Cw), &of(Direction::Ccw)).unwrap();
    let calibration = calibrated(&errors);
    let mut expected = vec![Matrix2::zeros(); calibration.estimates.len()];
    let h = 1e-6;
    for i in 0..errors.len() {
        let at = |by: (f64, f64, f64)| {
            let mut changed = errors.clone();
            changed[i].1 = moved(&errors[i].1, by);
            calibrated(&changed).estimates
        };
        let slopes =
            [(h, 0.0, 0.0), (0.0, h, 0.0), (0.0, 0.0, h)].map(|(x, y, by)| (at((x, y, by)), at((-x, -y, -by))));
        for (method, sum) in expected.iter_mut().enumerate() {
            let influence = nalgebra::Matrix2x3::from_columns(&slopes.each_ref().map(|(above, below)| {
                let [a, b] = [above, below].map(|estimates| estimates[method].correction);
                nalgebra::Vector2::new(a.e_d - b.e_d, a.e_b - b.e_b) / (2.0 * h)
            }));
            *sum += influence * pooled.of(errors[i].0) * influence.transpose();
        }
    }
    let methods = calibration.estimates.iter().map(|e| e.method);
    assert!(methods.eq(Method::ALL.into_iter().filter(|method| *method != Method::Model)));
    for (estimate, expected) in calibration.estimates.iter().zip(expected) {
        let covariance = estimate.covariance.unwrap();
        for i in 0..2 {
            for j in 0..2 {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                assert!(
                    (covariance[(i, j)] - expected[(i, j)]).abs() < 0.01 * scale,
                    "{:?} {covariance} {expected}",
                    estimate.method
                );
            }
        }
    }
}

/// Oracle: tables of Student's t with 4 degrees of freedom, 2.776 at 97.5 % and 2.132 at 95 %.
#[test]
fn an_interval_is_students_about_the_ratio_and_a_missing_heading_costs_those_of_the_heading_form() {
    let mut errors = scattered();
    let calibration = calibrated(&errors);
    assert!(!calibration.warnings.iter().any(|w| w.starts_with("Few runs")));
    for estimate in &calibration.estimates {
        for (i, ratio) in [Ratio::Diameters, Ratio::Wheelbase].into_iter().enumerate() {
            let (value, variance) = (estimate.correction.values()[i], estimate.covariance.unwrap()[(i, i)]);
            for (level, t) in [(0.95, 2.776_45), (0.90, 2.131_85)] {
                let interval = estimate.interval(ratio, level).unwrap();
                assert!((0.5 * (interval.low + interval.high) - value).abs() < 1e-12);
                assert!((0.5 * (interval.high - interval.low) / (t * variance.sqrt()) - 1.0).abs() < 1e-5);
            }
            assert_eq!(estimate.ratio(ratio), Some(value));
        }
    }
    errors[0].1.heading = None;
    let calibration = calibrated(&errors);
    for estimate in &calibration.estimates {
        let is_heading = estimate.method == Method::ClosedForm(ClosedForm::Heading);
        assert_eq!(estimate.covariance.is_none(), is_heading, "{:?}", estimate.method);
    }
}

#[test]
fn lengths_are_those_of_the_corrected_robot_as_far_as_the_ratios_show() {
    let drive = DifferentialDrive::new(0.34, 0.151, 0.149).unwrap();
    let robot = Robot { drive: drive.into(), ..Robot::labmate() };
    let correction = Correction { e_d: 1.02, e_b: 0.97, e_s: 1.03 };
    let corrected = correction.apply(&robot).unwrap().drive;
    let wheels = [corrected.wheel_diameter_left(), corrected.wheel_diameter_right()];
    for (shown, wheelbase_shows, wheels_show) in [
        ([true, true, false], true, true),
        ([false, true, false], true, false),
        ([true, false, false], false, true),
        ([false, false, true], false, true),
    ] {
        let estimate = Estimate { shown, ..Estimate::new(Method::Exact, correction, 0.0) };
        let lengths = estimate.lengths(&robot);
        let close = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < 1e-15,
            (a, b) => a == b,
        };
        assert!(close(lengths.wheelbase, wheelbase_shows.then_some(corrected.wheelbase())), "{lengths:?}");
        let [left, right] = wheels.map(|length| wheels_show.then_some(length));
        assert!(close(lengths.left, left) && close(lengths.right, right), "{shown:?} {lengths:?}");
    }
}
