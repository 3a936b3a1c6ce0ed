//! Readings at given shares of the travel, the same for segment after segment: acceleration ramps.

use super::constant_rate::Step;
use super::{SampledOdometry, TickGeometry, Update};
use crate::engine::{Motion, UNITS_PER_TICK, WheelLine};

/// Where along a segment's travel the counters are read.
///
/// Shares are kept in whole 2^-53rds, so that the share 1 is exactly the end of the line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    shares: Vec<i64>,
}

impl Profile {
    /// A profile from the shares of the travel that are done at each reading, each clamped to \[0, 1\] (NaN to 0).
    ///
    /// For a speed v(t) they are the integral of v up to each instant over the whole integral. What happens after the last
    /// reading is not reported, so the last share should be 1.
    pub fn new(shares: impl IntoIterator<Item = f64>) -> Profile {
        const ONE: f64 = (1_u64 << 53) as f64;
        // The cast takes NaN to 0.
        Profile { shares: shares.into_iter().map(|share| (share.clamp(0.0, 1.0) * ONE) as i64).collect() }
    }

    /// How many readings there are.
    pub fn readings(&self) -> usize {
        self.shares.len()
    }

    /// The (left, right) counts at every reading along `line`, from \[0, 0\] at its start.
    #[inline]
    pub(super) fn counts<'a>(&'a self, line: &WheelLine) -> impl Iterator<Item = [i64; 2]> + 'a {
        let (start, travel) = (line.start(), line.travel());
        self.shares.iter().map(move |share| {
            [0, 1].map(|wheel| {
                let done = (i128::from(travel[wheel]) * i128::from(*share)) >> 53;
                (start[wheel] + done as i64).div_euclid(UNITS_PER_TICK)
            })
        })
    }
}

/// What readings do to the pose, worked out when they are first met: from rest to full speed, a few tens of changes of the
/// two counters come again and again.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    known: Vec<Option<Step>>,
}

impl Steps {
    /// Changes of a counter up to this size are kept.
    const REACH: i64 = 32;
    const WIDTH: i64 = 2 * Self::REACH + 1;

    #[inline]
    fn of(&mut self, geometry: &TickGeometry, update: Update, change: [i64; 2]) -> Step {
        if change.iter().any(|ticks| ticks.abs() > Self::REACH) {
            return Step::new(geometry, update, change);
        }
        if self.known.is_empty() {
            self.known = vec![None; (Self::WIDTH * Self::WIDTH) as usize];
        }
        let place = (change[0] + Self::REACH) * Self::WIDTH + change[1] + Self::REACH;
        *self.known[place as usize].get_or_insert_with(|| Step::new(geometry, update, change))
    }
}

impl SampledOdometry {
    /// The motion reported along `line` when the counters are read where a profile says.
    ///
    /// As [`with_profile`](SampledOdometry::with_profile) to within 1e-12 m, and several times faster.
    ///
    /// ```
    /// use umbmark_core::engine::{Profile, SampledOdometry, TickGeometry, Update, WheelLine};
    /// let mut odometry = SampledOdometry::new(TickGeometry::new(1e-3, 1e-3, 0.34)?, Update::Arc);
    /// let line = WheelLine::from_ticks([0.0, 0.0], [500.0, 520.0])?;
    /// let ramp = Profile::new((1..=50).map(|k| f64::from(k * k) / 2500.0));
    /// assert!((odometry.along(&line, &ramp).pose.heading - 0.02 / 0.34).abs() < 1e-15);
    /// # Ok::<(), umbmark_core::engine::EngineError>(())
    /// ```
    pub fn along(&mut self, line: &WheelLine, profile: &Profile) -> Motion {
        let (mut pose, mut before) = (Step::IDENTITY, [0; 2]);
        for counts in profile.counts(line) {
            let change = [counts[0] - before[0], counts[1] - before[1]];
            if change != [0; 2] {
                pose = pose.then(&self.steps.of(&self.geometry, self.update, change));
                before = counts;
            }
        }
        Motion::with_counts(pose.x, pose.y, before, &self.geometry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_worked_out_once_lead_where_readings_one_by_one_lead() {
        let geometry = TickGeometry::new(0.21e-3, 0.2e-3, 0.34).unwrap();
        let shares: Vec<f64> = (1..=700).map(|k| f64::from(k) / 700.0).map(|t| t * t * (3.0 - 2.0 * t)).collect();
        let profile = Profile::new(shares.iter().copied());
        for update in [Update::Arc, Update::Midpoint, Update::Euler] {
            let mut odometry = SampledOdometry::new(geometry, update);
            for travel in [[9000.3, 9100.7], [-1200.9, 1200.1], [40_000.0, 0.0], [-30.5, -900.25], [0.0, 0.0]] {
                let line = WheelLine::from_ticks([0.3, 0.9], travel).unwrap();
                let reference = odometry.with_profile(&line, shares.iter().copied());
                let fast = odometry.along(&line, &profile);
                let gap = (fast.pose.x - reference.pose.x).hypot(fast.pose.y - reference.pose.y);
                assert!(gap < 1e-12 && fast.pose.heading == reference.pose.heading, "{update:?} {travel:?}: {gap:e}");
            }
        }
    }
}
