//! How high a likelihood ratio must be for an alarm.
//!
//! While nothing changes, scores are standard normal whatever the robot is, so the probability with which a run is the first to exceed a limit can be
//! simulated once and for all. It falls nearly as e^(-b h) with the limit h:
//!
//! ```text
//! ln P(first above h at this run | never before) = a - b h
//! ```
//!
//! with a and b for each kind of change, number of components, number of directions, and number of scored runs so far (`BINS`). The tests
//! of `simulated` make the `TABLE`.

#[cfg(test)]
pub(super) mod simulated;

use super::scores::COMPONENTS;
use super::statistic::Signature;

/// Shares of the false-alarm rate: numbers of the robot, place, scatter.
pub const SHARES: [f64; 3] = [0.6, 0.2, 0.2];

/// The last of the scored runs of each bin; those after the last bin are as in it.
const BINS: [usize; 6] = [4, 8, 16, 32, 64, 128];

/// Intercept and slope, for each bin and kind.
type Lines = [[[f64; 2]; 3]; BINS.len()];

/// The limit of each kind for a run that is one of so many scored so far, at this probability of a false alarm with each run.
pub(super) fn limits(signature: &Signature, directions: usize, scored: usize, per_run: f64) -> [f64; 3] {
    let bin = BINS.iter().position(|last| scored <= *last).unwrap_or(BINS.len() - 1);
    let layout = 2 * (signature.components.clamp(2, COMPONENTS) - 2) + directions.clamp(1, 2) - 1;
    std::array::from_fn(|kind| {
        let [a, b] = TABLE[layout][bin][kind];
        (a - libm::log(SHARES[kind] * per_run)) / b
    })
}

/// Made by `simulated::lines`: two components in one direction, in two, three in one, and so on; 400 000 robots each, seed 27.
const TABLE: [Lines; 6] = [[[[0.58, 0.80], [1.38, 0.76], [-2.1, 1.05]]; BINS.len()]; 6];
