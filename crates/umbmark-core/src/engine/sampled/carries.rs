//! At which readings a wheel's count changes by the larger of its two values.

#[cfg(target_arch = "x86_64")]
pub(super) mod x86;

/// Readings per word.
pub(super) const WORD: u32 = u8::BITS;

/// Carry words, one after the other: bit i of word w is whether `phase + (8 w + i + 1) rest` wraps past 2^64 at that addition.
///
/// Whole numbers, so every instruction set gives the same words.
pub(super) trait Carries {
    /// The next word.
    fn word(&mut self) -> u8;
}

/// Carry by carry.
pub(super) struct OneByOne {
    phase: u64,
    rest: u64,
}

impl OneByOne {
    pub fn new(phase: u64, rest: u64) -> OneByOne {
        OneByOne { phase, rest }
    }
}

impl Carries for OneByOne {
    #[inline(always)]
    fn word(&mut self) -> u8 {
        (0..WORD).fold(0, |bits, i| {
            let carry;
            (self.phase, carry) = self.phase.overflowing_add(self.rest);
            bits | u8::from(carry) << i
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn every_instruction_set_finds_the_same_carries() {
        use crate::engine::Instructions;
        use crate::engine::random_lines::Source;
        let mut source = Source(21);
        for i in 0..2_000 {
            let rest = match i % 4 {
                0 => source.bits() >> (i % 60),
                1 => 0,
                2 => !(source.bits() >> (i % 60)),
                _ => source.bits(),
            };
            let phase = source.bits();
            let words = |carries: &mut dyn Carries| (0..i % 37).map(|_| carries.word()).collect::<Vec<u8>>();
            let portable = words(&mut OneByOne::new(phase, rest));
            // SAFETY: asked only of what the machine was found to have.
            unsafe {
                if Instructions::best() >= Instructions::Avx2 {
                    assert_eq!(words(&mut x86::Avx2Carries::new(phase, rest)), portable, "{phase} {rest}");
                }
                if Instructions::best() >= Instructions::Avx512 {
                    assert_eq!(words(&mut x86::Avx512Carries::new(phase, rest)), portable, "{phase} {rest}");
                }
            }
        }
    }

    #[test]
    fn a_carry_is_a_tick_more() {
        // Three eighths of a tick per reading, from one eighth.
        let eighth = 1_u64 << 61;
        // After eight readings the phase is 25 eighths: readings 3, 5 and 8 passed a whole tick.
        assert_eq!(OneByOne::new(eighth, 3 * eighth).word(), 1 << 2 | 1 << 4 | 1 << 7);
    }
}
