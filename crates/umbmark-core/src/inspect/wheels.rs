//! Whether the wheels are what their columns say.

use crate::drive::Robot;
use crate::path::{Direction, Path};
use crate::run::TickLog;
use crate::setup::{Fault, Setup};

/// What the columns of a log are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheels {
    /// What they are called.
    AsGiven,
    /// Something else.
    Otherwise {
        /// Left and right are exchanged.
        exchanged: bool,
        /// The left column counts down when driving forward.
        left_backward: bool,
        /// The right column counts down when driving forward.
        right_backward: bool,
    },
}

impl std::fmt::Display for Wheels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Wheels::Otherwise { exchanged, left_backward, right_backward } = *self else {
            return f.write_str("as named");
        };
        let said = [
            (exchanged, "left and right exchanged"),
            (left_backward, "ticks_left counts backward"),
            (right_backward, "ticks_right counts backward"),
        ];
        let said: Vec<&str> = said.into_iter().filter(|(is, _)| *is).map(|(_, text)| text).collect();
        f.write_str(&said.join(", "))
    }
}

/// What the motion says of the columns of a run, all runs looked at together; `None` where it cannot say.
pub(super) fn by_motion(setup: &Setup, run: &str) -> Option<Wheels> {
    let of_fault = |fault: &Fault| match fault {
        Fault::Exchanged => Some(Wheels::Otherwise { exchanged: true, left_backward: false, right_backward: false }),
        Fault::Backward { counters: [left_backward, right_backward], exchanged, .. } => Some(Wheels::Otherwise {
            exchanged: *exchanged,
            left_backward: *left_backward,
            right_backward: *right_backward,
        }),
        _ => None,
    };
    let of_run = |fault: &Fault| match fault {
        Fault::InRuns { fault, runs } if runs.iter().any(|own| own == run) => of_fault(fault),
        fault => of_fault(fault),
    };
    let unlike = |fault: &Fault| matches!(fault, Fault::OtherMotion { .. });
    let told = setup.of_run(run).is_some() && (setup.mounting.is_some() || !setup.faults.is_empty());
    (told && !setup.faults.iter().any(unlike)).then(|| setup.faults.iter().find_map(of_run).unwrap_or(Wheels::AsGiven))
}

/// So much of its travel a wheel goes the same way in a run that does not reverse.
const ONE_WAY: f64 = 0.6;
/// Turns by less than this share of those of the path contradict nothing.
const MUCH: f64 = 0.5;

/// What the path says of the columns of a log without poses on the way.
///
/// On a path where both wheels go forward, a wheel that goes backward nearly all the time, beside one that goes forward, counts
/// backward. Both are said to only where the robot also turned the other way than the direction that the run is named after: it may
/// have been driven backward. A run that reverses says nothing.
pub(super) fn by_path(log: &TickLog, direction: Option<Direction>, robot: &Robot, path: &Path) -> Option<Wheels> {
    let travel = |direction: Direction| {
        let travel = path.moves(direction).into_iter().map(|m| m.wheel_travel(&robot.drive));
        travel.fold((0.0, 0.0), |(l, r), travel| (l + travel.left, r + travel.right))
    };
    if !Direction::BOTH.into_iter().map(travel).all(|(left, right)| left > 0.0 && right > 0.0) {
        return None;
    }
    let [left, right] = [&log.left, &log.right].map(|counts| sense(counts));
    match (left?, right?) {
        (false, false) => Some(Wheels::AsGiven),
        (true, true) => {
            let (meant_left, meant_right) = travel(direction?);
            let per_tick = robot.metres_per_tick();
            let made = log.right.last()? * per_tick.right - log.left.last()? * per_tick.left;
            let meant = meant_right - meant_left;
            let contradicts = made * meant < 0.0 && made.abs() > MUCH * meant.abs();
            contradicts.then_some(Wheels::Otherwise { exchanged: false, left_backward: true, right_backward: true })
        }
        (left_backward, right_backward) => Some(Wheels::Otherwise { exchanged: false, left_backward, right_backward }),
    }
}

/// Whether a wheel counts down nearly all the time; `None` where it goes both ways, or stands.
fn sense(counts: &[f64]) -> Option<bool> {
    let whole: f64 = counts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    let net = counts.last()? - counts.first()?;
    (whole > 0.0 && net.abs() > ONE_WAY * whole).then_some(net < 0.0)
}
