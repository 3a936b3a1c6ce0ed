//! Robots whose numbers are known to depend on the floor, and robots whose do not.

use super::*;
use crate::calibrate::{Correction, drive_again};
use crate::dataset::{Dataset, ReturnError, Run, RunConditions, Stated};
use crate::diagnose::first_model;
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::likelihood::watched::watched;
use crate::path::{Direction, Path};
use crate::random::Stream;

type Size = (&'static str, &'static str, f64);

fn robot(effects: &[Size]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    let noise = [("wheel_noise", "k_sqrt_m", 3e-4), ("reference_noise", "position_sd_m", 1e-3)];
    for (effect, parameter, value) in noise.iter().chain(effects) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

fn tracks(effects: &[Size], runs: u64, seed: u64) -> Dataset {
    watched(&robot(effects), runs, seed)
}

/// Return poses of squares of 4 m, each with a scatter of 5 mm and 3 mrad.
fn returns(effects: &[Size], runs: u64, seed: u64) -> Dataset {
    let (robot, path, model) = (Robot::labmate(), Path::umbmark(), robot(effects));
    let mut stream = Stream::new(seed, 0, 0);
    let mut run = |(direction, number): (Direction, u64)| {
        let error = drive_again(&robot, &path, direction, &Correction::of(&model), &Correction::NONE).unwrap();
        let mut scatter = |size: f64| size * stream.normal();
        let heading = Some(error.heading.unwrap_or(0.0) + scatter(3e-3));
        let returned = Some(ReturnError { x: error.x + scatter(5e-3), y: error.y + scatter(5e-3), heading });
        let name = format!("{}_{number}", direction.name());
        Run { name, number: number as u32, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
    };
    let runs =
        (0..runs).flat_map(|number| Direction::BOTH.map(|direction| (direction, number))).map(&mut run).collect();
    Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() }
}

/// Datasets as one.
fn joined(sets: Vec<(&str, Dataset)>) -> Dataset {
    Dataset::joined(sets.into_iter().map(|(name, data)| (name.to_owned(), data)).collect()).unwrap()
}

/// All runs of one dataset, with what is stated of each by its place.
fn stating(mut data: Dataset, of: impl Fn(usize) -> Vec<(&'static str, Stated)>) -> Dataset {
    let stated = |(place, run): (usize, &Run)| RunConditions {
        run: run.name.clone(),
        stated: of(place).into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
    };
    data.conditions = data.runs.iter().enumerate().map(stated).collect();
    data
}

fn word(text: &str) -> Stated {
    Stated::Word(text.to_owned())
}

fn found(data: &Dataset) -> Conditions {
    Watch::nobody(|watch| conditions(data, &first_model(data).unwrap(), &Options::default(), watch)).unwrap()
}

fn differing(found: &Conditions) -> Vec<String> {
    found
        .differing()
        .map(|asked| format!("{} by {}", asked.number.parameter, found.conditions[asked.condition].condition.names[0]))
        .collect()
}

#[test]
fn a_wheelbase_that_differs_between_floors_is_named_and_its_difference_is_right_by_tracks_and_by_return_poses() {
    let floors = |made: fn(&[Size], u64, u64) -> Dataset| {
        let of = |e_b, seed| made(&[("wheelbase", "e_b", e_b), ("wheel_diameter_ratio", "e_d", 1.002)], 4, seed);
        found(&joined(vec![("tile", of(1.0, 1)), ("carpet", of(1.02, 2))]))
    };
    for found in [floors(tracks), floors(returns)] {
        assert_eq!(differing(&found), ["e_b by session"], "{}", found.sentence());
        let asked = found.differing().next().unwrap();
        let largest = asked.largest.as_ref().unwrap();
        assert_eq!((largest.high.as_str(), largest.low.as_str()), ("carpet", "tile"));
        assert!((largest.by.value - 0.02).abs() < 4.0 * largest.by.standard_error, "{largest:?}");
        let is_near = |of: &Estimate, truth: f64| (of.value - truth).abs() < 4.0 * of.standard_error;
        assert!(is_near(&asked.levels[0].own, 1.0) && is_near(&asked.levels[1].own, 1.02), "{asked:?}");
        let shared = &found.numbers[0];
        assert_eq!((shared.number.parameter, shared.depends_on.len()), ("e_d", 0));
        assert!(is_near(&shared.value, 1.002), "{shared:?}");
        assert!(
            found.sentence().starts_with("The effective wheelbase, E_b, differs between sessions (p < 0.001): tile "),
            "{}",
            found.sentence()
        );
    }
}

/// A covariate that differs from run to run, beside floors that change within one session.
#[test]
fn a_slope_is_found_beside_levels_and_what_does_not_matter_is_not_named() {
    let model = |run: usize| {
        let load = f64::from((run * 7 % 10) as u32);
        let floor = if run % 4 < 2 { 0.0 } else { 0.015 };
        (load, floor, [("scale", "e_s", 1.0 - 4e-4 * load), ("wheelbase", "e_b", 1.0 + floor)])
    };
    let mut whole: Option<Dataset> = None;
    for run in 0..12 {
        let (_, _, sizes) = model(run);
        let mut own = tracks(&sizes, 1, 100 + run as u64);
        own.runs = vec![own.runs.remove(run % 2)];
        own.runs[0].name = format!("run {run}");
        own.runs[0].number = run as u32;
        match &mut whole {
            Some(whole) => whole.runs.append(&mut own.runs),
            None => whole = Some(own),
        }
    }
    let data = stating(whole.unwrap(), |run| {
        let (load, floor, _) = model(run);
        let floor = if floor > 0.0 { "felt" } else { "stone" };
        vec![("load_kg", Stated::Number(load)), ("floor", word(floor)), ("driver", word(["a", "b", "c"][run % 3]))]
    });
    let found = found(&data);
    assert_eq!(differing(&found), ["e_s by load_kg", "e_b by floor"], "{}", found.sentence());
    let slope = found.differing().next().unwrap().slope.unwrap();
    assert!(slope.interval.contains(-4e-4), "{slope:?}");
    assert_eq!(found.conditions[0].beside, ["floor", "driver"]);
    assert!(found.conditions.iter().all(|of| of.against == Against::Runs && of.like.is_empty()));
}

/// Floors that differ no more than sessions on one floor do are not said to.
#[test]
fn what_is_the_same_in_whole_sessions_is_compared_with_sessions() {
    let days = [("a", 0.995), ("b", 1.005), ("c", 0.994), ("d", 1.006), ("e", 0.996), ("f", 1.004)];
    let set = |(day, (name, e_b)): (usize, &(&'static str, f64))| {
        let floor = if day % 3 == 0 { "tile" } else { "felt" };
        (*name, stating(returns(&[("wheelbase", "e_b", *e_b)], 3, 50 + day as u64), |_| vec![("floor", word(floor))]))
    };
    let found = found(&joined(days.iter().enumerate().map(set).collect()));
    assert_eq!(found.conditions[0].against, Against::Sessions);
    assert_eq!(differing(&found), ["e_b by session"], "{}", found.sentence());
    let between = found.differing().next().unwrap().between.as_ref().unwrap();
    assert!((0.003..0.012).contains(&between.deviation), "{between:?}");
}

#[test]
fn conditions_that_runs_do_not_separate_are_named_together() {
    let tile = stating(returns(&[], 3, 1), |_| vec![("floor", word("tile")), ("load_kg", Stated::Number(0.0))]);
    let felt = stating(returns(&[("wheelbase", "e_b", 1.03)], 3, 2), |_| {
        vec![("floor", word("felt")), ("load_kg", Stated::Number(5.0))]
    });
    let found = found(&joined(vec![("a", tile), ("b", felt)]));
    assert_eq!(found.conditions.len(), 1);
    assert_eq!(found.conditions[0].condition.names, ["floor", "load_kg", "session"]);
    assert_eq!(differing(&found), ["e_b by floor"]);
    assert!(
        found.remarks()[0].starts_with("floor and load_kg and session divide the runs alike"),
        "{:?}",
        found.remarks()
    );
}

/// With 5 %, more than four of 20 are accused with a probability of 0.3 %; 2000 are in docs/studies/conditions.md.
#[test]
fn robots_that_are_the_same_everywhere_are_rarely_accused() {
    let of = |seed: u64| {
        let data = stating(returns(&[("wheelbase", "e_b", 0.99)], 6, seed), |run| {
            vec![
                ("floor", word(["a", "b", "c"][run % 3])),
                ("load_kg", Stated::Number(f64::from((run * 5 % 12) as u32))),
            ]
        });
        found(&data).differs()
    };
    let accused = (0..20).filter(|seed| of(*seed)).count();
    assert!(accused <= 4, "{accused}");
}

#[test]
fn runs_without_conditions_or_with_the_same_ones_are_refused_by_what_is_missing() {
    let ask = |data: &Dataset| {
        let start = first_model(data).unwrap();
        Watch::nobody(|watch| conditions(data, &start, &Options::default(), watch)).unwrap_err()
    };
    let bare = returns(&[], 3, 1);
    assert_eq!(ask(&bare), ConditionsError::NothingStated);
    let same = stating(bare.clone(), |_| vec![("floor", word("tile"))]);
    let refused = ask(&same);
    assert_eq!(
        refused.to_string(),
        "floor is the same in all 6 runs, so nothing can be compared: drive under other conditions too"
    );
    let single = stating(bare.clone(), |run| vec![("floor", word(&run.to_string()))]);
    assert!(matches!(ask(&single), ConditionsError::TooFew { runs: 6 }));
    let mut none = same;
    none.runs.iter_mut().for_each(|run| run.returned = None::<ReturnError>);
    assert!(matches!(ask(&none), ConditionsError::Fit { group: None, .. }));
}
