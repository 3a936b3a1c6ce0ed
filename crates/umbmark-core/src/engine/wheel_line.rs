//! A segment in the plane of the two wheel angles.

use super::EngineError;
use crate::drive::Wheel;

/// Fixed-point units per encoder tick: 2^32, a resolution of 5e-14 m on a robot with 0.24 mm ticks.
pub const UNITS_PER_TICK: i64 = 1 << 32;

/// The longest travel of one wheel in one segment \[ticks\], either way.
pub const MAX_TICKS: i64 = 1 << 30;

const MAX_TRAVEL: i64 = MAX_TICKS * UNITS_PER_TICK;

/// A motion with a constant ratio of wheel speeds: the straight line `start + λ travel`, 0 <= λ <= 1, in the plane of the
/// (left, right) wheel angles, both in units of 2^-32 tick ([`UNITS_PER_TICK`]).
///
/// A wheel's counter reads floor(angle), so a tick is the crossing of a grid line of that plane. `start` is the phase of each encoder, 0 <=
/// start < 2^32: the position of the wheel within its current tick. Positive travel is forward. How the speed varies along the line does
/// not matter to the order of the ticks.
///
/// Angles are integers, so the phases of a chain of segments follow each other without rounding:
///
/// ```
/// # use umbmark_core::engine::WheelLine;
/// let there = WheelLine::from_ticks([0.25, 0.75], [10.5, -3.0])?;
/// assert_eq!(there.counts(), [10, -3]);
/// let back = there.followed_by([-there.travel()[0], -there.travel()[1]])?;
/// assert_eq!(back.end_phases(), there.start());
/// # Ok::<(), umbmark_core::engine::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WheelLine {
    start: [i64; 2],
    travel: [i64; 2],
}

impl WheelLine {
    /// A line from phases and travels (left, right) in units of 2^-32 tick.
    ///
    /// # Errors
    /// [`EngineError::Phase`] unless 0 <= start < 2^32, [`EngineError::Travel`] for more than 2^30 ticks either way.
    #[inline]
    pub fn new(start: [i64; 2], travel: [i64; 2]) -> Result<WheelLine, EngineError> {
        let ticks = |units: i64| units as f64 / UNITS_PER_TICK as f64;
        for (i, wheel) in Wheel::BOTH.into_iter().enumerate() {
            if !(0..UNITS_PER_TICK).contains(&start[i]) {
                return Err(EngineError::Phase { wheel, value: ticks(start[i]) });
            }
            if !(-MAX_TRAVEL..=MAX_TRAVEL).contains(&travel[i]) {
                return Err(EngineError::Travel { wheel, value: ticks(travel[i]) });
            }
        }
        Ok(WheelLine { start, travel })
    }

    /// A line from phases in \[0, 1) and travels \[ticks\], rounded to the nearest unit; a phase that would round up to a
    /// whole tick stays below it.
    ///
    /// # Errors
    /// As [`WheelLine::new`]; NaN and infinities included.
    #[inline]
    pub fn from_ticks(start: [f64; 2], travel: [f64; 2]) -> Result<WheelLine, EngineError> {
        for (i, wheel) in Wheel::BOTH.into_iter().enumerate() {
            if !(0.0..1.0).contains(&start[i]) {
                return Err(EngineError::Phase { wheel, value: start[i] });
            }
        }
        let phase = |ticks: f64| nearest_unit(ticks).min(UNITS_PER_TICK - 1);
        WheelLine { start: start.map(phase), travel: [0; 2] }.with_travel(travel)
    }

    /// The line that starts where this one ends, with the given travel in units of 2^-32 tick.
    ///
    /// # Errors
    /// [`EngineError::Travel`] for more than 2^30 ticks either way.
    #[inline]
    pub fn followed_by(&self, travel: [i64; 2]) -> Result<WheelLine, EngineError> {
        WheelLine::new(self.end_phases(), travel)
    }

    /// The line that starts where this one ends, with the given travel \[ticks\], rounded to the nearest unit.
    ///
    /// # Errors
    /// [`EngineError::Travel`] for NaN and for more than 2^30 ticks either way.
    #[inline]
    pub fn followed_by_ticks(&self, travel: [f64; 2]) -> Result<WheelLine, EngineError> {
        WheelLine { start: self.end_phases(), travel: [0; 2] }.with_travel(travel)
    }

    #[inline]
    fn with_travel(self, travel: [f64; 2]) -> Result<WheelLine, EngineError> {
        for (i, wheel) in Wheel::BOTH.into_iter().enumerate() {
            if !(-(MAX_TICKS as f64)..=MAX_TICKS as f64).contains(&travel[i]) {
                return Err(EngineError::Travel { wheel, value: travel[i] });
            }
        }
        Ok(WheelLine { start: self.start, travel: travel.map(nearest_unit) })
    }

    /// Encoder phases (left, right) at the start, each in \[0, 2^32).
    #[inline]
    pub fn start(&self) -> [i64; 2] {
        self.start
    }

    /// Wheel travels (left, right) in units of 2^-32 tick, forward positive.
    #[inline]
    pub fn travel(&self) -> [i64; 2] {
        self.travel
    }

    /// Encoder phases (left, right) at the end, each in \[0, 2^32): the start of whatever follows.
    #[inline]
    pub fn end_phases(&self) -> [i64; 2] {
        [0, 1].map(|i| (self.start[i] + self.travel[i]) & (UNITS_PER_TICK - 1))
    }

    /// By how much each counter (left, right) changed: floor(end) - floor(start), negative for a backward wheel.
    #[inline]
    pub fn counts(&self) -> [i64; 2] {
        [0, 1].map(|i| (self.start[i] + self.travel[i]) >> 32)
    }

    /// Whether each wheel (left, right) turns backward.
    #[inline]
    pub fn backward(&self) -> [bool; 2] {
        self.travel.map(|travel| travel < 0)
    }

    /// The same line with backward wheels mirrored, so that both travels are forward.
    ///
    /// The counter of a backward wheel ticks just below a grid line, that of a forward wheel on it; mirroring at -1/2 unit
    /// (u -> 2^32 - 1 - u) maps the one to the other exactly.
    #[inline]
    pub(super) fn mirrored_forward(&self) -> WheelLine {
        let mut line = *self;
        for i in 0..2 {
            if line.travel[i] < 0 {
                line.start[i] = UNITS_PER_TICK - 1 - line.start[i];
                line.travel[i] = -line.travel[i];
            }
        }
        line
    }
}

impl AsRef<WheelLine> for WheelLine {
    fn as_ref(&self) -> &WheelLine {
        self
    }
}

/// `ticks` in units, halves away from zero. Exact: the scaling is by a power of two.
#[inline]
fn nearest_unit(ticks: f64) -> i64 {
    let units = ticks * UNITS_PER_TICK as f64;
    let whole = units as i64;
    let rest = units - whole as f64;
    whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_floor_in_both_directions() {
        let line = |start, travel| WheelLine::from_ticks([start, 0.0], [travel, 0.0]).unwrap();
        assert_eq!(line(0.0, 1.0).counts()[0], 1);
        assert_eq!(line(0.0, -1e-9).counts()[0], -1);
        assert_eq!(line(0.5, -0.5).counts()[0], 0);
        assert_eq!(line(0.5, -0.6).counts()[0], -1);
        assert_eq!(line(0.9, 0.05).counts()[0], 0);
        assert_eq!(line(0.9, -2.95).counts()[0], -3);
    }

    #[test]
    fn travels_are_rounded_to_the_nearest_unit() {
        let unit = 1.0 / UNITS_PER_TICK as f64;
        for (units, expected) in [(0.4, 0), (0.5, 1), (-0.5, -1), (-1.4, -1), (1.6, 2), (1e9 + 0.25, 1_000_000_000)] {
            assert_eq!(nearest_unit(units * unit), expected, "{units}");
        }
        assert_eq!(nearest_unit((MAX_TICKS - 1) as f64), (MAX_TICKS - 1) << 32);
        let line = WheelLine::from_ticks([1.0 - 1e-12, 0.0], [MAX_TICKS as f64, -(MAX_TICKS as f64)]).unwrap();
        assert_eq!((line.start()[0], line.travel()[1]), (UNITS_PER_TICK - 1, -MAX_TRAVEL));
        assert_eq!(line.counts(), [MAX_TICKS, -MAX_TICKS]);
    }

    #[test]
    fn phases_outside_a_tick_and_travels_out_of_range_are_refused() {
        for bad in [-1e-9, 1.0, f64::NAN, f64::INFINITY] {
            let error = WheelLine::from_ticks([0.0, bad], [1.0, 1.0]).unwrap_err();
            assert!(matches!(error, EngineError::Phase { wheel: Wheel::Right, .. }), "{error}");
        }
        for bad in [1.1e9, -1.1e9, f64::NAN, f64::NEG_INFINITY] {
            let error = WheelLine::from_ticks([0.0, 0.0], [bad, 1.0]).unwrap_err();
            assert!(matches!(error, EngineError::Travel { wheel: Wheel::Left, .. }), "{error}");
            assert!(WheelLine::default().followed_by_ticks([0.0, bad]).is_err());
        }
        assert!(WheelLine::new([UNITS_PER_TICK, 0], [0, 0]).is_err());
        assert!(WheelLine::new([0, -1], [0, 0]).is_err());
        assert!(WheelLine::new([0, 0], [MAX_TRAVEL + 1, 0]).is_err());
        assert!(WheelLine::new([0, 0], [0, i64::MIN]).is_err());
    }
}
