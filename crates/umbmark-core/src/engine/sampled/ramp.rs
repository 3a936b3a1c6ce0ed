//! Readings along a profile, acceleration ramps above all: the counts of all of them first, then two look-ups for each.

use super::constant_rate::PoseIncrement;
use super::directions::{Directions, sum, turned};
use super::{Profile, SampledOdometry, TickGeometry, Update};
use crate::engine::{Instructions, Motion, UNITS_PER_TICK, WheelLine};
use crate::geometry::by_width;

/// Lines whose wheels travel less than this far \[units\] have angles that are whole numbers in `f64`.
const TRAVEL_LIMIT: i64 = 1 << 52;

/// Profiles with fewer readings are done one reading after the other.
const FEWEST_READINGS: usize = 16;

/// Pose changes of readings: between rest and full speed, the same few tens of changes of the two counters repeat.
#[derive(Clone, Debug, Default)]
struct Steps {
    known: Vec<PoseIncrement>,
}

impl Steps {
    /// Changes of a counter up to this size are kept.
    const REACH: i32 = 32;
    const WIDTH: i32 = 2 * Self::REACH + 1;

    fn prepare(&mut self, geometry: &TickGeometry, update: Update) {
        if self.known.is_empty() {
            let changes = || -Self::REACH..=Self::REACH;
            let pairs = changes().flat_map(|left| changes().map(move |right| [left, right]));
            self.known = pairs.map(|change| PoseIncrement::new(geometry, update, change.map(i64::from))).collect();
        }
    }

    /// The step of a change, if it is among those kept.
    #[inline(always)]
    fn get(&self, change: [i64; 2]) -> Option<&PoseIncrement> {
        let width = i64::from(Self::WIDTH);
        let [left, right] = change.map(|ticks| ticks + i64::from(Self::REACH));
        let kept = (0..width).contains(&left) && (0..width).contains(&right);
        if kept { self.known.get((left * width + right) as usize) } else { None }
    }
}

/// Table indices for the readings of a line, computed by additions and multiplications without a dependence or branch from one reading to
/// the next.
#[derive(Clone, Debug, Default)]
struct LookUps {
    /// The (left, right) counts: 0 at the start, then one for each reading.
    counts: [Vec<i32>; 2],
    /// Places of the changes among the kept ones.
    steps: Vec<u32>,
    /// Headings before each change \[ticks\], from that of the greatest clockwise turn.
    headings: Vec<u32>,
    /// Whether a change is not among the kept ones.
    any_missing: bool,
}

impl LookUps {
    #[inline(always)]
    fn fill(&mut self, line: &WheelLine, shares: &[f64], origin: i32) {
        for (wheel, counts) in self.counts.iter_mut().enumerate() {
            counts.resize(shares.len() + 1, 0);
            fill_counts(line.start()[wheel], line.travel()[wheel], shares, &mut counts[1..]);
        }
        self.steps.resize(shares.len(), 0);
        self.headings.resize(shares.len(), 0);
        let [left, right] = self.counts.each_ref().map(Vec::as_slice);
        let (steps, headings) = (&mut self.steps[..shares.len()], &mut self.headings[..shares.len()]);
        let mut beyond = 0;
        for (i, (step, heading)) in steps.iter_mut().zip(headings).enumerate() {
            let change = [left[i + 1] - left[i] + Steps::REACH, right[i + 1] - right[i] + Steps::REACH];
            let kept = |place: i32| (place as u32) < Steps::WIDTH as u32;
            beyond |= u32::from(!(kept(change[0]) & kept(change[1])));
            *step = (change[0] * Steps::WIDTH + change[1]) as u32;
            *heading = (origin + right[i] - left[i]) as u32;
        }
        self.any_missing = beyond != 0;
    }

    fn fill_by(&mut self, instructions: Instructions, line: &WheelLine, shares: &[f64], origin: i32) {
        let look_ups = self;
        by_width!(instructions, |look_ups: &mut LookUps, line: &WheelLine, shares: &[f64], origin: i32| -> () {
            look_ups.fill(line, shares, origin)
        })
    }
}

/// The counts of one wheel where these shares of its travel are done, in `f64`: the angle there is rounded to its 53 bits,
/// 2^-11 units on a ramp of 1000 ticks. The end of the line is exact.
#[inline(always)]
fn fill_counts(start: i64, travel: i64, shares: &[f64], counts: &mut [i32]) {
    // Adding it rounds to a whole number, which then stands in the low bits.
    const ROUND: f64 = 1.5 * (1_u64 << 52) as f64;
    let (start, travel) = (start as f64, travel as f64);
    for (count, share) in counts.iter_mut().zip(shares) {
        let ticks = (start + travel * share) * (1.0 / UNITS_PER_TICK as f64);
        let nearest = (ticks + ROUND) - ROUND;
        let below = if nearest > ticks { nearest - 1.0 } else { nearest };
        *count = (below + ROUND).to_bits() as i32;
    }
}

/// Scratch memory for readings along profiles. Its content changes the time for a segment, never its result.
#[derive(Clone, Debug, Default)]
pub(super) struct Ramps {
    steps: Steps,
    look_ups: LookUps,
}

impl SampledOdometry {
    /// Readings looked up in tables of steps and directions, if changes of both counters are among the kept steps.
    fn looked_up(&mut self, line: &WheelLine, profile: &Profile) -> Option<Motion> {
        if !Directions::suit(&self.geometry, line.counts()) || line.travel().iter().any(|t| t.abs() >= TRAVEL_LIMIT) {
            return None;
        }
        self.directions.reach_to(line.counts(), &self.geometry);
        let (directions, origin) = self.directions.table();
        let LookUps { counts, steps, headings, any_missing } = {
            self.ramps.look_ups.fill_by(self.instructions, line, profile.shares(), origin as i32);
            &self.ramps.look_ups
        };
        if *any_missing {
            return None;
        }
        let known = &self.ramps.steps.known;
        let end = steps.iter().zip(headings).fold([0.0; 2], |end, (step, heading)| {
            let PoseIncrement { x, y, .. } = known[*step as usize];
            sum(end, turned(directions[*heading as usize], [x, y]))
        });
        let last = counts.each_ref().map(|counts| counts.last().map_or(0, |count| i64::from(*count)));
        Some(Motion::with_counts(end[0], end[1], last, &self.geometry))
    }

    /// The motion reported along `line` when the counters are read where a profile says.
    ///
    /// As [`with_profile`](SampledOdometry::with_profile) to within 1e-12 m, and several times faster where the two
    /// tick lengths are equal. A reading that falls on the edge of a tick, to within 2^-11 units of 2^-32 tick on a line of
    /// 1000 ticks, may find it counted or not.
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
        self.ramps.steps.prepare(&self.geometry, self.update);
        if profile.readings() >= FEWEST_READINGS
            && let Some(motion) = self.looked_up(line, profile)
        {
            return motion;
        }
        let (mut pose, mut before) = (PoseIncrement::IDENTITY, [0; 2]);
        for counts in profile.counts(line) {
            let change = [counts[0] - before[0], counts[1] - before[1]];
            if change != [0; 2] {
                pose = match self.ramps.steps.get(change) {
                    Some(step) => pose.then(step),
                    None => pose.then(&PoseIncrement::new(&self.geometry, self.update, change)),
                };
                before = counts;
            }
        }
        Motion::with_counts(pose.x, pose.y, before, &self.geometry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UPDATES: [Update; 3] = [Update::Arc, Update::Midpoint, Update::Euler];

    /// Slow starts and ends; with 40 000 ticks changes too large to be kept.
    const TRAVELS: [[f64; 2]; 7] = [
        [9000.3, 9100.7],
        [9000.3, 9000.3],
        [-1200.9, 1200.1],
        [40_000.0, 0.0],
        [-40_000.0, 39_999.9],
        [-30.5, -900.25],
        [0.0, 0.0],
    ];

    fn shares() -> Vec<f64> {
        (1..=700).map(|k| f64::from(k) / 700.0).map(|t| t * t * (3.0 - 2.0 * t)).collect()
    }

    #[test]
    fn readings_looked_up_lead_where_readings_one_by_one_lead() {
        let profile = Profile::new(shares());
        for left in [0.21e-3, 0.2e-3] {
            let geometry = TickGeometry::new(left, 0.2e-3, 0.34).unwrap();
            for update in UPDATES {
                let mut odometry = SampledOdometry::new(geometry, update);
                for travel in TRAVELS {
                    let line = WheelLine::from_ticks([0.3, 0.9], travel).unwrap();
                    let reference = odometry.with_profile(&line, shares());
                    let fast = odometry.along(&line, &profile);
                    let gap = (fast.pose.x - reference.pose.x).hypot(fast.pose.y - reference.pose.y);
                    assert!(
                        gap < 1e-12 && fast.pose.heading == reference.pose.heading,
                        "{update:?} {travel:?}: {gap:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn counts_round_down_either_way_and_the_last_is_that_of_the_line() {
        let profile = Profile::new(shares());
        for travel in TRAVELS {
            let line = WheelLine::from_ticks([0.3, 0.9], travel).unwrap();
            let mut look_ups = LookUps::default();
            look_ups.fill(&line, profile.shares(), 0);
            for (i, counts) in profile.counts(&line).enumerate() {
                assert_eq!([0, 1].map(|wheel| i64::from(look_ups.counts[wheel][i + 1])), counts, "{travel:?} {i}");
            }
            assert_eq!(look_ups.counts.each_ref().map(|counts| i64::from(counts[700])), line.counts());
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits_whatever_was_computed_before() {
        let profile = Profile::new(shares());
        let geometry = TickGeometry::new(0.2e-3, 0.2e-3, 0.34).unwrap();
        let fresh = SampledOdometry::new(geometry, Update::Arc);
        let mut used =
            [Instructions::Portable, Instructions::Avx2, Instructions::Avx512].map(|i| fresh.clone().limited_to(i));
        for travel in TRAVELS {
            let line = WheelLine::from_ticks([0.3, 0.9], travel).unwrap();
            let expected = fresh.clone().along(&line, &profile);
            for odometry in &mut used {
                assert_eq!(odometry.along(&line, &profile), expected, "{travel:?}");
            }
        }
    }
}
