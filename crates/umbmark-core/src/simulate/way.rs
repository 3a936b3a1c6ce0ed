//! A run in small pieces, each with the variables of effects.

use super::Leg;
use crate::drive::{Robot, WheelTravel};
use crate::effect::{Aside, Context, Here, Progress, RunContext, Stretch};
use crate::geometry::{Displacement2, Pose2};
use crate::path::{Direction, Pieces, SpeedProfile};

/// The state of a run in terms of the robot's own odometry, plus its true pose.
#[derive(Clone, Debug)]
pub(super) struct Way {
    robot: Robot,
    progress: Progress,
    pieces: Pieces,
    /// Whether each move is one piece.
    pub whole: bool,
    /// The last piece.
    at: Context,
    /// True pose; its place stays at the beginning of the run unless `follows` is set.
    pose: Pose2,
    follows: bool,
    /// Number of the run that comes next in its session.
    next_run: usize,
    /// Time since START at which the course goes on \[s\].
    clock: f64,
}

impl Way {
    /// No session yet: [`Way::open`] comes first. The true place is tracked, in addition to the heading, if `follows` is set.
    pub(super) fn new(robot: &Robot, follows: bool) -> Way {
        Way {
            robot: robot.clone(),
            progress: RunContext::default().progress(robot, false),
            pieces: Pieces::along(&WheelTravel::default(), 0.0, SpeedProfile::default().over(0.0)),
            whole: false,
            at: Context::default(),
            pose: Pose2::IDENTITY,
            follows,
            next_run: 0,
            clock: 0.0,
        }
    }

    /// Begins a session.
    pub(super) fn open(&mut self) {
        self.next_run = 0;
    }

    /// Begins the session's next run with the robot truly there. Whether encoders record it decides what
    /// [`Context::recorded`] says.
    #[inline(never)]
    pub(super) fn start(&mut self, direction: Direction, recorded: bool, pose: Pose2) {
        let session_distance = if self.next_run == 0 { 0.0 } else { self.progress.session_distance() };
        let place = RunContext { run: self.next_run, session_distance, direction: Some(direction) };
        self.progress = place.progress(&self.robot, recorded);
        self.at = Context::default();
        self.pose = pose;
        self.next_run += 1;
        self.clock = 0.0;
    }

    /// Stands still \[s\], by its counts.
    pub(super) fn rest(&mut self, duration: f64) -> Context {
        self.progress.piece(&WheelTravel::default(), duration, [0.0; 2], [0.0; 2])
    }

    /// Stands still until some time after START, if it does not stand there already.
    pub(super) fn rest_until(&mut self, clock: f64) -> Option<Context> {
        let duration = clock - self.clock;
        (duration > 0.0).then(|| {
            self.clock = clock;
            self.rest(duration)
        })
    }

    /// Begins a move of the course, after the pause before it, of which the robot believes such a travel.
    #[inline(never)]
    pub(super) fn begin(&mut self, leg: &Leg, believed: &Stretch) {
        self.rest_until(leg.begins);
        self.clock = leg.begins + leg.profile.duration();
        self.pieces = Pieces::along(&believed.travel, believed.left, leg.profile);
        if self.whole {
            self.pieces = self.pieces.clone().in_one();
        }
    }

    /// The next piece of the move and its believed wheel travel, up to where `share` of the move is done.
    pub(super) fn until(&mut self, share: f64) -> Option<(Context, WheelTravel)> {
        let piece = self.pieces.until(share)?;
        let aside = Aside { way: piece.left, speed: piece.speed_left, ..Aside::NONE };
        let at = self.progress.piece_aside(&piece.travel, aside, piece.duration, piece.from, piece.to);
        self.at = at;
        Some((at, piece.travel))
    }

    /// This moment of the way, of no length and no duration.
    pub(super) fn moment(&self) -> Context {
        Context {
            length: 0.0,
            duration: 0.0,
            wheel_rotation: [0.0; 2],
            wheel_travel: [0.0; 2],
            aside: Aside::NONE,
            ..self.at
        }
    }

    /// Where the robot truly is, for a piece of its way.
    pub(super) fn here<'a>(&self, at: &'a Context) -> Here<'a> {
        at.at_pose(&self.pose)
    }

    /// Applies a true motion of the robot.
    #[inline]
    pub(super) fn advance(&mut self, motion: &Displacement2) {
        if self.follows {
            self.pose.advance(motion);
        } else {
            self.pose.heading += motion.rotation;
        }
    }

    /// Applies a displacement by noise, in the robot's frame.
    pub(super) fn put(&mut self, [x, y, turned]: [f64; 3]) {
        if self.follows {
            self.pose = self.pose.compose(&Pose2::new(x, y, turned));
        } else {
            self.pose.heading += turned;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::effect::TestKind;
    use crate::path::{DIAGONAL_SQUARE, Path};
    use crate::replay::Track;
    use crate::simulate::Course;

    #[test]
    fn the_pieces_of_a_run_are_those_of_the_track_of_its_commands_pauses_included() {
        let mecanum = Robot { drive: DriveKind::Mecanum.usual(), ..Robot::labmate() };
        let diamond = Path::new(&DIAGONAL_SQUARE, &[1.0], SpeedProfile::default()).unwrap();
        for (direction, robot, path) in Direction::BOTH
            .into_iter()
            .flat_map(|d| [(d, Robot::labmate(), Path::umbmark()), (d, mecanum.clone(), diamond.clone())])
        {
            let course = Course::new(&robot, &path, direction).unwrap();
            let mut way = Way::new(&robot, false);
            way.open();
            way.start(direction, false, Pose2::IDENTITY);
            let mut driven = Vec::new();
            for leg in &course.legs {
                let (index, test) = (driven.len(), TestKind::Systematic);
                way.begin(leg, &Stretch { index, direction, test, travel: leg.travel, left: leg.left });
                while let Some((at, travel)) = way.until(1.0) {
                    let motion = robot.drive.displacement(&travel);
                    way.advance(&Displacement2 { sideways: at.aside.way, ..motion });
                    driven.push(at);
                }
            }
            let track = Track::in_pieces(&path, direction, &robot);
            assert_eq!(driven.len(), track.contexts().len());
            for (driven, told) in driven.iter().zip(track.contexts()) {
                let numbers = |at: &Context| {
                    let along = [
                        at.time,
                        at.distance,
                        at.since_turn,
                        at.believed_heading,
                        at.wheel_angle[0],
                        at.wheel_angle[1],
                    ];
                    let rates =
                        [at.duration, at.speed, at.turn_rate, at.speed_change[0], at.speed_change[1], at.length];
                    let senses = [
                        at.last_turn,
                        at.direction,
                        at.reversed[0],
                        at.reversed[1],
                        at.run,
                        at.aside.way + at.aside.speed,
                    ];
                    [along, rates, senses]
                };
                let pairs = numbers(driven).into_iter().flatten().zip(numbers(told).into_iter().flatten());
                assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9), "{driven:?} {told:?}");
            }
        }
    }
}
