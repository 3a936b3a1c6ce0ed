//! A base on wheels with rollers: what its counters do, and what its odometry makes of them.

use super::{Course, Odometry, SimulateError, Simulator};
use crate::dataset::ReturnError;
use crate::drive::{MOST_WHEELS, Robot};
use crate::effect::{Sight, Stretch, TestKind};
use crate::engine::{MAX_TICKS, Motion, RollerLine, RollerOdometry, UNITS_PER_TICK};
use crate::geometry::Displacement2;
use crate::path::{Direction, Path};
use crate::simulate::{Truth, return_error};

/// Positions of all wheels at rest: their counts, and the positions within a tick in 2^-32 ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WheelsAtRest {
    pub count: [i64; MOST_WHEELS],
    pub phase: [u32; MOST_WHEELS],
}

impl WheelsAtRest {
    /// The way of all wheels from here to the next rest.
    pub(super) fn line_to(&self, next: &WheelsAtRest) -> RollerLine {
        let travel = |wheel: usize| {
            ((next.count[wheel] - self.count[wheel]) << 32)
                + (i64::from(next.phase[wheel]) - i64::from(self.phase[wheel]))
        };
        RollerLine { start: self.phase.map(i64::from), travel: std::array::from_fn(travel) }
    }
}

/// The wheels of a base, and where they stop.
#[derive(Clone, Debug)]
pub(super) struct Rolling {
    pub odometry: RollerOdometry,
    pub wheels: usize,
    /// Ideal counts of the wheels after each move, cumulative from START, clockwise and counter-clockwise.
    ideal: [Vec<[f64; MOST_WHEELS]>; 2],
    /// Whether the wheels roll through from one move to the next.
    flows: bool,
}

impl Rolling {
    /// The wheels of a robot that drives these courses; `None` where it has none with rollers.
    pub(super) fn new(robot: &Robot, path: &Path, courses: [&Course; 2]) -> Result<Option<Rolling>, SimulateError> {
        let Some(rollers) = robot.drive.rollers() else { return Ok(None) };
        let per_revolution = robot.encoder.ticks_per_revolution();
        let metres = rollers.metres_per_count(per_revolution);
        let mut after = [Vec::new(), Vec::new()];
        for (course, after) in courses.iter().zip(&mut after) {
            let mut ideal = [0.0; MOST_WHEELS];
            for (index, leg) in course.legs.iter().enumerate() {
                let motion = Displacement2 { sideways: leg.left, ..robot.drive.displacement(&leg.travel) };
                let ways = rollers.ways_of(&motion);
                for (wheel, (way, metres)) in ways.iter().zip(&metres).enumerate() {
                    let ticks = way / metres;
                    // A margin of one tick, for the rounding of the stops and the rest position within a tick.
                    if !(ticks.abs() < MAX_TICKS as f64 - 2.0) {
                        let (index, ticks) = (index + 1, ticks.abs());
                        return Err(SimulateError::TooManyTicksOfWheel { wheel: wheel + 1, index, ticks });
                    }
                    ideal[wheel] += ticks;
                }
                after.push(ideal);
            }
        }
        let odometry = RollerOdometry::new(&rollers, per_revolution);
        Ok(Some(Rolling { odometry, wheels: metres.len(), ideal: after, flows: path.shape().flows }))
    }

    /// Where the wheels are after a move: at rest at the count nearest to the ideal one, with a phase to be drawn; rolling through, where they
    /// are from the beginning on.
    pub(super) fn after(
        &self,
        direction: Direction,
        index: usize,
        begun: &WheelsAtRest,
        draw: impl FnOnce() -> [u32; MOST_WHEELS],
    ) -> WheelsAtRest {
        let ideal = &self.ideal[direction as usize];
        let counts = ideal[index];
        if !self.flows || index + 1 == ideal.len() {
            return WheelsAtRest { count: counts.map(|count| count.round() as i64), phase: draw() };
        }
        let units = |wheel: usize| (counts[wheel] * UNITS_PER_TICK as f64) as i64 + i64::from(begun.phase[wheel]);
        let units: [i64; MOST_WHEELS] = std::array::from_fn(units);
        let phase = units.map(|units| units.rem_euclid(UNITS_PER_TICK) as u32);
        WheelsAtRest { count: units.map(|units| units.div_euclid(UNITS_PER_TICK)), phase }
    }
}

impl Simulator {
    /// A whole test of a base on wheels with rollers: see [`Simulator::test`].
    pub(super) fn test_rolling(
        &mut self,
        rolling: &Rolling,
        truth: &mut Truth,
        test: TestKind,
        returned: [&mut [ReturnError]; 2],
    ) {
        truth.forget();
        let mut computed = Vec::new();
        for direction in Direction::BOTH {
            for _ in 0..returned[direction as usize].len() {
                truth.start_another(direction, false);
                let begun = WheelsAtRest { phase: self.draw_phases(), ..WheelsAtRest::default() };
                let mut rest = begun;
                let mut pose = Motion::IDENTITY;
                for index in 0..self.course(direction).legs.len() {
                    let next = rolling.after(direction, index, &begun, || self.draw_phases());
                    let line = rest.line_to(&next);
                    let leg = &self.courses[direction as usize].legs[index];
                    let believed = if self.odometry == Odometry::Continuous {
                        Displacement2 { sideways: leg.left, ..self.robot.drive.displacement(&leg.travel) }
                    } else {
                        rolling.odometry.displacement(line.ticks())
                    };
                    truth.begin(self.stretch(&believed, index, direction, test), leg);
                    truth.advance(1.0);
                    pose = pose.then(&match self.odometry {
                        Odometry::Continuous => Motion::exp(&believed),
                        Odometry::EveryTickOneByOne => rolling.odometry.one_by_one(&line),
                        _ => rolling.odometry.motion(&line),
                    });
                    rest = next;
                }
                computed.push(pose.pose);
            }
        }
        let at_rest = Sight { time: self.course(Direction::Cw).duration(), ..Sight::default() };
        let returned = returned.into_iter().flatten();
        for ((returned, measured), computed) in returned.zip(truth.measure_all(at_rest)).zip(&computed) {
            *returned = return_error(&measured, computed);
        }
    }

    /// The stretch of a motion that the robot believes to make.
    pub(super) fn stretch(
        &self,
        believed: &Displacement2,
        index: usize,
        direction: Direction,
        test: TestKind,
    ) -> Stretch {
        let travel = self.robot.drive.wheel_travel(believed.forward, believed.rotation);
        Stretch { index, direction, test, travel, left: believed.sideways }
    }

    /// Positions of all wheels within a tick.
    pub(super) fn draw_phases(&mut self) -> [u32; MOST_WHEELS] {
        let ([a, b], [c, d]) = (self.draw_phase(), self.draw_phase());
        [a, b, c, d]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::effect::{CATALOGUE, Changes, Model};
    use crate::engine::Update;
    use crate::geometry::wrap;
    use crate::parameter::Role;
    use crate::path::{
        CIRCLE, DIAGONAL_SQUARE, FIXED_CIRCLE, FIXED_SQUARE, SIDEWAYS_SQUARE, SLIDE, SQUARE, STRAIGHT, Shape,
        SpeedProfile,
    };
    use crate::replay::Track;
    use crate::simulate::Phase;

    const SAMPLED: Odometry = Odometry::Sampled { rate: 100.0, update: Update::Arc };

    fn robots() -> [Robot; 4] {
        [DriveKind::Mecanum, DriveKind::Omni3, DriveKind::Omni4, DriveKind::DeadWheels]
            .map(|kind| Robot { drive: kind.usual(), ..Robot::labmate() })
    }

    fn path(shape: &'static Shape, side: f64) -> Path {
        let values = if shape.parameters.len() == 2 { vec![side, 1.0] } else { vec![side] };
        Path::new(shape, &values, SpeedProfile::default()).unwrap()
    }

    fn paths() -> Vec<Path> {
        [&SQUARE, &FIXED_SQUARE, &DIAGONAL_SQUARE, &SIDEWAYS_SQUARE, &CIRCLE, &FIXED_CIRCLE]
            .map(|shape| path(shape, 2.0))
            .into()
    }

    fn model(robot: &Robot, settings: &[(&str, &str, f64)]) -> Model {
        let mut model = Model::new(robot);
        settings.iter().for_each(|(effect, parameter, value)| model.set(effect, parameter, *value).unwrap());
        model
    }

    fn opened(model: &Model, path: &Path, odometry: Odometry, phase: Phase, trial: u64) -> (Simulator, Truth) {
        let mut simulator = Simulator::new(model.robot(), path, odometry, phase).unwrap();
        let mut truth = Truth::new(model);
        simulator.open(&mut truth, 11, trial);
        (simulator, truth)
    }

    fn run(model: &Model, path: &Path, odometry: Odometry, direction: Direction) -> ReturnError {
        let (mut simulator, mut truth) = opened(model, path, odometry, Phase::Random, 0);
        simulator.run(&mut truth, direction, TestKind::Systematic)
    }

    #[test]
    fn a_base_without_errors_returns_on_every_path_but_for_its_ticks() {
        for robot in robots() {
            let nothing = Model::new(&robot);
            for path in paths() {
                for direction in Direction::BOTH {
                    let size = |e: ReturnError| e.x.abs() + e.y.abs() + e.heading.unwrap().abs();
                    assert!(size(run(&nothing, &path, Odometry::Continuous, direction)) < 1e-12);
                    // Half a tick of 0.24 mm at each wheel turns by 0.4 mrad, and that over 2 m.
                    let counted = size(run(&nothing, &path, SAMPLED, direction));
                    assert!(counted > 1e-7 && counted < 4e-3, "{} {counted}", path.shape().name);
                }
            }
        }
    }

    /// Oracle: the same laws along the commands of the path, which contain no simulator.
    #[test]
    fn a_simulated_run_ends_where_replay_of_its_commands_does_with_every_effect() {
        let mut moved = 0;
        for robot in robots() {
            let kind = robot.drive.kind();
            for entry in CATALOGUE.iter().filter(|entry| entry.drives().contains(kind)) {
                let mut alone = Model::new(&robot);
                for p in entry.about.parameters {
                    let by_chance =
                        !entry.changes.include(Changes::MEAN) || matches!(p.role, Role::Scatter | Role::Count);
                    let value = if by_chance { p.default.resolve(&robot) } else { p.usual(&robot) };
                    alone.set(entry.about.name, p.name, value).unwrap();
                }
                for path in
                    [&FIXED_SQUARE, &DIAGONAL_SQUARE, &SIDEWAYS_SQUARE, &FIXED_CIRCLE].map(|shape| path(shape, 1.0))
                {
                    for direction in Direction::BOTH {
                        let end = run(&alone, &path, Odometry::Continuous, direction);
                        let track = match alone.varies() {
                            true => Track::in_pieces(&path, direction, &robot),
                            false => Track::from_path(&path, direction, &robot),
                        };
                        let expected = return_error(&track.end(&alone.chain()), &path.end(direction));
                        let turned = wrap(end.heading.unwrap() - expected.heading.unwrap());
                        let gap = (end.x - expected.x).abs() + (end.y - expected.y).abs() + turned.abs();
                        assert!(gap < 1e-9, "{} {} {gap:e}", entry.about.name, path.shape().name);
                        moved += usize::from(end.x.abs() + end.y.abs() > 1e-4);
                    }
                }
            }
        }
        assert!(moved > 40, "{moved}");
    }

    #[test]
    fn a_test_at_once_has_the_bits_of_its_runs_one_after_the_other() {
        for robot in robots() {
            let noisy = model(&robot, &[("wheel_noise", "k_sqrt_m", 1e-3), ("lateral_scale", "ratio", 0.98)]);
            let path = path(&DIAGONAL_SQUARE, 1.0);
            let (mut simulator, mut truth) = opened(&noisy, &path, SAMPLED, Phase::Random, 3);
            let (mut cw, mut ccw) = ([ReturnError::default(); 2], [ReturnError::default(); 2]);
            simulator.test(&mut truth, TestKind::Systematic, [&mut cw, &mut ccw]);
            simulator.open(&mut truth, 11, 3);
            for (direction, runs) in [(Direction::Cw, cw), (Direction::Ccw, ccw)] {
                for expected in runs {
                    let alone = simulator.run(&mut truth, direction, TestKind::Systematic);
                    assert_eq!([alone.x, alone.y], [expected.x, expected.y]);
                }
            }
        }
    }

    #[test]
    fn a_recording_ends_where_the_run_ends_and_its_wheels_count_by_themselves() {
        for robot in robots() {
            let off = model(&robot, &[("wheelbase", "e_b", 1.01), ("lateral_scale", "ratio", 0.98)]);
            for path in paths() {
                for direction in Direction::BOTH {
                    let (mut simulator, mut truth) = opened(&off, &path, SAMPLED, Phase::Random, 1);
                    let run = simulator.run(&mut truth, direction, TestKind::Systematic);
                    simulator.open(&mut truth, 11, 1);
                    let rates = [100.0, 10.0];
                    let recording = simulator.record(&mut truth, direction, TestKind::Systematic, rates).unwrap();
                    let log = &recording.log;
                    assert_eq!(log.rollers.len(), robot.drive.kind().columns().len());
                    let gap = libm::hypot(recording.returned.x - run.x, recording.returned.y - run.y);
                    assert!(gap < 1e-4, "{} {gap:e}", path.shape().name);
                    assert!((recording.returned.heading.unwrap() - run.heading.unwrap()).abs() < 1e-9);
                    // What is replayed by the true model is where the robot truly is.
                    let track = Track::from_log(log, &robot).unwrap();
                    let replayed = track.poses(&off.chain());
                    for (seen, pose) in log.reference.iter().zip(&replayed) {
                        let gap = libm::hypot(seen.x - pose.x, seen.y - pose.y);
                        assert!(gap < 5e-3, "{} {gap:e}", path.shape().name);
                    }
                }
            }
        }
    }

    /// Oracle: the closed forms of a straight way with an axle across it; seed 11, n = 4000, alpha = 1e-3 for each of five numbers.
    #[test]
    fn noise_scatters_a_way_in_any_direction_as_it_scatters_one_ahead() {
        for (robot, shape) in robots().iter().flat_map(|robot| [(robot, &SLIDE), (robot, &STRAIGHT)]) {
            let (k, length, base) = (1e-3, 4.0, robot.drive.wheelbase());
            let noisy = model(robot, &[("wheel_noise", "k_sqrt_m", k)]);
            let (mut simulator, mut truth) = opened(&noisy, &path(shape, length), Odometry::Continuous, Phase::Edge, 0);
            let n = 4000;
            let mut sums = [0.0; 4];
            for trial in 0..n {
                simulator.open(&mut truth, 11, trial);
                let e = simulator.run(&mut truth, Direction::Ccw, TestKind::Systematic);
                // Along the course and to its left.
                let [along, aside] = if std::ptr::eq(shape, &SLIDE) { [e.y, -e.x] } else { [e.x, e.y] };
                let heading = e.heading.unwrap();
                for (sum, product) in
                    sums.iter_mut().zip([along * along, aside * aside, heading * heading, aside * heading])
                {
                    *sum += product / n as f64;
                }
            }
            let heading = 2.0 * k * k * length / (base * base);
            let expected = [0.5 * k * k * length, heading * length * length / 3.0, heading, 0.5 * heading * length];
            // The standard error of a variance is sqrt(2/n) of it; second order lengthens `along` by 5 % at most.
            for (sum, expected) in sums.iter().zip(expected) {
                assert!((sum / expected - 1.0).abs() < 3.3 * (2.0 / n as f64).sqrt() + 0.05, "{sums:?} {expected}");
            }
        }
    }

    #[test]
    fn ten_bumps_on_the_first_leg_turn_a_base_to_the_inside_whatever_way_it_goes() {
        for robot in robots() {
            let bumped = model(&robot, &[("placed_bumps", "count", 10.0), ("placed_bumps", "height_m", 0.01)]);
            let lost = crate::effect::extra_travel(0.01, robot.drive.wheel_diameter_left() / 2.0, true);
            for path in paths().iter().filter(|path| path.shape().parameters.len() == 1) {
                for direction in Direction::BOTH {
                    let (mut simulator, mut truth) = opened(&bumped, path, Odometry::Continuous, Phase::Edge, 0);
                    let heading = simulator.run(&mut truth, direction, TestKind::Bumps).heading.unwrap();
                    let expected = direction.sign() * 10.0 * lost / robot.drive.wheelbase();
                    assert!((heading - expected).abs() < 1e-9, "{} {heading} {expected}", path.shape().name);
                }
            }
        }
    }

    #[test]
    fn a_robot_that_cannot_move_sideways_is_refused_and_told_which_can() {
        let error = Simulator::new(&Robot::labmate(), &path(&FIXED_SQUARE, 1.0), Odometry::EveryTick, Phase::Edge);
        let said = "a robot with drive = \"differential\" cannot move sideways, as it does in move 2 of the path; drive = \"mecanum\", \
                    drive = \"omni3\", drive = \"omni4\" or drive = \"dead_wheels\" can";
        assert_eq!(error.unwrap_err().to_string(), said);
        let mut fine = robots()[0].clone();
        fine.encoder = crate::drive::Encoder::new(1e9, None, None).unwrap();
        let far = path(&SLIDE, 9999.0);
        let error = Simulator::new(&fine, &far, Odometry::EveryTick, Phase::Edge).unwrap_err().to_string();
        assert!(error.starts_with("the counter of wheel 1 makes 2.122e13 ticks in move 1"), "{error}");
    }
}
