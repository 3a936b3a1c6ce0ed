//! Properties that hold for every effect, and the paths for the tests of single effects.

use super::*;
use crate::dataset::{ReferencePose, TickLog};
use crate::drive::{Drive, LinkReading, Robot};
use crate::geometry::{Displacement2, Dual, LANES, Pose2, seeded};
use crate::parameter::Role;
use crate::path::{CIRCLE, Path, SQUARE, SpeedProfile};
use crate::preset::Preset;
use crate::random::Stream;
use crate::replay::Track;

/// An effect's parameter and its value.
pub(super) type Setting<'a> = (&'a str, &'a str, f64);

pub(super) fn ccw_and_cw() -> [(Direction, f64); 2] {
    [(Direction::Ccw, 1.0), (Direction::Cw, -1.0)]
}

pub(super) fn model_with(settings: &[Setting]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in settings {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

/// A circle of radius 2 m, driven once.
pub(super) fn circle() -> Path {
    Path::new(&CIRCLE, &[2.0, 1.0], SpeedProfile::default()).unwrap()
}

/// The poses seen after each leg and each turn of the paper's square.
pub(super) fn stops_with(settings: &[Setting], direction: Direction) -> Vec<Pose2> {
    Track::with_stops(&Path::umbmark(), direction, &Robot::labmate()).poses(&model_with(settings).chain())
}

pub(super) fn circle_end_with(settings: &[Setting], direction: Direction) -> Pose2 {
    Track::in_pieces(&circle(), direction, &Robot::labmate()).end(&model_with(settings).chain())
}

/// The paper's CLAPPER.
fn clapper() -> Robot {
    Preset::find("clapper").unwrap().robot()
}

/// The poses seen after each leg and each corner of the CLAPPER's rectangle, less those that a robot without errors would have.
pub(super) fn clapper_stops_with(settings: &[Setting], direction: Direction) -> Vec<Pose2> {
    let track = Track::with_stops(&Preset::find("clapper").unwrap().path(), direction, &clapper());
    let off =
        |(seen, told): (&Pose2, &Pose2)| Pose2::new(seen.x - told.x, seen.y - told.y, seen.heading - told.heading);
    let (seen, told) = (track.poses(&model_with(settings).chain()), track.poses(&model_with(&[]).chain()));
    seen.iter().zip(&told).map(off).collect()
}

/// The return error of the CLAPPER on its rectangle.
pub(super) fn clapper_returned_with(settings: &[Setting], direction: Direction) -> Pose2 {
    clapper_stops_with(settings, direction).pop().unwrap()
}

/// A path watched all along, and the poses seen.
pub(super) fn watched_with(settings: &[Setting], path: &Path, direction: Direction) -> (Track, Vec<Pose2>) {
    let track = Track::watched(path, direction, &Robot::labmate());
    let poses = track.poses(&model_with(settings).chain());
    (track, poses)
}

/// The pose seen from where the robot believes to be, when it has gone `way` \[m\] along the paper's square.
pub(super) fn along_with(settings: &[Setting], direction: Direction, way: f64) -> Displacement2 {
    let (track, seen) = watched_with(settings, &Path::umbmark(), direction);
    let (_, believed) = watched_with(&[], &Path::umbmark(), direction);
    let there = track.contexts().iter().position(|at| at.distance + at.length > way - 1e-6).unwrap();
    let error = believed[there].between(&seen[there]);
    Displacement2 { forward: error.x, sideways: error.y, rotation: error.heading }
}

/// How much farther than believed the robot has turned halfway round the circle \[rad\].
pub(super) fn halfway_round_with(settings: &[Setting], direction: Direction) -> f64 {
    let (_, seen) = watched_with(settings, &circle(), direction);
    let (_, believed) = watched_with(&[], &circle(), direction);
    let middle = seen.len() / 2;
    seen[middle].heading - believed[middle].heading
}

/// Speeds of the left and the right wheel halfway round it \[m/s\]: 0.2 for the outer one, on a circle of 2.17 m.
pub(super) fn circle_speeds(direction: Direction) -> [f64; 2] {
    let inner = 0.2 * 1.83 / 2.17;
    if direction == Direction::Ccw { [inner, 0.2] } else { [0.2, inner] }
}

/// A recorded drive: 0.4 s of rest, 1.5 s ahead, 2 s of rest, an arc that becomes a turn on the spot, 2 s of rest; 20 readings a second, and
/// poses at those between which the speed stays.
pub(super) fn recorded_log() -> TickLog {
    let per_tick = Robot::labmate().metres_per_tick();
    let speeds = |time: f64| match time {
        time if (0.4..1.9).contains(&time) => [0.2, 0.2],
        time if (3.9..4.9).contains(&time) => [0.12, 0.21],
        time if (4.9..5.4).contains(&time) => [-0.13, 0.13],
        _ => [0.0; 2],
    };
    let (mut log, mut way) = (TickLog::default(), [0.0; 2]);
    for reading in 0..150 {
        log.time.push(0.05 * f64::from(reading));
        log.left.push(way[0] / per_tick.left);
        log.right.push(way[1] / per_tick.right);
        let [before, after, later] = [-2.5, 0.5, 2.5].map(|on| speeds(0.05 * (f64::from(reading) + on)));
        // Where the speed jumps, a delay of the reference has two slopes.
        if before == after && after == later {
            log.reference.push(ReferencePose { sample: log.left.len() - 1, x: 0.0, y: 0.0, heading: None });
        }
        let [left, right] = after;
        way = [way[0] + 0.05 * left, way[1] + 0.05 * right];
    }
    log
}

/// The same drive, every way of it back.
pub(crate) fn recorded_back() -> TickLog {
    let mut log = recorded_log();
    log.left.iter_mut().chain(&mut log.right).for_each(|count| *count = -*count);
    log
}

/// Tracks on which every deterministic effect of one axle shows: a small square and a circle, both ways, and a recorded drive, ahead and back.
pub(super) fn probes() -> Vec<Track> {
    let robot = Robot::labmate();
    let square = Path::new(&SQUARE, &[0.5], SpeedProfile::default()).unwrap();
    let mut tracks = Vec::new();
    for (direction, _) in ccw_and_cw() {
        tracks.push(Track::watched(&square, direction, &robot));
        tracks.push(Track::watched(&circle(), direction, &robot));
    }
    tracks.extend([recorded_log(), recorded_back()].map(|log| Track::from_log(&log, &robot).unwrap()));
    tracks
}

/// Motions of a base that also moves sideways, each driven in ten steps of 0.1 s: ahead, in a bend, on the spot, aslant while it turns, and to
/// the left \[m, m, rad\].
const SIDEWAYS: [[f64; 3]; 5] =
    [[0.3, 0.0, 0.0], [0.3, 0.0, 0.8], [0.0, 0.0, -1.2], [-0.1, 0.25, 0.5], [0.0, 0.2, 0.0]];

/// The log of a robot that makes these motions and truly is `truth`, with a pose at each sample; its heading is left out.
pub(crate) fn sideways_log(truth: &Drive, robot: &Robot) -> TickLog {
    let rollers = truth.rollers().unwrap();
    let per_count = rollers.metres_per_count(robot.encoder.ticks_per_revolution());
    let (mut log, mut pose, mut ways) = (TickLog::default(), Pose2::IDENTITY, vec![0.0; per_count.len()]);
    log.rollers = vec![Vec::new(); per_count.len()];
    log.clock_excess = 0.04;
    let mut note = |pose: &Pose2, ways: &[f64]| {
        let sample = log.time.len();
        log.time.push(0.1 * sample as f64);
        log.rollers.iter_mut().zip(ways).zip(&per_count).for_each(|((counts, way), per)| counts.push(way / per));
        log.reference.push(ReferencePose { sample, x: pose.x, y: pose.y, heading: Some(pose.heading) });
    };
    note(&pose, &ways);
    for [forward, sideways, rotation] in SIDEWAYS {
        let step = Displacement2 { forward: 0.1 * forward, sideways: 0.1 * sideways, rotation: 0.1 * rotation };
        for _ in 0..10 {
            pose.advance(&step);
            ways.iter_mut().zip(rollers.ways_of(&step)).for_each(|(way, more)| *way += more);
            note(&pose, &ways);
        }
    }
    [log.left, log.right] = robot.axle_ticks_of_rollers(&log.rollers).unwrap();
    log
}

/// A robot of usual numbers that truly is `truth` must be where effects with these values put it, all along.
pub(super) fn assert_rolls(truth: Drive, settings: &[Setting]) {
    assert_rolls_as(truth.kind().usual(), truth, settings);
}

/// The same of a robot that believes to be `nominal`.
pub(super) fn assert_rolls_as(nominal: Drive, truth: Drive, settings: &[Setting]) {
    let robot = Robot { drive: nominal, ..Robot::labmate() };
    let log = sideways_log(&truth, &robot);
    let track = Track::from_log(&log, &robot).unwrap();
    let mut model = Model::new(&robot);
    let nominal = track.poses(&model.chain());
    for (effect, parameter, value) in settings {
        model.set(effect, parameter, *value).unwrap();
    }
    let mut most = 0.0_f64;
    for ((pose, seen), plain) in track.poses(&model.chain()).iter().zip(&log.reference).zip(nominal) {
        let off = (pose.x - seen.x).hypot(pose.y - seen.y) + (pose.heading - seen.heading.unwrap()).abs();
        assert!(off < 1e-9, "{settings:?} {pose:?} {seen:?}");
        most = most.max((plain.x - seen.x).hypot(plain.y - seen.y));
    }
    assert!(most > 1e-3, "{settings:?} {most}");
}

/// Whether all drives that may have an effect move sideways.
fn is_of_rollers(entry: &Entry) -> bool {
    entry.drives().each().all(DriveKind::moves_sideways)
}

/// Tracks on which an effect shows: of its own drive, where it has only that.
fn probes_of(entry: &Entry) -> Vec<Track> {
    if is_of_rollers(entry) {
        let kind = entry.drives().each().next().unwrap();
        let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
        return vec![Track::from_log(&sideways_log(&robot.drive, &robot), &robot).unwrap()];
    }
    if !entry.drives().each().all(DriveKind::has_trucks) {
        return probes();
    }
    let square = Path::new(&SQUARE, &[1.0], SpeedProfile::default()).unwrap();
    vec![Track::with_stops(&square, Direction::Ccw, &clapper())]
}

/// Everything that is seen on the probes.
pub(super) fn seen<T: Evaluate>(model: &Model, values: &[T], probes: &[Track]) -> Vec<T> {
    let chain = model.chain_with(values);
    probes.iter().flat_map(|track| track.poses(&chain)).flat_map(|pose| [pose.x, pose.y, pose.heading]).collect()
}

/// The model of one effect with each of its numbers at `value(parameter)`.
fn alone(entry: &Entry, value: fn(&Parameter, &Robot) -> f64) -> Model {
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    for p in entry.about.parameters {
        model.set(entry.about.name, p.name, value(p, &robot)).unwrap();
    }
    model
}

fn neutral(p: &Parameter, robot: &Robot) -> f64 {
    p.default.resolve(robot)
}

/// The derivative of everything seen by parameter `i`, by duals.
pub(super) fn column(model: &Model, i: usize, probes: &[Track]) -> Vec<f64> {
    seen(model, &seeded(model.values(), &[i]), probes).iter().map(|d| d.eps[0]).collect()
}

fn stepped(model: &Model, i: usize, step: f64, probes: &[Track]) -> Vec<f64> {
    let mut values: Vec<f64> = model.values().collect();
    values[i] += step;
    seen(model, &values, probes)
}

#[test]
fn the_catalogue_is_complete_and_consistent() {
    let mut flags = Vec::new();
    for entry in CATALOGUE {
        let about = &entry.about;
        assert!(std::ptr::eq(find(about.name).unwrap(), *entry), "{} stands twice", about.name);
        for text in [about.title, about.equation, about.physics, about.signature, about.separated_by, about.source] {
            assert!(text.len() > 3, "{} leaves a text empty", about.name);
        }
        for p in about.parameters {
            assert!(!p.flag.is_empty() && !flags.contains(&p.flag), "--{} of {} stands twice", p.flag, about.name);
            flags.push(p.flag);
            assert!(!p.meaning.is_empty());
            p.check(p.default.resolve(&Robot::labmate())).unwrap();
            p.check(p.usual(&Robot::labmate())).unwrap();
        }
    }
    let mut purposes: Vec<u64> = CATALOGUE.iter().map(|entry| entry.purpose()).collect();
    purposes.sort_unstable();
    purposes.dedup();
    assert_eq!(purposes.len(), CATALOGUE.len());
}

/// A drive of usual numbers, and with each of the words that one of them may stand for.
fn drives_of(kind: DriveKind) -> Vec<Drive> {
    let words = kind.parameters().iter().flat_map(|p| (0..p.choices().len()).map(|word| (p.name, word as f64)));
    let worded = words.map(|(name, word)| kind.usual().with(name, word).unwrap());
    std::iter::once(kind.usual()).chain(worded).collect()
}

#[test]
fn every_drive_may_have_its_first_effects_whose_default_values_correct_nothing() {
    for drive in DriveKind::ALL.iter().flat_map(|kind| drives_of(*kind)) {
        let first = drive.first_effects().map(|name| find(name).unwrap());
        for entry in first {
            assert!(entry.drives().contains(drive.kind()), "{} of {}", entry.about.name, drive.kind().name());
        }
        let nothing = first.map(|entry| neutral(&entry.about.parameters[0], &Robot { drive, ..Robot::labmate() }));
        assert_eq!(drive.corrected(nothing), Ok(drive));
    }
}

/// Oracle: the odometry of a drive with these numbers.
#[test]
fn every_own_effect_becomes_numbers_with_which_the_odometry_is_right() {
    for kind in DriveKind::ALL {
        let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
        for name in robot.drive.own_effects() {
            let entry = find(name).unwrap();
            assert!(entry.drives().contains(*kind), "{name} of {}", kind.name());
            let parameter = &entry.about.parameters[0];
            let value = neutral(parameter, &robot) + 0.02;
            let mut model = Model::new(&robot);
            model.set(name, parameter.name, value).unwrap();
            let corrected = model.corrected_robot().unwrap().drive;
            assert_ne!(corrected, robot.drive, "{name} of {}", kind.name());
            if kind.moves_sideways() {
                assert_rolls_as(robot.drive, corrected, &[(name, parameter.name, value)]);
            }
        }
    }
}

#[test]
fn effects_that_look_alike_name_each_other() {
    for entry in CATALOGUE {
        for other in entry.confused_with() {
            assert_ne!(other, entry.about.name);
            let back = find(other).unwrap().confused_with();
            assert!(back.contains(&entry.about.name), "{other} does not name {}", entry.about.name);
        }
    }
}

#[test]
fn a_misspelt_effect_is_told_its_neighbour() {
    let error = find("wheel_base").unwrap_err().to_string();
    assert_eq!(error, "there is no effect \"wheel_base\"; did you mean \"wheelbase\"?");
}

#[test]
fn an_effect_with_its_default_values_does_nothing_to_the_last_bit() {
    for entry in CATALOGUE {
        let probes = probes_of(entry);
        let nothing = seen::<f64>(&Model::new(&Robot::labmate()), &[], &probes);
        let model = alone(entry, neutral);
        let values: Vec<f64> = model.values().collect();
        assert!(seen(&model, &values, &probes) == nothing, "{}", entry.about.name);
    }
}

#[test]
fn each_number_but_those_of_chance_shows_and_its_derivative_is_that_of_finite_differences() {
    let mut silent = Vec::new();
    for entry in CATALOGUE {
        let probes = probes_of(entry);
        let model = alone(entry, |p, robot| p.usual(robot));
        for (i, p) in entry.about.parameters.iter().enumerate() {
            let exact = column(&model, i, &probes);
            let h = 1e-3 * p.typical.max(1e-6);
            let (high, low) = (stepped(&model, i, h, &probes), stepped(&model, i, -h, &probes));
            for (k, e) in exact.iter().enumerate() {
                let numeric = (high[k] - low[k]) / (2.0 * h);
                assert!((e - numeric).abs() < 1e-5 * (1.0 + e.abs()), "{} {}: {e} {numeric}", entry.about.name, p.name);
            }
            if exact.iter().all(|e| *e == 0.0) {
                silent.push((entry.about.name, p.name));
            }
        }
    }
    let by_chance = |entry: &Entry, p: &Parameter| {
        !entry.changes.include(Changes::MEAN)
            || p.role == Role::Scatter
            || (entry.about.name == "placed_bumps" && p.role != Role::Size)
    };
    let chance: Vec<(&str, &str)> = CATALOGUE
        .iter()
        .flat_map(|entry| entry.about.parameters.iter().map(move |p| (entry, p)))
        .filter(|(entry, p)| by_chance(entry, p))
        .map(|(entry, p)| (entry.about.name, p.name))
        .collect();
    assert_eq!(silent, chance);
}

/// Everything that the catalogue offers to a model with two effects of its own and a formula: side by side in few chains, and each
/// alone with its effect.
#[test]
fn derivatives_taken_together_are_those_of_each_number_alone_to_the_last_bit() {
    let probes = probes();
    let mut model = model_with(&[("wheelbase", "e_b", 1.02), ("caster_kick", "kick_rad", 0.01)]);
    let nap = Formula::new("nap", Target::HeadingPerMetre, "k * sin(heading - h0)", &["k", "h0"]).unwrap();
    model.add_formula(nap, &[0.02, 0.5]).unwrap();
    let own =
        [("wheelbase", "e_b"), ("caster_kick", "kick_rad"), ("caster_kick", "trail_m"), ("nap", "k"), ("nap", "h0")];
    let listed = of_drive(DriveKind::default()).filter(|entry| entry.about.name != "caster_kick");
    let listed = listed.flat_map(|entry| entry.about.parameters.iter().map(move |p| (entry.about.name, p.name)));
    let number = |(effect, parameter)| Number::of(effect, parameter);
    let mut numbers: Vec<Number> = own.into_iter().chain(listed).map(number).collect();
    let trail =
        |value| Number { effect: "leg_kick", parameter: "kick_rad", shapes: [Some(("trail_m", value)), None, None] };
    numbers.extend([trail(0.1), trail(0.2)]);
    let derived = model.derived(&numbers).unwrap();
    assert!(derived.len() <= numbers.len().div_ceil(LANES) + 2, "{} chains", derived.len());
    let mut told = 0;
    for Derived { chain, numbers: places, .. } in &derived {
        let together: Vec<Pose2<Dual>> = probes.iter().flat_map(|track| track.poses(chain)).collect();
        for (lane, place) in places.iter().enumerate() {
            let Number { effect, parameter, shapes } = numbers[*place];
            let mut with = model.clone();
            with.add(effect).unwrap();
            for (name, value) in shapes.into_iter().flatten() {
                with.set(effect, name, value).unwrap();
            }
            let alone = with.chain_with(&seeded(with.values(), &[with.place_of(effect, parameter).unwrap()]));
            let alone = probes.iter().flat_map(|track| track.poses(&alone));
            for (pose, alone) in together.iter().zip(alone) {
                assert_eq!((pose.value(), pose.slope(lane)), (alone.value(), alone.slope(0)), "{effect} {parameter}");
            }
            told += 1;
        }
    }
    assert_eq!(told, numbers.len());
}

#[test]
fn derivatives_of_every_effect_have_the_same_bits_in_registers_of_every_width() {
    let number = |re: f64, k: usize| Dual { re, eps: std::array::from_fn(|lane| libm::sin((9 * lane + k) as f64)) };
    for entry in CATALOGUE {
        let values: Vec<Dual> =
            entry.about.parameters.iter().enumerate().map(|(k, p)| number(p.usual(&Robot::labmate()), k)).collect();
        for (k, at) in contexts().iter().enumerate() {
            let at = at.at_pose(&Pose2::new(number(1.5, k + 6), number(-0.8, k + 7), number(0.7, k)));
            let acted = |mean: &MeanLaws<Dual>| {
                let mut travel = WheelTravel { left: number(0.01, k + 1), right: number(-0.02, k + 2) };
                let mut motion = Displacement2 {
                    forward: number(0.02, k + 3),
                    sideways: number(1e-4, k + 4),
                    rotation: number(-0.03, k + 5),
                };
                (mean.wheels)(&values, &at, &mut travel);
                (mean.body)(&values, &at, &mut motion);
                (travel, motion)
            };
            assert_eq!(acted(Dual::mean(entry)), acted(&entry.duals[0]), "{}", entry.about.name);
        }
    }
}

#[test]
fn each_number_acts_linearly_where_the_effect_does_nothing() {
    for entry in CATALOGUE {
        let probes = probes_of(entry);
        let model = alone(entry, neutral);
        for (i, p) in entry.about.parameters.iter().enumerate() {
            let exact = column(&model, i, &probes);
            let h = 1e-4 * p.typical.max(1e-6);
            for step in [h, -h] {
                let (there, here) = (stepped(&model, i, step, &probes), stepped(&model, i, 0.0, &probes));
                let scale = exact.iter().fold(0.0_f64, |most, e| most.max(e.abs()));
                for (k, e) in exact.iter().enumerate() {
                    let slope = (there[k] - here[k]) / step;
                    let what = (entry.about.name, p.name);
                    assert!((slope - e).abs() < 1e-3 * scale + 1e-6, "{what:?} by {step:e}: {slope} {e}");
                }
            }
        }
    }
}

/// A place in the room, with nothing at zero that an effect may depend on.
fn there() -> Pose2 {
    Pose2::new(2.0, -1.5, 1.0)
}

/// In a turn and on the first leg, with nothing at zero that an effect may depend on.
fn contexts() -> [Context; 2] {
    let turn = Context {
        aside: Aside { way: 3e-3, disagreement: -2e-3, speed: 0.15 },
        duration: 0.1,
        speed: 0.2,
        turn_rate: 0.9,
        wheel_speed: [0.05, 0.35],
        speed_change: [0.01, 0.02],
        turn_rate_change: 0.1,
        wheel_angle: [2.0, 3.0],
        wheel_rotation: [0.1, 0.2],
        wheel_travel: [0.01, 0.02],
        falls_behind: [[1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4], [6e-4, 5e-4, 4e-4, 3e-4, 2e-4, 1e-4]],
        reversed: [1.0, -1.0],
        distance: 3.0,
        time: 20.0,
        session_distance: 40.0,
        since_turn: 0.02,
        since_stop: 0.01,
        length: 0.02,
        last_turn: -1.0,
        believed_heading: 0.9,
        truck: 1.0,
        wheelbase: 0.34,
        axle_distance: 0.5,
        wheel_layout: [0.6, 0.8],
        run: 2.0,
        direction: 1.0,
        clock_excess: 0.03,
        recorded: false,
    };
    [turn, Context { last_turn: 0.0, turn_rate: 0.1, wheel_speed: [0.2; 2], recorded: true, ..turn }]
}

#[test]
fn an_effect_says_whether_it_depends_on_where_and_how_the_robot_drives() {
    let travel = WheelTravel { left: 0.005, right: 0.035 };
    for entry in CATALOGUE {
        let model = alone(entry, |p, robot| p.usual(robot));
        let chain = model.chain();
        let depends = contexts().iter().any(|at| {
            // What moves a base to the side is a part of its motion.
            let anywhere = Context { aside: Aside { disagreement: 0.0, ..at.aside }, ..Context::default() };
            chain.displacement(&at.at_pose(&there()), &travel) != chain.displacement(&anywhere.as_believed(), &travel)
        });
        assert_eq!(depends, model.varies(), "{}", entry.about.name);
    }
}

/// What an effect is seen to change, asked for everything.
fn changed(entry: &Entry, values: &[f64]) -> Changes {
    let travel = WheelTravel { left: 0.3, right: 0.5 };
    let motion = Displacement2 { forward: 0.4, sideways: 0.1, rotation: 0.2 };
    let pose = Pose2::new(1.0, 2.0, 0.5);
    let MeanLaws { start, wheels, body, link, late, filter, seen } = entry.values;
    let RandomLaws { diffusion, bumps, start_scatter, measured } = entry.scatter;
    let mut stream = Stream::new(1, 2, 3);
    let (mut rolled, mut moved, mut shown, mut found) = ([travel; 2], [motion; 2], pose, pose);
    for ((at, rolled), moved) in contexts().iter().zip(&mut rolled).zip(&mut moved) {
        let at = at.at_pose(&there());
        wheels(values, &at, rolled);
        body(values, &at, moved);
    }
    let sight = Sight { time: 20.0, room: Some(Pose2::IDENTITY), ..Sight::default() };
    seen(values, &sight, &mut shown);
    let mut behind = 0.0;
    late(values, 30.0, &mut behind);
    let mut filtered = Filter::NONE;
    filter(values, &mut filtered);
    let reading = LinkReading { length: 1.0, angles: [0.1, -0.2] };
    let mut read = reading;
    link(values, &mut read);
    measured(values, &mut stream, &mut found);
    let mut met = Vec::new();
    let long = WheelTravel { left: 300.0, right: 500.0 };
    let stretch = Stretch { index: 0, direction: Direction::Ccw, test: TestKind::Bumps, travel: long, left: 0.0 };
    bumps(values, &stretch, &mut stream, &mut met);
    let found = [
        (Changes::WHEELS, rolled != [travel; 2]),
        (Changes::BODY, moved != [motion; 2]),
        (Changes::SEEN, shown != pose),
        (Changes::CLOCK, behind != 0.0),
        (Changes::FILTER, filtered != Filter::NONE),
        (Changes::LINK, read != reading),
        (Changes::MEASURED, found != pose),
        (Changes::BUMPS, !met.is_empty()),
        (Changes::DIFFUSION, diffusion(values, &travel) != WheelVariance::default()),
        (Changes::START, start(values) != Pose2::IDENTITY),
        (Changes::START_SCATTER, start_scatter(values, &mut stream) != Pose2::IDENTITY),
    ];
    found.into_iter().filter(|(_, seen)| *seen).map(|(change, _)| change).reduce(Changes::and).unwrap()
}

#[test]
fn an_effect_changes_what_it_says_and_nothing_else() {
    for entry in CATALOGUE {
        let values: Vec<f64> = alone(entry, |p, robot| p.usual(robot)).values().collect();
        assert_eq!(changed(entry, &values), entry.changes, "{}", entry.about.name);
    }
}

#[test]
fn an_effect_varies_from_the_first_of_its_sizes_that_is_not_zero_and_not_before() {
    for entry in CATALOGUE {
        let nothing = alone(entry, neutral);
        assert!(!nothing.varies(), "{}", entry.about.name);
        if !alone(entry, |p, robot| p.usual(robot)).varies() {
            continue;
        }
        for p in entry.about.parameters.iter().filter(|p| matches!(p.role, Role::Size | Role::Scatter)) {
            let mut one = nothing.clone();
            one.set(entry.about.name, p.name, p.typical).unwrap();
            assert!(one.varies(), "{} {}", entry.about.name, p.name);
        }
    }
}

#[test]
fn an_effect_says_what_its_numbers_mean_in_a_sentence_that_changes_with_their_size() {
    let robot = Robot::labmate();
    for entry in CATALOGUE {
        let said = |model: Model| model.meaning(entry.about.name).unwrap_or_else(|| panic!("{}", entry.about.name));
        let usual = said(alone(entry, |p, robot| p.usual(robot)));
        assert!(usual.ends_with('.') && usual.contains(|c: char| c.is_ascii_digit()), "{}: {usual}", entry.about.name);
        assert!(!usual.contains("NaN") && !usual.contains("inf") && !usual.contains("  "), "{usual}");
        let sized = |p: &Parameter, robot: &Robot| {
            let rest = p.default.resolve(robot);
            if p.choices().is_empty() { rest + 2.0 * (p.usual(robot) - rest) + 1e-3 } else { rest }
        };
        assert_ne!(said(alone(entry, sized)), usual);
    }
    let mut model = Model::new(&robot);
    model.set("wheel_eccentricity_left", "sine_m", -9e-4).unwrap();
    model.set("caster_kick", "kick_rad", 0.007).unwrap();
    model.set("wheel_diameter_ratio", "e_d", 1.00121).unwrap();
    let said = |effect: &str| model.meaning(effect).unwrap();
    assert!(said("wheel_eccentricity_left").starts_with("The left wheel runs out by 0.900 mm"));
    assert!(said("caster_kick").starts_with("After each turn the casters push the robot 0.401 deg further round"));
    // 2 · 0.00121/2.00121 over 0.34 m.
    assert!(said("wheel_diameter_ratio").ends_with("each metre ahead turns the robot by 0.204 deg to the left."));
    assert_eq!(model.meaning("scale"), None);
}
