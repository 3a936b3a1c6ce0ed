//! What the robot did by its ticks: legs, turns, arcs and stops, and the shape that they make.

use crate::drive::Robot;
use crate::geometry::{Pose2, wrap};
use crate::prose::counted;
use crate::run::TickLog;
use crate::run::dead_reckoning::computed_poses;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Speeds are those over so long a time \[s\], and over two samples at least.
const OVER: f64 = 0.2;
/// Below this share of the greatest speed of a wheel the robot stands.
const STANDING: f64 = 0.05;
/// Shorter stops \[s\], legs \[m\] and turns \[rad\] are transitions.
const LEAST_STOP: f64 = 0.1;
const LEAST_LEG: f64 = 0.05;
const LEAST_TURN: f64 = 0.1;
/// Legs and turns are alike when they differ by less than this share.
const ALIKE: f64 = 0.1;
/// A corner that a real robot turns begins and ends in curves; what is left is this near to a right angle \[rad\].
const CORNER: f64 = 0.4;
/// A base that moves sideways goes round at a fixed heading where it ends nearer than this share of its way.
const ROUND: f64 = 0.5;
/// Places and speeds kept for a picture.
const SKETCH: usize = 400;

/// What the robot did, as the ticks have it \[m, rad\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Done {
    Stop,
    /// Its course is that of its end from the heading at its beginning.
    Leg {
        length: f64,
        course: f64,
    },
    Turn {
        angle: f64,
    },
    Arc {
        length: f64,
        angle: f64,
    },
}

/// A move, and the samples between which it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MoveDone {
    pub done: Done,
    pub from: usize,
    pub to: usize,
}

/// The moves of a log in order; what is too short to be meant stands between them.
pub(crate) fn moves_of(log: &TickLog, robot: &Robot) -> Vec<MoveDone> {
    moves(&log.time, &computed_poses(log, robot), robot)
}

/// What a log shows of the path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovesFound {
    /// Times that the robot stood between moves.
    pub stops: usize,
    /// Straight legs.
    pub legs: usize,
    /// Turns on the spot.
    pub turns: usize,
    /// Curved pieces.
    pub arcs: usize,
    /// The name of the shape that they make, where they make one.
    pub shape: Option<&'static str>,
    /// The shape in words, with its size.
    pub described: String,
    /// Places along the path by the ticks \[m\], for a picture.
    pub computed: Vec<(f64, f64)>,
    /// The places that were measured \[m\], for a picture.
    pub measured: Vec<(f64, f64)>,
    /// Speed of the faster wheel, evenly over the time \[m/s\], for a picture.
    pub speed: Vec<f64>,
}

impl MovesFound {
    pub(super) fn of(log: &TickLog, robot: &Robot) -> MovesFound {
        let poses = computed_poses(log, robot);
        let moves: Vec<Done> = moves(&log.time, &poses, robot).iter().map(|m| m.done).collect();
        let count = |is: fn(&Done) -> bool| moves.iter().filter(|done| is(done)).count();
        let inner = moves.len().saturating_sub(1);
        let (shape, described) = shape(&moves);
        // Steps that are added up drift away from where the robot was.
        let measured = log.reference.iter().filter(|_| !log.relative).step_by(log.reference.len() / SKETCH + 1);
        let measured = measured.map(|pose| (pose.x, pose.y)).collect();
        MovesFound {
            stops: moves.iter().take(inner).skip(1).filter(|done| **done == Done::Stop).count(),
            legs: count(|done| matches!(done, Done::Leg { .. })),
            turns: count(|done| matches!(done, Done::Turn { .. })),
            arcs: count(|done| matches!(done, Done::Arc { .. })),
            shape,
            described,
            computed: poses.iter().step_by(poses.len() / SKETCH + 1).map(|pose| (pose.x, pose.y)).collect(),
            measured,
            speed: speeds(&log.time, &poses, 0.5 * robot.drive.wheelbase()),
        }
    }
}

/// Speed of the faster wheel over each of at most `SKETCH` equal times.
fn speeds(time: &[f64], poses: &[Pose2], arm: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return Vec::new() };
    let count = SKETCH.min(time.len() / 4).max(1);
    let at = |i: usize| {
        let when = first + (last - first) * i as f64 / count as f64;
        time.partition_point(|t| *t < when).min(time.len() - 1)
    };
    let speed = |i: usize| {
        let (a, b) = (at(i), at(i + 1));
        let moved = poses[a].between(&poses[b]);
        let seconds = time[b] - time[a];
        if seconds > 0.0 { (libm::hypot(moved.x, moved.y) + arm * moved.heading.abs()) / seconds } else { 0.0 }
    };
    (0..count).map(speed).collect()
}

/// The moves in order. A leg that bends a little, as a robot does that steers back to its line, is a leg; what is too short to
/// be meant is a transition.
fn moves(time: &[f64], poses: &[Pose2], robot: &Robot) -> Vec<MoveDone> {
    let (arm, slides) = (0.5 * robot.drive.wheelbase(), robot.drive.kind().moves_sideways());
    let kinds = kinds(time, poses, arm);
    let mut pieces: Vec<MoveDone> = Vec::new();
    let mut start = 0;
    for same in kinds.chunk_by(|a, b| a == b) {
        let end = (start + same.len()).min(poses.len() - 1);
        let length: f64 = poses[start..=end].windows(2).map(|p| libm::hypot(p[1].x - p[0].x, p[1].y - p[0].y)).sum();
        let angle = poses[end].heading - poses[start].heading;
        let done = match same[0] {
            MotionState::Standing => (time[end] - time[start] > LEAST_STOP).then_some(Done::Stop),
            MotionState::Turning => (angle.abs() > LEAST_TURN).then_some(Done::Turn { angle }),
            MotionState::Going if angle.abs() < CORNER => {
                let moved = poses[start].between(&poses[end]);
                if slides && libm::hypot(moved.x, moved.y) < ROUND * length {
                    pieces.push(MoveDone { done: Done::Arc { length, angle }, from: start, to: end });
                    start = end;
                    continue;
                }
                Some(Done::Leg { length, course: libm::atan2(moved.y, moved.x) })
            }
            MotionState::Going => Some(Done::Arc { length, angle }),
        };
        pieces.extend(done.map(|done| MoveDone { done, from: start, to: end }));
        start = end;
    }
    let mut moves = joined(pieces);
    moves.retain(|m| !matches!(m.done, Done::Leg { length, .. } if length < LEAST_LEG));
    joined(moves)
}

/// Neighbours of one kind as one move.
fn joined(pieces: Vec<MoveDone>) -> Vec<MoveDone> {
    let mut moves: Vec<MoveDone> = Vec::new();
    for piece in pieces {
        let last = moves.last_mut();
        match last.and_then(|last| Some((together(last.done, piece.done)?, last))) {
            Some((done, last)) => (last.done, last.to) = (done, piece.to),
            None => moves.push(piece),
        }
    }
    moves
}

/// Two neighbours as one move, where they are of one kind.
fn together(before: Done, after: Done) -> Option<Done> {
    match (before, after) {
        (Done::Stop, Done::Stop) => Some(Done::Stop),
        (Done::Leg { length: a, course }, Done::Leg { length: b, course: next })
            if wrap(next - course).abs() < CORNER || a.min(b) < LEAST_LEG =>
        {
            Some(Done::Leg { length: a + b, course: if a > b { course } else { next } })
        }
        (Done::Turn { angle: a }, Done::Turn { angle: b }) => Some(Done::Turn { angle: a + b }),
        (Done::Arc { length: a, angle: turned }, Done::Arc { length: b, angle: more }) if turned * more > 0.0 => {
            Some(Done::Arc { length: a + b, angle: turned + more })
        }
        _ => None,
    }
}

#[derive(Clone, Copy, PartialEq)]
enum MotionState {
    Standing,
    Going,
    Turning,
}

/// What the robot does at each sample, by how far it goes in the time around it.
fn kinds(time: &[f64], poses: &[Pose2], arm: f64) -> Vec<MotionState> {
    let around = |i: usize| {
        let from = time.partition_point(|t| *t < time[i] - 0.5 * OVER).min(i.saturating_sub(1));
        let to = (time.partition_point(|t| *t <= time[i] + 0.5 * OVER) - 1).max((i + 1).min(time.len() - 1));
        let moved = poses[from].between(&poses[to]);
        let seconds = (time[to] - time[from]).max(f64::MIN_POSITIVE);
        (libm::hypot(moved.x, moved.y) / seconds, arm * moved.heading.abs() / seconds)
    };
    let speeds: Vec<(f64, f64)> = (0..time.len()).map(around).collect();
    let fastest = speeds.iter().map(|(forward, turn)| forward + turn).fold(0.0, f64::max);
    let kind = |(forward, turn): &(f64, f64)| match () {
        () if forward + turn <= STANDING * fastest => MotionState::Standing,
        () if *forward < 0.5 * turn => MotionState::Turning,
        () => MotionState::Going,
    };
    speeds.iter().map(kind).collect()
}

/// Whether an angle is another one, as far as driving shows.
fn near(angle: f64, other: f64) -> bool {
    wrap(angle - other).abs() < 0.5 * CORNER
}

/// Whether each leg goes a quarter turn to the same side of the one before.
fn goes_round(courses: &[f64]) -> bool {
    let quarter = |to: f64| courses.windows(2).all(|pair| near(pair[1] - pair[0], to));
    quarter(FRAC_PI_2) || quarter(-FRAC_PI_2)
}

/// The shape that moves make, and its size in words.
fn shape(moves: &[Done]) -> (Option<&'static str>, String) {
    let (legs, courses): (Vec<f64>, Vec<f64>) = moves
        .iter()
        .filter_map(|d| if let Done::Leg { length, course } = d { Some((*length, *course)) } else { None })
        .unzip();
    let turns: Vec<f64> =
        moves.iter().filter_map(|d| if let Done::Turn { angle } = d { Some(*angle) } else { None }).collect();
    let arcs: Vec<(f64, f64)> = moves
        .iter()
        .filter_map(|d| if let Done::Arc { length, angle } = d { Some((*length, *angle)) } else { None })
        .collect();
    let alike = |a: f64, b: f64| (a - b).abs() <= ALIKE * a.abs().max(b.abs());
    let right = |angle: &f64| (angle.abs() - FRAC_PI_2).abs() < CORNER && *angle * turns[0] > 0.0;
    let way: f64 = legs.iter().sum();
    match (&legs[..], &arcs[..]) {
        ([a, b, c, d], [])
            if turns.is_empty() && alike(*a, *c) && alike(*b, *d) && alike(*a, *b) && goes_round(&courses) =>
        {
            let diagonal = near(courses[0].abs(), FRAC_PI_4) || near(courses[0].abs(), 3.0 * FRAC_PI_4);
            let (name, how) = if diagonal {
                ("diagonal_square", "on its corner, at a fixed heading")
            } else {
                ("fixed_square", "at a fixed heading")
            };
            (Some(name), format!("a square of {:.2} m {how}", way / 4.0))
        }
        ([a, b, c, d], [])
            if (3..=4).contains(&turns.len()) && turns.iter().all(right) && alike(*a, *c) && alike(*b, *d) =>
        {
            if alike(*a, *b) && courses.iter().all(|course| near(course.abs(), FRAC_PI_2)) {
                (Some("sideways_square"), format!("a square of {:.2} m driven to the side", way / 4.0))
            } else if alike(*a, *b) {
                (Some("square"), format!("a square of {:.2} m", way / 4.0))
            } else {
                (Some("rectangle"), format!("a rectangle of {:.2} by {:.2} m", 0.5 * (a + c), 0.5 * (b + d)))
            }
        }
        ([length], []) if turns.is_empty() && near(courses[0].abs(), FRAC_PI_2) => {
            (Some("slide"), format!("a way of {length:.2} m to the side"))
        }
        ([length], []) if turns.is_empty() => (Some("straight"), format!("a straight of {length:.2} m")),
        ([], []) if !turns.is_empty() => {
            let round = turns.iter().sum::<f64>().abs() / std::f64::consts::TAU;
            (Some("spin"), format!("a spin of {round:.2} turns"))
        }
        (_, [(length, angle)]) if *length > 0.8 * (length + way) && angle.abs() < CORNER => {
            (Some("fixed_circle"), format!("a circle at a fixed heading, {length:.2} m round"))
        }
        (_, [(length, angle)]) if *length > 0.8 * (length + way) && angle.abs() > 5.0 => {
            let turns = angle.abs() / std::f64::consts::TAU;
            (Some("circle"), format!("a circle of {:.2} m radius, {turns:.2} turns", length / angle.abs()))
        }
        (_, [(a, left), (b, right)]) if left * right < 0.0 && alike(*a, *b) && a + b > 0.8 * (a + b + way) => {
            (Some("figure_eight"), format!("a figure of eight of {:.2} m radius", (a + b) / (left.abs() + right.abs())))
        }
        _ => (
            None,
            format!(
                "no usual shape: {}, {}, {}",
                counted(legs.len(), "leg"),
                counted(turns.len(), "turn"),
                counted(arcs.len(), "arc")
            ),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::path::{Direction, Path, SpeedProfile};
    use std::f64::consts::PI;

    /// A path driven at 50 Hz by a perfect robot, with rests between the moves.
    fn found_of(robot: &Robot, shape: &'static crate::path::Shape, values: &[f64], direction: Direction) -> MovesFound {
        let path = Path::new(shape, values, SpeedProfile::default()).unwrap();
        let (per_tick, rollers) = (robot.metres_per_tick(), robot.drive.rollers());
        let per_count =
            rollers.as_ref().map_or(Vec::new(), |r| r.metres_per_count(robot.encoder.ticks_per_revolution()));
        let mut log = TickLog { rollers: vec![Vec::new(); per_count.len()], ..TickLog::default() };
        let (mut axle, mut ways) = ([0.0; 2], vec![0.0; per_count.len()]);
        let write = |log: &mut TickLog, axle: &[f64; 2], ways: &[f64]| {
            log.time.push(0.02 * log.time.len() as f64);
            log.left.push(axle[0] / per_tick.left);
            log.right.push(axle[1] / per_tick.right);
            log.rollers.iter_mut().zip(ways).zip(&per_count).for_each(|((counts, way), per)| counts.push(way / per));
        };
        (0..50).for_each(|_| write(&mut log, &axle, &ways));
        for m in path.moves(direction) {
            let travel = m.wheel_travel(&robot.drive);
            let steps = (m.farthest(&robot.drive) / 0.004).ceil();
            let all = rollers.as_ref().map_or(Vec::new(), |rollers| rollers.ways_of(&m.displacement()));
            for _ in 0..steps as usize {
                axle = [axle[0] + travel.left / steps, axle[1] + travel.right / steps];
                ways.iter_mut().zip(&all).for_each(|(way, all)| *way += all / steps);
                write(&mut log, &axle, &ways);
            }
            if shape.flows {
                continue;
            }
            (0..40).for_each(|_| write(&mut log, &axle, &ways));
        }
        MovesFound::of(&log, robot)
    }

    fn found(shape: &'static crate::path::Shape, values: &[f64], direction: Direction) -> MovesFound {
        found_of(&Robot::labmate(), shape, values, direction)
    }

    #[test]
    fn shapes_of_robots_that_move_sideways_are_told_too() {
        use crate::path::{DIAGONAL_SQUARE, FIXED_CIRCLE, FIXED_SQUARE, SIDEWAYS_SQUARE, SLIDE, SQUARE};
        for kind in [DriveKind::Mecanum, DriveKind::Omni3, DriveKind::Omni4, DriveKind::DeadWheels] {
            let robot = Robot { drive: kind.usual(), ..Robot::labmate() };
            for direction in Direction::BOTH {
                let told = |shape| found_of(&robot, shape, &[2.0], direction);
                let fixed = told(&FIXED_SQUARE);
                assert_eq!((fixed.legs, fixed.turns, fixed.stops), (4, 0, 3));
                assert_eq!(fixed.described, "a square of 2.00 m at a fixed heading");
                assert_eq!(told(&DIAGONAL_SQUARE).described, "a square of 2.00 m on its corner, at a fixed heading");
                assert_eq!(told(&SIDEWAYS_SQUARE).described, "a square of 2.00 m driven to the side");
                assert_eq!(told(&SQUARE).described, "a square of 2.00 m");
                assert_eq!(told(&SLIDE).described, "a way of 2.00 m to the side");
                let round = found_of(&robot, &FIXED_CIRCLE, &[1.0, 1.0], direction);
                assert_eq!(round.described, "a circle at a fixed heading, 6.28 m round");
                for shape in [&FIXED_SQUARE, &DIAGONAL_SQUARE, &SIDEWAYS_SQUARE, &SQUARE, &SLIDE] {
                    assert_eq!(told(shape).shape, Some(shape.name));
                }
            }
        }
    }

    #[test]
    fn every_shape_is_told_by_its_moves_both_ways_round() {
        use crate::path::{CIRCLE, FIGURE_EIGHT, RECTANGLE, SPIN, STRAIGHT};
        for direction in Direction::BOTH {
            let square = found(&crate::path::SQUARE, &[2.0], direction);
            assert_eq!(square.described, "a square of 2.00 m");
            assert_eq!((square.legs, square.turns, square.arcs, square.stops), (4, 4, 0, 7));
            assert_eq!(found(&RECTANGLE, &[3.0, 1.0], direction).described, "a rectangle of 3.00 by 1.00 m");
            assert_eq!(found(&STRAIGHT, &[2.5], direction).described, "a straight of 2.50 m");
            assert_eq!(found(&SPIN, &[3.0], direction).described, "a spin of 3.00 turns");
            assert_eq!(found(&CIRCLE, &[1.0, 2.0], direction).described, "a circle of 1.00 m radius, 2.00 turns");
            let eight = found(&FIGURE_EIGHT, &[1.0], direction);
            assert_eq!((eight.shape, eight.stops), (Some("figure_eight"), 1), "{}", eight.described);
        }
    }

    #[test]
    fn what_is_no_shape_is_said_by_its_pieces() {
        let points = [1.0, 0.0, 1.0, 1.0, 3.0, 1.0 + PI];
        let waypoints = found(&crate::path::WAYPOINTS, &points, Direction::Ccw);
        assert_eq!(waypoints.shape, None);
        assert_eq!(waypoints.described, "no usual shape: 3 legs, 2 turns, 0 arcs");
    }
}
