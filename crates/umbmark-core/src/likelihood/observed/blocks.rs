//! Observations gathered into blocks.

use super::walk::Walk;
use super::{Block, Growth};
use crate::effect::Chain;
use crate::geometry::Pose2;
use crate::replay::Track;

/// Poses measured within this way \[m\] and rotation \[rad\] are one observation: they share the noise of the wheels, and only
/// that of the reference is averaged.
pub(crate) const BLOCK: (f64, f64) = (0.03, 0.05);
/// Number of units of a run, by the distance driven.
const UNITS: f64 = 4.0;

/// Cuts the observations of a track into blocks, each for itself where they are to stand `alone`; each of `jumps` is the first of one.
pub(super) fn blocks(
    track: &Track,
    seen: &[(f64, f64, Option<f64>)],
    jumps: &[usize],
    (chain, alone): (&Chain<f64>, bool),
) -> Vec<Block> {
    let walk = Walk::new(track, chain);
    let whole = walk.way.last().copied().unwrap_or(0.0);
    let mut blocks: Vec<Block> = Vec::new();
    let mut first = 0;
    while first < seen.len() {
        let begins = track.seen_after()[first];
        let together = |made: &usize| {
            walk.way[*made] - walk.way[begins] < BLOCK.0 && walk.turned[*made] - walk.turned[begins] < BLOCK.1
        };
        let until = jumps.iter().copied().find(|jump| *jump > first).unwrap_or(seen.len());
        let count = track.seen_after()[first..until].iter().take_while(|made| !alone && together(made)).count().max(1);
        let unit = (UNITS * walk.way[begins] / whole.max(f64::MIN_POSITIVE)).min(UNITS - 1.0) as usize;
        let headings = seen[first..first + count].iter().filter(|s| s.2.is_some()).count();
        let jumped = first > 0 && jumps.contains(&first);
        blocks.push(Block {
            first,
            count,
            positions: count,
            headings,
            place: Pose2::IDENTITY,
            velocity: [0.0; 3],
            drifts: [[0.0; 3]; 2],
            wander: 0.0,
            growth: Growth::default(),
            growth_seen: Growth::default(),
            growth_of_mean: Growth::default(),
            unit,
            afresh: jumped,
            jumped,
            steps: 1.0,
            resolution: [0.0; 2],
            beside: [0.0; 3],
        });
        first += count;
    }
    blocks
}
