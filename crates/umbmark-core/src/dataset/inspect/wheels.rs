//! Whether the wheels are what their columns say.

use super::super::TickLog;
use super::super::dead_reckoning::computed_poses;
use crate::drive::Robot;
use crate::path::{Direction, Path};

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

/// What was found of the wheels of a log, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelsFound {
    /// What the columns are.
    pub wheels: Wheels,
    /// Root mean square distance of the absolute poses to the computed ones \[m\], for the columns as given and as they
    /// fit best; nothing where there are no absolute poses to tell by.
    pub misfit: Option<(f64, f64)>,
}

/// The best fit must be this many times better than the columns as given to be believed.
const CLEARLY: f64 = 3.0;
/// The fewest absolute poses that columns are told by.
const FEWEST: usize = 4;

/// Tries every exchange and sign against the absolute poses; without those, looks whether both wheels go forward.
pub(super) fn find_wheels(log: &TickLog, robot: &Robot, path: Option<&Path>) -> Option<WheelsFound> {
    if log.reference.len() < FEWEST {
        return signs_by_path(log, robot, path?);
    }
    let given = misfit(log, robot);
    let (mut best, mut wheels) = (given, Wheels::AsGiven);
    for trial in 1..8 {
        let (exchanged, left_backward, right_backward) = (trial & 1 != 0, trial & 2 != 0, trial & 4 != 0);
        let sign = |backward| if backward { -1.0 } else { 1.0 };
        let mut turned = log.clone();
        turned.left.iter_mut().for_each(|ticks| *ticks *= sign(left_backward));
        turned.right.iter_mut().for_each(|ticks| *ticks *= sign(right_backward));
        if exchanged {
            std::mem::swap(&mut turned.left, &mut turned.right);
        }
        let found = misfit(&turned, robot);
        if found * CLEARLY < given && found < best {
            (best, wheels) = (found, Wheels::Otherwise { exchanged, left_backward, right_backward });
        }
    }
    Some(WheelsFound { wheels, misfit: Some((given, best)) })
}

/// Root mean square distance of absolute and computed positions \[m\].
fn misfit(log: &TickLog, robot: &Robot) -> f64 {
    let poses = computed_poses(log, robot);
    let square = |p: &super::super::ReferencePose| {
        let at = poses[p.sample];
        (p.x - at.x) * (p.x - at.x) + (p.y - at.y) * (p.y - at.y)
    };
    (log.reference.iter().map(square).sum::<f64>() / log.reference.len() as f64).sqrt()
}

/// A wheel that ends behind where it began counts backward, on a path where both wheels go forward.
fn signs_by_path(log: &TickLog, robot: &Robot, path: &Path) -> Option<WheelsFound> {
    let ahead = Direction::BOTH.into_iter().all(|direction| {
        let moves = path.moves(direction);
        let travel = moves.iter().map(|m| m.wheel_travel(&robot.drive));
        let (left, right) = travel.fold((0.0, 0.0), |(l, r), travel| (l + travel.left, r + travel.right));
        left > 0.0 && right > 0.0
    });
    let (left, right) = (log.left.last()?, log.right.last()?);
    ahead.then(|| {
        let (left_backward, right_backward) = (*left < 0.0, *right < 0.0);
        let wheels = match (left_backward, right_backward) {
            (false, false) => Wheels::AsGiven,
            _ => Wheels::Otherwise { exchanged: false, left_backward, right_backward },
        };
        WheelsFound { wheels, misfit: None }
    })
}
