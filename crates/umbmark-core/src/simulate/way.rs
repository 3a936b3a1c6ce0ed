//! A run under way in small pieces, each with what effects may depend on.

use super::Leg;
use crate::drive::{Robot, WheelTravel};
use crate::effect::{Context, Place, Progress};
use crate::path::{Direction, Pieces, SpeedProfile};

/// How far a run has come, in the robot's own terms but for its true heading.
#[derive(Clone, Debug)]
pub(super) struct Way {
    robot: Robot,
    progress: Progress,
    pieces: Pieces,
    /// The last piece.
    at: Context,
    /// True heading \[rad\].
    heading: f64,
    /// Number of the run that comes next in its session.
    next_run: usize,
    /// Time since START at which the course goes on \[s\].
    clock: f64,
}

impl Way {
    /// No session yet: [`Way::open`] comes first.
    pub(super) fn new(robot: &Robot) -> Way {
        Way {
            robot: robot.clone(),
            progress: Progress::new(robot, Place::default(), false),
            pieces: Pieces::of(&WheelTravel::default(), &SpeedProfile::default()),
            at: Context::default(),
            heading: 0.0,
            next_run: 0,
            clock: 0.0,
        }
    }

    /// Begins a session.
    pub(super) fn open(&mut self) {
        self.progress = Progress::new(&self.robot, Place::default(), false);
        self.next_run = 0;
    }

    /// Begins the session's next run with the robot truly heading so \[rad\]. Whether encoders record it decides what
    /// [`Context::recorded`] says.
    pub(super) fn start(&mut self, direction: Direction, recorded: bool, heading: f64) {
        let place = Place {
            run: self.next_run,
            session_distance: self.progress.session_distance(),
            direction: Some(direction),
        };
        self.progress = Progress::new(&self.robot, place, recorded);
        self.at = Context::default();
        self.heading = heading;
        self.next_run += 1;
        self.clock = 0.0;
    }

    /// Stands still \[s\].
    pub(super) fn rest(&mut self, duration: f64) {
        self.progress.piece(&WheelTravel::default(), duration, [0.0; 2], [0.0; 2]);
    }

    /// Begins a move of the course, after the pause before it, of which the robot believes such a travel.
    pub(super) fn begin(&mut self, leg: &Leg, believed: &WheelTravel) {
        self.rest(leg.begins - self.clock);
        self.clock = leg.begins + leg.profile.duration();
        self.pieces = Pieces::along(believed, leg.profile);
    }

    /// The next piece of the move and its believed wheel travel, up to where `share` of the move is done.
    pub(super) fn until(&mut self, share: f64) -> Option<(Context, WheelTravel)> {
        let piece = self.pieces.until(share)?;
        let at = self.progress.piece(&piece.travel, piece.duration, piece.from, piece.to);
        self.at = Context { heading: self.heading, ..at };
        Some((self.at, piece.travel))
    }

    /// This moment of the way, of no length and no duration.
    pub(super) fn moment(&self) -> Context {
        Context { heading: self.heading, length: 0.0, duration: 0.0, wheel_rotation: [0.0; 2], ..self.at }
    }

    /// The robot has truly turned \[rad\].
    pub(super) fn turn(&mut self, rotation: f64) {
        self.heading += rotation;
    }
}
