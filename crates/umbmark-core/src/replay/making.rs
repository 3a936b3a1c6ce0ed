//! Tracks of recorded runs, and of paths that are driven as commanded.

use super::error::{ReplayError, check};
use super::pace;
use super::track::Track;
use crate::dataset::TickLog;
use crate::drive::{Robot, WheelTravel};
use crate::effect::{Aside, RunContext, Sight};
use crate::engine::Convoy;
use crate::geometry::Pose2;
use crate::path::{Direction, Path, Pieces};
use std::sync::Arc;

impl Track {
    /// The track of a recorded run, one piece a sample, observed at each of its reference poses.
    ///
    /// It stands first in its session; see [`Track::from_log_at`].
    pub fn from_log(log: &TickLog, robot: &Robot) -> Result<Track, ReplayError> {
        Track::from_log_at(log, robot, RunContext::default())
    }

    /// [`Track::from_log`] of a run with its place among others.
    pub fn from_log_at(log: &TickLog, robot: &Robot, place: RunContext) -> Result<Track, ReplayError> {
        Track::from_log_seen(log, robot, place, log.reference.iter().map(|reference| reference.sample))
    }

    /// [`Track::from_log_at`], observed at some of its samples, in order.
    pub fn from_log_seen(
        log: &TickLog,
        robot: &Robot,
        place: RunContext,
        samples: impl Iterator<Item = usize>,
    ) -> Result<Track, ReplayError> {
        check(log)?;
        let per_tick = robot.metres_per_tick();
        let speeds = pace::wheel_speeds(log, &per_tick);
        let asides = log.asides(robot);
        let paces = pace::speeds_aside(log, &asides);
        let mut progress = place.progress(robot, true).with_clock_excess(log.clock_excess);
        let mut track = Track::empty();
        let mut due = samples.peekable();
        let (mut left, mut right) = (0.0, 0.0);
        for (sample, (l, r)) in log.left.iter().zip(&log.right).enumerate() {
            let before = sample.saturating_sub(1);
            let duration = log.time[sample] - log.time[before];
            let travel = WheelTravel { left: (l - left) * per_tick.left, right: (r - right) * per_tick.right };
            let mut aside = Aside::NONE;
            if let Some([to, apart]) = asides.get(sample) {
                // The first sample is START.
                let [from, were] = if sample == 0 { [0.0; 2] } else { asides[before] };
                let speed = 0.5 * (paces[before] + paces[sample]);
                aside = Aside { way: to - from, disagreement: apart - were, speed };
            }
            if let Some(excess) = log.clock_excess_along.get(sample) {
                progress.set_clock_excess(*excess);
            }
            track.push(travel, progress.piece_aside(&travel, aside, duration, speeds[before], speeds[sample]));
            (left, right) = (*l, *r);
            track.duration = log.time[sample] - log.time[0];
            while due.next_if_eq(&sample).is_some() {
                let speed_aside = paces.get(sample).copied().unwrap_or(0.0);
                track.observe(Sight { speed_aside, ..sight(track.duration, speeds[sample], robot) });
            }
        }
        Ok(track)
    }

    /// The track of a robot that makes the moves of a path as its odometry believes, observed at the end.
    ///
    /// Where only return errors were measured, this is what the robot believed to drive: its controller stops each move
    /// when the odometry says so. Each move is one piece: for models that do not [vary](crate::effect::Model::varies).
    pub fn from_path(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, Pieces::in_one, Observed::AtEnd)
    }

    /// [`Track::from_path`] in pieces of a centimetre, for every model.
    pub fn in_pieces(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, |pieces| pieces, Observed::AtEnd)
    }

    /// [`Track::in_pieces`] for a plan, in pieces five times as long, observed after every move or at the end: its worth in standard deviations
    /// need only be right to some per cent.
    pub fn planned(path: &Path, direction: Direction, robot: &Robot, at_stops: bool) -> Track {
        let observed = if at_stops { Observed::AtStops } else { Observed::AtEnd };
        Track::along_path(path, direction, robot, |pieces| pieces.coarser(5), observed)
    }

    /// [`Track::in_pieces`] observed after every move.
    pub fn with_stops(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, |pieces| pieces, Observed::AtStops)
    }

    /// [`Track::in_pieces`] observed after every piece.
    pub fn watched(path: &Path, direction: Direction, robot: &Robot) -> Track {
        Track::along_path(path, direction, robot, |pieces| pieces, Observed::Always)
    }

    fn along_path(
        path: &Path,
        direction: Direction,
        robot: &Robot,
        cut: fn(Pieces) -> Pieces,
        observed: Observed,
    ) -> Track {
        if let Some(convoy) = Convoy::new(robot, path, direction) {
            return Track::of_trucks(convoy, robot, observed);
        }
        let place = RunContext { direction: Some(direction), ..RunContext::default() };
        let mut progress = place.progress(robot, false);
        let mut track = Track::empty();
        let moves = path.moves(direction);
        for (index, (m, (profile, pause))) in moves.iter().zip(path.profiles(direction, &robot.drive)).enumerate() {
            let pieces = Pieces::along(&m.wheel_travel(&robot.drive), m.displacement().sideways, profile);
            for piece in cut(pieces) {
                let aside = Aside { way: piece.left, speed: piece.speed_left, ..Aside::NONE };
                let at = progress.piece_aside(&piece.travel, aside, piece.duration, piece.from, piece.to);
                track.push(piece.travel, at);
                if observed == Observed::Always {
                    let speed_aside = piece.speed_left;
                    track.observe(Sight { speed_aside, ..sight(progress.time(), piece.to, robot) });
                }
            }
            let stops = !path.shape().flows || index + 1 == moves.len();
            if observed == Observed::AtStops && stops || (observed == Observed::AtEnd && index + 1 == moves.len()) {
                let room = (observed == Observed::AtStops).then_some(Pose2::IDENTITY);
                track.observe(Sight { time: progress.time(), room, ..Sight::default() });
            }
            if pause > 0.0 || !path.shape().flows {
                progress.piece(&WheelTravel::default(), pause, [0.0; 2], [0.0; 2]);
            }
        }
        track
    }

    /// The track of a front truck, one piece a period.
    fn of_trucks(convoy: Convoy, robot: &Robot, observed: Observed) -> Track {
        let mut track = Track::empty();
        for (made, step) in (1..).zip(convoy.steps()) {
            track.travel.push(step.travel[0]);
            track.contexts.push(step.contexts[0]);
            let stops = convoy.stops().contains(&made);
            if match observed {
                Observed::Always => true,
                Observed::AtStops => stops,
                Observed::AtEnd => made == convoy.steps().len(),
            } {
                let by_tape = observed == Observed::AtEnd;
                let room = (!by_tape).then_some(Pose2::IDENTITY);
                track.observe(Sight { room, ..sight(step.time, step.speeds[0], robot) });
            }
        }
        track.convoy = Some(Arc::new(convoy));
        track
    }
}

/// When a robot on a path is observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Observed {
    AtEnd,
    AtStops,
    Always,
}

/// The moment at which the wheels have these speeds \[m/s\].
fn sight(time: f64, [left, right]: [f64; 2], robot: &Robot) -> Sight {
    let (speed, turn_rate) = (0.5 * (left + right), (right - left) / robot.drive.wheelbase());
    Sight { time, speed, turn_rate, room: Some(Pose2::IDENTITY), ..Sight::default() }
}
