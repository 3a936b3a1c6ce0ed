//! The commands of one direction of driving, in terms of the robot's own counters.

use crate::drive::{Counting, Robot, WheelTravel};
use crate::engine::{MAX_TICKS, WheelLine};
use crate::path::{Direction, Path, Trapezoid};

use super::SimulateError;

/// One move of a path, in the robot's own terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Believed wheel travel without quantisation \[m\].
    pub travel: WheelTravel,
    /// Believed way to the left without quantisation \[m\].
    pub left: f64,
    /// Counts at which both counters stop, cumulative from START.
    pub stop: [i64; 2],
    /// What the counters do.
    pub counting: Counting,
    /// When it begins \[s\] after START.
    pub begins: f64,
    /// How its travel is spread over time.
    pub profile: Trapezoid,
}

/// All moves of a path in one direction.
///
/// Each wheel is position-controlled, as the LabMate's: it stops when its own counter reaches the count nearest to its ideal cumulative
/// travel. So quantisation errors do not accumulate over the moves.
#[derive(Clone, Debug)]
pub struct Course {
    /// Sense of driving.
    pub direction: Direction,
    /// The moves.
    pub legs: Vec<Leg>,
    ranks: Vec<usize>,
}

impl Course {
    /// The commands that `robot` gives itself to drive `path`.
    pub fn new(robot: &Robot, path: &Path, direction: Direction) -> Result<Course, SimulateError> {
        let (mut ideal, mut clock) = ([0.0, 0.0], 0.0);
        let mut legs = Vec::new();
        let drive = robot.drive.kind();
        let moves = path.moves(direction);
        for (index, (one, (profile, pause))) in moves.iter().zip(path.profiles(direction, &robot.drive)).enumerate() {
            let travel = one.wheel_travel(&robot.drive);
            let d = one.displacement();
            if d.sideways != 0.0 && !drive.moves_sideways() {
                return Err(SimulateError::Sideways { drive: drive.name(), index: index + 1 });
            }
            let Some(counting) = robot.counting(d.forward, d.rotation) else {
                return Err(SimulateError::TooTight { drive: drive.name(), index: index + 1 });
            };
            for (counter, gain) in drive.counters().into_iter().zip(counting.gain) {
                // The axle of a base on rollers has no counters of its own.
                let ticks = if drive.moves_sideways() { 0.0 } else { gain.abs() };
                // A margin of one tick, for the rounding of the stops and the rest position within a tick.
                if !(ticks < MAX_TICKS as f64 - 2.0) {
                    return Err(SimulateError::TooManyTicks { counter, index: index + 1, ticks });
                }
            }
            ideal = [ideal[0] + counting.gain[0], ideal[1] + counting.gain[1]];
            let stop = ideal.map(|count| count.round() as i64);
            legs.push(Leg { travel, left: d.sideways, stop, counting, begins: clock, profile });
            clock += profile.duration() + pause;
        }
        // The rotation of a move distinguishes legs, turns and arcs.
        let turn = |index: &usize| (legs[*index].travel.right - legs[*index].travel.left).abs();
        let mut alike: Vec<usize> = (0..legs.len()).collect();
        alike.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        let mut ranks = vec![0; legs.len()];
        alike.iter().enumerate().for_each(|(rank, index)| ranks[*index] = rank);
        Ok(Course { direction, legs, ranks })
    }

    /// The place of move `index` in an order in which moves that turn alike are neighbours.
    #[inline]
    pub(super) fn rank(&self, index: usize) -> usize {
        self.ranks[index]
    }

    /// When the last move ends \[s\].
    pub fn duration(&self) -> f64 {
        self.legs.last().map_or(0.0, |leg| leg.begins + leg.profile.duration())
    }
}

/// Position of a wheel at rest: its count, and the position within the tick in 2^-32 ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rest {
    pub count: [i64; 2],
    pub phase: [u32; 2],
}

impl Rest {
    /// The straight line in the wheel plane from here to the next rest.
    pub(super) fn line_to(&self, next: &Rest) -> WheelLine {
        let travel = |wheel: usize| {
            ((next.count[wheel] - self.count[wheel]) << 32)
                + (i64::from(next.phase[wheel]) - i64::from(self.phase[wheel]))
        };
        WheelLine::new(self.phase.map(i64::from), [travel(0), travel(1)])
            .expect("Course::new keeps travels within the engine's range")
    }
}
