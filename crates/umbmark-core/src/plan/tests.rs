//! Planned tests held against brute force: tests simulated by the engine and judged as measured ones are.

use super::*;
use crate::action::Action;
use crate::calibrate::{self, Method, Ratio, calibrate};
use crate::diagnose::ends::{Asked, Family};
use crate::diagnose::tests::{dataset, margin, trials};
use crate::path::{FIGURE_EIGHT, SpeedProfile};
use crate::watch::Watch;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

fn labmate(effects: &[(&str, &str, f64)]) -> Model {
    let mut truth = Model::new(&Robot::labmate());
    for (effect, parameter, value) in [("wheel_noise", "k_sqrt_m", 1e-3)].iter().chain(effects) {
        truth.set(effect, parameter, *value).unwrap();
    }
    truth
}

fn setting(path: &Path) -> Setting {
    Setting::new(path, &labmate(&[]), 1).unwrap()
}

/// Whole tests as the robot would drive them.
fn driven(truth: &Model, path: &Path, n: usize, seed: u64, tests: u64) -> Vec<Dataset> {
    let one = |test: u64| {
        let mut simulator = Simulator::new(truth.robot(), path, Odometry::EveryTick, Phase::Random).unwrap();
        let mut truth = Truth::new(truth);
        simulator.open(&mut truth, seed, test);
        let mut returned = Direction::BOTH.map(|_| vec![ReturnError::default(); n]);
        simulator.test(&mut truth, TestKind::Systematic, returned.each_mut().map(Vec::as_mut_slice));
        let of = |d: Direction| returned[d as usize].iter().map(move |error| (d, *error));
        let errors: Vec<_> = Direction::BOTH.into_iter().flat_map(of).collect();
        dataset(path, &errors)
    };
    (0..tests).into_par_iter().map(one).collect()
}

/// Says how far the planned power lies from the share of tests that saw the effect.
fn held(what: &str, planned: f64, seen: usize, tests: u64) {
    let share = seen as f64 / tests as f64;
    let error = (planned * (1.0 - planned) / tests as f64).sqrt();
    let z = (share - planned) / error;
    let _ =
        writeln!(std::io::stderr(), "{what}: planned {planned:.4}, {share:.4} of {tests} ({z:+.1} standard errors)");
    assert!((share - planned).abs() < margin(planned, tests), "{what}: planned {planned}, seen {share}");
}

#[test]
fn an_expected_test_has_the_means_and_the_scatter_that_are_expected() {
    let setting = setting(&Path::umbmark()).with_sigma(0.05);
    for n in [3, 4, 5, 12] {
        let returns = crate::score::Returns::of(&expected_dataset(&setting, n).runs);
        let scatter = Scatter::pooled(&returns.cw, &returns.ccw).unwrap();
        let scale = setting.covariance.diagonal().map(f64::sqrt);
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let off = (scatter.covariance[(i, j)] - setting.covariance[(i, j)]) / (scale[i] * scale[j]);
            assert!(off.abs() < 1e-10, "n = {n}, {i} {j}: {off}");
        }
        let summary = crate::score::summarise(&returns.cw, &returns.ccw);
        assert!((summary.e_max_sys().unwrap() - setting.e_max_sys()).abs() < 1e-12);
        assert!((summary.sigma_axis().unwrap() - 0.05).abs() < 1e-12);
    }
}

/// Seed 31. Seen: the 95 % interval of `calibrate`'s exact fit leaves 1 out.
#[test]
fn the_power_to_see_e_d_and_e_b_is_that_of_calibrate_on_simulated_tests() {
    let tests = trials(400);
    for (path, n) in [(Path::umbmark(), 5), (Path::umbmark(), 3), (resized_square(2.0), 8)] {
        let setting = setting(&path);
        let planned = Planned::new(&setting, n, &Options::default()).unwrap();
        for (effect, parameter, ratio) in
            [("wheelbase", "e_b", Ratio::Wheelbase), ("wheel_diameter_ratio", "e_d", Ratio::Diameters)]
        {
            let one = Sought::named(parameter, 1.001, setting.robot()).unwrap();
            let value = 1.0 + planned.least(&one, 0.8).unwrap();
            let sought = Sought::named(parameter, value, setting.robot()).unwrap();
            assert!((planned.power(&sought) - 0.8).abs() < 1e-4);
            let truth = labmate(&[(effect, parameter, value)]);
            let sees = |data: &&Dataset| {
                let calibration = calibrate(data, &calibrate::Options::default()).unwrap();
                let estimate = calibration.estimate(Method::Exact).unwrap();
                !estimate.interval(ratio, 0.95).unwrap().contains(1.0)
            };
            let seen = driven(&truth, &path, n, 31, tests).par_iter().filter(sees).count();
            held(&format!("{parameter} {value:.5}, n = {n}"), planned.power(&sought), seen, tests);
        }
    }
}

fn resized_square(side: f64) -> Path {
    Path::new(&crate::path::SQUARE, &[side], SpeedProfile::default()).unwrap()
}

/// How many tests certify an effect, among all that `diagnose` asks.
fn certified(data: &[Dataset], sought: &Sought, options: &Options) -> usize {
    let sees = |data: &&Dataset| {
        let ends = Ends::new(data).unwrap();
        let fitted = Fitted::new(&ends, &base_model(&Robot::labmate()).unwrap()).unwrap();
        let asked = Asked::new(&ends, &fitted).unwrap().unwrap();
        let family = Family::new(&asked, options).unwrap();
        let units = asked.units.iter().zip(&family.p_adjusted);
        let mut own = units.filter(|(u, _)| u.effect == sought.effect && u.parameter.name == sought.parameter.name);
        own.any(|(_, p)| *p < options.size)
    };
    data.par_iter().filter(sees).count()
}

/// Seed 32. Exact tests on the square, simulated ones on the figure-eight.
#[test]
fn the_power_to_see_any_other_effect_is_that_of_diagnose_on_simulated_tests() {
    let options = Options { draws: 499, ..Options::default() };
    let eight = Path::new(&FIGURE_EIGHT, &[1.0], SpeedProfile::default()).unwrap();
    let cases = [
        (Path::umbmark(), 5, "slope-x", 0.6, 300),
        (Path::umbmark(), 8, "start-heading", 0.9, 300),
        (Path::umbmark(), 3, "slope-y", 0.8, 300),
        (eight, 6, "start-y", 0.7, 100),
    ];
    for (path, n, flag, power, usual) in cases {
        let tests = trials(usual);
        let setting = setting(&path);
        let plan = Planned::new(&setting, n, &options).unwrap();
        let one = Sought::named(flag, 1e-3, setting.robot()).unwrap();
        let value = plan.least(&one, power).unwrap();
        let sought = Sought::named(flag, value, setting.robot()).unwrap();
        let planned = plan.power(&sought);
        assert!((planned - power).abs() < 0.005, "{flag} {value}: {planned}");
        let truth = labmate(&[(sought.effect.about.name, sought.parameter.name, value)]);
        let seen = certified(&driven(&truth, &path, n, 32, tests), &sought, &options);
        held(&format!("{flag} {value:.5}, n = {n}, {}", path.shape().name), planned, seen, tests);
    }
}

#[test]
fn the_runs_needed_are_the_fewest_that_have_the_power() {
    let setting = setting(&Path::umbmark()).with_sigma(0.05);
    let options = Options { draws: 199, ..Options::default() };
    for flag in ["eb", "ed"] {
        let sought = Sought::named(flag, if flag == "eb" { 1.005 } else { 1.0007 }, setting.robot()).unwrap();
        let runs = runs_needed(&setting, &sought, 0.9, &options).unwrap().unwrap();
        let power = |n| Planned::new(&setting, n, &options).unwrap().power(&sought);
        assert!(power(runs) >= 0.9 && power(runs - 1) < 0.9, "{flag}: {runs}");
    }
    let scale = Sought::named("es", 1.003, setting.robot()).unwrap();
    let planned = Planned::new(&setting, 5, &options).unwrap();
    assert_eq!(planned.shown(&scale), Shown::Absorbed(vec!["wheelbase"]));
    assert_eq!(runs_needed(&setting, &scale, 0.9, &options).unwrap(), None);
}

/// Seed 1, 2000 tests: 1.95 ± 0.49 % outside in one that holds with 95 % or more.
#[test]
fn intervals_of_e_max_sys_hold_as_often_as_they_say_and_narrow_with_more_runs() {
    let truth = labmate(&[("wheel_diameter_ratio", "e_d", 1.00121), ("wheelbase", "e_b", 337.2 / 340.0)]);
    let setting = Setting::new(&Path::umbmark(), &truth, 1).unwrap();
    let expected = intervals(&setting, &[3, 5, 10, 30], 0.95, 2000, 1);
    for pair in expected.windows(2) {
        assert!(pair[1].half_width < pair[0].half_width && pair[1].std_dev < pair[0].std_dev);
    }
    for e in &expected {
        assert!(e.coverage > 0.95 - margin(0.95, 2000), "{e:?}");
        // The larger of two distances, each made longer by scatter.
        assert!(e.mean > setting.e_max_sys() - 4.0 * e.std_dev / 2000f64.sqrt(), "{e:?}");
    }
}

/// E_d growing by Δ over the session: in blocks the two directions differ by Δ/2, which is read as E_b off by
/// Δ L/(2πb) (to first order). Even numbers of pairs in mirrored order cancel a linear drift.
#[test]
fn a_drift_is_read_as_the_other_parameter_in_blocks_and_cancels_in_mirrored_order() {
    let setting = setting(&Path::umbmark());
    let change = Sought::named("ed", 1.001, setting.robot()).unwrap();
    let found = drifts(&setting, 6, &[change]).unwrap();
    let error = |order: Order, name: &str| {
        let drift = found.iter().find(|d| d.order == order).unwrap();
        drift.errors.iter().find(|(parameter, _, _)| *parameter == name).unwrap().1
    };
    let expected = -1e-3 * 4.0 / (2.0 * std::f64::consts::PI * 0.34);
    assert!((error(Order::Blocks, "e_b") / expected - 1.0).abs() < 0.02, "{}", error(Order::Blocks, "e_b"));
    assert!((error(Order::Alternating, "e_b") / expected - 1.0 / 6.0).abs() < 0.01);
    assert!(error(Order::Mirrored, "e_b").abs() < 0.01 * expected.abs());
    for order in Order::ALL {
        assert!(error(order, "e_d").abs() < 0.02e-3, "{order:?}");
    }
}

#[test]
fn a_sheet_lists_every_run_once_in_its_order_with_the_columns_of_returns() {
    let setting = setting(&Path::umbmark()).with_heading(false);
    let sheet = Protocol::new(&setting, 4, Order::Mirrored, 10.0, Action::plain);
    assert_eq!(sheet.columns, ["test", "direction", "run", "x_abs_m", "y_abs_m", "x_calc_m", "y_calc_m"]);
    let first: Vec<_> = sheet.runs[..4].iter().map(|run| (run.direction, run.number)).collect();
    let [cw, ccw] = Direction::BOTH;
    assert_eq!(first, [(cw, 1), (ccw, 1), (ccw, 2), (cw, 2)]);
    assert_eq!(sheet.runs.iter().filter(|run| run.test == TestKind::Bumps).count(), 8);
    assert!(sheet.steps[0].contains("free for 4.0 m ahead of START and 4.0 m to either side"), "{}", sheet.steps[0]);
}

/// Seed 33, 20 runs a direction: k is known to some 8 %.
#[test]
fn the_robot_of_some_runs_has_their_errors_and_their_scatter() {
    let data = driven(&labmate(&[("wheelbase", "e_b", 1.01)]), &Path::umbmark(), 20, 33, 1).remove(0);
    let measured = Measured::new(&data).unwrap();
    let k = measured.truth.get("wheel_noise", "k_sqrt_m").unwrap();
    assert!((k / 1e-3 - 1.0).abs() < 0.25, "{k}");
    assert!((measured.truth.get("wheelbase", "e_b").unwrap() - 1.01).abs() < 1.5e-3);
    let mut few = data.clone();
    few.runs.retain(|run| run.number <= 2 || run.number > 38);
    assert_eq!(Measured::new(&few).unwrap_err(), PlanError::TooFewRuns);
    let pathless = Dataset { path: None, ..data };
    assert_eq!(Measured::new(&pathless).unwrap_err(), PlanError::NoPath);
}

/// Headings of ten bumps of 0.573 degrees, and the interval that `score` would give.
#[test]
fn the_extended_test_reads_the_turn_of_its_bumps() {
    let setting = setting(&Path::umbmark());
    let test = extended_test(&setting, 5, 10.0, &Options::default()).unwrap();
    assert!((test.orientation.to_degrees() - 5.73).abs() < 0.1, "{test:?}");
    let more = extended_test(&setting, 20, 10.0, &Options::default()).unwrap();
    assert!(more.half_width < 0.6 * test.half_width && test.half_width > 0.0);
}

#[test]
fn a_larger_square_shows_e_d_better_and_e_b_worse_and_one_direction_neither() {
    let setting = setting(&Path::umbmark());
    let options = Options { draws: 199, ..Options::default() };
    let sought = ["ed", "eb"].map(|flag| Sought::named(flag, 1.01, setting.robot()).unwrap());
    let found = alternatives(&setting, 5, &sought, 0.9, &options).unwrap();
    let least = |i: usize, which: usize| found[i].least[which].unwrap();
    // Least E_d falls and least E_b rises as the root of the side.
    for (which, expected) in [(0, 0.5f64.sqrt()), (1, 2f64.sqrt())] {
        assert!((least(2, which) / least(0, which) / expected - 1.0).abs() < 0.08, "{found:?}");
    }
    assert_eq!((found[4].runs, &found[4].least), ([10, 0], &vec![None, None]));
}

#[test]
fn what_cannot_be_planned_is_refused_with_the_reason() {
    let robot = Robot::labmate();
    let refuse = |name, value| Sought::named(name, value, &robot).unwrap_err().to_string();
    assert!(refuse("e_bb", 1.0).contains("no effect has a size \"e_bb\""));
    assert_eq!(refuse("eb", 1.0), "eb = 1 has no effect: there is nothing to detect");
    assert!(refuse("eb", -1.0).contains("e_b must be between"));
    let setting = setting(&Path::umbmark());
    assert_eq!(
        Planned::new(&setting, 2, &Options::default()).unwrap_err().to_string(),
        "runs a direction must be between 3 and 1000, got 2"
    );
}

#[test]
fn a_plan_that_is_stopped_has_the_numbers_of_runs_that_were_looked_at() {
    let setting = setting(&Path::umbmark());
    let see = [(Sought::named("eb", 1.01, setting.robot()).unwrap(), 1.01)];
    let options = Options { draws: 99, ..Options::default() };
    let request = Request { runs: 5, see: &see, power: 0.9, numbers: &[3, 4, 5, 6], sigma_interval: None, options };
    let whole = Watch::nobody(|watch| request.findings(&setting, watch)).unwrap();
    assert!(!whole.partial && whole.by_runs.len() == 4 && whole.extended.is_some());
    let stop = AtomicBool::new(false);
    let after_two = |share: f64| stop.store(share >= 0.5, Ordering::Relaxed);
    let part = request.findings(&setting, &Watch::new(&stop, &after_two)).unwrap();
    assert!(part.partial && part.by_runs.len() == 2 && part.answers.len() == 1);
    assert!(part.alternatives.is_empty() && part.drifts.is_empty() && part.extended.is_none());
    assert_eq!(part.by_runs[1].least, whole.by_runs[1].least);
}
