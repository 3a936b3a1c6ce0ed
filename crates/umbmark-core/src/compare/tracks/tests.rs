//! Simulated tracks whose cause is known.

use super::*;
use crate::dataset::ReferencePose;
use crate::diagnose::first_model;
use crate::diagnose::tests::{margin, trials};
use crate::drive::{Encoder, Robot};
use crate::effect::{Formula, Target};
use crate::geometry::Pose2;
use crate::likelihood::watched::{watched, watched_on};
use crate::path::{CIRCLE, Path, SQUARE, SpeedProfile};
use rayon::prelude::*;
use std::io::Write;

/// A robot with usual errors of wheels and reference, plus further effects.
fn robot_with(effects: &[(&str, &str, f64)]) -> Model {
    of_robot(&Robot::labmate(), effects)
}

fn of_robot(robot: &Robot, effects: &[(&str, &str, f64)]) -> Model {
    let mut model = Model::new(robot);
    let usual = [
        ("wheel_diameter_ratio", "e_d", 1.0012),
        ("wheelbase", "e_b", 0.993),
        ("scale", "e_s", 1.002),
        ("wheel_noise", "k_sqrt_m", 4e-4),
        ("reference_noise", "position_sd_m", 8e-4),
        ("reference_noise", "heading_sd_rad", 8e-4),
    ];
    for (effect, parameter, value) in usual.iter().chain(effects) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

fn judged(data: &Dataset, model: &Model) -> TracksJudged {
    compare_tracks(data, &[("asked".into(), model.clone())], &Options::default()).unwrap().models.remove(0)
}

/// The rates against a covariate.
fn asked<'a>(judged: &'a TracksJudged, rate: Rate, covariate: &str) -> &'a Against {
    judged.errors.against.iter().find(|a| a.rate == rate && a.covariate.name == covariate).unwrap()
}

fn p_adjusted(judged: &TracksJudged, rate: Rate, covariate: &str) -> f64 {
    asked(judged, rate, covariate).test.unwrap().p * judged.errors.tests as f64
}

/// Seed 5, 5 + 5 runs of a robot with one effect that its model lacks.
fn missing(effect: &str, parameter: &str, value: f64) -> TracksJudged {
    judged(&watched(&robot_with(&[(effect, parameter, value)]), 5, 5), &robot_with(&[]))
}

#[test]
fn a_kick_of_casters_shows_in_the_first_centimetres_after_turns_with_its_size_and_in_legs() {
    let kick = 0.02;
    let judged = missing("caster_kick", "kick_rad", kick);
    assert!(p_adjusted(&judged, Rate::Yaw, "since_turn") < 0.01, "{:?}", judged.sentences);
    assert_eq!(judged.explains(0.05), Some(false));
    let against = asked(&judged, Rate::Yaw, "since_turn");
    for bin in against.bins.iter().filter(|bin| bin.span.low < 0.15) {
        let left = |way: f64| libm::exp(-way / 0.05);
        let expected = kick * (left(bin.span.low) - left(bin.span.high)) / (bin.span.high - bin.span.low);
        let mean = bin.mean.unwrap();
        assert_eq!(mean.runs, 5);
        assert!((mean.value * bin.span.sense / expected - 1.0).abs() < 0.25, "{bin:?} {expected}");
    }
    // Leg 1 has no kick; legs 2 to 4 have it, in the sense of the turns.
    let legs = judged.errors.parts.iter().filter(|p| p.by == By::Move && p.name.starts_with("leg"));
    for leg in legs {
        let expected = if leg.name == "leg 1" { 0.0 } else { kick * leg.direction.unwrap().sign() };
        let heading = leg.mean[2];
        assert!((heading.value - expected).abs() < 5e-3, "{leg:?} {expected}");
    }
}

#[test]
fn a_floor_slope_shows_against_the_heading_where_it_points() {
    let drift = 6e-3;
    let judged = missing("floor_slope", "drift_x", drift);
    assert!(p_adjusted(&judged, Rate::Forward, "heading") < 0.01, "{:?}", judged.sentences);
    assert!(p_adjusted(&judged, Rate::Sideways, "heading") < 0.01);
    let forward = asked(&judged, Rate::Forward, "heading");
    for (bin, expected) in [(0, drift), (4, -drift)] {
        let mean = forward.bins[bin].mean.unwrap();
        assert!((mean.value - expected).abs() < 1e-3, "{bin}: {mean:?}");
        let interval = mean.interval.unwrap();
        assert!(interval.high - interval.low < 0.5e-3, "{interval:?}");
    }
}

#[test]
fn a_slip_that_grows_with_speed_shows_against_the_speed() {
    // Runs at two speeds: within a run, only the ramps show the effect.
    let truth = robot_with(&[("speed_slip", "s_per_m", 0.02)]);
    let path = |speed: f64| {
        let [_, acceleration, pause] = SpeedProfile::default().values();
        Path::new(&SQUARE, &[2.0], SpeedProfile::new(speed, acceleration, pause).unwrap()).unwrap()
    };
    let mut data = watched_on(&path(0.2), &truth, 3, 5);
    let faster = watched_on(&path(0.5), &truth, 3, 6);
    data.runs
        .extend(faster.runs.into_iter().map(|run| crate::dataset::Run { name: format!("fast_{}", run.name), ..run }));
    let judged = judged(&data, &robot_with(&[]));
    assert!(p_adjusted(&judged, Rate::Forward, "speed") < 0.01, "{:?}", judged.sentences);
    let legs: Vec<&Part> =
        judged.errors.parts.iter().filter(|p| p.by == By::Speed && p.name.starts_with("legs")).collect();
    assert_eq!(legs.len(), 2);
    assert!(legs.iter().all(|leg| leg.count == 24 && leg.mean[0].runs == 6));
}

#[test]
fn a_kick_at_the_start_of_legs_shows_in_every_leg_the_same_way() {
    let kick = 0.02;
    let judged = missing("leg_kick", "kick_rad", kick);
    for leg in judged.errors.parts.iter().filter(|p| p.by == By::Kind && p.name == "all legs") {
        assert!((leg.mean[2].value - kick).abs() < 3e-3, "{leg:?}");
        assert!(leg.mean[2].interval.unwrap().contains(kick));
        assert_eq!(leg.count, 20);
    }
    let turns = judged.errors.parts.iter().find(|p| p.by == By::Kind && p.name == "all turns").unwrap();
    assert!(turns.mean[2].value.abs() < 3e-3, "{turns:?}");
    assert!(judged.sentences.iter().any(|s| s.starts_with("Not explained: yaw is off by")), "{:?}", judged.sentences);
}

#[test]
fn a_wheelbase_that_depends_on_the_sense_of_the_turn_shows_in_turns() {
    let judged = missing("direction_dependent_wheelbase", "difference", 0.02);
    assert!(p_adjusted(&judged, Rate::Turn, "last_turn") < 0.01, "{:?}", judged.sentences);
    let [right, _, left] = asked(&judged, Rate::Turn, "last_turn").bins[..] else { panic!() };
    let apart = right.mean.unwrap().value - left.mean.unwrap().value;
    assert!((apart.abs() - 0.02).abs() < 2e-3, "{apart}");
}

#[test]
fn shares_add_up_to_one_however_parts_are_gathered_and_those_of_one_cause_lie_where_it_is() {
    let judged = missing("caster_kick", "kick_rad", 0.02);
    for by in [By::Move, By::Kind, By::Direction, By::Run] {
        let of = |value: fn(&Share) -> f64| {
            judged.errors.parts.iter().filter(|p| p.by == by).map(|p| value(&p.share)).sum::<f64>()
        };
        for sum in [of(|s| s.position), of(|s| s.heading), of(|s| s.end)] {
            assert!((sum - 1.0).abs() < 1e-9, "{by:?}: {sum}");
        }
    }
    let of = |name: &str| {
        let parts = judged.errors.parts.iter().filter(|p| p.by == By::Kind && p.name == name);
        parts.map(|p| p.share.position).sum::<f64>()
    };
    assert!(of("all legs") > 0.9 && of("all turns").abs() < 0.1, "{} {}", of("all legs"), of("all turns"));
}

#[test]
fn whole_runs_end_with_the_error_of_their_last_place() {
    let judged = missing("floor_slope", "drift_x", 6e-3);
    let runs: Vec<&Part> = judged.errors.parts.iter().filter(|p| p.by == By::Run).collect();
    let mut squares = 0.0;
    for (part, residuals) in runs.iter().zip(&judged.errors.residuals) {
        let last = residuals.errors.last().unwrap();
        for k in 0..3 {
            assert!((part.mean[k].value - last[k]).abs() < 1e-12, "{part:?} {last:?}");
        }
        squares += last[0] * last[0] + last[1] * last[1];
    }
    assert!((judged.errors.end.position - (squares / 10.0).sqrt()).abs() < 1e-12);
}

/// Poses only at stops: the error of each move is measured, but no rate.
#[test]
fn poses_at_stops_tell_of_moves_and_not_of_rates() {
    let mut data = watched(&robot_with(&[("leg_kick", "kick_rad", 0.02)]), 4, 5);
    let robot = data.robot.clone().unwrap();
    for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
        let stops = moves_of(log, &robot);
        let stops = stops.iter().filter(|m| m.done == crate::inspect::Done::Stop).map(|m| (m.from + m.to) / 2);
        let nearest = |sample: usize| *log.reference.iter().min_by_key(|r| r.sample.abs_diff(sample)).unwrap();
        let kept: Vec<ReferencePose> = stops.map(nearest).collect();
        log.reference = kept;
        assert!((8..=9).contains(&log.reference.len()), "{}", log.reference.len());
    }
    let judged = judged(&data, &robot_with(&[]));
    assert!(judged.errors.overall.is_empty() && judged.errors.against.is_empty() && judged.errors.p.is_none());
    let legs: Vec<&Part> =
        judged.errors.parts.iter().filter(|p| p.by == By::Move && p.name.starts_with("leg")).collect();
    assert_eq!(legs.len(), 8);
    assert!(legs.iter().all(|leg| (leg.mean[2].value - 0.02).abs() < 5e-3), "{legs:?}");
    assert!(judged.sentences[0].starts_with("Too few runs, or poses too far apart"));
}

#[test]
fn without_headings_the_way_is_still_told_and_yaw_is_not() {
    let mut data = watched(&robot_with(&[("floor_slope", "drift_x", 6e-3)]), 5, 5);
    for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
        log.reference.iter_mut().for_each(|pose| pose.heading = None);
    }
    let comparison = compare_tracks(&data, &[("asked".into(), robot_with(&[]))], &Options::default()).unwrap();
    let judged = &comparison.models[0];
    assert!(judged.errors.along.heading.is_none() && judged.errors.overall.iter().all(|o| o.rate == Rate::Forward));
    assert!(p_adjusted(judged, Rate::Forward, "heading") < 0.01);
    assert!(comparison.remarks.iter().any(|remark| remark.starts_with("Headings were not measured")));
}

/// A sideways motion in turns looks like a marker ahead of the axle: nothing is added to a model that has it; the marker offset is added to
/// a model that has neither.
#[test]
fn the_place_of_the_marker_is_taken_from_the_motion_only_where_the_model_does_not_move_sideways_already() {
    let mut truth = robot_with(&[]);
    let crab = Formula::new("own", Target::SidewaysPerRadian, "a * sign(turn_rate)", &["a"]).unwrap();
    truth.add_formula(crab, &[0.03]).unwrap();
    let data = watched(&truth, 5, 11);
    let [right, without] = [&truth, &robot_with(&[])].map(|model| judged(&data, model));
    assert_eq!(right.errors.taken, []);
    assert_eq!(without.errors.taken.iter().map(|taken| taken.effect).collect::<Vec<_>>(), ["marker_offset"]);
    assert!(
        right.errors.along.position < 1.1 * without.errors.along.position,
        "{} {}",
        right.errors.along.position,
        without.errors.along.position
    );
}

/// A clock that is wrong by 60 ms at START and correct in the middle of a run: its offset without its rate makes the poses worse.
#[test]
fn offset_and_rate_of_the_clock_are_taken_together_though_neither_helps_alone() {
    let model = robot_with(&[]);
    let duration = watched(&model, 1, 3).runs[0].log.as_ref().unwrap().time.last().copied().unwrap();
    let clock = [("reference_delay", "delay_s", 0.06), ("reference_clock_rate", "ratio", -0.12 / duration)];
    let judged = judged(&watched(&robot_with(&clock), 5, 3), &model);
    let taken: Vec<&str> = judged.errors.taken.iter().map(|taken| taken.effect).collect();
    assert_eq!(taken, ["reference_delay", "reference_clock_rate"]);
    assert!(judged.errors.along.position < 0.03, "{:?}", judged.errors.along);
}

/// A robot that creeps ahead by 0.3 mm for each radian of a turn: it is shown, and it makes nothing worse that matters.
#[test]
fn an_error_that_repeats_but_is_worth_nothing_does_not_accuse() {
    let mut truth = robot_with(&[]);
    let creep = Formula::new("own", Target::ForwardPerRadian, "a", &["a"]).unwrap();
    truth.add_formula(creep, &[3e-4]).unwrap();
    let judged = judged(&watched(&truth, 10, 5), &robot_with(&[]));
    assert_eq!(judged.errors.taken, []);
    let of = |rate: Rate| judged.errors.overall.iter().find(|o| o.rate == rate).and_then(|o| o.test).unwrap();
    let (small, tests) = (of(Rate::TurnForward), judged.errors.tests as f64);
    assert!(small.p * tests < 0.01 && !small.matters(), "{small:?}");
    assert_eq!(judged.explains(0.05), Some(true), "{:?}", judged.sentences);
    let said = judged
        .sentences
        .iter()
        .find(|said| said.starts_with("Repeats, but lowers the error of runs left out by"))
        .unwrap();
    assert!(said.contains("forward in turns overall"), "{said}");
}

/// The reference of one run turns by half a radian along its way: the kicks that all runs share still matter.
#[test]
fn one_run_that_is_far_off_hides_no_error_of_all() {
    let mut data = watched(&robot_with(&[("caster_kick", "kick_rad", 0.005)]), 5, 5);
    let kicks = |data: &Dataset| asked(&judged(data, &robot_with(&[])), Rate::Yaw, "since_turn").test.unwrap();
    let before = kicks(&data);
    assert!(before.matters(), "{before:?}");
    let reference = &mut data.runs[0].log.as_mut().unwrap().reference;
    let last = reference.len() as f64;
    for (index, pose) in reference.iter_mut().enumerate() {
        let turned = Pose2::new(0.0, 0.0, 0.5 * index as f64 / last);
        let seen = turned.compose(&Pose2::new(pose.x, pose.y, pose.heading.unwrap()));
        (pose.x, pose.y, pose.heading) = (seen.x, seen.y, Some(seen.heading));
    }
    let after = kicks(&data);
    assert!(after.matters(), "{before:?} {after:?}");
}

/// The counters make a turn of 7 degrees one tick: steps that are counted short appear slow and have an error ahead.
#[test]
fn speeds_that_the_ticks_blur_are_not_asked() {
    let mut coarse = Robot::labmate();
    coarse.encoder = Encoder::new(100.0, None, None).unwrap();
    let truth = of_robot(&coarse, &[]);
    let told = judged(&watched(&truth, 5, 7), &truth);
    let asked = |judged: &TracksJudged, covariate: &str| {
        judged.errors.against.iter().filter(|a| a.covariate.name == covariate && a.test.is_some()).count()
    };
    assert_eq!(asked(&told, "turn_rate"), 0, "{:?}", told.sentences);
    let said = told.sentences.iter().find(|said| said.starts_with("Not tested within runs")).unwrap();
    assert!(said.contains("rotation in turns by the turn rate"), "{said}");
    assert!(asked(&told, "heading") > 0 && told.explains(0.05) == Some(true), "{:?}", told.sentences);
    let fine = judged(&watched(&robot_with(&[]), 5, 7), &robot_with(&[]));
    assert!(asked(&fine, "turn_rate") > 0 && fine.sentences.iter().all(|said| !said.starts_with("Not tested")));
}

/// Seeds 100 on. p of each test and of all together, for the true model and for one fitted to the same runs; on squares and on
/// circles.
#[test]
fn a_right_model_is_accused_no_more_often_than_is_asked() {
    let trials = trials(8);
    let truth = robot_with(&[]);
    let circle = Path::new(&CIRCLE, &[1.0, 1.0], SpeedProfile::default()).unwrap();
    let models = |data: &Dataset, fitted: bool| {
        let model = fitted.then(|| evidence::fit(data, &first_model(data).unwrap()).unwrap().model);
        [Some(truth.clone()), model].into_iter().flatten().map(|model| (String::new(), model)).collect::<Vec<_>>()
    };
    let outcomes = |path: Option<&Path>| -> Vec<Vec<(bool, usize, usize)>> {
        let outcome = |judged: &TracksJudged| {
            let tests =
                judged.errors.overall.iter().map(|o| o.test).chain(judged.errors.against.iter().map(|a| a.test));
            let p = tests.flatten().map(|test| test.p);
            (judged.explains(0.05) == Some(false), p.filter(|p| *p < 0.05).count(), judged.errors.tests)
        };
        let of = |trial| {
            let data = match path {
                Some(path) => watched_on(path, &truth, 5, 100 + trial),
                None => watched(&truth, 5, 100 + trial),
            };
            let compared = compare_tracks(&data, &models(&data, path.is_none()), &Options::default()).unwrap();
            compared.models.iter().map(outcome).collect()
        };
        (0..trials).into_par_iter().map(of).collect()
    };
    let [squares, circles] = [None, Some(&circle)].map(outcomes);
    for (case, of, place) in [("squares", &squares, 0), ("circles", &circles, 0), ("squares, fitted", &squares, 1)] {
        let outcomes: Vec<_> = of.iter().map(|models| models[place]).collect();
        let share = outcomes.iter().filter(|o| o.0).count() as f64 / trials as f64;
        let (small, tests) = outcomes.iter().fold((0, 0), |(s, t), o| (s + o.1, t + o.2));
        let single = small as f64 / tests as f64;
        let _ = writeln!(
            std::io::stderr(),
            "{case}: accused {share:.3}, single tests {single:.4} of {tests}, n = {trials}"
        );
        assert!(share < 0.05 + margin(0.05, trials), "{case}: {share}");
        // Single tests of one data set are correlated; their number counts as that of the sets.
        assert!(single < 0.05 + margin(0.05, trials), "{case}: {single}");
    }
}

/// The report and the figures take the errors without the judgement.
#[test]
fn errors_alone_are_those_of_the_comparison() {
    let kick = robot_with(&[("caster_kick", "kick_rad", 0.02)]);
    let data = watched(&kick, 2, 5);
    let models = [("nominal".to_owned(), robot_with(&[])), ("true".to_owned(), kick)];
    let alone = track_errors(&data, &models, &Options::default()).unwrap();
    let compared = compare_tracks(&data, &models, &Options::default()).unwrap();
    assert_eq!(alone.len(), 2);
    for (alone, judged) in alone.iter().zip(&compared.models) {
        assert_eq!(format!("{alone:?}"), format!("{:?}", judged.errors));
        assert!(alone.along.position > 0.0 && !alone.residuals.is_empty());
    }
}
