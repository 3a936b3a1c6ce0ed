//! Incremental wheel encoders and their counters.

use super::{DriveError, positive};

/// The widest counter that is unrolled.
pub const MAX_COUNTER_BITS: u32 = 62;

/// The encoders of a robot's wheels.
///
/// A wheel at angle u \[ticks\] shows the count floor(u): resolution and phase of the quantisation. The counts are looked
/// at `rate` times a second, or at every tick where no rate is given. A counter of n bits shows the count modulo 2^n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    ticks_per_revolution: f64,
    rate: Option<f64>,
    counter_bits: Option<u32>,
}

impl Encoder {
    /// Encoders from ticks per wheel revolution (after gearing and quadrature; need not be whole), sampling rate \[Hz\]
    /// (`None`: every tick is seen) and counter width (`None`: never rolls over).
    pub fn new(ticks_per_revolution: f64, rate: Option<f64>, counter_bits: Option<u32>) -> Result<Self, DriveError> {
        positive("ticks per revolution", ticks_per_revolution, "ticks")?;
        if let Some(rate) = rate {
            positive("encoder rate", rate, "Hz")?;
        }
        match counter_bits {
            Some(bits) if !(1..=MAX_COUNTER_BITS).contains(&bits) => Err(DriveError::CounterBits(bits)),
            _ => Ok(Encoder { ticks_per_revolution, rate, counter_bits }),
        }
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

/// The change between two readings of a counter of `bits` bits, taken as the shorter way round: in [-2^(n-1), 2^(n-1)).
///
/// Right as long as a wheel moves less than half the counter's range between readings. Readings may be signed or
/// unsigned; only their difference modulo 2^n counts.
///
/// ```
/// # use umbmark_core::drive::roll_over;
/// assert_eq!(roll_over(65533, 394, 16), 397);
/// assert_eq!(roll_over(169, 65410, 16), -295);
/// ```
pub fn roll_over(before: i64, after: i64, bits: u32) -> i64 {
    let unused = 64 - bits;
    (after.wrapping_sub(before) << unused) >> unused
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
    fn impossible_encoders_are_refused() {
        assert!(Encoder::new(0.0, None, None).is_err());
        assert!(Encoder::new(2000.0, Some(-5.0), None).is_err());
        assert!(Encoder::new(2000.0, None, Some(0)).is_err());
        assert!(Encoder::new(2000.0, None, Some(63)).is_err());
    }
}
