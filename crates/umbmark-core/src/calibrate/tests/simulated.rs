//! Calibrations of simulated tests, whose truth is known.

use super::*;
use crate::diagnose::tests::{margin, trials};
use crate::simulate::{Odometry, Phase, Simulator, Truth};

/// A simulated test of n + n runs with wheel noise.
fn simulated(simulator: &mut Simulator, truth: &mut Truth, n: u32, trial: u64, path: &Path) -> Dataset {
    simulator.open(truth, 17, trial);
    let errors: Vec<(Direction, ReturnError)> = Direction::BOTH
        .into_iter()
        .flat_map(|d| (0..n).map(move |_| d))
        .map(|d| (d, simulator.run(truth, d, TestKind::Systematic)))
        .collect();
    dataset(&Robot::labmate(), path, &errors)
}

fn noisy_labmate(k: f64) -> Model {
    let mut model = PLAIN.model(&Robot::labmate()).unwrap();
    model.set("wheel_noise", "k_sqrt_m", k).unwrap();
    model
}

/// Share of simulated tests whose 95 % intervals hold the true E_d and E_b, by each method.
fn coverage(n: u32, trials: u64) -> Vec<(Method, [f64; 2], [f64; 2])> {
    let (robot, path) = (Robot::labmate(), Path::umbmark());
    let mut simulator = Simulator::new(&robot, &path, Odometry::Continuous, Phase::Edge).unwrap();
    let mut truth = Truth::new(&noisy_labmate(1e-3));
    let mut held = vec![[0.0; 2]; 5];
    let mut squares = vec![[0.0; 2]; 5];
    for trial in 0..trials {
        let data = simulated(&mut simulator, &mut truth, n, trial, &path);
        let calibration = calibrate(&data, &Options::default()).unwrap();
        for (i, estimate) in calibration.estimates.iter().enumerate() {
            for (j, ratio) in [Ratio::Diameters, Ratio::Wheelbase].into_iter().enumerate() {
                let true_value = PLAIN.values()[j];
                held[i][j] += f64::from(u8::from(estimate.interval(ratio, 0.95).unwrap().contains(true_value)));
                squares[i][j] += (estimate.ratio(ratio).unwrap() - true_value).powi(2);
            }
        }
    }
    let share = |v: [f64; 2]| v.map(|x| x / trials as f64);
    Method::ALL.into_iter().zip(held).zip(squares).map(|((m, h), s)| (m, share(h), share(s).map(f64::sqrt))).collect()
}

/// 1000 tests, seed 17: the standard error of a coverage of 95 % is 0.7 %.
#[test]
fn intervals_from_return_errors_hold_the_true_ratios_as_often_as_they_say() {
    for n in [2, 5] {
        let all = coverage(n, 1000);
        for (method, held, _) in &all {
            // The closed forms' own error, 18 mm of y in one round, is not in their intervals.
            let least = if *method == Method::Exact { 0.93 } else { 0.91 };
            assert!(held.iter().all(|h| (least..0.97).contains(h)), "{n} {method:?} {held:?}");
        }
        let spread = |method: Method| all.iter().find(|(m, _, _)| *m == method).unwrap().2;
        for form in ClosedForm::ALL {
            let (exact, closed) = (spread(Method::Exact), spread(Method::ClosedForm(form)));
            assert!(exact[0] < 1.03 * closed[0] && exact[1] < 1.03 * closed[1], "{form:?} {exact:?} {closed:?}");
        }
    }
}

/// A simulated test recorded with ticks and tracks.
fn recorded(simulator: &mut Simulator, truth: &mut Truth, n: u32, trial: u64, path: &Path) -> Dataset {
    simulator.open(truth, 23, trial);
    let mut data = dataset(&Robot::labmate(), path, &[]);
    for direction in Direction::BOTH {
        for number in 1..=n {
            let recording = simulator.record(truth, direction, TestKind::Systematic, [10.0, 5.0]).unwrap();
            data.runs.push(Run {
                name: format!("{}_{number}", direction.name()),
                number,
                direction: Some(direction),
                test: TestKind::Systematic,
                log: Some(recording.log),
                returned: Some(recording.returned),
            });
        }
    }
    data
}

fn one_metre_square() -> Path {
    Path::new(&SQUARE, &[1.0], SpeedProfile::default()).unwrap()
}

/// 80 tests, seed 23: the standard error of a coverage of 95 % is 2.4 %.
#[test]
fn tracks_show_all_three_ratios_and_their_intervals_hold_the_truth() {
    let robot = Robot::labmate();
    let true_values = Correction { e_s: 1.004, ..TAPED };
    let mut model = true_values.model(&robot).unwrap();
    model.set("wheel_noise", "k_sqrt_m", 5e-4).unwrap();
    let path = one_metre_square();
    let mut simulator = Simulator::new(&robot, &path, Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(&model);
    let trials = trials(80);
    let mut held = [0.0; 3];
    for trial in 0..trials {
        let calibration =
            calibrate(&recorded(&mut simulator, &mut truth, 3, trial, &path), &Options::default()).unwrap();
        assert_eq!(calibration.level, Level::Tracks);
        let exact = calibration.estimate(Method::Exact).unwrap();
        for (i, ratio) in Ratio::ALL.into_iter().enumerate() {
            held[i] += f64::from(u8::from(exact.interval(ratio, 0.95).unwrap().contains(true_values.values()[i])));
        }
    }
    let share = held.map(|h| h / trials as f64);
    assert!(share.iter().all(|s| *s > 0.95 - margin(0.95, trials)), "{share:?}");
}

#[test]
fn end_poses_of_tick_logs_give_the_same_ratios_as_return_errors() {
    let robot = Robot::labmate();
    let path = one_metre_square();
    let mut simulator = Simulator::new(&robot, &path, Odometry::EveryTick, Phase::Random).unwrap();
    let mut data = recorded(&mut simulator, &mut Truth::new(&noisy_labmate(5e-4)), 3, 0, &path);
    for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
        // A pose at START says nothing.
        let last = log.reference.len() - 1;
        log.reference.drain(1..last);
    }
    let with_ticks = calibrate(&data, &Options::default()).unwrap();
    assert_eq!(with_ticks.level, Level::Ends);
    data.runs.iter_mut().for_each(|run| run.log = None);
    let without = calibrate(&data, &Options::default()).unwrap();
    let [a, b] = [&with_ticks, &without].map(|c| c.estimate(Method::Exact).unwrap());
    assert!((a.correction.e_d - b.correction.e_d).abs() < 1e-4 && (a.correction.e_b - b.correction.e_b).abs() < 1e-4);
    let ratio = a.std_error(Ratio::Wheelbase).unwrap() / b.std_error(Ratio::Wheelbase).unwrap();
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    assert!(a.replayed_after.unwrap().e_max_sys.unwrap() < a.replayed_before.unwrap().e_max_sys.unwrap());
    assert_eq!(b.replayed_before, None);
}

/// Oracle for the heading arm: the root mean square distance from START of all poses recorded.
#[test]
fn a_track_without_noise_gives_all_three_ratios_back_and_is_told_of_none_that_is_missing() {
    let (robot, path) = (Robot::labmate(), one_metre_square());
    let true_values = Correction { e_s: 1.004, ..TAPED };
    let mut simulator = Simulator::new(&robot, &path, Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(&true_values.model(&robot).unwrap());
    let data = recorded(&mut simulator, &mut truth, 2, 0, &path);
    let calibration = calibrate(&data, &Options::default()).unwrap();
    let exact = calibration.estimate(Method::Exact).unwrap();
    assert_eq!((calibration.level, exact.shown, exact.degrees_of_freedom), (Level::Tracks, [true; 3], 3.0));
    for (found, value) in exact.correction.values().into_iter().zip(true_values.values()) {
        assert!((found - value).abs() < 1e-4, "{:?}", exact.correction);
    }
    assert!(!calibration.warnings.iter().any(|w| w.contains("not determined")), "{:?}", calibration.warnings);
    let poses = || data.runs.iter().flat_map(|run| &run.log.as_ref().unwrap().reference);
    let squares: f64 = poses().map(|pose| libm::hypot(pose.x, pose.y).powi(2)).sum();
    let arm = calibration.heading_arm.unwrap();
    assert!((arm - (squares / poses().count() as f64).sqrt()).abs() < 1e-12, "{arm}");
    // Both ends of both directions, computed again.
    let (before, after) = (exact.replayed_before.unwrap(), exact.replayed_after.unwrap());
    assert!(after.largest < 1e-3 && before.largest > 0.05 && before.e_max_sys.unwrap() <= before.largest);
}

/// A robot that turns on the spot hardly changes its place: only the headings of its track show E_b.
#[test]
fn the_headings_of_a_track_count() {
    let robot = Robot::labmate();
    let path = Path::new(&SPIN, &[2.3], SpeedProfile::default()).unwrap();
    let mut simulator = Simulator::new(&robot, &path, Odometry::EveryTick, Phase::Random).unwrap();
    let mut truth = Truth::new(&Correction { e_b: 0.98, ..Correction::NONE }.model(&robot).unwrap());
    let data = recorded(&mut simulator, &mut truth, 2, 0, &path);
    let options = Options { heading_arm: Some(1.0), ..Options::default() };
    let calibration = calibrate(&data, &options).unwrap();
    assert_eq!((calibration.level, calibration.heading_arm), (Level::Tracks, options.heading_arm));
    let exact = calibration.estimate(Method::Exact).unwrap();
    assert!(exact.shown[1] && (exact.correction.e_b - 0.98).abs() < 1e-3, "{exact:?}");
}
