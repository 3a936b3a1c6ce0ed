//! A CLAPPER under way: two trucks that steer by their odometry, and the link that corrects it.
//!
//! On legs the trucks drive one behind the other; in a corner both turn across the link, drive it round about its middle, and
//! turn back. The rule of the correction (our reconstruction of Borenstein's internal position error correction): a bump turns a truck
//! at once, while its position goes wrong only slowly, as it drives on. So the direction from truck to truck, by both
//! odometries, is good for the next moment, and each truck's heading is that direction less the angle at which its rotary
//! encoder sees the link. What is left of a heading error δ is the sideways step δ · (way of a period)/2, seen over the link.
//!
//! The link's length, by its linear encoder, sets both odometries as far apart as the trucks are. Without it a believed length
//! that is wrong by a share a (a bump makes it so) would turn the believed direction by a · φ in a corner of φ: 2πa a round.

use super::{Leg, SimulateError, Truth, return_error};
use crate::dataset::ReturnError;
use crate::drive::{ClapperDrive, Drive, Kind, Robot, WheelTravel};
use crate::effect::{Bump, Stretch, TestKind};
use crate::geometry::{Displacement2, Pose2, wrap};
use crate::path::{Direction, Move, Path, SpeedProfile};
use std::f64::consts::{FRAC_PI_2, PI};

/// How often odometry and link are read where the robot does not say \[Hz\].
const RATE: f64 = 25.0;
/// Share of a heading error that is steered away in a period.
const HEADING_GAIN: f64 = 0.2;
/// A truck beside its way heads for it as if it were so far ahead \[m\].
const LOOK_AHEAD: f64 = 0.5;

/// What both trucks are to do in a period.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Number of the move of the path.
    index: usize,
    /// Share of that move's own way done at the end of it, where it is a leg.
    share: f64,
    motion: [Displacement2; 2],
    /// Where they are to be at its end.
    target: [Pose2; 2],
}

/// The plan of both directions.
#[derive(Clone, Debug)]
pub(super) struct Convoy {
    drive: ClapperDrive,
    plans: [Vec<Step>; 2],
}

impl Convoy {
    /// The plan of a CLAPPER; `None` for other drives.
    pub fn new(robot: &Robot, path: &Path) -> Result<Option<Convoy>, SimulateError> {
        let Drive::Clapper(drive) = robot.drive else { return Ok(None) };
        let period = 1.0 / robot.encoder.rate().unwrap_or(RATE);
        let plan = |direction| plan(&drive, path, direction, period);
        Ok(Some(Convoy { drive, plans: [plan(Direction::Cw)?, plan(Direction::Ccw)?] }))
    }

    /// Drives once round the path: the error of the front truck's pose.
    pub fn run(&self, truth: &mut Truth, legs: &[Leg], direction: Direction, test: TestKind) -> ReturnError {
        let mut believed = at_start(self.drive.link());
        let start = truth.draw_start();
        let mut real = believed.map(|pose| start.compose(&pose));
        let (mut begun, mut done, mut bumps) = (None, 0.0, Vec::new());
        for step in &self.plans[direction as usize] {
            if begun != Some(step.index) {
                let leg = &legs[step.index];
                truth.begin(Stretch { index: step.index, direction, test, travel: leg.travel }, leg);
                (begun, done, bumps) = (Some(step.index), 0.0, truth.take_bumps());
            }
            for truck in 0..2 {
                let travel = self.steered(&believed[truck], step, truck);
                // The cable lies under the front truck.
                let lost = if truck == 0 { lost_between(&bumps, done, step.share) } else { WheelTravel::default() };
                real[truck] = real[truck].moved(&truth.rolled(&travel, &lost));
                believed[truck] = believed[truck].moved(&self.drive.truck().displacement(&travel));
            }
            done = step.share;
            if self.drive.corrects() {
                self.correct(&mut believed, &real);
            }
        }
        return_error(&truth.measured_at_rest(&real[0]), &believed[0])
    }

    /// The wheel travel that a truck gives itself: what is planned, and back towards the plan.
    fn steered(&self, believed: &Pose2, step: &Step, truck: usize) -> WheelTravel {
        let (planned, ahead) = (&step.motion[truck], believed.between(&step.target[truck]));
        let aside = if planned.forward != 0.0 { ahead.y / LOOK_AHEAD * planned.forward.signum() } else { 0.0 };
        let turn = planned.rotation + HEADING_GAIN * (wrap(ahead.heading - planned.rotation) + aside);
        let forward = if planned.forward != 0.0 { ahead.x } else { 0.0 };
        self.drive.truck().wheel_travel(forward, turn)
    }

    /// Sets the trucks as far apart as the link is long, half of the difference each, and gives each the heading at which it
    /// would see the other there.
    fn correct(&self, believed: &mut [Pose2; 2], real: &[Pose2; 2]) {
        let (expected, there) = (direction_of(believed), direction_of(real));
        let share = 0.5 * (1.0 - length_of(real) / length_of(believed));
        let [front, rear] = *believed;
        let (x, y) = (share * (front.x - rear.x), share * (front.y - rear.y));
        believed[0] = Pose2 { x: front.x - x, y: front.y - y, ..front };
        believed[1] = Pose2 { x: rear.x + x, y: rear.y + y, ..rear };
        for (truck, behind) in [(0, PI), (1, 0.0)] {
            let seen = self.drive.shown(wrap(there + behind - real[truck].heading));
            let heading = &mut believed[truck].heading;
            *heading += wrap(expected + behind - seen - *heading);
        }
    }
}

/// The direction of the front truck from the rear one.
fn direction_of([front, rear]: &[Pose2; 2]) -> f64 {
    libm::atan2(front.y - rear.y, front.x - rear.x)
}

/// How far the trucks are apart \[m\].
fn length_of([front, rear]: &[Pose2; 2]) -> f64 {
    libm::hypot(front.x - rear.x, front.y - rear.y)
}

/// Both trucks at START, the front one at the origin.
fn at_start(link: f64) -> [Pose2; 2] {
    [Pose2::IDENTITY, Pose2::new(-link, 0.0, 0.0)]
}

/// What bumps between two shares of a leg cost the wheels.
fn lost_between(bumps: &[Bump], from: f64, to: f64) -> WheelTravel {
    let met = bumps.iter().filter(|bump| from <= bump.at && bump.at < to);
    met.fold(WheelTravel::default(), |sum, bump| match bump.wheel {
        crate::drive::Wheel::Left => WheelTravel { left: sum.left - bump.lost, ..sum },
        crate::drive::Wheel::Right => WheelTravel { right: sum.right - bump.lost, ..sum },
    })
}

fn plan(drive: &ClapperDrive, path: &Path, direction: Direction, period: f64) -> Result<Vec<Step>, SimulateError> {
    let mut steps = Vec::new();
    let mut target = at_start(drive.link());
    for (index, one) in path.moves(direction).into_iter().enumerate() {
        for motion in maneuvers(one, drive.link())? {
            cut(drive, &path.speed, period, index, motion, &mut target, &mut steps);
        }
    }
    Ok(steps)
}

/// What both trucks do for a move of the vehicle, one after the other.
fn maneuvers(one: Move, link: f64) -> Result<Vec<[Displacement2; 2]>, SimulateError> {
    let motion = |forward: f64, rotation: f64| Displacement2 { forward, sideways: 0.0, rotation };
    match one {
        Move::Straight { length } => Ok(vec![[motion(length, 0.0); 2]]),
        Move::Turn { angle } => {
            let across = FRAC_PI_2.copysign(angle);
            let round = motion(0.5 * link * angle.abs(), angle);
            Ok(vec![
                [motion(0.0, across), motion(0.0, -across)],
                [round; 2],
                [motion(0.0, -across), motion(0.0, across)],
            ])
        }
        Move::Arc { .. } => Err(SimulateError::Unsupported { drive: Kind::Clapper.name(), what: "paths with arcs" }),
    }
}

/// Cuts a maneuver into periods, from rest to rest.
fn cut(
    drive: &ClapperDrive,
    speed: &SpeedProfile,
    period: f64,
    index: usize,
    motion: [Displacement2; 2],
    target: &mut [Pose2; 2],
    steps: &mut Vec<Step>,
) {
    let rolled = motion.iter().map(|m| {
        let travel = drive.truck().wheel_travel(m.forward, m.rotation);
        travel.left.abs().max(travel.right.abs())
    });
    let profile = speed.over(rolled.fold(0.0, f64::max));
    let periods = (profile.duration() / period).ceil().max(1.0) as usize;
    let mut done = 0.0;
    for k in 1..=periods {
        let share = if k == periods { 1.0 } else { profile.fraction(k as f64 * period) };
        let part = motion.map(|m| Displacement2 {
            forward: m.forward * (share - done),
            sideways: 0.0,
            rotation: m.rotation * (share - done),
        });
        *target = [0, 1].map(|truck| target[truck].moved(&part[truck]));
        steps.push(Step { index, share, motion: part, target: *target });
        done = share;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{DifferentialDrive, Encoder};
    use crate::effect::Model;
    use crate::path::RECTANGLE;
    use crate::simulate::{Odometry, Phase, Simulator};

    fn clapper(correction: bool) -> Robot {
        let truck = DifferentialDrive::new(0.34, 0.15, 0.15).unwrap();
        let drive = ClapperDrive::new(truck, 1.0, 1e9, correction).unwrap();
        let encoder = Encoder::new(2000.0, Some(25.0), None).unwrap();
        Robot { name: "CLAPPER".into(), drive: Drive::Clapper(drive), encoder }
    }

    fn path() -> Path {
        Path::new(&RECTANGLE, &[7.0, 4.0], SpeedProfile::new(0.45, 0.45, 0.0).unwrap()).unwrap()
    }

    fn returned(robot: &Robot, values: &[(&str, &str, f64)], direction: Direction, test: TestKind) -> ReturnError {
        let mut model = Model::new(robot);
        values.iter().for_each(|(effect, parameter, value)| model.set(effect, parameter, *value).unwrap());
        let mut simulator = Simulator::new(robot, &path(), Odometry::of(robot), Phase::Random).unwrap();
        let mut truth = Truth::new(&model);
        simulator.open(&mut truth, 1, 0);
        simulator.run(&mut truth, direction, test)
    }

    #[test]
    fn the_plan_closes_and_keeps_the_link_straight_on_legs_and_at_its_length_in_corners() {
        let convoy = Convoy::new(&clapper(true), &path()).unwrap().unwrap();
        for plan in &convoy.plans {
            let [front, rear] = plan.last().unwrap().target;
            assert!(front.x.abs() < 1e-9 && front.y.abs() < 1e-9 && (rear.x + 1.0).abs() < 1e-9 && rear.y.abs() < 1e-9);
            for step in plan {
                assert!((length_of(&step.target) - 1.0).abs() < 1e-9, "{step:?}");
            }
        }
    }

    #[test]
    fn without_errors_it_returns_and_without_correction_its_front_truck_errs_as_a_labmate() {
        for direction in Direction::BOTH {
            for correction in [true, false] {
                let error = returned(&clapper(correction), &[], direction, TestKind::Systematic);
                assert!(libm::hypot(error.x, error.y) < 1e-6 && error.heading.unwrap().abs() < 1e-6, "{error:?}");
            }
            let bumps = [("placed_bumps", "count", 10.0)];
            let plain = returned(&clapper(false), &bumps, direction, TestKind::Bumps).heading.unwrap();
            let expected = direction.sign() * 10.0 * crate::effect::extra_travel(0.010, 0.075, true) / 0.34;
            assert!((plain - expected).abs() < 1e-9, "{plain} {expected}");
            let corrected = returned(&clapper(true), &bumps, direction, TestKind::Bumps).heading.unwrap();
            assert!(corrected.abs() < 0.1 * plain.abs() && corrected != 0.0, "{corrected} {plain}");
        }
    }

    /// Oracle: a bump turns the front truck by δ in a period of way s, which it drives along the mean heading δ/2: the link's
    /// direction turns by δ s/2 over its length, and the correction takes it for the truck's own.
    #[test]
    fn what_a_bump_leaves_is_half_of_its_turn_over_the_way_of_a_period() {
        let bump = [("placed_bumps", "count", 1.0)];
        let turned = returned(&clapper(false), &bump, Direction::Ccw, TestKind::Bumps).heading.unwrap();
        let left = returned(&clapper(true), &bump, Direction::Ccw, TestKind::Bumps).heading.unwrap();
        let expected = turned * 0.5 * (0.45 / 25.0) / 1.0;
        assert!((left / expected - 1.0).abs() < 0.05, "{left} {expected}");
    }

    #[test]
    fn unequal_wheels_of_the_trucks_are_corrected_too() {
        let unequal = [("wheel_diameter_ratio", "e_d", 1.002)];
        let [plain, corrected] =
            [false, true].map(|on| returned(&clapper(on), &unequal, Direction::Ccw, TestKind::Systematic));
        assert!(
            plain.heading.unwrap().abs() > 0.1 && corrected.heading.unwrap().abs() < 0.01,
            "{plain:?} {corrected:?}"
        );
    }
}
