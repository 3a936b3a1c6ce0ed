//! Incremental wheel encoders and their counters.

use super::DriveError;
use crate::parameter::Parameter;

pub use umbmark_odometry::gearing::{MAX_COUNTER_BITS, roll_over};

/// How the counters of a log are wired to the wheels: which is in which column, and which way it counts.
///
/// Columns are as the file names them; first each counts its own way, then they are exchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wiring {
    /// The first column is the second counter, and the second is the first.
    pub exchanged: bool,
    /// Whether the first column, and the second, counts down when the robot drives forward.
    pub backward: [bool; 2],
}

impl Wiring {
    /// What the drive's own counters show, for what stands in the columns of a log.
    pub fn counters<T: std::ops::Neg<Output = T>>(&self, mut columns: [Vec<T>; 2]) -> [Vec<T>; 2] {
        self.turn(&mut columns);
        if self.exchanged {
            columns.reverse();
        }
        columns
    }

    /// What stands in the columns of a log, for what the drive's own counters show.
    pub fn columns<T: std::ops::Neg<Output = T>>(&self, mut counters: [Vec<T>; 2]) -> [Vec<T>; 2] {
        if self.exchanged {
            counters.reverse();
        }
        self.turn(&mut counters);
        counters
    }

    fn turn<T: std::ops::Neg<Output = T>>(&self, columns: &mut [Vec<T>; 2]) {
        for (column, backward) in columns.iter_mut().zip(self.backward) {
            if backward {
                *column = std::mem::take(column).into_iter().map(|count| -count).collect();
            }
        }
    }
}

/// The encoders of a robot's wheels.
///
/// A wheel at angle u \[ticks\] shows the count floor(u): resolution and phase of the quantisation. The counts are looked
/// at `rate` times a second, or at every tick where no rate is given. A counter of n bits shows the count modulo 2^n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    ticks_per_revolution: f64,
    rate: Option<f64>,
    counter_bits: Option<u32>,
    wiring: Wiring,
}

impl Encoder {
    /// Ticks per wheel revolution.
    pub const TICKS: Parameter = Parameter::shape(
        "ticks_per_revolution",
        "ticks-per-revolution",
        "",
        2000.0,
        (1.0, 1e9),
        "counts per wheel revolution, after gearing and quadrature",
    );

    /// How often the counts are looked at, where that is not at every tick.
    pub const RATE: Parameter = Parameter::shape(
        "encoder_rate_hz",
        "encoder-rate",
        "Hz",
        100.0,
        (1e-3, 1e6),
        "how often the counters are read",
    );

    /// Width of a counter.
    pub const BITS: Parameter = Parameter::count(
        "counter_bits",
        "",
        16.0,
        (1.0, MAX_COUNTER_BITS as f64),
        "width of a counter that rolls over",
    );

    /// Encoders from ticks per wheel revolution (after gearing and quadrature; need not be whole), sampling rate \[Hz\]
    /// (`None`: every tick is seen) and counter width (`None`: never rolls over).
    pub fn new(ticks_per_revolution: f64, rate: Option<f64>, counter_bits: Option<u32>) -> Result<Self, DriveError> {
        Encoder { ticks_per_revolution, rate, counter_bits, wiring: Wiring::default() }.checked()
    }

    fn checked(self) -> Result<Self, DriveError> {
        Self::TICKS.check(self.ticks_per_revolution)?;
        self.rate.map(|rate| Self::RATE.check(rate)).transpose()?;
        self.counter_bits.map(|bits| Self::BITS.check(f64::from(bits))).transpose()?;
        Ok(self)
    }

    /// The same encoders, looked at so often \[Hz\]; at every tick for `None`.
    pub fn with_rate(self, rate: Option<f64>) -> Result<Self, DriveError> {
        Encoder { rate, ..self }.checked()
    }

    /// One of its numbers, by its name in files; `None` for a number of something else. An encoder may have no rate.
    pub(super) fn number(&self, name: &str) -> Option<Option<f64>> {
        match name {
            _ if name == Self::TICKS.name => Some(Some(self.ticks_per_revolution)),
            _ if name == Self::RATE.name => Some(self.rate),
            _ => None,
        }
    }

    /// The encoder with another value of one of its numbers, by its name in files; `None` for a number of something else.
    pub(super) fn with(&self, name: &str, value: f64) -> Result<Option<Self>, DriveError> {
        let changed = match name {
            _ if name == Self::TICKS.name => Encoder { ticks_per_revolution: value, ..*self },
            _ if name == Self::RATE.name => Encoder { rate: Some(value), ..*self },
            _ => return Ok(None),
        };
        changed.checked().map(Some)
    }

    /// The same encoders, whose logs are wired as said.
    #[must_use]
    pub fn wired(self, wiring: Wiring) -> Self {
        Encoder { wiring, ..self }
    }

    /// The same encoders, with counters that never roll over.
    #[must_use]
    pub fn without_roll_over(self) -> Self {
        Encoder { counter_bits: None, ..self }
    }

    /// How the columns of a log are wired to the counters.
    pub fn wiring(&self) -> Wiring {
        self.wiring
    }

    /// Ticks per wheel revolution.
    pub fn ticks_per_revolution(&self) -> f64 {
        self.ticks_per_revolution
    }

    /// Sampling rate \[Hz\]; `None` where every tick is seen.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Width of the counter \[bit\]; `None` where it never rolls over.
    pub fn counter_bits(&self) -> Option<u32> {
        self.counter_bits
    }

    /// The reading of the counter at an unbounded `count`: modulo 2^n, in [0, 2^n).
    pub fn reading(&self, count: i64) -> i64 {
        match self.counter_bits {
            Some(bits) => count & ((1 << bits) - 1),
            None => count,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rolled_counter_unrolls_to_the_motion_that_made_it_both_ways_and_over_many_rolls() {
        for bits in [4u32, 8, 16, 32, 62] {
            let encoder = Encoder::new(2000.0, None, Some(bits)).unwrap();
            let step = (1i64 << (bits - 1)) - 1;
            for direction in [-1, 1] {
                let (mut count, mut unrolled) = (3i64, 3i64);
                for _ in 0..50 {
                    let before = encoder.reading(count);
                    count = count.wrapping_add(direction * step / 2);
                    unrolled = unrolled.wrapping_add(roll_over(before, encoder.reading(count), bits));
                    assert_eq!(unrolled, count);
                }
            }
        }
    }

    #[test]
    fn columns_are_the_counters_as_they_are_wired_and_back() {
        let columns = [vec![1.0, 2.0], vec![10.0, 20.0]];
        let wired = |exchanged, backward| Wiring { exchanged, backward };
        assert_eq!(wired(false, [false; 2]).counters(columns.clone()), columns);
        assert_eq!(wired(true, [false; 2]).counters(columns.clone()), [vec![10.0, 20.0], vec![1.0, 2.0]]);
        assert_eq!(wired(true, [true, false]).counters(columns.clone()), [vec![10.0, 20.0], vec![-1.0, -2.0]]);
        for k in 0..8 {
            let wiring = wired(k & 1 != 0, [k & 2 != 0, k & 4 != 0]);
            assert_eq!(wiring.columns(wiring.counters(columns.clone())), columns, "{wiring:?}");
        }
    }

    #[test]
    fn impossible_encoders_are_refused() {
        assert!(Encoder::new(0.0, None, None).is_err());
        assert!(Encoder::new(2000.0, Some(-5.0), None).is_err());
        assert!(Encoder::new(2000.0, None, Some(0)).is_err());
        assert!(Encoder::new(2000.0, None, Some(63)).is_err());
    }
}
