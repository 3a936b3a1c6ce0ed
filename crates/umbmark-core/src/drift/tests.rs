//! Robots that are watched, from the scores to the words.

use super::scores::{COMPONENTS, Scorer};
use super::*;
use crate::calibrate::{Correction, drive_again};
use crate::dataset::{Dataset, ReturnError, Run};
use crate::diagnose::tests::trials;
use crate::effect::{Model, TestKind};
use crate::random::Stream;
use crate::simulate::{Odometry, Phase, Simulator, Truth};
use rayon::prelude::*;

/// A robot, its path, and the standard deviations of its return errors.
#[derive(Clone)]
struct World {
    robot: Robot,
    path: Path,
    /// x, y \[m\] and heading \[rad\], the last of which is correlated with the others.
    noise: [f64; 3],
    heading: bool,
}

impl World {
    fn usual() -> World {
        World { robot: Robot::labmate(), path: Path::umbmark(), noise: [0.02, 0.02, 0.01], heading: true }
    }

    /// Runs in turns by direction; `truth` says what the robot is at each run, `factor` how large its noise is.
    fn data(&self, runs: u32, seed: u64, truth: impl Fn(u32) -> Correction, factor: impl Fn(u32) -> f64) -> Dataset {
        let mut stream = Stream::new(seed, 77, 0);
        let run = |number: u32| {
            let direction = Direction::BOTH[number as usize % 2];
            let end = drive_again(&self.robot, &self.path, direction, &truth(number), &Correction::NONE).unwrap();
            let [a, b, c] = [0; 3].map(|_| factor(number) * stream.normal());
            let heading = self.heading.then(|| end.heading.unwrap() + self.noise[2] * (0.8 * a + 0.6 * c));
            let returned = Some(ReturnError { x: end.x + self.noise[0] * a, y: end.y + self.noise[1] * b, heading });
            let name = format!("{}_{:02}", direction.name(), number / 2 + 1);
            let number = number + 1;
            Run { name, number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
        };
        let runs = (0..runs).map(run).collect();
        Dataset { robot: Some(self.robot.clone()), path: Some(self.path.clone()), runs, ..Dataset::default() }
    }

    fn watched(&self, data: &Dataset) -> (Record, Arrived, Watched) {
        let mut record = Record::new(data, Rate::default()).unwrap();
        let arrived = record.add(data).unwrap();
        let watched = Watched::of(&record, &self.robot, Some(&self.path), 1);
        (record, arrived, watched)
    }
}

fn first(data: &Dataset, runs: usize) -> Dataset {
    Dataset { runs: data.runs[..runs].to_vec(), ..data.clone() }
}

const GOOD: Correction = Correction { e_d: 1.001, e_b: 0.99, e_s: 1.0 };

/// The right wheel a share smaller: E_d by all of it, b over the mean diameter by half of it.
fn with_smaller_wheel(share: f64) -> Correction {
    Correction { e_d: GOOD.e_d * (1.0 - share), e_b: GOOD.e_b * (1.0 + 0.5 * share), e_s: 1.0 }
}

/// Kolmogorov-Smirnov against the normal distribution: seed 3, 40 000 scores of each component from baselines of all sizes, means and covariances;
/// D below 1.63/√n is passed with probability 0.99 by a correct one.
#[test]
fn scores_are_standard_normal_whatever_the_robot_is() {
    let mut all: [Vec<f64>; 3] = Default::default();
    for robot in 0..2000 {
        let mut stream = Stream::new(3, 1, robot);
        let shape: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|_| stream.normal() * 10f64.powi(i as i32 - 2)));
        let mean = [stream.normal(), 100.0 * stream.normal(), stream.normal()];
        let mut scorer = Scorer::new(3);
        for _ in 0..25 {
            let draws = [stream.normal(), stream.normal(), stream.normal()];
            let mut run = [0.0; COMPONENTS];
            (0..3).for_each(|k| run[k] = mean[k] + (0..3).map(|j| shape[k][j] * draws[j]).sum::<f64>());
            if let Some(scored) = scorer.add(&run) {
                // What was shortened is lengthened again.
                let length = scored.scores.iter().map(|z| z * z).sum::<f64>().sqrt();
                (0..3).for_each(|k| all[k].push(scored.scores[k] * scored.distance / length));
            }
        }
    }
    for scores in &mut all {
        scores.sort_by(f64::total_cmp);
        let n = scores.len() as f64;
        assert_eq!(scores.len(), 40_000);
        let off = |(i, z): (usize, &f64)| (crate::stats::standard_normal_share(*z) - (i as f64 + 0.5) / n).abs();
        let d = scores.iter().enumerate().map(off).fold(0.0, f64::max);
        assert!(d < 1.63 / n.sqrt(), "{d}");
    }
}

/// One component by the definition: prediction by mean and standard deviation, Student's t, and the same place on the normal.
#[test]
fn the_score_of_one_component_is_that_of_its_prediction_interval() {
    let runs = [0.3, -0.1, 0.25, 0.8, -0.4, 0.1, 0.9];
    let mut scorer = Scorer::new(1);
    let scored: Vec<_> = runs.iter().map(|x| scorer.add(&[*x, 0.0, 0.0, 0.0])).collect();
    assert!(scored[..3].iter().all(Option::is_none));
    for n in 3..runs.len() {
        let earlier = &runs[..n];
        let mean = earlier.iter().sum::<f64>() / n as f64;
        let variance = earlier.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1) as f64;
        let t = (runs[n] - mean) / (variance * (1.0 + 1.0 / n as f64)).sqrt();
        let p = crate::stats::t_two_sided(t, (n - 1) as f64);
        let z = scored[n].unwrap().scores[0];
        assert!((2.0 * (1.0 - crate::stats::standard_normal_share(z.abs())) - p).abs() < 1e-9 && z * t > 0.0, "{n}");
    }
}

/// Derivatives of the scores against differences, for runs near what is predicted; Student's t is worth a little less than a normal.
#[test]
fn the_slopes_of_scores_are_their_derivatives_but_for_what_a_t_is_worth() {
    let mut stream = Stream::new(4, 1, 0);
    let mut scorer = Scorer::new(3);
    for _ in 0..300 {
        let [a, b, c] = [stream.normal(), stream.normal(), stream.normal()];
        scorer.add(&[a, 0.5 * a + b, 3.0 * c - b, 0.0]);
    }
    let at = |j: usize, by: f64| {
        let mut run = [0.1, -0.2, 0.3, 0.0];
        run[j] += by;
        scorer.clone().add(&run).unwrap()
    };
    for j in 0..3 {
        let (more, less) = (at(j, 1e-4), at(j, -1e-4));
        for k in 0..3 {
            let slope = (more.scores[k] - less.scores[k]) / 2e-4;
            assert!((slope - at(j, 0.0).slopes[k][j]).abs() < 0.02, "{k} {j}: {slope} {}", at(j, 0.0).slopes[k][j]);
        }
    }
}

#[test]
fn one_bad_run_is_outlying_and_no_change() {
    let world = World::usual();
    let mut data = world.data(40, 1, |_| GOOD, |_| 1.0);
    data.runs[30].returned.as_mut().unwrap().x += 0.5;
    let (_, arrived, watched) = world.watched(&data);
    assert!(watched.change.is_none());
    assert_eq!(watched.outlying, [30]);
    assert!(watched.sentence(&arrived).contains("Outlying runs, which are no lasting change by themselves: cw_16."));
}

#[test]
fn a_wheel_that_shrinks_is_named_with_when_and_how_much() {
    let world = World::usual();
    let data = world.data(44, 2, |run| if run < 30 { GOOD } else { with_smaller_wheel(0.002) }, |_| 1.0);
    let (mut record, arrived, watched) = world.watched(&data);
    let change = watched.change.clone().unwrap();
    assert_eq!((change.kind, change.since), (Kind::Numbers, 30));
    assert!(change.earliest <= 30 && 30 <= change.latest && change.seen < 40);
    let e_d = &change.numbers[0];
    assert!(e_d.interval.contains(-0.002 * GOOD.e_d) && e_d.interval.high < 0.0, "{e_d:?}");
    assert!((e_d.before.value - GOOD.e_d).abs() < e_d.before.half + 1e-4, "{e_d:?}");
    assert!(change.alone.iter().any(|alone| alone.key == "wheel_diameter_right_m"));
    assert!(change.alone.iter().all(|alone| alone.key != "wheelbase_m"));
    let said = watched.sentence(&arrived);
    assert!(said.starts_with("The robot changed: since run cw_16"), "{said}");
    assert!(watched.delays.is_empty());
    // The alarm stays until the baseline begins anew.
    record.restart(&Restart::At("cw_16".into())).unwrap();
    let anew = Watched::of(&record, &world.robot, Some(&world.path), 1);
    assert!(anew.change.is_none() && anew.runs[29].used == Use::Earlier && anew.runs[30].used == Use::Baseline);
    record.restart(&Restart::Now).unwrap();
    let empty = Watched::of(&record, &world.robot, Some(&world.path), 1);
    assert!(empty.sentence(&Arrived::default()).starts_with("0 runs watched"));
    assert!(matches!(record.restart(&Restart::At("cw_99".into())), Err(DriftError::NoSuchRun { .. })));
}

#[test]
fn a_start_that_moved_and_a_scatter_that_grew_are_told_from_numbers() {
    let world = World::usual();
    let mut data = world.data(50, 3, |_| GOOD, |_| 1.0);
    data.runs[30..].iter_mut().for_each(|run| run.returned.as_mut().unwrap().x += 0.1);
    let (_, arrived, watched) = world.watched(&data);
    let change = watched.change.as_ref().unwrap();
    assert_eq!((change.kind, change.since), (Kind::Place, 30));
    assert!(change.places.iter().all(|place| (place.x.value - 0.1).abs() < 2.0 * place.x.half), "{change:?}");
    assert!(watched.sentence(&arrived).contains("no change of E_d and E_b explains it"));
    let data = world.data(80, 4, |_| GOOD, |run| if run < 40 { 1.0 } else { 3.0 });
    let (_, arrived, watched) = world.watched(&data);
    let change = watched.change.as_ref().unwrap();
    assert_eq!(change.kind, Kind::Scatter);
    assert!(change.scatter.unwrap().interval.contains(3.0), "{:?}", change.scatter);
    assert!(watched.sentence(&arrived).starts_with("The scatter of the runs rose to"));
}

#[test]
fn runs_one_by_one_say_what_runs_at_once_say() {
    let world = World::usual();
    let data = world.data(40, 5, |run| if run < 24 { GOOD } else { with_smaller_wheel(0.003) }, |_| 1.0);
    let (at_once, _, whole) = world.watched(&data);
    let mut record = Record::new(&data, Rate::default()).unwrap();
    for runs in 1..=40 {
        assert_eq!(record.add(&first(&data, runs)).unwrap(), Arrived { new: 1, ..Arrived::default() });
        assert_eq!(record.add(&first(&data, runs)).unwrap(), Arrived::default(), "the same data again");
    }
    assert_eq!(record, at_once);
    assert_eq!(Watched::of(&record, &world.robot, Some(&world.path), 1), whole);
}

#[test]
fn runs_that_vanish_or_change_are_named_and_kept() {
    let world = World::usual();
    let data = world.data(20, 6, |_| GOOD, |_| 1.0);
    let (mut record, ..) = world.watched(&data);
    let before = record.clone();
    let mut other = first(&data, 19);
    other.runs[4].returned.as_mut().unwrap().y += 1e-9;
    let arrived = record.add(&other).unwrap();
    assert_eq!(
        (arrived.new, arrived.changed, arrived.vanished),
        (0, vec!["cw_03".to_owned()], vec!["ccw_10".to_owned()])
    );
    assert_eq!(record, before);
    // A second dataset changes the names, and not the runs.
    let joined =
        Dataset::joined(vec![("one".into(), data.clone()), ("two".into(), world.data(2, 7, |_| GOOD, |_| 1.0))]);
    let arrived = record.add(&joined.unwrap()).unwrap();
    assert_eq!(arrived, Arrived { new: 2, ..Arrived::default() });
    assert_eq!(record.runs[20].name, "two/cw_01");
}

#[test]
fn another_robot_path_or_rate_and_an_impossible_record_are_refused() {
    let world = World::usual();
    let data = world.data(12, 8, |_| GOOD, |_| 1.0);
    let (mut record, ..) = world.watched(&data);
    let mut other = data.clone();
    other.robot.as_mut().unwrap().drive = crate::drive::DifferentialDrive::new(0.35, 0.15, 0.15).unwrap().into();
    let refused = record.add(&other).unwrap_err().to_string();
    assert!(refused.contains("wheelbase_m = 0.34, and the data wheelbase_m = 0.35"), "{refused}");
    let other = Dataset { path: None, ..data.clone() };
    assert!(matches!(record.add(&other), Err(DriftError::Foreign { .. })));
    let refused = Record::resumed(Some(record.clone()), &data, Some(0.1), None).unwrap_err();
    assert!(matches!(refused, DriftError::OtherRate { .. }));
    assert_eq!(Record::resumed(Some(record.clone()), &data, None, Some(60)).unwrap(), record);
    for (rate, runs) in [(0.0, 60), (0.6, 60), (f64::NAN, 60), (0.01, 0)] {
        let refused = Record::resumed(None, &data, Some(rate), Some(runs));
        assert!(matches!(refused, Err(DriftError::Rate { .. })));
    }
    record.begins = 13;
    assert!(matches!(record.checked(), Err(DriftError::Damaged { .. })));
}

#[test]
fn runs_that_cannot_be_compared_are_left_out_by_name() {
    let world = World::usual();
    let mut data = world.data(20, 9, |_| GOOD, |_| 1.0);
    data.runs[13].returned.as_mut().unwrap().heading = None;
    data.runs[15].returned = None;
    let (_, arrived, watched) = world.watched(&data);
    assert_eq!(arrived.left_out, [("ccw_08".to_owned(), "it has no return error")]);
    assert_eq!(watched.runs[13].used, Use::LeftOut("it has no heading, as the first run has"));
    assert!(
        watched.sentence(&arrived).contains("Not watched, because it has no heading, as the first run has: ccw_07.")
    );
    let few = first(&data, 5);
    let (_, arrived, watched) = world.watched(&few);
    assert_eq!(watched.missing, [2, 3]);
    assert!(watched.sentence(&arrived).contains("needs 2 more clockwise and 3 more counter-clockwise"));
}

/// Runs that repeat each other to the bit have no scatter to be compared with, and nothing is made of that.
#[test]
fn runs_without_scatter_are_no_alarm() {
    let world = World { noise: [0.0; 3], ..World::usual() };
    let data = world.data(30, 10, |run| if run < 20 { GOOD } else { with_smaller_wheel(0.01) }, |_| 1.0);
    let mut record = Record {
        known: Known { drive: String::new(), numbers: vec![], path: None },
        rate: Rate::default(),
        begins: 0,
        runs: vec![],
    };
    record.runs = observation::of(&data, &world.robot).0;
    let watched = Watched::of(&record, &world.robot, Some(&world.path), 1);
    assert!(watched.sentence(&Arrived::default()).chars().all(|c| !c.is_control()));
    assert!(watched.runs.iter().all(|run| run.p.is_none_or(f64::is_finite)));
}

/// Robots of the engine on bumpy floors to which nothing happens; each is watched until its first alarm.
fn months_of_engine(robots: u64, runs: u32, rate: Rate, seed: u64) -> (usize, usize) {
    let watch = |robot: u64| {
        let mut draws = Stream::new(seed, 78, robot);
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_diameter_ratio", "e_d", 1.0 + 0.01 * (draws.uniform() - 0.5)).unwrap();
        model.set("wheelbase", "e_b", 1.0 + 0.04 * (draws.uniform() - 0.5)).unwrap();
        model.set("wheel_noise", "k_sqrt_m", 1e-4 * libm::exp(1.6 * draws.uniform())).unwrap();
        if robot % 2 == 1 {
            model.set("bumps", "rate_per_m", 0.5 * draws.uniform()).unwrap();
            model.set("bumps", "height_m", 0.004).unwrap();
        }
        let path = Path::umbmark();
        let mut simulator = Simulator::new(model.robot(), &path, Odometry::of(model.robot()), Phase::Random).unwrap();
        let mut truth = Truth::new(&model);
        simulator.open(&mut truth, seed, robot);
        let run = |number: u32| {
            let direction = Direction::BOTH[number as usize % 2];
            let error = simulator.run(&mut truth, direction, TestKind::Systematic);
            let returned = Some(ReturnError { heading: error.heading.filter(|_| robot % 4 < 2), ..error });
            let name = format!("{number}");
            Run { name, number, direction: Some(direction), test: TestKind::Systematic, log: None, returned }
        };
        let robot = model.robot().clone();
        let runs = (0..runs).map(run).collect();
        let data = Dataset { robot: Some(robot.clone()), path: Some(path.clone()), runs, ..Dataset::default() };
        let mut record = Record::new(&data, rate).unwrap();
        record.runs = observation::of(&data, &robot).0;
        let watched = Watched::of(&record, &robot, Some(&path), 1);
        let last = watched.change.as_ref().map_or(watched.runs.len(), |change| change.seen + 1);
        let compared = watched.runs[..last].iter().filter(|run| run.used == Use::Compared).count();
        (usize::from(watched.change.is_some()), compared)
    };
    (0..robots).into_par_iter().map(watch).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

/// Seed 6; 150 robots of the engine, half of them on bumpy floors and half without headings, 130 runs each; a false alarm in 3 months of 60 runs is asked.
#[test]
fn robots_of_the_engine_that_do_not_change_are_accused_as_often_as_is_asked() {
    let rate = Rate { false_alarms_per_month: 1.0 / 3.0, runs_per_month: 60 };
    let (alarms, compared) = months_of_engine(trials(150), 130, rate, 6);
    let asked = compared as f64 * rate.per_run();
    println!("{alarms} alarms in {compared} runs, {asked:.1} asked");
    // 4 standard errors of the number of alarms; robots on bumpy floors are not normal.
    assert!((alarms as f64 - asked).abs() < 4.0 * asked.sqrt() + 0.15 * asked, "{alarms} {asked}");
}

/// Seed 6; 10 000 months of 60 runs, a robot a year, at one false alarm in 100 months.
#[test]
#[ignore = "minutes in release"]
fn ten_thousand_months_of_the_engine() {
    let rate = Rate::default();
    let (alarms, compared) = months_of_engine(834, 730, rate, 6);
    let months = compared as f64 / 60.0;
    println!("{alarms} alarms in {months:.0} months, {:.4} a month", alarms as f64 / months);
    assert!((alarms as f64 - 0.01 * months).abs() < 4.0 * (0.01 * months).sqrt() + 0.15 * 0.01 * months, "{alarms}");
}
