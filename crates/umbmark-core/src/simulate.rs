//! One run: the commands of the robot and its true motion.
//!
//! The robot drives by its own odometry, as in the paper: it stops when its counters say so. So its believed motion is the path itself, up
//! to quantisation, and the effects of the model turn it into the true motion.

mod counters;
mod course;
mod diffusion;
mod pieces;
mod record;
mod recorded_test;
mod rolling;
mod rolls;
mod sampling;
mod trucks;
mod truth;
mod way;

use crate::dataset::ReturnError;
use crate::drive::{DriveError, DriveKind, Robot, WheelTravel};
use crate::effect::{Sight, Stretch, TestKind};
use crate::engine::{
    EngineError, Instructions, Integrator, Method, Motion, Segment, TickGeometry, UNITS_PER_TICK, Update, WheelLine,
};
use crate::geometry::{Pose2, wrap};
use crate::path::{Direction, Path};
use crate::random::Stream;
use rand::Rng;

pub use course::{Course, Leg};
pub use record::Recording;
pub use recorded_test::{is_extended, record_test};
pub use truth::Truth;

use course::Rest;
use rolling::Rolling;
use sampling::SampledMoves;
use trucks::Convoys;

/// Purpose of the stream that encoder phases are drawn from.
const ENCODER_PHASE: u64 = 1;

/// Why something cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A move so long, or ticks so fine, that the counters overflow.
    #[error("the {counter} counter makes {ticks:.3e} ticks in move {index} of the path; at most 2^30 - 2 are possible")]
    TooManyTicks {
        /// Its name, as "left".
        counter: &'static str,
        /// The move, from 1.
        index: usize,
        /// Its ticks.
        ticks: f64,
    },
    /// The same of one of several wheels with rollers.
    #[error(
        "the counter of wheel {wheel} makes {ticks:.3e} ticks in move {index} of the path; at most 2^30 - 2 are possible"
    )]
    TooManyTicksOfWheel {
        /// The wheel, from 1.
        wheel: usize,
        /// The move, from 1.
        index: usize,
        /// Its ticks.
        ticks: f64,
    },
    /// A turn that the drive cannot make.
    #[error(
        "a robot with drive = \"{drive}\" cannot turn as tightly as in move {index} of the path; give a path of arcs, as \
         shape = \"rounded_rectangle\""
    )]
    TooTight {
        /// Kind of the drive.
        drive: &'static str,
        /// The move, from 1.
        index: usize,
    },
    /// A move to the side of a drive that cannot make one.
    #[error(
        "a robot with drive = \"{drive}\" cannot move sideways, as it does in move {index} of the path; {}",
        sideways()
    )]
    Sideways {
        /// Kind of the drive.
        drive: &'static str,
        /// The move, from 1.
        index: usize,
    },
    /// Something that is not simulated of a drive.
    #[error("drive = \"{drive}\" does not support {what}")]
    Unsupported {
        /// Kind of the drive.
        drive: &'static str,
        /// What.
        what: &'static str,
    },
    /// A robot or an update rule that the integrator refuses.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Invalid encoder.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// A recording without a sampling rate.
    #[error("{what} must be positive and finite, got {value} Hz")]
    Rate {
        /// Which rate.
        what: &'static str,
        /// \[Hz\]
        value: f64,
    },
}

/// The drives that move sideways, in words.
fn sideways() -> String {
    let names: Vec<String> = DriveKind::ALL
        .iter()
        .filter(|kind| kind.moves_sideways())
        .map(|kind| format!("drive = \"{}\"", kind.name()))
        .collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last} can", others.join(", ")),
        _ => format!("{} can", names.concat()),
    }
}

/// Position of the wheels within a tick at START and at every stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Uniformly distributed, independent from stop to stop.
    Random,
    /// Always on the edge of a tick: the only quantisation error is that of whole ticks.
    Edge,
}

/// How the robot computes its pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odometry {
    /// At every encoder tick, exactly.
    EveryTick,
    /// At every encoder tick, one after the other: slow, to check the above.
    EveryTickOneByOne,
    /// From counters read at a fixed rate.
    Sampled {
        /// \[Hz\]
        rate: f64,
        /// How the pose follows the counts.
        update: Update,
    },
    /// From the wheel angles themselves: no quantisation, neither of the pose nor of the stops.
    Continuous,
}

impl Odometry {
    /// What the robot has: sampled at its encoders' rate where there is one, else at every tick.
    pub fn of(robot: &Robot) -> Odometry {
        match robot.encoder.rate() {
            Some(rate) => Odometry::Sampled { rate, update: Update::Arc },
            None => Odometry::EveryTick,
        }
    }
}

#[derive(Debug)]
enum Computer {
    Ticks(Box<Integrator>),
    Sampled(Box<SampledMoves>),
    /// A whole move at once, from the change of the counters, for drives whose counters are not those of the axle's wheels.
    Counters,
    Continuous,
}

/// A robot, a path and an odometry, ready to be driven.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::{Model, TestKind}, path::{Direction, Path}};
/// use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};
/// let robot = Robot::labmate();
/// let mut model = Model::new(&robot);
/// model.set("wheelbase", "e_b", 1.01)?;
/// let mut simulator = Simulator::new(&robot, &Path::umbmark(), Odometry::Continuous, Phase::Edge)?;
/// let mut truth = Truth::new(&model);
/// simulator.open(&mut truth, 1, 0);
/// let error = simulator.run(&mut truth, Direction::Ccw, TestKind::Systematic);
/// assert!((error.heading.unwrap().to_degrees() + 3.56).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulator {
    robot: Robot,
    per_tick: PerTick,
    courses: [Course; 2],
    computer: Computer,
    /// The plan of a drive of two trucks, which replaces everything else.
    convoys: Option<Convoys>,
    /// The wheels of a base on rollers, whose counters are more than two.
    rolling: Option<Rolling>,
    odometry: Odometry,
    phase: Phase,
    phases: Stream,
    segments: Vec<Segment>,
    motions: Vec<Motion>,
}

impl Simulator {
    /// A simulator of `robot` driving `path`.
    pub fn new(robot: &Robot, path: &Path, odometry: Odometry, phase: Phase) -> Result<Simulator, SimulateError> {
        let per_tick = robot.metres_per_tick();
        let geometry = TickGeometry::new(per_tick.left, per_tick.right, robot.drive.wheelbase())?;
        // A path to the side is refused as that, by its course.
        let convoys = if path.slides() { None } else { Convoys::new(robot, path) };
        if robot.drive.kind().has_trucks() && convoys.is_none() && !path.slides() {
            return Err(SimulateError::Unsupported { drive: robot.drive.kind().name(), what: "paths with arcs" });
        }
        let [cw, ccw] = [Course::new(robot, path, Direction::Cw)?, Course::new(robot, path, Direction::Ccw)?];
        let rolling = Rolling::new(robot, path, [&cw, &ccw])?;
        let differential = robot.drive.kind().has_axle_wheels();
        let computer = match odometry {
            Odometry::Continuous => Computer::Continuous,
            Odometry::EveryTick | Odometry::EveryTickOneByOne if !differential => Computer::Counters,
            Odometry::EveryTick => Computer::Ticks(Box::new(Integrator::new(geometry, Method::EveryTick))),
            Odometry::EveryTickOneByOne => {
                Computer::Ticks(Box::new(Integrator::new(geometry, Method::EveryTickOneByOne)))
            }
            Odometry::Sampled { rate, update } => {
                if !(rate > 0.0 && rate.is_finite()) {
                    return Err(SimulateError::Rate { what: "encoder rate", value: rate });
                }
                if differential {
                    Computer::Sampled(Box::new(SampledMoves::new(geometry, update, rate, [&cw.legs, &ccw.legs])))
                } else {
                    Computer::Counters
                }
            }
        };
        Ok(Simulator {
            robot: robot.clone(),
            per_tick: PerTick(per_tick),
            courses: [cw, ccw],
            computer,
            convoys,
            rolling,
            odometry,
            phase,
            phases: Stream::new(0, 0, 0),
            segments: Vec::new(),
            motions: Vec::new(),
        })
    }

    /// The same simulator, with registers no wider than these: the same bits, maybe slower.
    pub fn limited_to(self, instructions: Instructions) -> Simulator {
        let computer = match self.computer {
            Computer::Ticks(integrator) => Computer::Ticks(Box::new(integrator.limited_to(instructions))),
            Computer::Sampled(moves) => Computer::Sampled(Box::new(moves.limited_to(instructions))),
            other => other,
        };
        Simulator { computer, ..self }
    }

    /// The nominal robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The commands of one direction.
    pub fn course(&self, direction: Direction) -> &Course {
        &self.courses[direction as usize]
    }

    /// Opens all random streams of a trial, those of `truth` included.
    pub fn open(&mut self, truth: &mut Truth, seed: u64, trial: u64) {
        self.phases = Stream::new(seed, ENCODER_PHASE, trial);
        truth.open(seed, trial);
    }

    /// Drives once round the path and measures the return error.
    pub fn run(&mut self, truth: &mut Truth, direction: Direction, test: TestKind) -> ReturnError {
        let mut returned = [ReturnError::default()];
        let [mut cw, mut ccw]: [&mut [ReturnError]; 2] = [&mut [], &mut []];
        *(if direction == Direction::Cw { &mut cw } else { &mut ccw }) = &mut returned;
        self.test(truth, test, [cw, ccw]);
        returned[0]
    }

    /// Drives a whole test, as many runs clockwise and then counter-clockwise as there are places in `returned`, and
    /// measures the return error of each.
    ///
    /// The same as one run after the other, to the last bit; the odometry of all moves is computed at once.
    pub fn test(&mut self, truth: &mut Truth, test: TestKind, returned: [&mut [ReturnError]; 2]) {
        if let Some(convoys) = &self.convoys {
            for (direction, returned) in Direction::BOTH.into_iter().zip(returned) {
                let legs = &self.courses[direction as usize].legs;
                returned.iter_mut().for_each(|returned| *returned = convoys.run(truth, legs, direction, test));
            }
            return;
        }
        if let Some(rolling) = self.rolling.take() {
            self.test_rolling(&rolling, truth, test, returned);
            self.rolling = Some(rolling);
            return;
        }
        let runs = returned.each_ref().map(|returned| returned.len());
        self.command(runs);
        self.compute(runs);
        truth.forget();
        for course in &self.courses {
            let direction = course.direction;
            for run in 0..runs[direction as usize] {
                truth.start_another(direction, false);
                for (index, leg) in course.legs.iter().enumerate() {
                    let travel = match self.computer {
                        Computer::Continuous => leg.travel,
                        Computer::Counters => leg.rolled(&self.segments[self.place(runs, direction, run, index)].line),
                        _ => self.per_tick.of(&self.segments[self.place(runs, direction, run, index)].line),
                    };
                    truth.begin(Stretch { index, direction, test, travel, left: leg.left }, leg);
                    truth.advance(1.0);
                }
            }
        }
        let at_rest = Sight { time: self.course(Direction::Cw).duration(), ..Sight::default() };
        let mut measured = truth.measure_all(at_rest);
        for (direction, returned) in Direction::BOTH.into_iter().zip(returned) {
            for (run, (returned, measured)) in returned.iter_mut().zip(&mut measured).enumerate() {
                let moves = 0..self.course(direction).legs.len();
                let computed = moves.fold(Motion::IDENTITY, |pose, index| {
                    pose.then(&self.motions[self.place(runs, direction, run, index)])
                });
                *returned = return_error(&measured, &computed.pose);
            }
        }
    }

    /// Index of a move's segment among those of all runs: similar moves are neighbours, which the engine computes fastest.
    #[inline]
    fn place(&self, runs: [usize; 2], direction: Direction, run: usize, index: usize) -> usize {
        let course = self.course(direction);
        let before = if direction == Direction::BOTH[0] { 0 } else { runs[0] * self.courses[0].legs.len() };
        before + course.rank(index) * runs[direction as usize] + run
    }

    /// Notes the wheel motion of all runs, from rest to rest, with any position within a tick.
    fn command(&mut self, runs: [usize; 2]) {
        let moves = [0, 1].map(|d| runs[d] * self.courses[d].legs.len());
        self.segments.resize(moves[0] + moves[1], Segment::default());
        for direction in Direction::BOTH {
            for run in 0..runs[direction as usize] {
                let mut rest = Rest { count: [0; 2], phase: self.draw_phase() };
                for index in 0..self.course(direction).legs.len() {
                    let next = Rest { count: self.course(direction).legs[index].stop, phase: self.draw_phase() };
                    let place = self.place(runs, direction, run, index);
                    self.segments[place] = Segment::every_tick(rest.line_to(&next));
                    rest = next;
                }
            }
        }
    }

    /// Computes the motion that the robot believes of every segment, for these numbers of runs \[cw, ccw\].
    fn compute(&mut self, runs: [usize; 2]) {
        self.motions.resize(self.segments.len(), Motion::IDENTITY);
        if let Computer::Ticks(integrator) = &mut self.computer {
            return integrator.motions(&self.segments, &mut self.motions);
        }
        for direction in Direction::BOTH {
            for index in 0..self.course(direction).legs.len() {
                for run in 0..runs[direction as usize] {
                    let place = self.place(runs, direction, run, index);
                    self.motions[place] = match &mut self.computer {
                        Computer::Sampled(moves) => moves.motion(direction as usize, index, &self.segments[place].line),
                        Computer::Counters => {
                            let travel = self.courses[direction as usize].counted(index);
                            Motion::exp(&self.robot.drive.displacement(&travel))
                        }
                        _ => {
                            let travel = &self.courses[direction as usize].legs[index].travel;
                            Motion::exp(&self.robot.drive.displacement(travel))
                        }
                    };
                }
            }
        }
    }

    /// Travel of the axle's wheels along a line of the counters, as the odometry believes.
    fn believed(&self, leg: &Leg, line: &WheelLine) -> WheelTravel {
        if self.robot.drive.kind().has_axle_wheels() { self.per_tick.of(line) } else { leg.rolled(line) }
    }

    fn draw_phase(&mut self) -> [u32; 2] {
        match self.phase {
            Phase::Edge => [0; 2],
            Phase::Random => {
                let word = self.phases.next_u64();
                [word as u32, (word >> 32) as u32]
            }
        }
    }
}

/// Metres per tick of each wheel.
#[derive(Clone, Copy, Debug)]
struct PerTick(WheelTravel);

impl PerTick {
    /// Believed wheel travel of a line \[m\].
    fn of(&self, line: &WheelLine) -> WheelTravel {
        let [left, right] = line.travel().map(|units| units as f64 / UNITS_PER_TICK as f64);
        WheelTravel { left: left * self.0.left, right: right * self.0.right }
    }
}

/// Absolute minus computed (Eq. 1).
pub(crate) fn return_error(absolute: &Pose2, computed: &Pose2) -> ReturnError {
    ReturnError {
        x: absolute.x - computed.x,
        y: absolute.y - computed.y,
        heading: Some(wrap(absolute.heading - computed.heading)),
    }
}

#[cfg(test)]
mod agreement;

#[cfg(test)]
mod tests;
