use super::*;
use crate::dataset::{ReferencePose, TickLog};
use crate::drive::Encoder;
use crate::path::SpeedProfile;

/// Drives a square of 2 m at 50 Hz, tracked every `every` samples; `wheels` changes the counts written down.
fn drive(direction: Direction, every: usize, wheels: impl Fn(f64, f64) -> (f64, f64)) -> Run {
    let robot = Robot::labmate();
    let path = Path::new(&crate::path::SQUARE, &[2.0], SpeedProfile::default()).unwrap();
    let per_tick = robot.metres_per_tick();
    let (mut log, mut pose) = (TickLog::default(), Pose2::IDENTITY);
    let (mut left, mut right) = (0.0, 0.0);
    let mut write = |pose: &Pose2, (left, right): (f64, f64)| {
        let sample = log.time.len();
        log.time.push(sample as f64 / 50.0);
        log.left.push(left);
        log.right.push(right);
        if sample.is_multiple_of(every) {
            let noise = 1e-3 * (sample as f64 * 12.9898).sin();
            log.reference.push(ReferencePose { sample, x: pose.x + noise, y: pose.y, heading: Some(pose.heading) });
        }
    };
    (0..50).for_each(|_| write(&pose, wheels(left, right)));
    for m in path.moves(direction) {
        let (n, d) = (200, m.displacement());
        let travel = m.wheel_travel(&robot.drive);
        for _ in 0..n {
            pose = pose.moved(&crate::geometry::Displacement2 {
                forward: d.forward / f64::from(n),
                sideways: 0.0,
                rotation: d.rotation / f64::from(n),
            });
            left += travel.left / f64::from(n) / per_tick.left;
            right += travel.right / f64::from(n) / per_tick.right;
            write(&pose, wheels(left, right));
        }
    }
    (0..50).for_each(|_| write(&pose, wheels(left, right)));
    let returned = return_error(&log, &computed_end(&log, &robot).0.unwrap(), EndPose::Standing);
    let (name, test) = (direction.name().to_owned(), TestKind::Systematic);
    Run { name, number: 1, direction: Some(direction), test, log: Some(log), returned }
}

fn dataset(runs: Vec<Run>) -> Dataset {
    let path = Path::new(&crate::path::SQUARE, &[2.0], SpeedProfile::default()).unwrap();
    Dataset { robot: Some(Robot::labmate()), path: Some(path), runs, ..Dataset::default() }
}

fn same(left: f64, right: f64) -> (f64, f64) {
    (left, right)
}

fn check<'a>(inspection: &'a Inspection, name: &str) -> &'a Check {
    inspection.checks.iter().find(|check| check.name == name).unwrap()
}

#[test]
fn a_clean_log_is_measured_as_it_was_made() {
    let found = dataset(vec![drive(Direction::Cw, 5, same), drive(Direction::Ccw, 5, same)]).inspect();
    for (log, turn) in found.logs.iter().zip([-1.0, 1.0]) {
        assert_eq!(log.rows, 1700);
        assert!((log.duration - 33.98).abs() < 1e-9 && (log.rate - 50.0).abs() < 1e-6 && log.jitter < 1e-6);
        assert!((log.length.unwrap() - 8.0).abs() < 1e-9);
        assert!((log.heading.unwrap() - turn * std::f64::consts::TAU).abs() < 1e-9);
        let reference = log.reference.as_ref().unwrap();
        assert_eq!((reference.poses, reference.coverage), (340, Coverage::Track));
        assert!((reference.rate - 10.0).abs() < 0.1 && (reference.longest_gap - 0.1).abs() < 1e-9);
        let noise = reference.noise.unwrap();
        assert!(noise > 0.3e-3 && noise < 0.8e-3, "{noise}");
        assert!(reference.heading_noise.unwrap() < 1e-9);
    }
    let bad: Vec<_> = found.checks.iter().filter(|check| !check.ok).map(|check| check.name).collect();
    assert_eq!(bad, ["runs"]);
    assert!(found.checks.iter().all(|check| check.name != "returns against logs"), "they are from the logs");
    assert!(found.determined.iter().take(4).all(|d| d.yes));
}

#[test]
fn exchanged_and_backward_wheels_are_told_from_the_track() {
    for (exchanged, left_backward, right_backward) in [(true, false, false), (false, true, false), (true, false, true)]
    {
        let wheels = |left: f64, right: f64| {
            let (mut l, mut r) = if exchanged { (right, left) } else { (left, right) };
            l = if left_backward { -l } else { l };
            r = if right_backward { -r } else { r };
            (l, r)
        };
        let found = dataset(vec![drive(Direction::Ccw, 5, wheels)]).inspect();
        let expected = Wheels::Otherwise { exchanged, left_backward, right_backward };
        assert_eq!(found.logs[0].wheels, Some(expected));
        assert!(!check(&found, "wheels").ok);
    }
    assert_eq!(
        Wheels::Otherwise { exchanged: true, left_backward: false, right_backward: true }.to_string(),
        "left and right exchanged, ticks_right counts backward"
    );
}

#[test]
fn one_recording_of_exchanged_wheels_among_others_is_named() {
    let mut runs: Vec<Run> = (4..8).map(|every| drive(Direction::Ccw, every, same)).collect();
    runs[2] = Run { name: "odd".into(), ..drive(Direction::Ccw, 5, |left, right| (right, left)) };
    let found = dataset(runs).inspect();
    assert_eq!(check(&found, "wheels").found, "left and right exchanged, in odd");
    assert_eq!(found.logs[0].wheels, Some(Wheels::AsGiven));
    let faults = &found.setup.as_ref().unwrap().faults;
    assert!(matches!(&faults[..], [Fault::InRuns { runs, .. }] if *runs == ["odd"]), "{faults:?}");
}

/// What is said of the wheels of a run without poses on the way.
fn by_path(run: Run) -> Option<Wheels> {
    dataset(vec![run]).inspect().logs[0].wheels
}

const NONE: usize = 100_000;

#[test]
fn without_a_track_a_wheel_that_runs_backward_is_told_by_the_path() {
    let otherwise =
        |left_backward, right_backward| Some(Wheels::Otherwise { exchanged: false, left_backward, right_backward });
    for direction in Direction::BOTH {
        assert_eq!(by_path(drive(direction, NONE, |left, right| (left, -right))), otherwise(false, true));
        assert_eq!(by_path(drive(direction, NONE, |left, right| (-left, right))), otherwise(true, false));
        assert_eq!(by_path(drive(direction, NONE, same)), Some(Wheels::AsGiven));
        assert_eq!(by_path(drive(direction, NONE, |left, right| (-left, -right))), otherwise(true, true));
    }
}

#[test]
fn a_run_that_reverses_or_is_driven_backward_accuses_no_counter() {
    let reversing = |mut run: Run, share: f64| {
        let log = run.log.as_mut().unwrap();
        let turn = (share * (log.time.len() - 1) as f64) as usize;
        // From there on, it goes back the way that it came.
        for counts in [&mut log.left, &mut log.right] {
            let most = counts[turn];
            counts[turn + 1..].iter_mut().for_each(|count| *count = 2.0 * most - *count);
        }
        run
    };
    for share in [0.3, 0.5, 0.7] {
        assert_eq!(by_path(reversing(drive(Direction::Ccw, NONE, same), share)), None, "{share}");
    }
    // Backward all the way, and turning as the direction is named.
    assert_eq!(by_path(drive(Direction::Ccw, NONE, |left, right| (-right, -left))), None);
}

#[test]
fn a_clock_is_told_only_where_poses_and_wheels_move_alike() {
    let mut run = drive(Direction::Ccw, 5, same);
    let other = drive(Direction::Cw, 5, |left, right| (0.3 * left, right));
    let log = run.log.as_mut().unwrap();
    // The poses of a robot that was driven round and round meanwhile.
    for (k, pose) in log.reference.iter_mut().enumerate() {
        let angle = 0.31 * k as f64 + (0.05 * k as f64).sin();
        (pose.x, pose.y, pose.heading) = (0.7 * angle.cos(), 0.4 * angle.sin(), Some(wrap(-2.3 * angle)));
    }
    (log.left, log.right) = {
        let log = other.log.unwrap();
        (log.left, log.right)
    };
    let found = dataset(vec![run]).inspect();
    let clock = check(&found, "clock of the poses");
    assert!(!clock.ok && clock.found.starts_with("unknown") && !clock.found.contains("ms"), "{}", clock.found);
    assert!(found.logs[0].delay.is_none());
}

#[test]
fn a_recording_with_a_clock_of_its_own_is_named() {
    let late = |run: Run, samples: usize| {
        let mut run = run;
        let log = run.log.as_mut().unwrap();
        log.reference.retain(|pose| pose.sample + samples < log.time.len());
        log.reference.iter_mut().for_each(|pose| pose.sample += samples);
        run.name = format!("late_{samples}");
        run
    };
    let runs = [0, 0, 5, 0].map(|samples| late(drive(Direction::Ccw, 5, same), samples));
    let found = dataset(runs.into()).inspect();
    let clock = check(&found, "clock of the poses");
    assert!(!clock.ok && clock.found.contains("late_5 by +"), "{}", clock.found);
    assert!((found.logs[2].delay.unwrap().value - 0.1).abs() < 0.01, "{:?}", found.logs[2].delay);
}

#[test]
fn what_was_mended_in_a_log_is_counted_and_only_a_roll_over_is_harmless() {
    let mut mended = drive(Direction::Ccw, 5, same);
    mended.log.as_mut().unwrap().mended =
        Mended { roll_overs: 3, resets: 1, late: 2, repeated: 0, stale: 4, filled_in: 0 };
    let mut data = dataset(vec![mended, drive(Direction::Cw, 5, same)]);
    let encoder = data.robot.as_ref().unwrap().encoder;
    let encoder = Encoder::new(encoder.ticks_per_revolution(), encoder.rate(), Some(16)).unwrap();
    data.robot.as_mut().unwrap().encoder = encoder;
    let found = data.inspect();
    let said = |name| (check(&found, name).found.as_str(), check(&found, name).ok);
    assert_eq!(said("counter roll-overs"), ("3 of counters of 16 bits, undone", true));
    assert_eq!(said("counter resets"), ("1, counted on from zero", false));
    assert_eq!(said("rows and poses repaired"), ("2 out of order, 0 repeated, 4 stale poses", false));
    data.runs[0].log.as_mut().unwrap().mended = Mended { filled_in: 30, ..Mended::default() };
    let found = data.inspect();
    let said = check(&found, "rows and poses repaired");
    assert!(!said.ok && said.found.ends_with("0 stale poses, 30 filled in"), "{}", said.found);
}

#[test]
fn a_sheet_that_tells_of_other_runs_is_seen() {
    let mut run = drive(Direction::Ccw, 5, same);
    run.returned.as_mut().unwrap().y += 0.05;
    let found = dataset(vec![run]).inspect();
    assert_eq!(check(&found, "returns against logs").found, "50.0 mm apart at most");
    assert!(!check(&found, "returns against logs").ok);
}

#[test]
fn gaps_jitter_and_a_wrong_wheelbase_are_seen() {
    let mut run = drive(Direction::Ccw, 5, same);
    for time in &mut run.log.as_mut().unwrap().time[800..] {
        *time += 1.0;
    }
    for (i, time) in run.log.as_mut().unwrap().time.iter_mut().enumerate() {
        *time += 0.006 * f64::from(i as u32 % 2);
    }
    let mut data = dataset(vec![run]);
    let robot = data.robot.as_mut().unwrap();
    robot.drive = crate::drive::DifferentialDrive::new(0.36, 0.16, 0.16).unwrap().into();
    let found = data.inspect();
    for name in ["jitter", "longest gap", "length by ticks"] {
        assert!(!check(&found, name).ok, "{name}: {}", check(&found, name).found);
    }
    assert_eq!(check(&found, "length by ticks").found, "6.7 % off the path");
    robot_heading(&data);
}

fn robot_heading(data: &Dataset) {
    let mut data = data.clone();
    let robot = data.robot.as_mut().unwrap();
    robot.drive = crate::drive::DifferentialDrive::new(0.36, 0.15, 0.15).unwrap().into();
    let found = data.inspect();
    assert_eq!(check(&found, "heading by ticks").found, "20.0 deg off the path");
}

/// Whether E_d, E_b and E_s can be had from return errors on a path.
fn determined(path: Path, directions: &[Direction], heading: bool) -> [bool; 3] {
    determined_of(&Robot::labmate(), path, directions, heading)
}

/// The same of the first effects of another robot.
fn determined_of(robot: &Robot, path: Path, directions: &[Direction], heading: bool) -> [bool; 3] {
    let returned = ReturnError { x: 0.0, y: 0.0, heading: heading.then_some(0.0) };
    let run = |direction: &Direction| Run {
        name: String::new(),
        number: 1,
        direction: Some(*direction),
        test: TestKind::Systematic,
        log: None,
        returned: Some(returned),
    };
    let mut data = dataset(directions.iter().map(run).collect());
    data.path = Some(path);
    data.robot = Some(robot.clone());
    let answers = data.inspect().determined;
    [answers[0].yes, answers[1].yes, answers[2].yes]
}

#[test]
fn what_returns_can_determine_depends_on_path_directions_and_headings() {
    use crate::path::{CIRCLE, FIGURE_EIGHT, SPIN, SQUARE, STRAIGHT};
    let path = |shape, values: &[f64]| Path::new(shape, values, SpeedProfile::default()).unwrap();
    let (cw, both) = (&[Direction::Cw][..], &Direction::BOTH[..]);
    for heading in [true, false] {
        assert_eq!(determined(path(&SQUARE, &[4.0]), both, heading), [true, true, false]);
        assert_eq!(determined(path(&SQUARE, &[4.0]), cw, heading), [false, false, false]);
        assert_eq!(determined(path(&SPIN, &[4.0]), both, heading), [false, heading, false]);
        assert_eq!(determined(path(&STRAIGHT, &[4.0]), cw, heading), [true, false, true]);
    }
    assert_eq!(determined(path(&FIGURE_EIGHT, &[2.0]), cw, true), [true, true, false]);
    assert_eq!(determined(path(&CIRCLE, &[2.0, 1.0]), both, true), [true, true, false]);
    assert_eq!(determined(path(&CIRCLE, &[2.0, 0.5]), both, true), [true, true, true]);
}

#[test]
fn what_returns_of_a_base_on_rollers_can_determine_depends_on_how_it_goes_round() {
    use crate::drive::DriveKind;
    use crate::path::{FIXED_SQUARE, SIDEWAYS_SQUARE, SLIDE, SQUARE};
    for kind in [DriveKind::Mecanum, DriveKind::Omni3, DriveKind::Omni4, DriveKind::DeadWheels] {
        let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
        for (shape, expected) in [
            (&SQUARE, [true, true, false]),
            // Without turns, nothing shows how far the wheels stand apart; without ways ahead, nothing bends legs.
            (&FIXED_SQUARE, [true, false, false]),
            (&SIDEWAYS_SQUARE, [false, true, false]),
            (&SLIDE, [false, false, true]),
        ] {
            let path = Path::new(shape, &[4.0], SpeedProfile::default()).unwrap();
            let found = determined_of(&robot, path, &Direction::BOTH, true);
            assert_eq!(found, expected, "{} {}", kind.name(), shape.name);
        }
    }
}

/// A log of a drive along a straight of 6 m, tracked all the way, which wanders by some hundredths of a radian.
fn straight(number: u32) -> Run {
    let robot = Robot::labmate();
    let per_tick = robot.metres_per_tick();
    let (mut log, mut pose) = (TickLog::default(), Pose2::IDENTITY);
    let [mut left, mut right] = [0.0; 2];
    for sample in 0..600 {
        log.time.push(f64::from(sample) / 50.0);
        log.left.push(left / per_tick.left);
        log.right.push(right / per_tick.right);
        log.reference.push(ReferencePose {
            sample: sample as usize,
            x: pose.x,
            y: pose.y,
            heading: Some(pose.heading),
        });
        let rotation = 1e-4 * f64::from(sample % 100 - 50) / 50.0;
        let (l, r) = (0.01 - 0.17 * rotation, 0.01 + 0.17 * rotation);
        (left, right) = (left + l, right + r);
        pose = pose.moved(&crate::geometry::Displacement2 { forward: 0.01, sideways: 0.0, rotation });
    }
    let (name, test) = (format!("straight_{number}"), TestKind::Systematic);
    Run { name, number, direction: None, test, log: Some(log), returned: None }
}

#[test]
fn what_tracks_determine_depends_on_the_motion_that_was_driven_and_not_on_the_path_that_is_named() {
    // The path of the dataset is a square, but these runs only went straight on.
    let found = dataset((0..6).map(straight).collect()).inspect();
    let [bends, turns, scale] = [0, 1, 2].map(|k| &found.determined[k]);
    assert!(bends.yes && !turns.yes && scale.yes, "{:?}", &found.determined[..3]);
    assert!(turns.std_error.is_none_or(|error| error > 0.5 * turns.usual.unwrap()), "{turns:?}");
    assert!(turns.because.contains("does not show it") && found.rank == 2, "{turns:?}");
    let blind = |inspection: &Inspection| check(inspection, "wheels").found.contains(SIDES);
    assert!(blind(&found), "{}", check(&found, "wheels").found);
    let square = dataset(vec![drive(Direction::Ccw, 5, same)]).inspect();
    assert!(!blind(&square));
    assert!(square.determined[..3].iter().all(|d| d.yes && d.std_error.unwrap() < 2e-3), "{:?}", square.determined);
    assert_eq!(square.rank, 3);
}

/// The robot drives tail first, or the wheels are exchanged and both count backward: one motion.
#[test]
fn headings_half_a_turn_off_leave_open_which_wheel_is_which() {
    let turned = |direction| {
        let mut run = drive(direction, 5, same);
        let log = run.log.as_mut().unwrap();
        log.reference.iter_mut().for_each(|pose| pose.heading = pose.heading.map(|h| wrap(h + std::f64::consts::PI)));
        run
    };
    let found = dataset(vec![turned(Direction::Cw), turned(Direction::Ccw)]).inspect();
    let wheels = check(&found, "wheels");
    assert!(!wheels.ok && wheels.found.contains(EITHER_WAY), "{}", wheels.found);
}

/// Oracle: the stamps of the second log are 0.4 s late.
#[test]
fn the_log_whose_clock_is_farthest_from_the_others_is_named() {
    let mut late = drive(Direction::Ccw, 5, same);
    let log = late.log.as_mut().unwrap();
    let rows = log.time.len();
    log.reference.retain(|pose| pose.sample + 20 < rows);
    log.reference.iter_mut().for_each(|pose| pose.sample += 20);
    let runs = vec![drive(Direction::Cw, 5, same), late];
    let found = dataset(runs).inspect();
    let clock = check(&found, "clock of the poses");
    assert!(!clock.ok && clock.found.contains("ccw"), "{}", clock.found);
}

#[test]
fn more_runs_have_smaller_standard_errors_and_one_direction_of_ends_keeps_both_together() {
    let ends = |directions: &[Direction]| {
        let runs = directions.iter().map(|d| drive(*d, NONE, same)).map(|mut run| {
            run.log = None;
            run
        });
        dataset(runs.collect()).inspect()
    };
    let error = |found: &Inspection, k: usize| found.determined[k].std_error;
    let (two, eight) = (ends(&Direction::BOTH), ends(&Direction::BOTH.repeat(4)));
    for k in 0..2 {
        let ratio = error(&two, k).unwrap() / error(&eight, k).unwrap();
        assert!((ratio - 2.0).abs() < 0.05, "{ratio}: {:?}", two.determined);
    }
    let one = ends(&[Direction::Cw; 20]);
    for d in &one.determined[..2] {
        assert!(!d.yes && d.because.contains("cannot separate them"), "{d:?}");
    }
    assert_eq!([one.rank, two.rank], [1, 2]);
}

#[test]
fn without_logs_and_a_path_nothing_is_determined() {
    let mut run = drive(Direction::Cw, NONE, same);
    run.log = None;
    let found = Dataset { path: None, ..dataset(vec![run]) }.inspect();
    assert!(found.determined[..3].iter().all(|d| !d.yes && d.std_error.is_none() && d.because.contains("[path]")));
    assert_eq!(found.rank, 0);
}

#[test]
fn what_cannot_be_determined_is_said_with_what_would_help() {
    let strip = |mut run: Run| {
        run.log = None;
        run
    };
    let found = |runs: Vec<Run>| dataset(runs).inspect().determined;
    let cw = strip(drive(Direction::Cw, 5, same));
    let ccw = strip(drive(Direction::Ccw, 5, same));
    let one = found(vec![cw.clone()]);
    assert!(one[..2].iter().all(|answer| answer.because.contains("drive the other direction")));
    let both = found(vec![cw, ccw]);
    assert!(both[2].because.contains("E_b/E_s only") && both[3].yes && !both[4].yes && !both[5].yes);
    assert!(found(Vec::new())[0].because.contains("no return error"));
    let tracked = found(vec![drive(Direction::Cw, 5, same)]);
    assert!(tracked[..3].iter().all(|answer| answer.yes));
}

#[test]
fn late_poses_and_a_tracked_point_beside_the_axle_are_seen_by_the_motion() {
    for (late, ahead) in [(0.0, 0.0), (0.1, 0.0), (0.0, 0.05)] {
        let mut run = drive(Direction::Ccw, 5, same);
        let log = run.log.as_mut().unwrap();
        log.reference.truncate(log.reference.len() - 2);
        for pose in &mut log.reference {
            pose.sample += (50.0 * late) as usize;
            let heading = pose.heading.unwrap();
            (pose.x, pose.y) = (pose.x + ahead * heading.cos(), pose.y + ahead * heading.sin());
        }
        let found = dataset(vec![run]).inspect();
        let mounting = found.setup.as_ref().unwrap().mounting.unwrap();
        assert!((mounting.delay.value - late).abs() < 0.01, "{late}: {mounting:?}");
        assert!((found.logs[0].delay.unwrap().value - late).abs() < 0.01, "{late}: {:?}", found.logs[0].delay);
        assert!((mounting.ahead.unwrap().value - ahead).abs() < 2e-3, "{ahead}: {mounting:?}");
        assert_eq!(check(&found, "clock of the poses").ok, late == 0.0);
        assert_eq!(check(&found, "tracked point").ok, ahead == 0.0);
        assert!(check(&found, "tracked heading").ok && check(&found, "path by ticks").ok);
    }
}
