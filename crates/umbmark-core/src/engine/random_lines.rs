//! Wheel lines of every kind, for tests.

use super::{UNITS_PER_TICK, WheelLine};

/// SplitMix64 (Steele, Lea & Flood 2014): enough randomness for tests, the same on every machine.
pub(super) struct Source(pub u64);

impl Source {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Below `bound`.
    pub fn below(&mut self, bound: i64) -> i64 {
        (self.bits() % bound as u64) as i64
    }

    /// In \[0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn phase(&mut self) -> i64 {
        match self.below(4) {
            0 => 0,
            1 => UNITS_PER_TICK / (1 + self.below(8)) - 1,
            2 => (self.below(5) - 2) & (UNITS_PER_TICK - 1),
            _ => self.below(UNITS_PER_TICK),
        }
    }

    fn sign(&mut self) -> i64 {
        1 - 2 * self.below(2)
    }

    /// A line of at most about `ticks` ticks per wheel: equal speeds, rational and nearly rational ratios, steep and flat
    /// ones, still wheels, fractions of a tick, lattice points missed by units; all four pairs of directions, phases on
    /// and off the grid.
    pub fn line(&mut self, ticks: i64) -> WheelLine {
        let whole = UNITS_PER_TICK;
        let any = |source: &mut Source| source.below(ticks * whole);
        let [left, right] = match self.below(10) {
            0 => [any(self), any(self)],
            1 => [any(self); 2],
            2 => {
                let unit = self.below(ticks * whole / 8);
                [unit / 5 * self.below(40), unit / 5 * self.below(40)]
            }
            3 => {
                let (p, q) = (1 + self.below(6), 1 + self.below(6));
                let length = self.below(ticks) / 6 * whole;
                [length / q * q, length / q * p]
            }
            4 => {
                let left = any(self);
                [left, left + self.below(2 * whole) - whole]
            }
            5 => [any(self), self.below(3) * self.below(whole)],
            6 => [self.below(2) * self.below(whole), any(self)],
            7 => [self.below(4 * whole), self.below(4 * whole)],
            8 => {
                let (length, ratio) = (self.below(ticks) / 4 * whole, 1 + self.below(4));
                [length + self.below(5), (length * ratio + self.below(5) - 2).max(0)]
            }
            _ => [self.below(ticks) * whole, self.below(ticks) * whole],
        };
        let start = [self.phase(), self.phase()];
        let start = if self.below(4) == 0 { [start[0]; 2] } else { start };
        WheelLine::new(start, [self.sign() * left, self.sign() * right]).expect("a line within range")
    }
}

/// Number of cases of a test: `UMBMARK_TEST_CASES` if set, otherwise `default`.
pub(super) fn cases(default: usize) -> usize {
    std::env::var("UMBMARK_TEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(default)
}
