//! How to look for missing effects.

use crate::dataset::Dataset;
use crate::evidence::Level;

/// How to look for missing effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Family-wise false-alarm rate of all tests together: the probability that a complete model is rejected.
    pub size: f64,
    /// Number of simulated tests for p-values without a closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Whether to use return poses alone, even where the runs were observed on the way.
    pub ends_only: bool,
    /// Which of the significant laws is added first if no effect of the catalogue explains the repeating pattern: 1 for the one that would
    /// be taken, 2 for the first of its [`Repeated::others`](super::Repeated::others), and so on.
    pub law: usize,
    /// Whether to work out which experiments would separate what return poses do not: half of the work.
    pub experiments: bool,
}

impl Default for Options {
    /// 5 %, 999 draws, seed 1, the first law, with experiments.
    fn default() -> Self {
        Options { size: 0.05, draws: 999, seed: 1, ends_only: false, law: 1, experiments: true }
    }
}

impl Options {
    /// The level of a dataset that is used.
    pub fn level(&self, data: &Dataset) -> Level {
        if self.ends_only { Level::Ends } else { Level::of(data) }
    }
}
