//! Jumps and wrong poses where the reference may smooth what it shows.
//!
//! A low-pass filter of the reference makes poses late, and it rounds every quick motion: beside a pure delay, a turn on the spot that begins and
//! ends at once looks like two jumps. The disturbances are searched beside a delay first. If there are any, clocks and agreement are found
//! again with the wheels behind filters of some time constants, and the search is repeated with the poses behind them.

use super::agreement::{Agreement, Beside, Reading};
use super::clock::{self, Late};
use super::disturbances::{self, Found};
use super::edges::{Sighting, Spread};
use super::{PoseNoise, ROUNDS, Seen, counted, sightings};
use crate::drive::Robot;

/// A shorter delay \[s\] is of no filter that could hide a jump.
const SHORTEST: f64 = 0.04;
/// Time constants that are tried, in terms of the delay that the motion shows. Windows of a quick motion, which a filter rounds most, show less of
/// its lag; and a part of the delay may be that of a clock.
const CONSTANTS: [f64; 5] = [0.5, 0.75, 1.0, 1.25, 1.5];
/// A filter holds if it leaves less than this share of the disturbances.
const LEFT: f64 = 0.75;

/// The wrong poses and jumps of each run, and the noise of a single pose: beside the delays of the runs, `delay` on average \[s\]; or beside that
/// filter which leaves the fewest, if these are clearly fewer, and the poses nearer to those by the wheels.
pub(super) fn search(
    seen: &[Seen],
    (robot, agreement, reading): (&Robot, &Agreement, Reading),
    agreed: impl Fn(&[Beside]) -> Agreement,
    delay: f64,
) -> (Vec<Found>, PoseNoise) {
    let relative = seen.iter().any(|seen| seen.log.relative);
    let counted = counted(seen, robot.drive.wheelbase());
    let late: Vec<Vec<Sighting>> =
        seen.iter().map(|seen| sightings::of(seen, &seen.late, (robot, agreement), None)).collect();
    let (found, noise) = disturbances::search(&late, relative, counted);
    let all = count(&found);
    if all == 0 {
        return (found, noise);
    }
    let (spread, _) = Spread::of(&late, counted);
    let misfit = spread.misfit(&late);
    let constants = CONSTANTS.iter().filter(|_| delay > SHORTEST).map(|share| share * delay);
    let behind = constants.map(|time_constant| filtered(seen, (robot, agreement, reading), &agreed, time_constant));
    let nearer = behind.filter(|sightings| spread.misfit(sightings) < misfit);
    let others = nearer.map(|sightings| disturbances::search(&sightings, relative, counted));
    let fewest = others.min_by_key(|(found, _)| count(found));
    fewest.filter(|(found, _)| (count(found) as f64) < LEFT * all as f64).unwrap_or((found, noise))
}

/// Number of disturbances in all runs.
fn count(found: &[Found]) -> usize {
    found.iter().map(|run| run.wrong.len() + run.jumps.len()).sum()
}

/// The poses beside those by the wheels behind a filter, with clocks and agreement as they are then.
fn filtered(
    seen: &[Seen],
    (robot, agreement, reading): (&Robot, &Agreement, Reading),
    agreed: impl Fn(&[Beside]) -> Agreement,
    time_constant: f64,
) -> Vec<Vec<Sighting>> {
    let wheelbase = robot.drive.wheelbase();
    let rolled: Vec<_> = seen.iter().map(|seen| seen.rolled.filtered(time_constant)).collect();
    let earlier = |late: &Late| Late { delay: late.delay - time_constant, ..*late };
    let mut clocks: Vec<Late> = seen.iter().map(|seen| earlier(&seen.late)).collect();
    let mut agreement = *agreement;
    for _ in 0..ROUNDS {
        let runs = || seen.iter().zip(&rolled);
        let beside = runs().zip(&clocks).flat_map(|((seen, rolled), late)| clock::beside(&seen.windows, rolled, late));
        agreement = agreed(&beside.collect::<Vec<_>>());
        let refined = runs().zip(&clocks).map(|((seen, rolled), late)| {
            clock::refined(&seen.windows, rolled, late, (&agreement, reading, wheelbase))
        });
        clocks = refined.collect();
    }
    let of_run = |(seen, late)| sightings::of(seen, late, (robot, &agreement), Some(time_constant));
    seen.iter().zip(&clocks).map(of_run).collect()
}
