//! Diagnoses of simulated tests, whose cause is known.

use super::ends::{Asked, Family, Moments};
use super::*;
use crate::dataset::{ReturnError, Run};
use crate::effect::{Changes, TestKind};
use crate::evidence::ends::Fitted;
use crate::evidence::noise_shape;
use crate::geometry::wrap;
use crate::path::{Direction, FIGURE_EIGHT, Path, SpeedProfile};
use crate::random::Stream;
use crate::replay::Track;
use crate::setup::{Fault, Suspicion};
use crate::stats::chi_squared_upper_tail;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::io::Write;

/// A robot like the paper's, with E_d, E_b and scatter of the paper's size, and one more cause.
pub(crate) fn robot_with(effects: &[(&str, &str, f64)]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    let usual =
        [("wheel_diameter_ratio", "e_d", 1.00121), ("wheelbase", "e_b", 0.9918), ("wheel_noise", "k_sqrt_m", 1e-3)];
    for (effect, parameter, value) in usual.iter().chain(effects) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

pub(crate) fn dataset(path: &Path, errors: &[(Direction, ReturnError)]) -> Dataset {
    let run = |(i, (direction, error)): (usize, &(Direction, ReturnError))| Run {
        name: format!("{}_{i}", direction.name()),
        number: i as u32 + 1,
        direction: Some(*direction),
        test: TestKind::Systematic,
        log: None,
        returned: Some(*error),
    };
    let runs = errors.iter().enumerate().map(run).collect();
    Dataset { robot: Some(Robot::labmate()), path: Some(path.clone()), runs, ..Dataset::default() }
}

/// Tests of n + n runs on a path: the end poses that the model predicts with the scatter that its wheel noise gives them.
pub(crate) fn simulated(truth: &Model, path: &Path, n: usize, seed: u64, trials: std::ops::Range<u64>) -> Vec<Dataset> {
    let robot = Robot::labmate();
    let k = truth.get("wheel_noise", "k_sqrt_m").unwrap();
    let ends = Direction::BOTH.map(|direction| {
        let track = Track::in_pieces(path, direction, &robot);
        let shape = noise_shape::end_covariance(&Track::from_path(path, direction, &robot), &robot.drive);
        let (end, told) = (track.end(&truth.chain()), path.end(direction));
        let mean = Vector3::new(end.x - told.x, end.y - told.y, wrap(end.heading - told.heading));
        (direction, mean, shape.cholesky().unwrap().l() * k)
    });
    let test = |trial: u64| {
        let mut stream = Stream::new(seed, 0, trial);
        let mut errors = Vec::new();
        for (direction, mean, root) in &ends {
            for _ in 0..n {
                let error = mean + root * Vector3::new(stream.normal(), stream.normal(), stream.normal());
                errors.push((*direction, ReturnError { x: error.x, y: error.y, heading: Some(error.z) }));
            }
        }
        dataset(path, &errors)
    };
    trials.map(test).collect()
}

fn base() -> Model {
    base_model(&Robot::labmate()).unwrap()
}

/// How many simulated tests a study makes; more where UMBMARK_TEST_CASES says so.
pub(crate) fn trials(default: u64) -> u64 {
    std::env::var("UMBMARK_TEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(default)
}

/// 3.5 standard errors of a share about `p`.
pub(crate) fn margin(p: f64, trials: u64) -> f64 {
    3.5 * (p * (1.0 - p) / trials as f64).sqrt()
}

/// Seed 3; LabMate-like errors, larger ones of the other sign, and none. The asymptotic test, which uses the estimated covariance as if it
/// were true, shows that this study can detect a wrong size.
#[test]
fn the_test_of_the_whole_model_has_its_size_and_plug_in_chi_square_has_not() {
    let trials = trials(1000);
    for (e_d, e_b) in [(1.00121, 0.9918), (1.003, 1.01), (1.0, 1.0)] {
        let truth = robot_with(&[("wheel_diameter_ratio", "e_d", e_d), ("wheelbase", "e_b", e_b)]);
        let (mut exact, mut plug_in) = (0, 0);
        for data in simulated(&truth, &Path::umbmark(), 5, 3, 0..trials) {
            let ends = Ends::new(&data).unwrap();
            let fitted = Fitted::new(&ends, &base()).unwrap();
            exact += u64::from(Asked::wilks_p(&ends, &fitted).unwrap() < 0.05);
            plug_in += u64::from(chi_squared_p(&ends, &fitted) < 0.05);
        }
        let [exact, plug_in] = [exact, plug_in].map(|count| count as f64 / trials as f64);
        let _ = writeln!(std::io::stderr(), "size at E_d {e_d}, E_b {e_b}: {exact}, chi-square {plug_in} of {trials}");
        assert!((exact - 0.05).abs() < margin(0.05, trials).max(0.01), "{exact}");
        assert!(plug_in > 0.15, "{plug_in}");
    }
}

/// Two contrasts a direction in units of their pooled covariance, as if that were known.
fn chi_squared_p(ends: &Ends, fitted: &Fitted) -> f64 {
    let side = 4.0;
    let contrasts = |r: &Vector3<f64>| Vector3::new(r.x + r.y, r.z - (r.x - r.y) / side, 0.0);
    let runs: Vec<_> =
        ends.runs.iter().zip(&fitted.residuals).map(|(run, r)| (run.direction as usize, contrasts(r))).collect();
    let moments = Moments::of(&runs, 2);
    let inverse = (moments.scatter / moments.freedom()).try_inverse().unwrap();
    let squares = |g: usize| moments.count(g) * moments.means[g].dot(&(inverse * moments.means[g]));
    chi_squared_upper_tail(squares(0) + squares(1), 4.0)
}

/// Seed 19. Found: certified. Right: the class holds the slope.
#[test]
fn a_floor_slope_is_found_and_its_class_is_right() {
    let trials = trials(60);
    let data = simulated(&robot_with(&[("floor_slope", "drift_x", 3e-3)]), &Path::umbmark(), 5, 19, 0..trials);
    let options = Options { draws: 499, ..Options::default() };
    let certified: Vec<Vec<&str>> = data
        .par_iter()
        .filter_map(|data| Some(diagnose(data, &base(), &options).unwrap().certified().first()?.class.clone()))
        .collect();
    let right = certified.iter().filter(|class| class.contains(&"floor_slope")).count() as u64;
    let found = certified.len() as u64;
    let _ = writeln!(std::io::stderr(), "slope of 3 mm/m: found {found} of {trials}, class right {right}");
    assert!(found as f64 / trials as f64 > 0.9 - margin(0.9, trials));
    assert!(right as f64 / found as f64 > 0.95 - margin(0.95, found));
}

/// Seed 5. To first order, left turns 0.4 % too large and right turns 0.4 % too small are E_d = 1 + 0.004 · π/2 · b/L = 1.0005.
#[test]
fn a_wheelbase_that_depends_on_the_direction_is_absorbed_and_named_among_what_cannot_be_told() {
    let mut truth = robot_with(&[("direction_dependent_wheelbase", "difference", -8e-3)]);
    truth.set("wheel_diameter_ratio", "e_d", 1.0).unwrap();
    truth.set("wheel_noise", "k_sqrt_m", 1e-4).unwrap();
    for data in simulated(&truth, &Path::umbmark(), 5, 5, 0..3) {
        let diagnosis = diagnose(&data, &base(), &Options::default()).unwrap();
        let e_d = diagnosis.fitted.iter().find(|e| e.parameter == "e_d").unwrap().value;
        assert!((e_d - 1.00053).abs() < 1e-4, "{e_d}");
        assert!(diagnosis.certified().iter().all(|s| !s.class.contains(&"direction_dependent_wheelbase")));
        let unseen = diagnosis.invisible.iter().find(|u| u.effect == "direction_dependent_wheelbase").unwrap();
        assert_eq!(unseen.why, Why::Absorbed(vec!["wheel_diameter_ratio"]));
        let next = diagnosis.next_experiments.iter();
        let told = next.filter(|e| e.separates == ["wheel_diameter_ratio", "direction_dependent_wheelbase"]);
        assert!(told.count() == 1);
    }
}

/// The paper's K2A: return headings of 3.77 and 0.97 degrees, yet E_max,sys 63 mm. Heading and angle about the centre differ.
#[test]
fn the_k2a_contradicts_e_d_and_e_b() {
    let mut stream = Stream::new(2, 0, 0);
    let mut errors = Vec::new();
    for (direction, x, y, degrees) in [(Direction::Cw, -0.04, 0.0487, 3.77), (Direction::Ccw, 0.03, -0.03, 0.97_f64)] {
        for _ in 0..5 {
            let mut near = |mean: f64, sd: f64| mean + sd * stream.normal();
            let heading = Some(near(degrees, 0.2).to_radians());
            errors.push((direction, ReturnError { x: near(x, 0.02), y: near(y, 0.02), heading }));
        }
    }
    let diagnosis = diagnose(&dataset(&Path::umbmark(), &errors), &base(), &Options::default()).unwrap();
    assert!(diagnosis.goodness_of_fit[0].p < 0.01 && diagnosis.verdict != Verdict::Explained);
    let said = diagnosis.remarks.iter().find(|r| r.starts_with("cw runs")).unwrap();
    // 4 m √2 · 2 sin(1.885 deg)/2 = 186 mm.
    assert!(said.contains("would put the end 18") || said.contains("would put the end 19"), "{said}");
    assert!(said.contains("E_d and E_b contradict these poses"), "{said}");
}

fn one_set(n: usize) -> Dataset {
    simulated(&robot_with(&[]), &Path::umbmark(), n, 7, 0..1).remove(0)
}

#[test]
fn one_direction_is_refused_the_split_with_the_reason() {
    let mut data = one_set(5);
    data.runs.retain(|run| run.direction == Some(Direction::Ccw));
    let diagnosis = diagnose(&data, &base(), &Options::default()).unwrap();
    assert_eq!((diagnosis.verdict, diagnosis.fitted.len()), (Verdict::NotEnoughData, 0));
    assert!(diagnosis.remarks[0].contains("E_d and E_b act alike there"), "{:?}", diagnosis.remarks);
    assert!((diagnosis.identifiability.hidden[0].ratio.unwrap() + 7.49).abs() < 0.01);
}

#[test]
fn without_headings_the_test_is_an_f_of_2_and_8_and_the_loss_is_told() {
    let mut data = one_set(5);
    data.runs[3].returned.as_mut().unwrap().heading = None;
    let diagnosis = diagnose(&data, &base(), &Options::default()).unwrap();
    assert_eq!(diagnosis.goodness_of_fit[0].degrees_of_freedom, Some([2.0, 8.0]));
    assert!(diagnosis.remarks.iter().any(|r| r.contains("one contrast of two is lost")));
    assert_eq!(diagnosis.contrasts.iter().map(|c| c.name).collect::<Vec<_>>(), ["c1", "c3"]);
}

#[test]
fn two_runs_a_direction_or_runs_without_scatter_are_not_tested() {
    let few = diagnose(&one_set(2), &base(), &Options::default()).unwrap();
    assert!(few.verdict == Verdict::NotEnoughData && few.goodness_of_fit.is_empty() && few.fitted.len() == 2);
    let mut same = one_set(5);
    let first = [same.runs[0].returned, same.runs[5].returned];
    for (i, run) in same.runs.iter_mut().enumerate() {
        run.returned = first[i / 5];
    }
    let diagnosis = diagnose(&same, &base(), &Options::default()).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::NotEnoughData);
    assert!(diagnosis.remarks[0].contains("too little scatter"), "{:?}", diagnosis.remarks);
}

#[test]
fn of_every_parameter_the_least_size_is_told_effect_by_effect_in_the_order_asked() {
    let mut diagnosis = diagnose(&one_set(2), &base(), &Options::default()).unwrap();
    let size = |effect, parameter, size| Detectable { effect, parameter, size };
    diagnosis.minimum_detectable = vec![
        size("bumps", "height_m", 3.0),
        size("backlash", "left_m", 2.0),
        size("bumps", "height_m", 1.0),
        size("bumps", "height_m", 4.0),
        size("bumps", "count", 5.0),
    ];
    let told: Vec<Vec<f64>> = diagnosis.least_sizes().iter().map(|own| own.iter().map(|d| d.size).collect()).collect();
    assert_eq!(told, [vec![1.0, 5.0], vec![2.0]]);
}

/// Seed 5; a slope far beyond the scatter.
pub(crate) fn steep() -> Dataset {
    let mut truth = robot_with(&[("floor_slope", "drift_x", 2e-2)]);
    truth.set("wheel_noise", "k_sqrt_m", 1e-4).unwrap();
    simulated(&truth, &Path::umbmark(), 5, 5, 0..1).remove(0)
}

#[test]
fn of_two_causes_both_are_certified_the_second_by_what_the_first_leaves() {
    let mut truth = robot_with(&[("floor_slope", "drift_x", 6e-3), ("caster_kick", "kick_rad", 0.01)]);
    truth.set("wheel_noise", "k_sqrt_m", 1e-4).unwrap();
    let data = simulated(&truth, &Path::umbmark(), 5, 5, 0..1).remove(0);
    let diagnosis = diagnose(&data, &base(), &Options::default()).unwrap();
    assert_eq!((diagnosis.verdict, diagnosis.certified().len()), (Verdict::SeveralMissing, 2), "{diagnosis:?}");
    for (suspect, cause) in diagnosis.certified().iter().zip(["floor_slope", "caster_kick"]) {
        assert!(suspect.class.contains(&cause) && suspect.p_adjusted < 0.05, "{suspect:?}");
    }
    let second = &diagnosis.ranking[1];
    assert!(diagnosis.ranking[2..].iter().all(|other| !second.class.contains(&other.best)), "{second:?}");
    let alone = diagnose(&steep(), &base(), &Options::default()).unwrap();
    assert_eq!((alone.verdict, alone.certified().len()), (Verdict::MissingEffect, 1));
}

/// The signs of 4 + 4 runs are all equal in one of 128 cases, so a family of tests cannot reach 1 %.
#[test]
fn where_signs_cannot_confirm_what_is_certified_it_is_said_that_it_rests_on_normal_scatter() {
    let mut truth = robot_with(&[("floor_slope", "drift_x", 2e-2)]);
    truth.set("wheel_noise", "k_sqrt_m", 1e-4).unwrap();
    let data = simulated(&truth, &Path::umbmark(), 4, 5, 0..1).remove(0);
    for (size, expected) in [(0.05, false), (0.01, true)] {
        let diagnosis = diagnose(&data, &base(), &Options { size, ..Options::default() }).unwrap();
        assert_eq!(diagnosis.certified().len(), 1);
        let said = diagnosis.remarks.iter().any(|remark| remark.contains("rests on normally distributed scatter"));
        assert_eq!(said, expected, "{:?}", diagnosis.remarks);
    }
}

#[test]
fn what_no_candidate_explains_though_the_whole_is_rejected_is_unlisted() {
    let mut met = BTreeSet::new();
    for (trial, mut data) in (0..).zip(simulated(&robot_with(&[]), &Path::umbmark(), 5, 9, 0..40)) {
        let mut stream = Stream::new(10, 0, trial);
        let shifts = [(); 2].map(|()| [0.05, 0.05, 0.01].map(|size| size * stream.normal()));
        for run in &mut data.runs {
            let [x, y, heading] = shifts[usize::from(run.direction == Some(Direction::Cw))];
            let error = run.returned.as_mut().unwrap();
            (error.x, error.y) = (error.x + x, error.y + y);
            error.heading = error.heading.map(|h| h + heading);
        }
        let diagnosis = diagnose(&data, &base(), &Options::default()).unwrap();
        let whole = diagnosis.goodness_of_fit[0].p < 0.05;
        let best = diagnosis.ranking.first().is_some_and(|suspect| suspect.p_adjusted < 0.05);
        let verdict = diagnosis.verdict;
        met.insert(format!("{verdict:?}"));
        match (best, whole) {
            (true, _) => assert!(matches!(verdict, Verdict::MissingEffect | Verdict::SeveralMissing)),
            (false, false) => assert_eq!(verdict, Verdict::Explained),
            // The whole-model test is one of the family, at a smaller size.
            (false, true) => assert!(matches!(verdict, Verdict::Explained | Verdict::UnlistedEffect)),
        }
    }
    assert!(["Explained", "MissingEffect", "UnlistedEffect"].iter().all(|verdict| met.contains(*verdict)), "{met:?}");
}

#[test]
fn drives_are_offered_against_what_is_in_a_class_or_absorbs_an_effect() {
    let diagnosis = diagnose(&steep(), &base(), &Options::default()).unwrap();
    let found = &diagnosis.certified()[0];
    assert!(found.class.len() > 1 && found.class.contains(&"floor_slope"), "{found:?}");
    assert!(diagnosis.next_experiments.iter().any(|experiment| experiment.separates[0] == found.best));
    for Experiment { separates: [first, second], .. } in &diagnosis.next_experiments {
        let in_class = |suspect: &Suspect| suspect.best == *first && suspect.class.contains(second);
        let absorbed = |unseen: &Unseen| unseen.effect == *second && unseen.why == Why::Absorbed(vec![*first]);
        let told = diagnosis.ranking.iter().any(in_class) || diagnosis.invisible.iter().any(absorbed);
        assert!(told, "{first} and {second}");
    }
}

pub(crate) fn asked_of(data: &Dataset) -> Asked {
    let ends = Ends::new(data).unwrap();
    let fitted = Fitted::new(&ends, &base()).unwrap();
    Asked::new(&ends, &fitted).unwrap().unwrap()
}

#[test]
fn every_effect_that_moves_poses_is_asked_or_said_to_be_unseen_and_no_other_is() {
    let asked = asked_of(&one_set(5));
    let told = asked.units.iter().map(|unit| unit.effect.about.name).chain(asked.unseen.iter().map(|own| own.effect));
    let of_drive = crate::effect::of_drive(Robot::labmate().drive.kind());
    let moving = of_drive.filter(|entry| entry.changes.include(Changes::MEAN)).map(|entry| entry.about.name);
    let own = ["wheel_diameter_ratio", "wheelbase"];
    assert_eq!(told.collect::<BTreeSet<_>>(), moving.filter(|name| !own.contains(name)).collect());
}

#[test]
fn the_misfit_falls_by_as_much_whatever_the_unit_of_a_size() {
    let asked = asked_of(&one_set(5));
    let mut other = asked.clone();
    other.units.iter_mut().flat_map(|unit| &mut unit.columns).for_each(|column| *column *= -1e3);
    for (drop, other) in asked.drops().iter().zip(other.drops()) {
        assert!((drop - other).abs() < 1e-9 * (1.0 + drop), "{drop} {other}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_for_any_number_of_threads() {
    let data = one_set(5);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| diagnose(&data, &base(), &Options::default()).unwrap())
    };
    assert_eq!(on(1), on(3));
}

/// E_d and E_b of a figure-eight are not parallel, and so is any path with a slope in the model: simulated p-values. 300 tests
/// each, seed 23.
#[test]
fn where_no_exact_test_applies_simulated_ones_have_their_size() {
    let eight = Path::new(&FIGURE_EIGHT, &[1.0], SpeedProfile::default()).unwrap();
    let mut with_slope = base();
    with_slope.add("floor_slope").unwrap().free = true;
    let trials = trials(300);
    for (path, model) in [(eight, base()), (Path::umbmark(), with_slope)] {
        let options = Options { draws: 199, ..Options::default() };
        let data = simulated(&robot_with(&[]), &path, 5, 23, 0..trials);
        let accused = data.par_iter().filter(|data| {
            let ends = Ends::new(data).unwrap();
            let fitted = Fitted::new(&ends, &model).unwrap();
            let asked = Asked::new(&ends, &fitted).unwrap().unwrap();
            let family = Family::new(&asked, &options).unwrap();
            assert_eq!(family.exact_whole, None);
            family.p_adjusted.iter().chain([&family.p_whole_adjusted]).any(|p| *p < 0.05)
        });
        let share = accused.count() as f64 / trials as f64;
        let _ = writeln!(std::io::stderr(), "family on {}: {share} of {trials}", path.shape().name);
        assert!(share < 0.05 + margin(0.05, trials), "{share}");
    }
}

/// Seed 23: a complete model of ten runs, one of them typed wrongly; and all of them in millimetres.
#[test]
fn a_typing_error_or_a_wrong_unit_is_never_explained() {
    let options = Options::default();
    let data = simulated(&robot_with(&[]), &Path::umbmark(), 5, 23, 0..1).remove(0);
    let told = diagnose(&data, &base(), &options).unwrap();
    assert_eq!((told.verdict, told.reasons.len()), (Verdict::Explained, 0));
    let changed = |change: &dyn Fn(usize, &mut ReturnError)| {
        let mut data = data.clone();
        let returns = data.runs.iter_mut().filter_map(|run| run.returned.as_mut());
        returns.enumerate().for_each(|(run, own)| change(run, own));
        data
    };
    let typed = changed(&|run, own| own.y = if run == 3 { 2.01 } else { own.y });
    let told = diagnose(&typed, &base(), &options).unwrap();
    assert_ne!(told.verdict, Verdict::Explained);
    assert!(
        matches!(&told.reasons[..], [Reason::Data(Suspicion::OutlyingReturn(run))] if run.run == data.runs[3].name),
        "{:?}",
        told.reasons
    );
    let learnt = crate::learn::learn(&typed, &options).unwrap();
    assert!(learnt.verdict != Verdict::Explained && learnt.diagnosis.reasons[0].is_of_data());
    let models = [("fitted".to_owned(), told.model)];
    let compared = crate::compare::compare_returns(&typed, &models, &options).unwrap();
    assert!(!compared.models[0].explains(0.05) && compared.models[0].in_doubt);
    let in_mm = changed(&|_, own| (own.x, own.y) = (1e3 * own.x, 1e3 * own.y));
    let told = diagnose(&in_mm, &base(), &options).unwrap();
    assert_eq!(told.verdict, Verdict::NotExplained);
    assert!(matches!(told.reasons[..], [Reason::Fault(Fault::ReturnsIn { .. })]), "{:?}", told.reasons);
    assert!(matches!(crate::evidence::fit(&in_mm, &base()), Err(FitError::Faulty { .. })));
    assert_eq!(crate::learn::learn(&in_mm, &options).unwrap().verdict, Verdict::NotExplained);
}
