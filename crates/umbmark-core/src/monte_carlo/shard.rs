//! A share of a study's trials, for one of several machines.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::CHUNK;

/// The i-th of k shards of a study, i from 1.
///
/// ```
/// use umbmark_core::monte_carlo::Shard;
/// let third: Shard = "3/16".parse()?;
/// assert_eq!(third.to_string(), "3/16");
/// assert!("17/16".parse::<Shard>().is_err());
/// # Ok::<(), umbmark_core::monte_carlo::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    index: u64,
    count: u64,
}

/// No shard.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("a shard is I/K with 1 <= I <= K <= {}, as in 3/16; got {given}", Shard::MAX_COUNT)]
pub struct ShardError {
    given: String,
}

impl Shard {
    /// All of a study.
    pub const WHOLE: Shard = Shard { index: 0, count: 1 };

    /// The most shards of a study.
    pub const MAX_COUNT: u64 = 1_000_000;

    /// Shard `index`, from 0, of `count`.
    pub fn new(index: u64, count: u64) -> Result<Shard, ShardError> {
        if index < count && count <= Shard::MAX_COUNT {
            Ok(Shard { index, count })
        } else {
            Err(ShardError { given: format!("{}/{count}", index.saturating_add(1)) })
        }
    }

    /// Which it is, from 0.
    pub(super) fn index(&self) -> u64 {
        self.index
    }

    /// How many there are.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Its trials of a study of `all` trials: whole chunks, as equal as they can be.
    pub fn trials(&self, all: u64) -> Range<u64> {
        let chunks = all.div_ceil(CHUNK);
        let edge = |i: u64| {
            let chunk = (u128::from(chunks) * u128::from(i) / u128::from(self.count)) as u64;
            chunk.saturating_mul(CHUNK).min(all)
        };
        edge(self.index)..edge(self.index + 1)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.count)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Shard, ShardError> {
        let wrong = || ShardError { given: text.to_owned() };
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let (index, count): (u64, u64) = (index.parse().map_err(|_| wrong())?, count.parse().map_err(|_| wrong())?);
        Shard::new(index.checked_sub(1).ok_or_else(wrong)?, count).map_err(|_| wrong())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_trials_out_without_gap_or_overlap() {
        for (all, count) in [(1, 1), (1, 3), (1000, 7), (1_000_000, 16), (256, 2)] {
            let mut next = 0;
            for index in 0..count {
                let trials = Shard::new(index, count).unwrap().trials(all);
                assert_eq!(trials.start, next);
                next = trials.end;
            }
            assert_eq!(next, all);
        }
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for text in ["0/3", "4/3", "1", "a/b", "1/0", "-1/3", ""] {
            assert!(text.parse::<Shard>().unwrap_err().to_string().ends_with(&format!("got {text}")));
        }
    }
}
