//! Whether other runs have large differences at the same place, too.

use super::edges::Sighting;

/// A jump is no accident if other runs have one at the same place, within this distance \[m\], more often than chance at this level.
const SAME_PLACE: (f64, f64) = (0.15, 1e-4);

/// Where each run has large differences.
pub(super) struct Shared {
    /// Distance by the wheels at these places, run by run.
    large: Vec<Vec<f64>>,
    /// Probability that a run has one at a given place by chance.
    chance: f64,
}

impl Shared {
    /// `large`: the large differences of each run, of any kind.
    pub fn new(runs: &[Vec<Sighting>], large: Vec<Vec<f64>>) -> Shared {
        let way: f64 = runs.iter().filter_map(|run| run.last()).map(|last| last.rolled).sum();
        let all: usize = large.iter().map(Vec::len).sum();
        Shared { large, chance: (all as f64 * 2.0 * SAME_PLACE.0 / way.max(SAME_PLACE.0)).min(1.0) }
    }

    /// Whether more of the other runs have one at this place than expected by chance.
    pub fn stands_elsewhere(&self, run: usize, rolled: f64) -> bool {
        let others = self.large.iter().enumerate().filter(|(other, _)| *other != run);
        let there = others.filter(|(_, own)| own.iter().any(|at| (at - rolled).abs() <= SAME_PLACE.0)).count();
        let n = self.large.len().saturating_sub(1);
        there > 0 && at_least(there, n, self.chance) < SAME_PLACE.1.max(0.5 * self.chance.powi(n as i32))
    }
}

/// Probability of a given number or more of n, each with probability p.
fn at_least(count: usize, n: usize, p: f64) -> f64 {
    if p >= 1.0 {
        return 1.0;
    }
    let mut term = (1.0 - p).powi(n as i32);
    let mut below = 0.0;
    for k in 0..count {
        below += term;
        term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
    }
    (1.0 - below).max(0.0)
}
