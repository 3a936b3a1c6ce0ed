//! Delays and clocks of runs.

use super::*;
use std::borrow::Cow;

#[test]
fn a_delay_of_each_run_is_found_as_its_own() {
    let delays = vec![0.0, 0.08, -0.05, 0.2];
    let found = Drive { delays: delays.clone(), ..clean() }.found();
    for (run, delay) in found.runs.iter().zip(delays) {
        assert!((run.delay.unwrap().value - delay).abs() < 8e-3, "{run:?}, and {delay} was put in");
    }
}

#[test]
fn runs_whose_clocks_differ_are_laid_each_on_its_own() {
    let drive = |delays: &[f64]| Drive { delays: delays.to_vec(), ..clean() };
    let delays = [0.03, 0.11, -0.02, 0.23];
    let runs = drive(&delays).runs();
    let (laid, found) = Setup::on_own_clocks(&runs, &robot(), None);
    let common = found.mounting.unwrap().delay.value;
    for (run, delay) in found.runs.iter().zip(delays) {
        assert!((run.own_clock + common - delay).abs() < 8e-3, "{run:?}, and {delay} was put in");
        assert!((run.delay.unwrap().value - common).abs() < 5e-3, "{run:?}");
    }
    let said = found.clocks().unwrap();
    assert!(
        said.contains(&format!("{} by +1", runs[3].name)) && said.contains(&format!("{} by -", runs[2].name)),
        "{said}"
    );
    // Nothing is lost but poses from before the first row.
    for (laid, run) in laid.iter().zip(&runs) {
        let [laid, log] = [laid, run].map(|run| run.log.as_ref().unwrap());
        assert!(laid.reference.len() + 6 > log.reference.len() && laid.time.len() >= log.time.len(), "{}", run.name);
    }
    for one_clock in [drive(&[0.1]), drive(&[0.0, 0.01, -0.01, 0.005]), Drive { rate: 2e-3, seconds: 120.0, ..clean() }]
    {
        let runs = one_clock.runs();
        let (laid, found) = Setup::on_own_clocks(&runs, &robot(), None);
        assert!(matches!(laid, Cow::Borrowed(_)) && found.runs.iter().all(|run| run.own_clock == 0.0));
        assert_eq!(found.clocks(), None);
    }
}

/// A clock that is fast is later in the middle of a long run than in that of a short one.
#[test]
fn a_clock_that_is_fast_is_no_clock_of_each_run() {
    let on = |seconds: f64, runs| Drive { rate: 2e-3, delays: vec![1e-3 * seconds], runs, seconds, ..clean() }.runs();
    let mut runs = on(120.0, 3);
    runs.extend(on(240.0, 1).into_iter().map(|run| Run { name: "long".into(), ..run }));
    let (laid, found) = Setup::on_own_clocks(&runs, &robot(), None);
    assert!(matches!(laid, Cow::Borrowed(_)), "{:?}", found.runs);
}

#[test]
fn a_clock_that_is_fast_or_slow_is_found() {
    for rate in [-1e-3, 2e-3] {
        let found = Drive { rate, runs: 3, seconds: 120.0, ..clean() }.found();
        near(found.mounting.unwrap().rate, rate, 2e-4);
    }
}
