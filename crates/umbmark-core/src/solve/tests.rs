//! Answers for simulated robots, whose numbers are known.

use super::off::Measure;
use super::*;
use crate::action::Action;
use crate::calibrate::Method;
use crate::diagnose::tests::{robot_with, simulated};
use crate::likelihood::watched::{watched, watched_on};
use crate::path::{Path, SQUARE, STRAIGHT, SpeedProfile};

fn answer(data: &Dataset) -> Solution {
    let start = Model::new(data.nominal_robot().unwrap());
    Watch::nobody(|watch| solve(data, &start, &Options::default(), watch)).unwrap()
}

fn robot(effects: &[(&'static str, &'static str, f64)]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    let noise = [("wheel_noise", "k_sqrt_m", 3e-4), ("reference_noise", "position_sd_m", 1e-3)];
    for (effect, parameter, value) in noise.iter().chain(effects) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

/// Squares at this speed, and at 0.5 m/s.
fn at_two_speeds(truth: &Model, slow: f64) -> Dataset {
    let at = |speed: f64, seed: u64| {
        let [_, acceleration, pause] = SpeedProfile::default().values();
        let path = Path::new(&SQUARE, &[2.0], SpeedProfile::new(speed, acceleration, pause).unwrap()).unwrap();
        watched_on(&path, truth, 3, seed)
    };
    let (mut data, faster) = (at(slow, 5), at(0.5, 6));
    data.runs
        .extend(faster.runs.into_iter().map(|run| crate::dataset::Run { name: format!("fast_{}", run.name), ..run }));
    data
}

fn total(parts: &[Part]) -> f64 {
    parts.iter().map(|part| part.worth).sum()
}

/// Wheels, wheelbase and a floor that turns the robot: the numbers are those of the wheels, the floor is known beside them, and what each
/// is worth adds up.
#[test]
fn a_floor_is_no_number_of_the_robot_and_what_everything_is_worth_adds_up() {
    let truth = [
        ("wheel_diameter_ratio", "e_d", 1.001),
        ("wheelbase", "e_b", 0.995),
        ("scale", "e_s", 0.998),
        ("floor_slope_yaw", "sine_rad_per_m", 0.03),
    ];
    let data = watched(&robot(&truth), 5, 3);
    let found: Vec<Solution> = (3..7).map(|seed| answer(&watched(&robot(&truth), 5, seed))).collect();
    let answer = &found[0];
    let off = answer.off.as_ref().unwrap();
    assert_eq!((off.measure, answer.learnt.verdict), (Measure::Returns, Verdict::Explained));
    assert_eq!(off.known.iter().map(|part| part.name).collect::<Vec<_>>(), ["floor_slope_yaw"]);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    near(off.driven - total(&off.reference) - total(&off.written), off.with_numbers);
    near(off.with_numbers - total(&off.known), off.rest);
    near(answer.changes.iter().map(|change| change.worth.unwrap()).sum(), total(&off.written));
    let lengths = [
        ("wheelbase_m", 0.995),
        ("wheel_diameter_left_m", 0.998 * 2.0 / 2.001),
        ("wheel_diameter_right_m", 0.998 * 2.002 / 2.001),
    ];
    // Four robots, 12 intervals of 95 %: more than two of them miss the truth with a probability of 2 %.
    let misses = found.iter().flat_map(|answer| {
        lengths.iter().filter(|(key, ratio)| {
            let change = answer.change(key).unwrap();
            !change.interval.unwrap().contains(change.old * ratio)
        })
    });
    assert!(misses.count() <= 2);
    for (key, _) in lengths {
        let change = answer.change(key).unwrap();
        assert!(!change.interval.unwrap().contains(change.old), "{change:?}");
    }
    assert!(answer.needed && answer.is_trusted() && !answer.misses_something());
    assert!(answer.sentence().contains("yaw on a sloping floor"), "{}", answer.sentence());
    // Beside it, the fit of the wheels alone takes the floor for wheels.
    let options = calibrate::Options::default();
    let (calibration, _) =
        Watch::nobody(|watch| calibrate_beside(&data, &options, &Options::default(), watch)).unwrap();
    assert_eq!(calibration.to_write().unwrap().method, Method::Model);
    let warned = calibration.warnings.iter().any(|warning| warning.contains("do not explain these runs"));
    assert!(warned, "{:?}", calibration.warnings);
}

#[test]
fn a_robot_without_errors_gets_nothing_to_write() {
    let data = simulated(
        &robot_with(&[("wheel_diameter_ratio", "e_d", 1.0), ("wheelbase", "e_b", 1.0)]),
        &Path::umbmark(),
        5,
        2,
        0..1,
    );
    let answer = answer(&data[0]);
    assert!(!answer.needed, "{:?}", answer.changes);
    assert!(answer.sentence().ends_with("nothing is to be written."), "{}", answer.sentence());
    assert!(answer.next(Action::plain).iter().all(|step| !step.contains("Write")), "{:?}", answer.next(Action::plain));
}

#[test]
fn numbers_that_make_it_worse_are_not_to_be_written() {
    let truth = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.97), ("scale", "e_s", 0.99)];
    let mut answer = answer(&watched(&robot(&truth), 3, 5));
    assert!(
        answer.is_trusted() && answer.next(Action::plain)[0].starts_with("Write the new numbers"),
        "{:?}",
        answer.next(Action::plain)
    );
    // As if the runs had missed by less as they were driven.
    let off = answer.off.as_mut().unwrap();
    off.driven = 0.8 * off.with_numbers;
    assert!(answer.makes_worse() && !answer.is_trusted());
    assert!(answer.sentence().ends_with("as driven: do not write them."), "{}", answer.sentence());
    assert!(answer.doubt().is_some_and(|why| why.contains("do not write them")));
    assert!(answer.next(Action::plain).iter().all(|step| !step.contains("Write")), "{:?}", answer.next(Action::plain));
}

#[test]
fn lengths_that_a_tape_tells_better_are_not_to_be_written() {
    let truth = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.97), ("scale", "e_s", 0.99)];
    let mut answer = answer(&watched(&robot(&truth), 3, 5));
    assert!(answer.is_trusted() && answer.vague().next().is_none());
    // As if the wheels were known to 56 %, and then to 9 %.
    let mut widen = |share: f64| {
        for change in answer.changes.iter_mut().filter(|change| change.key.starts_with("wheel_diameter")) {
            change.interval = Some(crate::stats::Interval::around(change.new, share * change.new));
        }
        (answer.is_trusted(), answer.sentence(), answer.doubt(), answer.next(Action::plain))
    };
    let (trusted, sentence, doubt, next) = widen(0.56);
    let told = "These runs leave the wheel diameters open, by up to 56 % either way";
    assert!(!trusted && sentence.contains(told) && doubt.is_some_and(|why| why.starts_with(told)), "{sentence}");
    assert!(next.iter().all(|step| !step.contains("Write")), "{next:?}");
    assert!(widen(0.09).0);
}

/// A law of the turn rate that no catalogue lists turns the robot by more than its wheels and wheelbase do.
#[test]
fn numbers_that_a_law_of_unknown_cause_outweighs_are_not_to_be_written() {
    let mut truth = robot(&[("wheelbase", "e_b", 1.001)]);
    let text = "a * sin(2 * pi * time / 17)";
    let wave = crate::effect::Formula::new("own", crate::effect::Target::HeadingPerMetre, text, &["a"]).unwrap();
    truth.add_formula(wave, &[0.03]).unwrap();
    let mut answer = answer(&watched(&truth, 5, 3));
    assert_eq!(answer.learnt.verdict, Verdict::UnlistedEffect);
    answer.needed = true;
    let [laws, numbers] = answer.outweighed().unwrap();
    assert!(laws > numbers && !answer.is_trusted());
    assert!(answer.sentence().ends_with("do not write them before it is found."), "{}", answer.sentence());
    assert!(answer.next(Action::plain)[0].starts_with("Find the cause of the law"), "{:?}", answer.next(Action::plain));
    // As if the numbers had been worth more.
    answer.off.as_mut().unwrap().driven += 2.0 * laws;
    assert!(answer.outweighed().is_none() && answer.is_trusted());
}

#[test]
fn straight_runs_give_the_wheels_and_no_wheelbase() {
    let truth = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.97), ("scale", "e_s", 0.99)];
    let path = Path::new(&STRAIGHT, &[4.0], SpeedProfile::default()).unwrap();
    let answer = answer(&watched_on(&path, &robot(&truth), 4, 5));
    let keys: Vec<&str> = answer.changes.iter().map(|change| change.key).collect();
    assert_eq!(keys, ["wheel_diameter_left_m", "wheel_diameter_right_m"]);
    assert_eq!(answer.not_shown, ["wheelbase"]);
    assert!(
        answer.next(Action::plain).iter().any(|step| step.contains("do not show the wheelbase")),
        "{:?}",
        answer.next(Action::plain)
    );
}

#[test]
fn exchanged_wheels_come_first_and_no_number_is_given() {
    let mut data = watched(&robot(&[("wheelbase", "e_b", 0.98)]), 3, 4);
    for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
        std::mem::swap(&mut log.left, &mut log.right);
    }
    let answer = answer(&data);
    assert!(answer.changes.is_empty() && !answer.is_trusted());
    assert!(answer.sentence().contains("write wheels_exchanged = true"), "{}", answer.sentence());
    assert!(
        answer.next(Action::plain)[0].starts_with("Write wheels_exchanged = true"),
        "{:?}",
        answer.next(Action::plain)
    );
}

/// Another effect with which the scale is 1 % larger: if it is as likely as the one that was added, intervals hold both values; with a
/// quarter of its weight, half as much is added to them.
#[test]
fn numbers_allow_for_other_effects_as_far_as_these_are_likely() {
    let truth = [("wheel_diameter_ratio", "e_d", 1.001), ("wheelbase", "e_b", 0.995), ("scale", "e_s", 0.998)];
    let learnt = answer(&watched(&robot(&truth), 5, 3)).learnt;
    let scale = learnt.diagnosis.fitted.iter().position(|own| own.effect == "scale").unwrap();
    let diameter = |others: &[Other]| {
        let mut learnt = learnt.clone();
        others::widen(&mut learnt.diagnosis, others, 0.95);
        let (changes, _) = numbers::of(&learnt, 0.05);
        changes.into_iter().find(|change| change.key == "wheel_diameter_left_m").unwrap()
    };
    let half = |change: &Change| 0.5 * change.interval.map_or(0.0, |interval| interval.high - interval.low);
    let other = |weight| {
        let mut off = vec![0.0; learnt.diagnosis.fitted.len()];
        off[scale] = 0.01;
        Other { added: Some("missed_counts"), effect: "speed_slip", off, weight }
    };
    let (alone, likely, quarter) = (diameter(&[]), diameter(&[other(0.5)]), diameter(&[other(0.125)]));
    assert!(likely.interval.unwrap().contains(likely.new + 0.01 * likely.old), "{likely:?}");
    let added = |change: &Change| (half(change).powi(2) - half(&alone).powi(2)).sqrt();
    assert!((added(&quarter) / added(&likely) - 0.5).abs() < 1e-9, "{quarter:?} {likely:?}");
    assert_eq!((likely.new, quarter.new), (alone.new, alone.new));
}

/// Return poses of a floor that turns the robot: START that lies elsewhere and wheels that are not round do as well, and with each of them the
/// numbers are others.
#[test]
fn from_return_poses_every_effect_of_the_catalogue_may_stand_in_place_of_one_that_was_added() {
    let truth = robot_with(&[("wheelbase", "e_b", 0.99), ("floor_slope_yaw", "sine_rad_per_m", 0.02)]);
    let mut data = simulated(&truth, &Path::umbmark(), 5, 11, 0..1).remove(0);
    data.runs.iter_mut().for_each(|run| run.returned.as_mut().unwrap().heading = None);
    let answer = answer(&data);
    let step = answer.learnt.steps.iter().find(|step| step.p_adjusted.is_some()).unwrap();
    let in_place = |other: &&Other| other.added == step.added && !step.class.contains(&other.effect);
    let beyond: Vec<&Other> = answer.others.iter().filter(in_place).collect();
    assert!(beyond.iter().any(|other| other.weight > 0.01), "{:?}", answer.others);
    let total: f64 = answer.others.iter().map(|other| other.weight).sum();
    assert!(total < 1.0 + 1e-12, "{total}");
}

/// A number is right only if the runs would have shown that it is not.
#[test]
fn numbers_with_wide_intervals_are_not_called_right() {
    let right = robot_with(&[("wheel_diameter_ratio", "e_d", 1.0), ("wheelbase", "e_b", 1.0)]);
    let data = simulated(&right, &Path::umbmark(), 5, 2, 0..1).remove(0);
    let mut answer = answer(&data);
    assert!(!answer.needed && answer.tells_numbers(), "{:?} {:?}", answer.unseen, answer.off);
    let off = answer.off.as_mut().unwrap();
    (off.driven, off.with_numbers, off.known) = (0.07, 0.07, vec![Part { name: "floor_slope_yaw", worth: 0.07 }]);
    assert!(answer.sentence().contains("Its numbers are right"), "{}", answer.sentence());
    answer.unseen = Some(0.2);
    assert!(answer.sentence().contains("do not tell whether its numbers are right"), "{}", answer.sentence());
}

/// Counts that are missed above 0.2 m/s, at speeds on both sides: slip that grows from rest on has nearly the same signature, but these runs refuse
/// it, and the intervals stay narrow.
#[test]
fn an_effect_of_a_class_that_the_runs_refuse_widens_no_interval() {
    let truth = [
        ("missed_counts", "left_s_per_m", 0.1),
        ("missed_counts", "right_s_per_m", 0.1),
        ("missed_counts", "threshold_m_s", 0.2),
    ];
    let answer = answer(&at_two_speeds(&robot(&truth), 0.15));
    for key in ["wheel_diameter_left_m", "wheel_diameter_right_m"] {
        let change = answer.change(key).unwrap();
        let interval = change.interval.unwrap();
        assert!(interval.high - interval.low < 2e-3 * change.old, "{change:?} {:?}", answer.others);
    }
}

/// Slip that grows with the speed, on squares at one speed: the turns, which are slower, show it, but runs left out hardly need it, and it
/// is not added. E_s is off by what it does at that speed, and its interval says so.
#[test]
fn what_a_significant_effect_that_is_not_added_would_do_is_in_the_intervals() {
    let truth = robot(&[
        ("wheel_diameter_ratio", "e_d", 1.002),
        ("wheelbase", "e_b", 1.01),
        ("speed_slip", "s_per_m", 0.02),
        ("wheel_noise", "k_sqrt_m", 5e-4),
        ("reference_noise", "position_sd_m", 2e-3),
    ]);
    let [_, acceleration, pause] = SpeedProfile::default().values();
    let path = Path::new(&SQUARE, &[4.0], SpeedProfile::new(0.2, acceleration, pause).unwrap()).unwrap();
    let mut not_added = 0;
    for seed in 1..=2 {
        let answer = answer(&watched_on(&path, &truth, 5, seed));
        let has_slip = answer.learnt.model.parts().iter().any(|part| part.effect.name() == "speed_slip");
        let scale = answer.learnt.diagnosis.fitted.iter().find(|own| own.effect == "scale").unwrap();
        let [value, error] = [scale.value, scale.standard_error];
        not_added += u32::from(!has_slip);
        assert!((value - 1.0).abs() < 3.0 * error && error < 5e-3, "{seed}: {value} {error}");
        // The wheelbase is off by more than any of them leaves open.
        assert!(answer.needed, "{seed}: {}", answer.sentence());
    }
    assert!(not_added > 0);
}
