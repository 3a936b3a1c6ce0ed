//! Pairs of tests of simulated robots, whose changes are known.

use super::*;
use crate::dataset::ReturnError;
use crate::drive::{DifferentialDrive, Robot};
use crate::geometry::Pose2;
use crate::likelihood::watched::watched;
use crate::preset::Preset;
use std::sync::LazyLock;

/// An effect, its parameter and the value.
type Size = (&'static str, &'static str, f64);

fn robot(effects: &[Size]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    let noise = [("wheel_noise", "k_sqrt_m", 3e-4), ("reference_noise", "position_sd_m", 1e-3)];
    for (effect, parameter, value) in noise.iter().chain(effects) {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

fn tracks(effects: &[Size], seed: u64) -> Dataset {
    watched(&robot(effects), 4, seed)
}

fn returns(effects: &[Size], seed: u64) -> Dataset {
    let mut data = watched(&robot(effects), 5, seed);
    data.runs.iter_mut().for_each(|run| run.log = None);
    data
}

fn between(before: &Dataset, after: &Dataset) -> Result<Changed, ChangeError> {
    let start = Model::new(before.robot.as_ref().unwrap_or(&Robot::labmate()));
    Watch::nobody(|watch| changed(before, after, &start, &Options::default(), watch))
}

/// A test by tracks and what is learnt of it, which takes most of the time and is the same in every pair.
struct Known {
    data: Dataset,
    model: Model,
    verdict: Verdict,
    doubt: Option<String>,
}

impl Known {
    fn of(data: Dataset) -> Known {
        let (start, options) = (Model::new(&Robot::labmate()), Options::default());
        let Learned { model, verdict, doubt, .. } =
            Watch::nobody(|watch| Learned::of(&data, &start, &options, watch)).unwrap();
        Known { data, model, verdict, doubt }
    }

    fn learned(&self) -> Learned<'_> {
        let Known { data, model, verdict, doubt } = self;
        let evidence = AnyEvidence::of(data, Level::Tracks).unwrap();
        Learned { data, evidence, model: model.clone(), verdict: *verdict, doubt: doubt.clone() }
    }
}

/// What [`between`] says of them.
fn between_known(before: &Known, after: &Known) -> Changed {
    Learned::compared([before.learned(), after.learned()], &Options::default()).unwrap()
}

/// Seed 1: a robot as it is entered.
static USUAL: LazyLock<Known> = LazyLock::new(|| Known::of(tracks(&[], 1)));

fn moved(found: &Changed) -> Vec<&str> {
    found.moved().map(|moved| moved.quantity.key.as_str()).collect()
}

/// A right wheel of a factor f and a left one of g: E_d = f/g, E_s their mean.
fn wheels(left: f64, right: f64) -> [Size; 2] {
    [("wheel_diameter_ratio", "e_d", right / left), ("scale", "e_s", 0.5 * (left + right))]
}

#[test]
fn the_wheel_that_wore_is_named_by_tracks_and_its_size_is_right() {
    let found = between_known(&USUAL, &Known::of(tracks(&wheels(1.0, 0.998), 2)));
    assert_eq!(moved(&found), ["wheel_diameter_right_m"]);
    let wheel = found.moved().next().unwrap();
    let truth = -0.002 * 0.15;
    assert!(wheel.interval.contains(truth) && wheel.change.abs() > wheel.seen.min(2e-4), "{wheel:?}");
    let [old, new] = found.costs.unwrap();
    assert!(old > 2.0 * new, "{old} {new}");
    assert!(found.sentence().contains("The wheel diameter right fell by 0.3"), "{}", found.sentence());
}

/// Return poses show two ratios, and a wheel moves both.
#[test]
fn return_poses_name_the_length_that_accounts_for_the_change() {
    let found = between(&returns(&wheels(1.0, 1.0), 1), &returns(&wheels(1.0, 0.997), 2)).unwrap();
    assert!(moved(&found).contains(&"wheel_diameter_ratio"));
    let [alone] = found.alone.as_slice() else { panic!("{:?}", found.alone) };
    assert_eq!(alone.key, "wheel_diameter_right_m");
    assert!((alone.share + 0.003).abs() < 3.0 * alone.standard_error, "{alone:?}");
    let base = between(&returns(&[], 1), &returns(&[("wheelbase", "e_b", 1.02)], 2)).unwrap();
    assert_eq!((moved(&base).as_slice(), base.alone[0].key), (&["wheelbase_over_diameter"][..], "wheelbase_m"));
}

/// The returns as they are measured from a START that was moved by 5 cm and -3 cm and turned \[rad\].
fn from_elsewhere(mut data: Dataset, turned: f64, with_headings: bool) -> Dataset {
    let start = Pose2::new(0.05, -0.03, turned);
    for run in &mut data.runs {
        let error = run.returned.as_mut().unwrap();
        let seen = start.compose(&Pose2::new(error.x, error.y, error.heading.unwrap()));
        *error = ReturnError { x: seen.x, y: seen.y, heading: with_headings.then_some(seen.heading) };
    }
    data
}

/// A START that lies elsewhere looks like other wheels; what the wheels do does not look like START, because it differs with the direction.
#[test]
fn a_start_that_lies_elsewhere_is_named_beside_what_it_looks_like() {
    let before = returns(&[("wheelbase", "e_b", 1.03)], 1);
    let again = || returns(&[("wheelbase", "e_b", 1.03)], 2);
    for (turned, with_headings) in [(0.0, true), (0.0, false), (0.035, true), (-0.06, true), (0.035, false)] {
        let found = between(&before, &from_elsewhere(again(), turned, with_headings)).unwrap();
        let case = format!("turned by {turned}, headings: {with_headings}: {}", found.sentence());
        assert!(found.is_changed(), "{case}");
        let start = found.start.unwrap_or_else(|| panic!("{case}"));
        assert!((start.x - 0.05).abs() < 0.01 && (start.y + 0.03).abs() < 0.01, "{start:?}");
        if with_headings {
            assert!((start.heading.unwrap() - turned).abs() < 0.01, "{start:?}");
        }
        let said = found.sentence();
        assert!(said.contains("A START that lies elsewhere accounts for it, too: by +"), "{said}");
    }
    for worn in [returns(&wheels(1.0, 0.997), 2), returns(&[("wheelbase", "e_b", 1.05)], 2)] {
        let found = between(&before, &worn).unwrap();
        assert_eq!((found.is_changed(), found.start), (true, None));
    }
}

/// Clockwise runs alone show neither ratio.
#[test]
fn tests_without_a_number_in_common_are_refused() {
    let mut after = returns(&[], 2);
    after.runs.retain(|run| run.direction == Some(crate::path::Direction::Ccw));
    assert_eq!(between(&returns(&[], 1), &after).unwrap_err(), ChangeError::NothingInCommon);
}

#[test]
fn robots_that_did_not_change_are_rarely_accused() {
    let truth = [("wheelbase", "e_b", 0.99), ("wheel_diameter_ratio", "e_d", 1.003)];
    let found = (0..13).map(|k| between(&returns(&truth, 2 * k), &returns(&truth, 2 * k + 1)).unwrap());
    // At 5 %, more than three of 13 are accused with a probability of 0.3 %; 500 pairs, and 30 of tracks, are in docs/studies/changed.md.
    assert!(found.filter(Changed::is_changed).count() <= 3);
}

/// The robot that was calibrated in between has other nominal numbers and is the same robot.
#[test]
fn another_nominal_robot_is_no_change() {
    let mut after = tracks(&[], 2);
    let drive = DifferentialDrive::new(0.345, 0.151, 0.149).unwrap();
    after.robot.as_mut().unwrap().drive = drive.into();
    let found = between_known(&USUAL, &Known::of(after));
    assert!(!found.is_changed(), "{}", found.sentence());
    let base = found.robot.iter().find(|moved| moved.quantity.key == "wheelbase_m").unwrap();
    assert!((base.after.value - 0.34).abs() < 4.0 * base.after.standard_error, "{base:?}");
}

/// A floor that turns the robot after, and did not before.
#[test]
fn an_effect_that_only_one_test_shows_is_fitted_to_both() {
    let slope = [("floor_slope_yaw", "sine_rad_per_m", 0.03)];
    let sloping = Known::of(tracks(&slope, 4));
    let found = between_known(&USUAL, &sloping);
    assert!(moved(&found).contains(&"floor_slope_yaw.sine_rad_per_m"), "{:?}", moved(&found));
    let back = between_known(&sloping, &USUAL);
    for (there, back) in found.robot.iter().zip(&back.robot) {
        assert!(there.quantity.of == Of::Scatter || (there.change + back.change).abs() < 1e-12, "{there:?} {back:?}");
    }
}

#[test]
fn a_robot_that_scatters_more_is_named() {
    let noisy = |k: f64, seed| {
        let mut model = robot(&[]);
        model.set("wheel_noise", "k_sqrt_m", k).unwrap();
        watched(&model, 6, seed)
    };
    let found = between(&noisy(1e-4, 1), &noisy(8e-4, 2)).unwrap();
    assert_eq!(moved(&found), ["scatter"]);
    let scatter = found.moved().next().unwrap();
    assert!(scatter.interval.contains(8.0), "{scatter:?}");
    assert!(found.sentence().contains("The scatter of the runs rose to "), "{}", found.sentence());
}

#[test]
fn tests_of_two_robots_are_refused() {
    let data = returns(&[], 1);
    let mut other = data.clone();
    other.robot = Some(Preset::find("clapper").unwrap().robot());
    let refused = between(&data, &other).unwrap_err();
    assert_eq!(refused, ChangeError::Drive { before: "differential", after: "clapper" });
    other.robot = None;
    let refused = between(&data, &other).unwrap_err();
    assert_eq!(refused, ChangeError::Fit { test: "after", source: FitError::NoRobot });
    assert!(refused.to_string().starts_with("after: the nominal robot is not known"));
}

/// Holm by hand, and what 80 % of tests see with many degrees of freedom: 1.96 + 0.84 standard errors.
#[test]
fn p_is_adjusted_for_all_numbers_and_what_could_be_seen_follows() {
    let value = |value: f64| Value { value, standard_error: 0.5_f64.sqrt(), degrees_of_freedom: 1e5 };
    let of = |change: f64| {
        let quantity = Quantity { of: Of::Robot, key: String::new(), meaning: String::new() };
        Moved::of(quantity, value(0.0), value(change), 0.05).unwrap()
    };
    let mut table = vec![of(2.5), of(0.5), of(2.2)];
    adjust(&mut table, 0.05);
    // Two-sided normal: 0.012419, 0.617075, 0.027807.
    for (moved, p) in table.iter().zip([3.0 * 0.012_419_3, 0.617_075_1, 2.0 * 0.027_806_9]) {
        assert!((moved.p_adjusted - p).abs() < 1e-4, "{} {p}", moved.p_adjusted);
    }
    let mut one = vec![of(2.5)];
    adjust(&mut one, 0.05);
    assert!((one[0].seen - (1.959_964 + 0.841_621)).abs() < 1e-3, "{}", one[0].seen);
    // Welch's ν of equal variances is the sum; of one variance alone its own.
    assert!((freedom([(1.0, 4.0), (1.0, 4.0)]) - 8.0).abs() < 1e-12);
    assert!((freedom([(1.0, 4.0), (0.0, 9.0)]) - 4.0).abs() < 1e-12);
}
