//! Diagnoses of simulated tests, whose cause is known.

use super::*;
use crate::calibrate::noise_shape;
use crate::dataset::ReturnError;
use crate::geometry::wrap;
use crate::path::{Direction, Path};
use crate::random::Stream;
use crate::replay::Track;
use nalgebra::Vector3;

/// A robot like the paper's, E_d and E_b of the size of the paper's, wheel noise of its scatter, and one more cause.
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
    Dataset { robot: Some(Robot::labmate()), path: Some(path.clone()), runs, warnings: vec![] }
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

#[test]
fn probe() {
    for (name, model) in [("none", robot_with(&[])), ("slope", robot_with(&[("floor_slope", "drift_x", 3e-3)]))] {
        let data = simulated(&model, &Path::umbmark(), 5, 1, 0..2);
        for d in &data {
            let t = std::time::Instant::now();
            let x = diagnose(d, &base(), &Options::default()).unwrap();
            println!("{name} {:?} {:?} {:?}", t.elapsed(), x.verdict, x.goodness_of_fit);
            for s in &x.ranking {
                println!(
                    "   {:?} f {:.2} p {:.4} adj {:.4} flips {:?} {:?} drop {:.2}",
                    s.class, s.f, s.p, s.p_adjusted, s.p_flips, s.estimate, s.expected_drop
                );
            }
            println!("   {:?}", x.invisible);
            println!(
                "   {:?}",
                x.minimum_detectable.iter().map(|m| (m.effect, m.parameter, m.size)).collect::<Vec<_>>()
            );
            for e in x.next_experiments.iter() {
                println!("   {:?} {} {:.1} {:.1}", e.separates, e.experiment, e.minutes, e.sd);
            }
            println!(
                "   {:?} {:?}",
                x.contrasts.iter().map(|c| (c.name, c.value, c.interval)).collect::<Vec<_>>(),
                x.remarks
            );
            let t = std::time::Instant::now();
            let l = crate::learn::learn(d, &Options::default()).unwrap();
            println!("   learn {:?} {:?}", t.elapsed(), l.verdict);
            for s in &l.steps {
                println!(
                    "     {:?} {:?} {:?} held {:?} {:?} {:?}",
                    s.added, s.p_adjusted, s.error, s.held_out, s.aicc, s.bic
                );
            }
        }
    }
}

#[test]
fn size_of_gof() {
    for (ed, eb) in [(1.00121, 0.9918), (1.003, 1.01), (1.0, 1.0)] {
        let mut truth = robot_with(&[]);
        truth.set("wheel_diameter_ratio", "e_d", ed).unwrap();
        truth.set("wheelbase", "e_b", eb).unwrap();
        let (mut n, mut rejected) = (0, 0);
        for data in simulated(&truth, &Path::umbmark(), 5, 3, 0..5000) {
            let ends = ends::Ends::new(&data).unwrap();
            let fitted = ends::Fitted::new(&ends, &base()).unwrap();
            n += 1;
            rejected += u32::from(ends::Asked::wilks_p(&ends, &fitted).unwrap() < 0.05);
        }
        println!("size {ed} {eb} {}", f64::from(rejected) / f64::from(n));
    }
}

#[test]
fn study() {
    use rayon::prelude::*;
    for (name, model, trials) in [
        ("slope", robot_with(&[("floor_slope", "drift_x", 3e-3)]), 60),
        ("dirwb", robot_with(&[("direction_dependent_wheelbase", "difference", 4e-3)]), 2),
        ("none", robot_with(&[]), 60),
    ] {
        let data = simulated(&model, &Path::umbmark(), 5, 9, 0..trials);
        let l: Vec<_> = data
            .par_iter()
            .map(|d| crate::learn::learn(d, &Options { draws: 499, ..Options::default() }).unwrap())
            .collect();
        let found = l.iter().filter(|l| l.steps.len() > 3 || !l.remarks.is_empty()).count();
        let added = l.iter().filter(|l| l.steps.len() > 3).count();
        let right = l.iter().filter(|l| l.steps.get(3).is_some_and(|s| s.class.contains(&"floor_slope"))).count();
        let better = l
            .iter()
            .filter(|l| l.steps.len() > 3 && l.steps[3].held_out.position < l.steps[2].held_out.position)
            .count();
        println!(
            "{name} found {found} added {added} right {right} better mm {better} of {trials}; {:?}",
            l.iter().map(|l| l.steps.len()).collect::<Vec<_>>()
        );
        println!("{:?} {:?}", l[0].remarks, l[0].model);
    }
}

#[test]
fn rank() {
    use rayon::prelude::*;
    let data = simulated(&robot_with(&[("floor_slope", "drift_x", 3e-3)]), &Path::umbmark(), 5, 19, 0..200);
    let rows: Vec<[bool; 5]> = data
        .par_iter()
        .map(|d| {
            let ends = ends::Ends::new(d).unwrap();
            let fitted = ends::Fitted::new(&ends, &base()).unwrap();
            let asked = ends::Asked::new(&ends, &fitted).unwrap().unwrap();
            let family = ends::Family::new(&asked, &Options { draws: 299, ..Options::default() }).unwrap();
            let classes = asked.classes();
            let drops = asked.drops();
            let class_of = |i: usize| {
                classes
                    .iter()
                    .find(|c| c.contains(&i))
                    .unwrap()
                    .iter()
                    .any(|j| asked.units[*j].effect.about.name == "floor_slope")
            };
            let all = 0..asked.units.len();
            let by_f =
                all.clone().max_by(|a, b| family.observed.units[*a].total_cmp(&family.observed.units[*b])).unwrap();
            let by_drop = all.clone().max_by(|a, b| drops[*a].total_cmp(&drops[*b])).unwrap();
            let among =
                all.clone().filter(|i| family.p_adjusted[*i] < 0.05).max_by(|a, b| drops[*a].total_cmp(&drops[*b]));
            [
                family.p_adjusted[by_f] < 0.05,
                class_of(by_f),
                class_of(by_drop),
                among.is_some_and(class_of),
                family.p_adjusted[by_drop] < 0.05,
            ]
        })
        .collect();
    let found: Vec<_> = rows.iter().filter(|r| r[0]).collect();
    println!(
        "found {} by f {} by drop {} among {} drop certified {}",
        found.len(),
        found.iter().filter(|r| r[1]).count(),
        found.iter().filter(|r| r[2]).count(),
        found.iter().filter(|r| r[3]).count(),
        found.iter().filter(|r| r[4]).count()
    );
}
