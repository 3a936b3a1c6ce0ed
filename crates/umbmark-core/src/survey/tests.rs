//! Fleets whose spread is known.

use super::*;
use crate::calibrate::{Correction, drive_again};
use crate::dataset::{ReturnError, Run};
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::path::{Direction, Path};
use crate::random::Stream;
use std::convert::Infallible;

/// E_b of a robot, its E_d, and its return poses of five squares each way.
fn robot(place: usize, spread: [f64; 2], odd: bool) -> Dataset {
    let (robot, path) = (Robot::labmate(), Path::umbmark());
    let mut stream = Stream::new(11, place as u64, 0);
    let e_d = 1.001 + spread[0] * stream.normal();
    let e_b = 1.0 + spread[1] * stream.normal() + if odd { 0.05 } else { 0.0 };
    let mut run = |(direction, number): (Direction, u32)| {
        let error =
            drive_again(&robot, &path, direction, &Correction { e_d, e_b, e_s: 1.0 }, &Correction::NONE).unwrap();
        let mut scatter = |size: f64| size * stream.normal();
        let heading = Some(error.heading.unwrap_or(0.0) + scatter(5e-3));
        let returned = Some(ReturnError { x: error.x + scatter(0.02), y: error.y + scatter(0.02), heading });
        let name = format!("{}_{number}", direction.name());
        Run { name, number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
    };
    let runs = (1..6).flat_map(|number| Direction::BOTH.map(|direction| (direction, number))).map(&mut run).collect();
    Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() }
}

fn of(count: usize, diagnosed: bool, load: impl Fn(usize) -> Result<Dataset, String> + Sync) -> Survey {
    let names: Vec<String> = (0..count).map(|place| format!("robot {place}")).collect();
    Watch::nobody(|watch| survey(&names, load, diagnosed, &Options { draws: 99, ..Options::default() }, watch))
}

#[test]
fn the_spread_of_a_fleet_is_told_without_the_errors_of_its_tests_and_the_odd_robot_is_named() {
    let spread = [5e-4, 8e-3];
    let found = of(60, false, |place| Ok(robot(place, spread, place == 17)));
    let out: Vec<&str> = found.outliers().map(|row| row.robot.as_str()).collect();
    assert_eq!(out, ["robot 17"]);
    for (among, (mean, spread)) in found.among.iter().zip([(1.001, spread[0]), (1.0, spread[1])]) {
        let (low, high) = (among.deviation_interval.low, among.deviation_interval.high);
        assert!(low < spread && spread < high && high < 1.6 * low, "{among:?}");
        assert!((among.mean - mean).abs() < 3.0 * spread / f64::sqrt(59.0), "{among:?}");
    }
    assert_eq!((found.among[0].robots, found.among[1].robots), (60, 59));
    assert!(found.rows.iter().all(|row| row.verdict.is_none() && row.e_max_sys.is_some()));
}

#[test]
fn robots_that_are_all_alike_have_hardly_any_spread_and_none_stands_out() {
    let found = of(40, false, |place| Ok(robot(place, [0.0; 2], false)));
    assert!(found.outliers().next().is_none());
    assert!(found.among.iter().all(|among| among.deviation_interval.low < 0.5 * among.error), "{:?}", found.among);
}

/// The row of a robot has the verdict and the numbers that a call of its own gives.
#[test]
fn each_robot_is_diagnosed_as_by_itself_and_one_that_cannot_be_read_does_not_stop_the_others() {
    let found =
        of(4, true, |place| if place == 2 { Err("no such file".into()) } else { Ok(robot(place, [0.0; 2], false)) });
    assert_eq!(found.failed, [("robot 2".to_owned(), "no such file".to_owned())]);
    let data = robot(3, [0.0; 2], false);
    let alone = diagnose(&data, &first_model(&data).unwrap(), &Options { draws: 99, ..Options::default() }).unwrap();
    let row = found.rows.last().unwrap();
    assert_eq!((row.verdict, &row.numbers), (Some(alone.verdict), &alone.fitted));
    assert!(!alone.next_experiments.is_empty());
}

#[test]
fn a_survey_that_is_stopped_says_so() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let watch = Watch::new(&stop, &|_| ());
    let load = |_| Ok::<Dataset, Infallible>(Dataset::default());
    let found = survey(&["a".to_owned()], load, false, &Options::default(), &watch);
    assert!(found.partial && found.rows.is_empty() && found.failed.is_empty());
}
