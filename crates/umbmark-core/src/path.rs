//! What the robot is told to drive.
//!
//! A [`Shape`] (one file each) turns its numbers into [`Move`]s for the counter-clockwise direction; the clockwise path
//! is their mirror image in the START heading. START is the origin, heading along the x axis. A [`SpeedProfile`] says how
//! fast each move is driven, from rest to rest.

mod pieces;
mod speed;

use crate::drive::{DifferentialDrive, Drive, Robot, WheelTravel};
use crate::geometry::{Displacement2, Pose2};
use crate::parameter::{Parameter, ParameterError};
use crate::register;

pub use pieces::{Piece, Pieces};
pub use speed::{SpeedProfile, Trapezoid};

register! {
    /// Every shape there is.
    pub SHAPES: Shape = SHAPE in
    square,
    rectangle,
    rounded_rectangle,
    figure_eight,
    circle,
    straight,
    spin,
    fixed_square,
    fixed_circle,
    diagonal_square,
    sideways_square,
    slide,
    waypoints,
}

pub use circle::SHAPE as CIRCLE;
pub use diagonal_square::SHAPE as DIAGONAL_SQUARE;
pub use figure_eight::SHAPE as FIGURE_EIGHT;
pub use fixed_circle::SHAPE as FIXED_CIRCLE;
pub use fixed_square::SHAPE as FIXED_SQUARE;
pub use rectangle::SHAPE as RECTANGLE;
pub use rounded_rectangle::SHAPE as ROUNDED_RECTANGLE;
pub use sideways_square::SHAPE as SIDEWAYS_SQUARE;
pub use slide::SHAPE as SLIDE;
pub use spin::SHAPE as SPIN;
pub use square::SHAPE as SQUARE;
pub use straight::SHAPE as STRAIGHT;
pub use waypoints::SHAPE as WAYPOINTS;

/// The sense in which a path is driven round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub enum Direction {
    /// Clockwise: right turns.
    Cw,
    /// Counter-clockwise: left turns.
    Ccw,
}

impl Direction {
    /// Both, in the order of the paper.
    pub const BOTH: [Direction; 2] = [Direction::Cw, Direction::Ccw];

    /// "cw" or "ccw", as in files.
    pub fn name(self) -> &'static str {
        match self {
            Direction::Cw => "cw",
            Direction::Ccw => "ccw",
        }
    }

    /// +1 for counter-clockwise, -1 for clockwise: the sign of its turns.
    pub fn sign(self) -> f64 {
        match self {
            Direction::Cw => -1.0,
            Direction::Ccw => 1.0,
        }
    }
}

/// One piece of a path, driven from rest to rest at a constant ratio of the wheel speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Straight ahead by a length \[m\]; negative is backward.
    Straight {
        /// \[m\]
        length: f64,
    },
    /// A turn on the spot.
    Turn {
        /// \[rad\], counter-clockwise positive.
        angle: f64,
    },
    /// A circular arc, driven forward.
    Arc {
        /// Radius of the path of the axle's centre \[m\], positive.
        radius: f64,
        /// Change of heading \[rad\], counter-clockwise positive.
        angle: f64,
    },
    /// A straight line in any direction at a fixed heading, for a robot that also moves sideways.
    Slide {
        /// Way ahead \[m\]; negative is backward.
        ahead: f64,
        /// Way to the left \[m\].
        left: f64,
    },
}

impl Move {
    /// The body motion of this move.
    pub fn displacement(&self) -> Displacement2 {
        let (forward, sideways, rotation) = match *self {
            Move::Straight { length } => (length, 0.0, 0.0),
            Move::Turn { angle } => (0.0, 0.0, angle),
            Move::Arc { radius, angle } => (radius * angle.abs(), 0.0, angle),
            Move::Slide { ahead, left } => (ahead, left, 0.0),
        };
        Displacement2 { forward, sideways, rotation }
    }

    /// The wheel travels that a robot believes to make for this move.
    pub fn wheel_travel(&self, drive: &DifferentialDrive) -> WheelTravel {
        let d = self.displacement();
        drive.wheel_travel(d.forward, d.rotation)
    }

    /// How far the wheel rolls that rolls farthest \[m\].
    pub fn farthest(&self, drive: &Drive) -> f64 {
        match drive.rollers() {
            Some(rollers) => rollers.ways_of(&self.displacement()).into_iter().map(f64::abs).fold(0.0, f64::max),
            None => self.wheel_travel(drive).farthest(),
        }
    }

    fn mirrored(self) -> Move {
        match self {
            Move::Straight { length } => Move::Straight { length },
            Move::Turn { angle } => Move::Turn { angle: -angle },
            Move::Arc { radius, angle } => Move::Arc { radius, angle: -angle },
            Move::Slide { ahead, left } => Move::Slide { ahead, left: -left },
        }
    }
}

/// A kind of path: how its numbers become moves.
#[derive(Debug)]
pub struct Shape {
    /// Its name in files and flags.
    pub name: &'static str,
    /// What it is and what it is for, in a sentence.
    pub about: &'static str,
    /// Its numbers. Empty for waypoints, whose numbers are a list of points.
    pub parameters: &'static [Parameter],
    /// Whether it ends at START, heading as it began; where it goes round, after whole turns.
    pub closed: bool,
    /// Whether it is driven through: the robot does not stop between its moves.
    pub flows: bool,
    moves: fn(&[f64]) -> Result<Vec<Move>, PathError>,
}

impl Shape {
    /// The path of usual size at the usual speed; of waypoints, a corner.
    pub fn usual(&'static self) -> Path {
        let usual: Vec<f64> = self.parameters.iter().map(|parameter| parameter.typical).collect();
        let values = if usual.is_empty() { &[1.0, 0.0, 1.0, 1.0] } else { &usual[..] };
        Path::new(self, values, SpeedProfile::default()).expect("usual sizes make a path")
    }
}

/// What makes a path impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// A number of the shape or of the speed profile is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Too few or too many numbers for the shape.
    #[error("{shape} takes {expected} numbers, got {got}")]
    Count {
        /// The shape.
        shape: &'static str,
        /// How many it takes.
        expected: usize,
        /// How many were given.
        got: usize,
    },
    /// Waypoints that are no path.
    #[error(
        "waypoints must be two or more points of at most 1e6 m either way, each another than the one before; point {index} is ({x}, {y})"
    )]
    Waypoint {
        /// Number of the offending point, from 1.
        index: usize,
        /// \[m\]
        x: f64,
        /// \[m\]
        y: f64,
    },
}

/// A path to be driven in either direction.
///
/// ```
/// use umbmark_core::path::{Direction, Path};
/// let path = Path::umbmark();
/// assert_eq!(path.moves(Direction::Cw).len(), 8);
/// assert!((path.length() - 16.0).abs() < 1e-12);
/// let end = path.end(Direction::Ccw);
/// assert!(end.x.abs() < 1e-12 && end.y.abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
pub struct Path {
    shape: &'static Shape,
    values: Vec<f64>,
    moves: Vec<Move>,
    /// How fast it is driven.
    pub speed: SpeedProfile,
}

/// The same way at the same speed.
impl PartialEq for Path {
    fn eq(&self, other: &Path) -> bool {
        std::ptr::eq(self.shape, other.shape) && self.values == other.values && self.speed == other.speed
    }
}

impl Path {
    /// A path of a given shape with its numbers in the order of [`Shape::parameters`].
    pub fn new(shape: &'static Shape, values: &[f64], speed: SpeedProfile) -> Result<Path, PathError> {
        if !std::ptr::eq(shape, &WAYPOINTS) && values.len() != shape.parameters.len() {
            return Err(PathError::Count { shape: shape.name, expected: shape.parameters.len(), got: values.len() });
        }
        for (parameter, value) in shape.parameters.iter().zip(values) {
            parameter.check(*value)?;
        }
        Ok(Path { shape, values: values.to_vec(), moves: (shape.moves)(values)?, speed })
    }

    /// The paper's 4 x 4 m square at 0.2 m/s.
    pub fn umbmark() -> Path {
        Path::new(&SQUARE, &[4.0], SpeedProfile::default()).expect("4 m is a side")
    }

    /// What kind of path it is.
    pub fn shape(&self) -> &'static Shape {
        self.shape
    }

    /// Its numbers, in the order of the shape's parameters.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The moves in order.
    pub fn moves(&self, direction: Direction) -> Vec<Move> {
        match direction {
            Direction::Ccw => self.moves.clone(),
            Direction::Cw => self.moves.iter().map(|m| m.mirrored()).collect(),
        }
    }

    /// How each of its moves is spread over time, and the rest after it \[s\].
    pub fn profiles(&self, direction: Direction, drive: &Drive) -> Vec<(Trapezoid, f64)> {
        let farthest = self.moves(direction).into_iter().map(|one| one.farthest(drive));
        if !self.shape.flows {
            return farthest.map(|way| (self.speed.over(way), self.speed.pause())).collect();
        }
        let ways: Vec<f64> = farthest.collect();
        let all: f64 = ways.iter().sum();
        let (whole, mut done) = (self.speed.over(all), 0.0);
        let part = |(index, way): (usize, &f64)| {
            let from = done;
            done = if index + 1 == ways.len() { 1.0 } else { from + way / all };
            (whole.between(from, done), if index + 1 == ways.len() { self.speed.pause() } else { 0.0 })
        };
        ways.iter().enumerate().map(part).collect()
    }

    /// Whether a robot can make all of its moves: one that cannot turn on the spot needs arcs, and only some move sideways.
    pub fn suits(&self, robot: &Robot) -> bool {
        let can = |d: Displacement2| robot.counting(d.forward, d.rotation).is_some();
        (!self.slides() || robot.drive.kind().moves_sideways()) && self.moves.iter().map(Move::displacement).all(can)
    }

    /// Whether the robot moves sideways on it.
    pub fn slides(&self) -> bool {
        self.first_slide().is_some()
    }

    /// The first of its moves in which the robot moves sideways, from 0.
    pub fn first_slide(&self) -> Option<usize> {
        self.moves.iter().position(|m| m.displacement().sideways != 0.0)
    }

    /// Length travelled by the axle's centre \[m\].
    pub fn length(&self) -> f64 {
        let length = |d: Displacement2| match d.sideways {
            0.0 => d.forward.abs(),
            sideways => libm::hypot(d.forward, sideways),
        };
        self.moves.iter().map(Move::displacement).map(length).sum()
    }

    /// Where a robot without errors ends, seen from START.
    pub fn end(&self, direction: Direction) -> Pose2 {
        self.moves(direction).iter().fold(Pose2::IDENTITY, |pose, m| pose.moved(&m.displacement()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(shape: &'static Shape, values: &[f64]) -> Path {
        Path::new(shape, values, SpeedProfile::default()).unwrap()
    }

    /// A shape of its usual sizes, and with each of them doubled, where that makes a path.
    fn paths(shape: &'static Shape) -> Vec<Path> {
        let usual = shape.usual();
        let doubled = |i: usize| {
            let mut values = usual.values().to_vec();
            values[i] *= 2.0;
            Path::new(shape, &values, usual.speed).ok()
        };
        let doubled: Vec<Path> = (0..shape.parameters.len()).filter_map(doubled).collect();
        [vec![usual], doubled].concat()
    }

    #[test]
    fn shapes_end_at_start_if_they_say_so_and_their_directions_mirror_each_other() {
        for p in SHAPES.iter().flat_map(|shape| paths(shape)) {
            let shape = p.shape();
            let (mut right, mut left) = (Pose2::IDENTITY, Pose2::IDENTITY);
            for (cw, ccw) in p.moves(Direction::Cw).iter().zip(p.moves(Direction::Ccw)) {
                right = right.moved(&cw.displacement());
                left = left.moved(&ccw.displacement());
                assert!((right.x - left.x).abs() < 1e-12 && (right.y + left.y).abs() < 1e-12, "{}", shape.name);
            }
            for end in [right, left] {
                let aside =
                    libm::hypot(end.x, end.y) + libm::hypot(libm::cos(end.heading) - 1.0, libm::sin(end.heading));
                assert_eq!(aside < 1e-12, shape.closed, "{} {end:?}", shape.name);
            }
        }
    }

    #[test]
    fn the_ccw_square_lies_to_the_left_of_start_and_has_the_length_of_its_sides() {
        let p = path(&SQUARE, &[4.0]);
        let corner = p.moves(Direction::Ccw)[..3].iter().fold(Pose2::IDENTITY, |q, m| q.moved(&m.displacement()));
        assert!((corner.x - 4.0).abs() < 1e-12 && (corner.y - 4.0).abs() < 1e-12);
        assert!((path(&RECTANGLE, &[7.0, 4.0]).length() - 22.0).abs() < 1e-12);
        assert!((path(&CIRCLE, &[1.5, 2.0]).length() - 6.0 * std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(path(&STRAIGHT, &[10.0]).end(Direction::Cw), Pose2::new(10.0, 0.0, 0.0));
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let refuse = |shape, values: &[f64]| Path::new(shape, values, SpeedProfile::default()).unwrap_err().to_string();
        assert_eq!(refuse(&SQUARE, &[-4.0]), "side_m must be between 0.001 and 10000 m, got -4");
        assert_eq!(refuse(&SQUARE, &[]), "square takes 1 numbers, got 0");
        assert!(refuse(&WAYPOINTS, &[1.0, 0.0, 1.0, 0.0]).contains("point 2"));
        let tight = refuse(&ROUNDED_RECTANGLE, &[4.0, 3.0, 1.6]);
        assert_eq!(tight, "corner_radius_m must be between 0.001 and 1.5 m (half of the shorter side), got 1.6");
        assert!(refuse(&WAYPOINTS, &[f64::NAN, 0.0]).contains("point 1"));
    }
}
