use super::*;
use crate::dataset::ReferencePose;
use crate::drive::{DifferentialDrive, Encoder, Wiring};
use crate::geometry::Pose2;
use crate::random::Stream;

mod clocks;
mod counts;
mod driven;

/// A drive as it is put in; see [`Drive::runs`].
#[derive(Clone)]
struct Drive {
    /// How the robot drives for so long \[s\].
    driven: fn(f64, &mut Stream) -> driven::Driven,
    wiring: Wiring,
    /// Counts of a turn of a wheel.
    counts: f64,
    /// Delay of the stamps in each run \[s\], the first of them also where there are no more, and what is added each second.
    delays: Vec<f64>,
    rate: f64,
    /// Time constant of a low-pass filter of the poses \[s\]; 0 for none.
    smoothed: f64,
    /// The tracked body on the robot.
    body: Pose2,
    /// What is written of a pose.
    written: fn(f64, f64, f64) -> (f64, f64, f64),
    /// Runs whose columns are exchanged.
    exchanged: Vec<usize>,
    /// Run, time and size of jumps; run, place and size of wrong poses.
    jumps: Vec<(usize, f64, [f64; 3])>,
    wrong: Vec<(usize, usize, [f64; 3])>,
    runs: usize,
    seconds: f64,
    seed: u64,
}

/// Poses a second.
const RATE: f64 = 20.0;
/// Noise of a pose \[m, rad\].
const NOISE: (f64, f64) = (1e-3, 2e-3);
const WHEELBASE: f64 = 0.3;

fn clean() -> Drive {
    Drive {
        driven: driven::free,
        wiring: Wiring::default(),
        counts: 20_000.0,
        delays: vec![0.0],
        rate: 0.0,
        smoothed: 0.0,
        body: Pose2::IDENTITY,
        written: |x, y, heading| (x, y, heading),
        exchanged: Vec::new(),
        jumps: Vec::new(),
        wrong: Vec::new(),
        runs: 4,
        seconds: 50.0,
        seed: 40,
    }
}

fn robot() -> Robot {
    clean().robot()
}

impl Drive {
    fn robot(&self) -> Robot {
        Robot {
            name: "free".into(),
            drive: DifferentialDrive::new(WHEELBASE, 0.1, 0.1).unwrap().into(),
            encoder: Encoder::new(self.counts, None, None).unwrap(),
        }
    }

    fn runs(&self) -> Vec<Run> {
        (0..self.runs).map(|run| self.run(run)).collect()
    }

    fn run(&self, run: usize) -> Run {
        let mut stream = Stream::new(self.seed, 0, run as u64);
        let driven = driven::smoothed((self.driven)(self.seconds, &mut stream), self.smoothed);
        let delay = self.delays.get(run).copied().unwrap_or(self.delays[0]);
        let per_tick = self.robot().metres_per_tick();
        let mut log = TickLog::default();
        let mut counters = [Vec::new(), Vec::new()];
        for sample in 0..(RATE * self.seconds) as usize {
            let time = sample as f64 / RATE;
            log.time.push(time);
            let (_, [left, right]) = driven[(1000.0 * time) as usize];
            counters[0].push((left / per_tick.left).floor());
            counters[1].push((right / per_tick.right).floor());
            let taken = time - delay - self.rate * (time - 0.5 * self.seconds);
            let (robot, _) = driven[((1000.0 * taken).round().max(0.0) as usize).min(driven.len() - 1)];
            let mut seen = robot.compose(&self.body);
            for (_, _, [x, y, turned]) in self.jumps.iter().filter(|(own, at, _)| *own == run && *at <= time) {
                seen = Pose2::new(seen.x + x, seen.y + y, seen.heading + turned);
            }
            for (_, _, [x, y, turned]) in self.wrong.iter().filter(|(own, at, _)| *own == run && *at == sample) {
                seen = Pose2::new(seen.x + x, seen.y + y, seen.heading + turned);
            }
            let noise = [NOISE.0, NOISE.0, NOISE.1].map(|sd| sd * stream.normal());
            let (x, y, heading) = (self.written)(seen.x + noise[0], seen.y + noise[1], wrap(seen.heading + noise[2]));
            log.reference.push(ReferencePose { sample, x, y, heading: Some(heading) });
        }
        let mut columns = self.wiring.columns(counters);
        if self.exchanged.contains(&run) {
            columns.reverse();
        }
        [log.left, log.right] = columns;
        let name = format!("run_{run}");
        Run { name, number: run as u32, direction: None, test: TestKind::Systematic, log: Some(log), returned: None }
    }

    fn found(&self) -> Setup {
        Setup::of(&self.runs(), &self.robot(), None)
    }
}

fn near(found: Option<Measured>, truth: f64, limit: f64) {
    let found = found.unwrap();
    let off = (found.value - truth).abs();
    assert!(off < limit && off < 4.0 * found.std_error, "{found:?}, and {truth} was put in");
}

#[test]
fn a_clean_set_has_no_fault_no_delay_and_no_disturbance() {
    for seed in [40, 41, 42] {
        let found = Drive { seed, ..clean() }.found();
        assert_eq!(found.faults, []);
        assert_eq!(found.disturbances(), [0, 0], "{:?}", found.runs);
        let mounting = found.mounting.unwrap();
        near(Some(mounting.delay), 0.0, 5e-3);
        near(mounting.ahead, 0.0, 2e-3);
        near(mounting.left, 0.0, 2e-3);
        near(mounting.yaw, 0.0, 3e-3);
        near(mounting.scale, 1.0, 3e-3);
        near(mounting.gain, 1.0, 3e-3);
        assert!(found.runs.iter().all(|run| run.delay.unwrap().value.abs() < 5e-3), "{:?}", found.runs);
        assert!(found.noise.position < 2e-3 && found.noise.heading < 4e-3, "{:?}", found.noise);
    }
}

/// What a fault says of the columns.
fn wiring(fault: &Fault) -> Wiring {
    match fault {
        Fault::Exchanged => Wiring { exchanged: true, backward: [false; 2] },
        Fault::Backward { counters, exchanged, .. } => Wiring { exchanged: *exchanged, backward: *counters },
        other => panic!("{other:?}"),
    }
}

#[test]
fn each_way_to_wire_the_counters_is_named_as_it_is() {
    for k in 1..8_u32 {
        let put_in = Wiring { exchanged: k & 1 != 0, backward: [k & 2 != 0, k & 4 != 0] };
        let found = Drive { wiring: put_in, ..clean() }.found();
        if put_in == (Wiring { exchanged: true, backward: [true; 2] }) {
            // Which is what a tracked body that faces backward looks like.
            assert_eq!(found.faults, []);
            assert!(wrap(found.mounting.unwrap().yaw.unwrap().value - std::f64::consts::PI).abs() < 0.01);
            assert!(matches!(found.tail_first(&robot()), Some(Suspicion::TailFirst { .. })));
            continue;
        }
        assert_eq!(found.faults.len(), 1, "{put_in:?}: {:?}", found.faults);
        assert_eq!(wiring(&found.faults[0]), put_in);
        assert!(!found.is_sound() && found.mounting.is_none());
    }
}

/// The counts of encoders with one channel: every step counts up, of the left, the right or both.
fn counted_up(mut runs: Vec<Run>, counters: [bool; 2]) -> Vec<Run> {
    let rising = |counts: &mut Vec<f64>| {
        let steps: Vec<f64> = counts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
        let mut sum = counts[0];
        for (count, step) in counts[1..].iter_mut().zip(&steps) {
            sum += step;
            *count = sum;
        }
    };
    for log in runs.iter_mut().filter_map(|run| run.log.as_mut()) {
        if counters[0] {
            rising(&mut log.left);
        }
        if counters[1] {
            rising(&mut log.right);
        }
    }
    runs
}

/// Free drives with turns on the spot, seeds 300 to 315; and drives in which no wheel rolls backward.
#[test]
fn counters_of_one_channel_are_named_where_wheels_roll_backward_and_nowhere_else() {
    for seed in 300..316 {
        let runs = Drive { seed, ..clean() }.runs();
        let faults = |runs: &[Run]| Setup::of(runs, &robot(), None).faults;
        assert_eq!(faults(&runs), [], "{seed}");
        for counters in [[true, false], [false, true], [true, true]] {
            let found = faults(&counted_up(runs.clone(), counters));
            let names = robot().drive.kind().counters();
            assert_eq!(found, [Fault::OneWay { names, counters }], "{seed}");
        }
        let ahead = Drive { seed, driven: driven::pursuing, ..clean() }.runs();
        let backward = |counts: &[f64]| counts.windows(2).any(|pair| pair[1] < pair[0]);
        let reverses =
            ahead.iter().filter_map(|run| run.log.as_ref()).any(|log| backward(&log.left) || backward(&log.right));
        if !reverses {
            assert_eq!(faults(&ahead), [], "{seed}");
        }
    }
}

/// Each count less the one of the row before.
#[test]
fn counts_since_the_row_before_are_named() {
    let steps = |counts: &[f64]| {
        let before = std::iter::once(&0.0).chain(counts);
        counts.iter().zip(before).map(|(count, before)| count - before).collect::<Vec<f64>>()
    };
    for (seed, driven) in [(40, driven::free as fn(f64, &mut Stream) -> driven::Driven), (41, driven::pursuing)] {
        let mut runs = Drive { seed, driven, ..clean() }.runs();
        for log in runs.iter_mut().filter_map(|run| run.log.as_mut()) {
            (log.left, log.right) = (steps(&log.left), steps(&log.right));
        }
        assert_eq!(Setup::of(&runs, &robot(), None).faults, [Fault::Increments], "{seed}");
    }
}

#[test]
fn headings_and_positions_that_are_not_what_they_are_called_are_named() {
    let faults = |written| Drive { written, ..clean() }.found().faults;
    assert_eq!(faults(|x, y, heading| (x, y, -heading)), [Fault::HeadingClockwise]);
    assert_eq!(faults(|x, y, heading| (x, -y, heading)), [Fault::PositionsMirrored]);
    assert_eq!(faults(|x, y, heading| (x, y, heading.to_degrees())), [Fault::HeadingInDegrees]);
    assert_eq!(faults(|x, y, heading| (x, y, heading.to_radians())), [Fault::HeadingInRadians]);
    assert_eq!(faults(|x, y, heading| (y, x, heading)), [Fault::PositionsExchanged]);
    let found = faults(|x, y, heading| (1e3 * y, 1e3 * x, heading));
    assert!(matches!(found[..], [Fault::PositionsExchanged, Fault::LengthsIn { unit: "mm", .. }]), "{found:?}");
    assert_eq!(faults(|x, y, heading| (-x, y, heading)), [Fault::PositionsMirrored]);
    // A reference that is mirrored altogether looks like exchanged wheels, and the remedy says so.
    let mirrored = faults(|x, y, heading| (x, -y, -heading));
    assert_eq!(mirrored, [Fault::Exchanged]);
    assert!(mirrored[0].remedy().contains("y_mirrored"));
    for (written, expected) in [
        ((|x, y, heading| (1e3 * x, 1e3 * y, heading)) as fn(f64, f64, f64) -> (f64, f64, f64), ("mm", "metres")),
        (|x, y, heading| (1e2 * x, 1e2 * y, heading), ("cm", "metres")),
        (|x, y, heading| (39.37 * x, 39.37 * y, heading), ("inches", "metres")),
        (|x, y, heading| (3.2808 * x, 3.2808 * y, heading), ("feet", "metres")),
        (|x, y, heading| (1e-1 * x, 1e-1 * y, heading), ("cm", "mm")),
        (|x, y, heading| (1e-2 * x, 1e-2 * y, heading), ("metres", "cm")),
        (|x, y, heading| (1e-3 * x, 1e-3 * y, heading), ("metres", "mm")),
    ] {
        let found = faults(written);
        let is_it = matches!(found[..], [Fault::LengthsIn { unit, named, .. }] if (unit, named) == expected);
        assert!(is_it, "{expected:?}: {found:?}");
    }
    let found = faults(|x, y, heading| (8.0 * x, 8.0 * y, heading));
    assert!(matches!(found[..], [Fault::OtherScale { ratio }] if (ratio - 8.0).abs() < 0.1), "{found:?}");
}

#[test]
fn wheels_that_roll_twice_the_commanded_path_are_suspicious_where_no_reference_tells() {
    let mut runs = clean().runs();
    let way = |run: &Run| {
        let log = run.log.as_ref().unwrap();
        let pairs = log.left.windows(2).zip(log.right.windows(2));
        let ticks: f64 = pairs.map(|(l, r)| 0.5 * ((l[1] - l[0]).abs() + (r[1] - r[0]).abs())).sum();
        ticks * robot().metres_per_tick().left
    };
    let rolled = way(&runs[0]);
    runs.truncate(1);
    runs[0].log.as_mut().unwrap().reference.clear();
    for (times, suspicious) in [(1.0, false), (1.3, false), (2.0, true), (0.25, true)] {
        let turns = 4.0 * 0.5 * WHEELBASE * std::f64::consts::FRAC_PI_2;
        let side = 0.25 * (rolled / times - turns);
        let path = Path::new(&crate::path::SQUARE, &[side], crate::path::SpeedProfile::default()).unwrap();
        let doubts = Setup::of(&runs, &robot(), Some(&path)).doubts;
        let told = doubts
            .iter()
            .any(|d| matches!(d, Suspicion::OtherWay(factor) if (factor.ratio * times - 1.0).abs() < 0.01));
        assert_eq!(told, suspicious, "{times}: {doubts:?}");
        assert_eq!(doubts.is_empty(), !suspicious);
    }
}

#[test]
fn runs_with_poses_of_another_drive_are_named_and_only_these() {
    for strange in [vec![2], vec![0, 3]] {
        let (mut runs, other) = (clean().runs(), Drive { seed: 78, ..clean() }.runs());
        for index in &strange {
            runs[*index].log.as_mut().unwrap().reference = other[*index].log.clone().unwrap().reference;
        }
        let found = Setup::of(&runs, &robot(), None);
        let [Fault::InRuns { fault, runs }] = &found.faults[..] else { panic!("{strange:?}: {:?}", found.faults) };
        assert!(matches!(**fault, Fault::OtherMotion { .. }), "{fault:?}");
        assert_eq!(*runs, strange.iter().map(|index| format!("run_{index}")).collect::<Vec<String>>());
        assert!(found.faults[0].remedy().contains("of the same drive"));
    }
}

/// Positions alone show a course, which points back while the robot drives back, and none in turns on the spot.
#[test]
fn a_wheel_that_spins_on_the_spot_in_a_straight_drive_is_a_jump_and_no_other_drive() {
    let mut runs = clean().runs();
    runs[2] = Drive { driven: driven::spinning_once, ..clean() }.run(2);
    let found = Setup::of(&runs, &robot(), None);
    assert!(found.is_sound(), "{:?}", found.faults);
    assert_eq!(found.disturbances(), [1, 0], "{:?}", found.runs);
    let jump = &found.runs[2].jumps[0];
    assert!(jump.since > 19.0 && jump.time < 23.0 && (jump.turned.unwrap() + 2.0).abs() < 0.1, "{jump:?}");
}

#[test]
fn positions_alone_accuse_nobody_who_drives_back_or_turns_on_the_spot() {
    type Kind = fn(f64, &mut Stream) -> driven::Driven;
    let spinning: Kind = |seconds, stream| {
        let driven = driven::free(seconds, stream);
        driven
            .into_iter()
            .map(|(pose, [l, r])| (Pose2 { x: 0.0, y: 0.0, ..pose }, [0.5 * (l - r), 0.5 * (r - l)]))
            .collect()
    };
    for (name, kinds) in [
        ("forth and back", [driven::forth_and_back as Kind; 2]),
        ("free, and on the spot", [driven::free as Kind, spinning]),
        ("stopping, and forth and back", [driven::stopping as Kind, driven::forth_and_back]),
    ] {
        let mut runs: Vec<Run> =
            kinds.into_iter().flat_map(|driven| Drive { driven, runs: 2, ..clean() }.runs()).collect();
        for (index, run) in runs.iter_mut().enumerate() {
            run.name = format!("run_{index}");
            run.log.as_mut().unwrap().reference.iter_mut().for_each(|pose| pose.heading = None);
        }
        let found = Setup::of(&runs, &robot(), None);
        assert_eq!(found.faults, [], "{name}");
    }
}

#[test]
fn poses_of_another_drive_are_named_and_nothing_is_said_of_the_clock() {
    let (mut runs, other) = (clean().runs(), Drive { seed: 77, ..clean() }.runs());
    for (run, other) in runs.iter_mut().zip(other) {
        run.log.as_mut().unwrap().reference = other.log.unwrap().reference;
    }
    let found = Setup::of(&runs, &robot(), None);
    assert!(matches!(found.faults[..], [Fault::OtherMotion { .. }]), "{:?}", found.faults);
    assert!(found.mounting.is_none() && found.runs.iter().all(|run| run.delay.is_none()));
}

#[test]
fn a_delay_of_either_sign_is_found_in_all_runs_and_in_each() {
    for delay in [-0.3, -0.12, -0.06, 0.04, 0.09, 0.18, 0.3] {
        let found = Drive { delays: vec![delay], ..clean() }.found();
        assert_eq!((found.faults.len(), found.disturbances()), (0, [0, 0]), "{delay}");
        near(found.mounting.map(|m| m.delay), delay, 5e-3);
        assert!(found.runs.iter().all(|run| (run.delay.unwrap().value - delay).abs() < 8e-3), "{:?}", found.runs);
    }
}

/// Counts of 12 mm: a pose at rest is off by up to two degrees, and stays so until the robot moves.
#[test]
fn coarse_counters_show_no_delay_that_is_not_there_and_make_no_pose_wrong() {
    for (seed, delay) in [(40, 0.0), (41, 0.0), (42, 0.0), (43, 0.0), (44, 0.1), (45, -0.06)] {
        let found = Drive { counts: 26.0, delays: vec![delay], runs: 6, seed, ..clean() }.found();
        assert_eq!((found.faults.len(), found.disturbances()), (0, [0, 0]), "{seed} {:?}", found.runs);
        near(found.mounting.map(|mounting| mounting.delay), delay, 1e-2);
    }
}

#[test]
fn lever_arm_and_yaw_are_found() {
    for (ahead, left, yaw) in [(0.1, 0.0, 0.0), (-0.05, 0.08, 0.0), (0.03, -0.02, 0.5), (0.0, 0.0, -2.5)] {
        let found = Drive { body: Pose2::new(ahead, left, yaw), ..clean() }.found();
        assert_eq!(found.faults, [], "{ahead} {left} {yaw}");
        let mounting = found.mounting.unwrap();
        near(mounting.ahead, ahead, 3e-3);
        near(mounting.left, left, 3e-3);
        near(mounting.yaw, yaw, 3e-3);
        assert_eq!(found.tail_first(&robot()), None);
    }
}

#[test]
fn turns_that_begin_at_once_and_fade_show_no_lever_arm() {
    for (seed, body) in [(40, Pose2::IDENTITY), (41, Pose2::IDENTITY), (42, Pose2::new(0.06, -0.03, 0.0))] {
        let found = Drive { driven: driven::pursuing, body, seed, ..clean() }.found();
        assert_eq!(found.faults, [], "{seed}");
        let mounting = found.mounting.unwrap();
        near(mounting.ahead, body.x, 3e-3);
        near(mounting.left, body.y, 3e-3);
        near(Some(mounting.delay), 0.0, 5e-3);
    }
}

#[test]
fn several_jumps_in_a_set_and_one_in_every_run_are_named_with_time_and_size() {
    let size = [0.4, -0.3, 0.5];
    let two = vec![(0, 20.0, size), (0, 31.0, [-0.2, 0.1, -0.3]), (2, 25.0, [0.0, 0.3, 0.0])];
    let every = (0..4).map(|run| (run, 12.0 + 7.0 * run as f64, size)).collect();
    for jumps in [two, every] {
        let found = Drive { jumps: jumps.clone(), ..clean() }.found();
        assert_eq!(found.disturbances(), [jumps.len(), 0], "{:?}", found.runs);
        let named = found.runs.iter().enumerate().flat_map(|(k, run)| run.jumps.iter().map(move |jump| (k, jump)));
        for ((run, time, [x, y, turned]), (own, jump)) in jumps.iter().zip(named) {
            assert!(*run == own && (jump.time - time).abs() < 0.06, "{jump:?}");
            assert!((jump.moved - libm::hypot(*x, *y)).abs() < 0.05, "{jump:?}");
            assert!((jump.turned.unwrap() - turned).abs() < 0.03, "{jump:?}");
            assert_eq!(jump.unrecorded, None, "{jump:?}");
        }
    }
}

#[test]
fn quick_turns_that_a_filter_of_the_reference_rounds_are_no_jumps_and_a_jump_among_them_is_one() {
    for smoothed in [0.25, 0.4] {
        let clean = Drive { driven: driven::stop_and_turn, smoothed, ..clean() };
        let found = clean.found();
        assert_eq!(found.disturbances(), [0, 0], "{smoothed}: {:?}", found.runs);
        let one = Drive { jumps: vec![(1, 20.0, [0.4, -0.3, 0.5])], ..clean }.found();
        assert_eq!(one.disturbances()[0], 1, "{smoothed}: {:?}", one.runs);
        let jump = &one.runs[1].jumps[0];
        assert!((jump.time - 20.0).abs() < 0.06 && (jump.moved - 0.5).abs() < 0.05, "{jump:?}");
    }
}

#[test]
fn where_no_rows_were_written_the_way_is_not_known_and_no_track_jumps() {
    let mut runs = clean().runs();
    let log = runs[1].log.as_mut().unwrap();
    let missing = 400..500;
    log.reference.retain(|pose| !missing.contains(&pose.sample));
    for pose in log.reference.iter_mut().filter(|pose| pose.sample >= missing.end) {
        pose.sample -= missing.len();
    }
    for column in [&mut log.time, &mut log.left, &mut log.right] {
        column.drain(missing.clone());
    }
    let without_headings = runs.clone().into_iter().map(|mut run| {
        run.log.iter_mut().flat_map(|log| &mut log.reference).for_each(|pose| pose.heading = None);
        run
    });
    for runs in [runs, without_headings.collect()] {
        let found = Setup::of(&runs, &robot(), None);
        let jumps: Vec<_> = found.jumps().collect();
        let [(run, jump)] = jumps[..] else { panic!("{jumps:?}") };
        assert_eq!(run.run, "run_1");
        assert!((jump.unrecorded.unwrap() - 5.05).abs() < 1e-9 && (jump.time - 25.0).abs() < 1e-9, "{jump:?}");
        let notices = found.notices();
        assert!(notices[0].starts_with("run run_1 has no rows for 5.1 s"), "{notices:?}");
    }
}

#[test]
fn poses_that_are_wrong_are_named_and_are_no_jumps() {
    let wrong: Vec<(usize, usize, [f64; 3])> = vec![
        (0, 150, [0.5, 0.0, 0.0]),
        (0, 151, [0.5, 0.1, 0.2]),
        (1, 400, [0.0, -0.2, 0.0]),
        (3, 300, [0.0, 0.0, 0.6]),
    ];
    let found = Drive { wrong: wrong.clone(), ..clean() }.found();
    assert_eq!(found.disturbances(), [0, 4], "{:?}", found.runs);
    let named: Vec<(usize, usize)> =
        found.runs.iter().enumerate().flat_map(|(k, run)| run.wrong.iter().map(move |w| (k, w.pose))).collect();
    assert_eq!(named, wrong.iter().map(|(run, pose, _)| (*run, *pose)).collect::<Vec<_>>());
}

#[test]
fn runs_that_were_wired_otherwise_are_named_and_only_these() {
    for exchanged in [vec![2], vec![0, 3], vec![0, 1, 3]] {
        let found = Drive { exchanged: exchanged.clone(), ..clean() }.found();
        let expected: Vec<String> = exchanged.iter().map(|run| format!("run_{run}")).collect();
        let [Fault::InRuns { fault, runs }] = &found.faults[..] else { panic!("{exchanged:?}: {:?}", found.faults) };
        assert_eq!((&**fault, runs), (&Fault::Exchanged, &expected));
        assert!(!found.is_sound() && found.faults[0].remedy().contains("correct the recordings of"));
        assert!(expected.iter().all(|name| found.faults[0].sentence().contains(name)));
    }
    // All of them are wired alike: no run differs.
    assert_eq!(Drive { exchanged: vec![0, 1, 2, 3], ..clean() }.found().faults, [Fault::Exchanged]);
}

#[test]
fn too_little_motion_says_nothing() {
    let mut runs = clean().runs();
    for run in &mut runs {
        let log = run.log.as_mut().unwrap();
        log.reference.retain(|pose| pose.sample < 30);
    }
    let found = Setup::of(&runs, &robot(), None);
    assert!(found.faults.is_empty() && found.disturbances() == [0, 0]);
    for run in &mut runs {
        run.log.as_mut().unwrap().reference.truncate(1);
    }
    assert!(Setup::of(&runs, &robot(), None).mounting.is_none());
    assert_eq!(Setup::of(&[], &robot(), None), Setup::default());
}

/// Headings in steps of 20 mrad.
fn in_steps(x: f64, y: f64, heading: f64) -> (f64, f64, f64) {
    (x, y, 0.02 * (50.0 * heading).round())
}

#[test]
fn headings_in_steps_of_a_robot_that_seldom_turns_hide_nothing() {
    let docking = Drive { driven: driven::docking, written: in_steps, ..clean() };
    let found = docking.found();
    assert_eq!((found.faults.len(), found.disturbances()), (0, [0, 0]), "{:?}", found.runs);
    near(found.mounting.unwrap().gain, 1.0, 0.02);
    let jumps = vec![(1, 23.0, [0.3, 0.2, 0.4]), (3, 31.0, [0.1, -0.4, -0.2])];
    let found = Drive { jumps: jumps.clone(), ..docking.clone() }.found();
    assert_eq!(found.disturbances(), [2, 0], "{:?}", found.runs);
    for (run, time, _) in jumps {
        let seen = &found.runs[run];
        assert!((seen.jumps[0].time - time).abs() < 0.06, "{seen:?}");
    }
    let exchanged = Wiring { exchanged: true, backward: [false; 2] };
    assert_eq!(Drive { wiring: exchanged, ..docking }.found().faults, [Fault::Exchanged]);
}

#[test]
fn positions_in_steps_and_a_robot_that_mostly_stands_hide_nothing() {
    let written = |x: f64, y: f64, heading: f64| {
        ((50.0 * x).round() / 50.0, (50.0 * y).round() / 50.0, 0.02 * (50.0 * heading).round())
    };
    let found = Drive { driven: driven::stopping, written, ..clean() }.found();
    assert_eq!((found.faults.len(), found.disturbances()), (0, [0, 0]), "{:?}", found.runs);
    let mounting = found.mounting.unwrap();
    near(mounting.scale, 1.0, 0.03);
    near(mounting.gain, 1.0, 0.03);
}

#[test]
fn headings_that_grow_clockwise_are_named_on_long_parallel_legs_too() {
    // Legs along x, and the same in a room that is turned by half a turn.
    let lawn = || Drive { driven: driven::lawn, seconds: 80.0, runs: 2, ..clean() };
    for drive in [
        Drive { written: |x, y, heading| (x, y, -heading), ..lawn() },
        Drive { written: |x, y, heading| (-x, -y, -heading - std::f64::consts::PI), ..lawn() },
    ] {
        assert_eq!(drive.found().faults, [Fault::HeadingClockwise]);
    }
    let exchanged = Wiring { exchanged: true, backward: [false; 2] };
    assert_eq!(Drive { wiring: exchanged, ..lawn() }.found().faults, [Fault::Exchanged]);
}

/// The rotation that unequal wheels seem to make, and the noise of the headings, add up over minutes.
#[test]
fn straight_drives_on_unequal_wheels_are_no_other_motion() {
    let found = Drive { driven: driven::forth_and_back, runs: 1, seconds: 300.0, ..clean() }.found();
    assert_eq!((&found.faults[..], &found.doubts[..]), (&[][..], &[][..]));
    assert!(found.mounting.is_some());
}
