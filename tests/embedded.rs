//! Odometry on the robot gives the poses of `apply`, to the last bit, for every effect that a table of constants can hold.

use umbmark_core::apply::{Corrected, Spread, apply, compiled};
use umbmark_core::drive::{DriveKind, Encoder, Robot, Wiring};
use umbmark_core::effect::{CATALOGUE, Changes, Entry, Formula, Model, RunContext, Target, of_drive};
use umbmark_core::geometry::Pose2;
use umbmark_core::likelihood::Noise;
use umbmark_core::path::Direction;
use umbmark_core::random::Stream;
use umbmark_core::run::TickLog;
use umbmark_odometry::context::Place;
use umbmark_odometry::law::{LAWS, Law};
use umbmark_odometry::{Odometer, Table, UpdateError};

/// A drive as the counters of a robot show it: times, and what the two columns count since the first row.
struct Drive {
    time: Vec<f64>,
    columns: [Vec<f64>; 2],
}

impl Drive {
    /// Legs, arcs, turns on the spot and stops, forward and backward, read at uneven times.
    fn drawn(robot: &Robot, stream: &mut Stream) -> Drive {
        let steering = robot.drive.kind().steers().then_some(usize::from(!robot.encoder.wiring().exchanged));
        let mut drive = Drive { time: vec![12.5], columns: [vec![0.0], vec![0.0]] };
        let (mut exact, mut speeds, mut wanted) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for sample in 1..700 {
            if sample % 70 == 1 {
                let (way, turn) = (8000.0 * (stream.uniform() - 0.3), 2000.0 * (stream.uniform() - 0.5));
                wanted = match sample / 70 % 5 {
                    0 => [way, way],
                    1 => [way - turn, way + turn],
                    2 => [0.0; 2],
                    _ => [-turn, turn],
                };
            }
            let seconds = 0.004 + 0.012 * stream.uniform();
            for column in 0..2 {
                speeds[column] += 0.2 * (wanted[column] - speeds[column]);
                exact[column] += speeds[column] * seconds;
                // A steering swings, and is not straight at START.
                let angle = 900.0 * libm::cos(exact[column] / 1500.0);
                drive.columns[column].push(if steering == Some(column) { angle } else { exact[column] }.round());
            }
            drive.time.push(drive.time[sample - 1] + seconds);
        }
        if let Some(column) = steering {
            drive.columns[column][0] = drive.columns[column][1];
        }
        drive
    }

    /// The log that is read from it.
    fn log(&self, robot: &Robot) -> TickLog {
        let [left, right] = robot.axle_ticks(robot.encoder.wiring().counters(self.columns.clone()));
        TickLog { time: self.time.clone(), left, right, ..TickLog::default() }
    }
}

/// Numbers, bit by bit.
fn bits(pose: &Pose2, spread: Option<&Spread>) -> Vec<u64> {
    let numbers = [pose.x, pose.y, pose.heading].into_iter().chain(spread.into_iter().flat_map(|s| s.numbers()));
    // Zero has one sign.
    numbers.map(|number| (number + 0.0).to_bits()).collect()
}

fn bits_of(corrected: &Corrected, sample: usize) -> Vec<u64> {
    bits(&corrected.poses[sample], corrected.spread.as_ref().map(|spread| &spread[sample]))
}

/// Drives a compiled model and holds every pose against `apply`: those of `update` against the whole log, some of `ahead` against the log
/// until then. `shown` is what a counter shows for a count.
fn holds(model: &Model, drive: &Drive, place: RunContext, shown: impl Fn(usize, f64) -> f64) {
    let robot = model.robot();
    let noise = Noise { heading_per_metre: 2e-3, ..Noise::default() };
    let start = Pose2::new(0.3, -0.2, 0.7);
    let log = drive.log(robot);
    let whole = apply(&log, model, Some(&noise), start, place).unwrap();
    let numbers: Vec<f64> = compiled(model, Some(&noise), start).unwrap().iter().map(|(_, number)| *number).collect();
    let table = Table::read(&numbers).unwrap();
    let mut odometer = Odometer::<32>::begin_at(&table, table.start, &place_of(place));
    let (mut settled, mut moved) = (0, 0.0_f64);
    for sample in 0..drive.time.len() {
        let counts = [0, 1].map(|column| shown(column, drive.columns[column][sample]));
        let now = odometer.update(drive.time[sample], counts).unwrap();
        while log.time[settled] < now.time {
            settled += 1;
        }
        assert_eq!(now.time.to_bits(), log.time[settled].to_bits());
        assert!(log.time[sample] - now.time < if table.reads_speed() { 0.08 } else { 1e-12 });
        assert_eq!(bits(&now.pose, now.spread.as_ref()), bits_of(&whole, settled), "sample {sample} of {model:?}");
        moved = moved.max((now.pose.x - start.x).hypot(now.pose.y - start.y));
        if sample % 90 == 40 || sample + 1 == drive.time.len() {
            let until = |all: &[f64]| all[..=sample].to_vec();
            let part = TickLog {
                time: until(&log.time),
                left: until(&log.left),
                right: until(&log.right),
                ..TickLog::default()
            };
            let part = apply(&part, model, Some(&noise), start, place).unwrap();
            let ahead = odometer.ahead().unwrap();
            assert_eq!(ahead.time.to_bits(), log.time[sample].to_bits());
            assert_eq!(
                bits(&ahead.pose, ahead.spread.as_ref()),
                bits_of(&part, sample),
                "ahead of {sample}: {model:?}"
            );
        }
    }
    assert!(moved > 0.05, "the drive stands still: {moved}");
}

/// The place of a run in its session as the robot knows it.
fn place_of(run: RunContext) -> Place {
    let direction = run.direction.map_or(0.0, Direction::sign);
    Place { run: run.run as f64, session_distance: run.session_distance, direction }
}

fn robot_of(kind: DriveKind) -> Robot {
    Robot { name: kind.name().into(), drive: kind.usual(), encoder: Encoder::new(2000.0, None, None).unwrap() }
}

/// The effect with numbers that show.
fn with(mut model: Model, entry: &Entry, stream: &mut Stream) -> Model {
    for parameter in entry.about.parameters {
        let (nothing, usual) = (parameter.nothing(), parameter.usual(&model.robot().clone()));
        let value = nothing.map_or(usual, |nothing| nothing + (usual - nothing) * 4.0 * (stream.uniform() - 0.5));
        model.set(entry.about.name, parameter.name, parameter.check(value).unwrap_or(usual)).unwrap();
    }
    model
}

fn acts(entry: &Entry) -> bool {
    entry.changes.include(Changes::WHEELS.and(Changes::BODY))
}

/// Drives whose pose follows from two counters.
fn kinds() -> impl Iterator<Item = DriveKind> + Clone {
    DriveKind::ALL.iter().copied().filter(|kind| *kind != DriveKind::Clapper && !kind.moves_sideways())
}

#[test]
fn every_effect_of_every_drive_has_the_bits_of_apply_and_changes_the_pose() {
    let (mut stream, mut tried) = (Stream::new(11, 0, 0), Vec::new());
    for kind in kinds() {
        let robot = robot_of(kind);
        for entry in of_drive(kind) {
            let model = with(Model::new(&robot), entry, &mut stream);
            let drive = Drive::drawn(&robot, &mut stream);
            let direction = [Direction::Ccw, Direction::Cw][tried.len() % 2];
            let place = RunContext { run: 2, session_distance: 31.5, direction: Some(direction) };
            holds(&model, &drive, place, |_, count| count);
            let end = |model: &Model| {
                *apply(&drive.log(&robot), model, None, Pose2::IDENTITY, place).unwrap().poses.last().unwrap()
            };
            // On a robot the ticks are recorded, so Euler steps of its own do not matter.
            let shows = acts(entry) && entry.about.name != "encoder_sampling";
            assert_eq!(end(&model) != end(&Model::new(&robot)), shows, "{} of {}", entry.about.name, kind.name());
            tried.push(entry.about.name);
        }
    }
    // Whatever acts on motion is compiled and was tried, but what only two trucks or wheels with rollers have.
    let of_rollers = |entry: &Entry| entry.drives().each().all(DriveKind::moves_sideways);
    for entry in CATALOGUE.iter().filter(|entry| acts(entry) && !of_rollers(entry)) {
        let law = Law::named(entry.about.name);
        assert_eq!(law.is_some(), entry.about.name != "rear_truck", "{}", entry.about.name);
        let parameters = law.map_or(entry.about.parameters.len(), |law| law.parameters);
        assert_eq!(parameters, entry.about.parameters.len(), "{}", entry.about.name);
        assert_eq!(tried.contains(&entry.about.name), law.is_some(), "{}", entry.about.name);
    }
    assert!(LAWS.iter().all(|law| CATALOGUE.iter().any(|entry| entry.about.name == law.name)));
}

#[test]
fn several_effects_together_have_the_bits_of_apply() {
    let mut stream = Stream::new(12, 0, 0);
    for trial in 0..40 {
        let kind = kinds().cycle().nth(trial).unwrap();
        let robot = robot_of(kind);
        let mut model = Model::new(&robot);
        for entry in of_drive(kind) {
            if stream.uniform() < 0.4 {
                model = with(model, entry, &mut stream);
            }
        }
        holds(&model, &Drive::drawn(&robot, &mut stream), RunContext::default(), |_, count| count);
    }
}

#[test]
fn counters_that_roll_over_and_are_wired_otherwise_mean_the_same_drive() {
    let mut stream = Stream::new(13, 0, 0);
    for trial in 0..24 {
        let kind = kinds().cycle().nth(trial).unwrap();
        let wiring = Wiring { exchanged: trial % 3 == 0, backward: [trial % 2 == 0, trial % 5 == 0] };
        let encoder = Encoder::new(2000.0, None, Some(12)).unwrap().wired(wiring);
        let robot = Robot { encoder, ..robot_of(kind) };
        let mut model = Model::new(&robot);
        for entry in of_drive(kind).filter(|entry| acts(entry)).skip(trial % 3).step_by(3) {
            model = with(model, entry, &mut stream);
        }
        let drive = Drive::drawn(&robot, &mut stream);
        // A counter begins anywhere, but that of a steering, which shows an angle.
        let steering = kind.steers().then_some(usize::from(!wiring.exchanged));
        let origin = |column: usize| if steering == Some(column) { 0 } else { 4000 };
        holds(&model, &drive, RunContext::default(), |column, count| {
            encoder.reading(origin(column) + count as i64) as f64
        });
    }
}

#[test]
fn what_cannot_be_compiled_is_refused_by_name_with_what_can() {
    let robot = Robot::labmate();
    let refused = |model: &Model| compiled(model, None, Pose2::IDENTITY).unwrap_err().to_string();
    let mut model = Model::new(&robot);
    let formula = Formula::new("my_drift", Target::ForwardScale, "k * x", &["k"]).unwrap();
    model.add_formula(formula, &[0.01]).unwrap();
    let said = refused(&model);
    assert!(said.starts_with("my_drift is a formula") && said.contains("turn_slip_rate"), "{said}");
    let said = refused(&Model::new(&robot_of(DriveKind::Clapper)));
    assert!(said.starts_with("a robot with drive = \"clapper\" cannot be compiled"), "{said}");
    for kind in [DriveKind::Mecanum, DriveKind::Omni3, DriveKind::Omni4, DriveKind::DeadWheels] {
        let said = refused(&Model::new(&robot_of(kind)));
        assert!(said.ends_with("correct its logs on a computer") && said.contains(kind.name()), "{said}");
    }
    let mut rear = Model::new(&robot);
    rear.add("rear_truck").unwrap();
    assert!(refused(&rear).starts_with("rear_truck cannot be compiled"), "{}", refused(&rear));
    let silly = Noise { heading_per_metre: f64::INFINITY, ..Noise::silent() };
    let said = compiled(&Model::new(&robot), Some(&silly), Pose2::IDENTITY).unwrap_err().to_string();
    assert_eq!(said, "number 21 of the table cannot be inf");
}

#[test]
fn readings_that_come_too_fast_are_left_out_and_the_pose_goes_on() {
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    model.set("turn_slip", "share", 0.01).unwrap();
    let numbers: Vec<f64> =
        compiled(&model, None, Pose2::IDENTITY).unwrap().iter().map(|(_, number)| *number).collect();
    let table = Table::read(&numbers).unwrap();
    let mut odometer = Odometer::<8>::begin(&table);
    let readings = (0..400).map(|k| odometer.update(f64::from(k) * 1e-3, [f64::from(k); 2])).collect::<Vec<_>>();
    assert!(readings.contains(&Err(UpdateError::TooFast)));
    let ahead = odometer.ahead().unwrap();
    assert!((ahead.pose.x - ahead.time * 1e3 * robot.metres_per_tick().left).abs() < 1e-12 && ahead.time > 0.35);
}
