//! Typing errors and units of return errors, of simulated tests.

use super::*;
use crate::calibrate::{Correction, drive_again};
use crate::diagnose::tests::{robot_with, simulated, trials};
use crate::geometry::Pose2;
use crate::likelihood::watched::watched;
use crate::random::Stream;
use crate::run::ReturnError;
use rayon::prelude::*;
use std::io::Write;

/// n runs each way with normal scatter: 20 mm and 0.3 deg about the errors of a robot like the paper's; y and heading correlated.
fn normal(n: [usize; 2], stream: &mut Stream) -> Vec<Run> {
    let mut runs = Vec::new();
    for (k, direction) in Direction::BOTH.into_iter().enumerate() {
        for number in 1..=n[k] as u32 {
            let [a, b, c] = [0; 3].map(|_: i32| stream.normal());
            let y = 0.02 * (0.8 * c + 0.6 * b) - 0.15;
            let returned = Some(ReturnError { x: 0.02 * a - 0.2, y, heading: Some(0.005 * c + 0.04) });
            let name = format!("{}_{number}", direction.name());
            let direction = Some(direction);
            runs.push(Run { name, number, direction, test: TestKind::Systematic, log: None, returned });
        }
    }
    runs
}

fn named(runs: &[Run]) -> Vec<String> {
    let found = Returned::of(runs, &Robot::labmate(), Some(&Path::umbmark()));
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    found.outlying.into_iter().map(|run| run.run).collect()
}

/// Seed 11. Allowed: 1e-3 of the sets of each size; Bonferroni makes it less.
#[test]
fn normal_scatter_is_named_in_at_most_one_of_a_thousand_sets() {
    let trials = trials(4000);
    for n in [[2, 2], [3, 3], [3, 5], [5, 5], [5, 2], [10, 10], [20, 20]] {
        let false_alarm = |trial: u64| !named(&normal(n, &mut Stream::new(11, n[0] as u64, trial))).is_empty();
        let alarms = (0..trials).into_par_iter().filter(|trial| false_alarm(*trial)).count();
        let _ = writeln!(std::io::stderr(), "{n:?}: {alarms} false alarms in {trials} sets");
        assert!(alarms as f64 <= 1e-3 * trials as f64 + 3.0 * (1e-3 * trials as f64).sqrt(), "{n:?}: {alarms}");
    }
}

/// Seed 12. Numbers rounded to 10 mm and a degree repeat each other; a rounding step is no outlier.
#[test]
fn rounded_numbers_that_repeat_each_other_are_not_named() {
    for trial in 0..500 {
        let mut runs = normal([5, 5], &mut Stream::new(12, 0, trial));
        for returned in runs.iter_mut().filter_map(|run| run.returned.as_mut()) {
            let to = |value: f64, step: f64| (value / step).round() * step;
            let heading = returned.heading.map(|heading| to(heading, 1f64.to_radians()));
            *returned = ReturnError { x: to(returned.x, 0.01), y: to(returned.y, 0.01), heading };
        }
        assert_eq!(named(&runs), Vec::<String>::new(), "{trial}");
    }
}

/// Seed 13. One typing error, two in one direction, one each way; a digit more, a lost sign, degrees for radians.
#[test]
fn one_and_two_typing_errors_of_ten_are_named_and_no_other_run() {
    let typed = |runs: &mut [Run], place: usize, how: u64| {
        if let Some(own) = runs[place].returned.as_mut() {
            match how {
                0 => own.y = 2.010,
                1 => own.x *= -10.0,
                _ => own.heading = own.heading.map(|heading| wrap(heading.to_degrees())),
            }
        }
    };
    let (sets, mut right) = (trials(600), 0);
    for trial in 0..sets {
        let mut runs = normal([5, 5], &mut Stream::new(13, 0, trial));
        let places: &[usize] = [&[3][..], &[3, 4], &[1, 8]][trial as usize % 3];
        for (k, place) in places.iter().enumerate() {
            typed(&mut runs, *place, (trial / 3 + k as u64) % 3);
        }
        let expected: Vec<&str> = places.iter().map(|place| runs[*place].name.as_str()).collect();
        right += u64::from(named(&runs) == expected);
    }
    let _ = writeln!(std::io::stderr(), "named rightly: {right} of {sets}");
    assert!(right as f64 > 0.99 * sets as f64, "{right} of {sets}");
}

/// Seed 19. More subsets than a number holds, and tails below every number.
#[test]
fn typing_errors_among_thousands_are_named() {
    let mut runs = normal([3000, 3000], &mut Stream::new(19, 0, 0));
    for place in [7, 2999, 3000] {
        runs[place].returned.as_mut().unwrap().y *= 10.0;
    }
    assert_eq!(named(&runs), ["cw_8", "cw_3000", "ccw_1"]);
    (0..200).for_each(|place| runs[29 * place + 5].returned.as_mut().unwrap().x -= 0.5);
    assert_eq!(named(&runs).len(), 203);
}

#[test]
fn a_run_is_told_with_its_distance_and_with_what_stands_out() {
    let mut runs = normal([5, 5], &mut Stream::new(14, 0, 0));
    runs[2].returned.as_mut().unwrap().y = 2.010;
    let found = Returned::of(&runs, &Robot::labmate(), None).outlying;
    let [run] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((run.run.as_str(), run.others, run.deviants.len()), ("cw_3", 4, 1));
    assert_eq!(run.deviants[0].coordinate, Coordinate::Y);
    assert!((run.moved - 2.16).abs() < 0.05 && (50.0..400.0).contains(&run.deviations()), "{run:?}");
    assert!(run.turned.is_some_and(|turned| turned.abs() < 0.03));
    let told = run.sentence();
    assert!(
        told.starts_with("the return error of run cw_3 lies 2.1") && told.contains("y is 2.010 m, their mean is -0.1"),
        "{told}"
    );
}

#[test]
fn bumps_have_groups_of_their_own() {
    let mut runs = normal([5, 5], &mut Stream::new(15, 0, 0));
    let with_bumps: Vec<Run> = normal([5, 5], &mut Stream::new(15, 0, 1))
        .into_iter()
        .map(|run| {
            let moved =
                run.returned.map(|own| ReturnError { x: own.x + 0.5, heading: own.heading.map(|h| h + 0.3), ..own });
            Run { name: format!("bumps_{}", run.name), test: TestKind::Bumps, returned: moved, ..run }
        })
        .collect();
    runs.extend(with_bumps);
    assert_eq!(named(&runs), Vec::<String>::new());
    runs[14].returned.as_mut().unwrap().x = -5.0;
    assert_eq!(named(&runs), ["bumps_cw_5"]);
    assert_eq!(Returned::of(&runs, &Robot::labmate(), None).outlying[0].test, TestKind::Bumps);
}

/// Of two runs, none can be named as wrong, and two runs of one direction are not compared with those of the other.
#[test]
fn of_two_runs_nothing_is_said() {
    let mut runs = normal([5, 2], &mut Stream::new(16, 0, 0));
    runs[6].returned.as_mut().unwrap().x = 3.0;
    assert_eq!(named(&runs), Vec::<String>::new());
}

/// Robots that are off by 5 % and 10 % return metres and tens of degrees away: that is no unit.
#[test]
fn large_errors_of_a_robot_are_no_fault_and_the_same_in_millimetres_or_degrees_is() {
    let (robot, path) = (Robot::labmate(), Path::umbmark());
    let (mut told, mut honest) = ([0; 2], 0);
    for trial in 0..200 {
        let mut stream = Stream::new(17, 0, trial);
        let truth = Correction { e_d: 0.95 + 0.1 * stream.uniform(), e_b: 0.9 + 0.2 * stream.uniform(), e_s: 1.0 };
        let mut runs = normal([5, 5], &mut stream);
        for run in &mut runs {
            let (Some(own), Some(direction)) = (run.returned.as_mut(), run.direction) else { continue };
            let mean = drive_again(&robot, &path, direction, &truth, &Correction::NONE).unwrap();
            let heading = own.heading.map(|h| wrap(h - 0.04 + mean.heading.unwrap_or(0.0)));
            *own = ReturnError { x: own.x + 0.2 + mean.x, y: own.y + 0.15 + mean.y, heading };
        }
        let faults = |runs: &[Run]| Returned::of(runs, &robot, Some(&path)).faults;
        assert_eq!(faults(&runs), Vec::new(), "{truth:?}");
        honest += 1;
        let scaled = |length: f64, angle: f64| {
            let of = |own: ReturnError| ReturnError {
                x: length * own.x,
                y: length * own.y,
                heading: own.heading.map(|heading| wrap(angle * heading)),
            };
            runs.iter().map(|run| Run { returned: run.returned.map(of), ..run.clone() }).collect::<Vec<_>>()
        };
        told[0] += usize::from(matches!(faults(&scaled(1e3, 1.0))[..], [Fault::ReturnsIn { .. }]));
        told[1] += usize::from(faults(&scaled(1.0, 1f64.to_degrees())) == [Fault::ReturnHeadingsInDegrees]);
    }
    let _ = writeln!(std::io::stderr(), "of {honest} robots: mm {}, deg {}", told[0], told[1]);
    assert_eq!(told[0], 200);
}

/// Seeds 20: usual robots, whose returns are measured in the frame of a room; and from START, which lies a little beside the mark.
#[test]
fn returns_in_the_frame_of_a_room_are_told_from_errors_and_from_units() {
    let (path, mut told) = (Path::umbmark(), 0);
    for data in simulated(&robot_with(&[]), &path, 5, 20, 0..100) {
        let faults = |runs: &[Run]| Returned::of(runs, &Robot::labmate(), Some(&path)).faults;
        let seen_from = |x: f64, y: f64, turned: f64| {
            let start = Pose2::new(x, y, turned);
            let of = |own: ReturnError| {
                let pose = start.compose(&Pose2::new(own.x, own.y, own.heading.unwrap_or(0.0)));
                ReturnError { x: pose.x, y: pose.y, heading: own.heading.map(|_| wrap(pose.heading)) }
            };
            data.runs.iter().map(|run| Run { returned: run.returned.map(of), ..run.clone() }).collect::<Vec<_>>()
        };
        assert_eq!(faults(&seen_from(0.1, -0.05, 0.0)), []);
        let elsewhere = [seen_from(3.0, 2.0, 0.0), seen_from(-1.0, 4.0, 1.6), seen_from(20.0, -8.0, -3.0)];
        told +=
            elsewhere.iter().filter(|runs| matches!(faults(runs)[..], [Fault::ReturnsFromElsewhere { .. }])).count();
    }
    let _ = writeln!(std::io::stderr(), "of 300 sets {told} told");
    assert!(told > 295, "{told}");
}

/// Odometry that turns around while the robot drives straight ends nearly twice the way from it; no error is larger.
#[test]
fn errors_of_logs_are_in_another_unit_only_beyond_twice_the_way() {
    let robot = Robot::labmate();
    let mut run = watched(&robot_with(&[]), 1, 3).runs[0].clone();
    let way = way(run.log.as_ref().unwrap(), &robot).unwrap();
    for (times, wrong) in [(0.9, false), (1.9, false), (2.1, true)] {
        run.returned = Some(ReturnError { x: times * way, y: 0.0, heading: None });
        let faults = Returned::of(std::slice::from_ref(&run), &robot, None).faults;
        assert_eq!(matches!(faults[..], [Fault::ReturnsIn { .. }]), wrong, "{times}: {faults:?}");
    }
}

/// Seeds 18: the paper's robot and 5 + 5 runs.
#[test]
fn degrees_of_a_usual_robot_are_seen_and_its_radians_are_left_alone() {
    let (sets, mut told) = (100, 0);
    for data in simulated(&robot_with(&[]), &Path::umbmark(), 5, 18, 0..sets) {
        let mut runs = data.runs.clone();
        let faults = |runs: &[Run]| Returned::of(runs, &Robot::labmate(), data.path.as_ref()).faults;
        assert_eq!(faults(&runs), Vec::new());
        for own in runs.iter_mut().filter_map(|run| run.returned.as_mut()) {
            own.heading = own.heading.map(|heading| wrap(heading.to_degrees()));
        }
        told += usize::from(faults(&runs) == [Fault::ReturnHeadingsInDegrees]);
    }
    let _ = writeln!(std::io::stderr(), "degrees seen in {told} of {sets}");
    assert!(told > 90, "{told}");
}

/// Read as degrees, these headings would lie half a turn from those of the positions, some on one side and some on the other: that is no
/// scatter.
#[test]
fn radians_half_a_turn_from_what_they_would_be_in_degrees_are_left_alone() {
    let mut robot = Robot::labmate();
    robot.drive = crate::drive::DifferentialDrive::new(0.45, 0.095, 0.095).unwrap().into();
    let path = Path::new(&crate::path::SQUARE, &[1.0], crate::path::SpeedProfile::default()).unwrap();
    let mut stream = Stream::new(19, 0, 0);
    for _ in 0..3000 {
        let truth = Correction { e_d: 1.0145 + 0.001 * stream.uniform(), e_b: 0.977, e_s: 1.0 };
        let mut runs = normal([4, 4], &mut stream);
        for run in &mut runs {
            let (Some(own), Some(direction)) = (run.returned.as_mut(), run.direction) else { continue };
            let mean = drive_again(&robot, &path, direction, &truth, &Correction::NONE).unwrap();
            let heading = own.heading.map(|h| h - 0.04 + mean.heading.unwrap_or(0.0));
            *own = ReturnError { x: 0.2 * (own.x + 0.2) + mean.x, y: 0.2 * (own.y + 0.15) + mean.y, heading };
        }
        assert_eq!(Returned::of(&runs, &robot, Some(&path)).faults, [], "{truth:?}");
    }
}
