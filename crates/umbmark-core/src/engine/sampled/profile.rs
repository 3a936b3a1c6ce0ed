//! Readings at given shares of the travel, the same for segment after segment: acceleration ramps.

use crate::engine::{UNITS_PER_TICK, WheelLine};

/// Where along a segment's travel the counters are read.
///
/// Shares are kept in whole 2^-53rds, so that the share 1 is exactly the end of the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    shares: Vec<f64>,
}

const ONE: f64 = (1_u64 << 53) as f64;

impl Profile {
    /// A profile from the shares of the travel that are done at each reading, each clamped to \[0, 1\] (NaN to 0).
    ///
    /// For a speed v(t) they are the integral of v up to each instant over the whole integral. What happens after the last
    /// reading is not reported, so the last share should be 1.
    pub fn new(shares: impl IntoIterator<Item = f64>) -> Profile {
        // The cast takes NaN to 0.
        let whole = |share: f64| (share.clamp(0.0, 1.0) * ONE) as i64;
        Profile { shares: shares.into_iter().map(|share| whole(share) as f64 / ONE).collect() }
    }

    /// How many readings there are.
    pub fn readings(&self) -> usize {
        self.shares.len()
    }

    /// The shares.
    #[inline]
    pub(super) fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// The (left, right) counts at every reading along `line`, from \[0, 0\] at its start.
    #[inline]
    pub(super) fn counts<'a>(&'a self, line: &WheelLine) -> impl Iterator<Item = [i64; 2]> + 'a {
        let (start, travel) = (line.start(), line.travel());
        self.shares.iter().map(move |share| {
            [0, 1].map(|wheel| {
                let done = (i128::from(travel[wheel]) * i128::from((share * ONE) as i64)) >> 53;
                (start[wheel] + done as i64).div_euclid(UNITS_PER_TICK)
            })
        })
    }
}
