//! At which readings a wheel's count changes by the larger of its two values.

use crate::engine::Instructions;

#[cfg(target_arch = "x86_64")]
mod x86;

/// Readings per word.
pub(super) const WORD: u32 = u8::BITS;

/// Carry words: bit i of `words[w]` is whether `phase + (8 w + i + 1) rest` wraps past 2^64 at that addition.
///
/// Whole numbers, so every instruction set gives the same words.
pub(super) fn carry_words(instructions: Instructions, phase: u64, rest: u64, words: &mut [u8]) {
    #[cfg(target_arch = "x86_64")]
    match instructions {
        // SAFETY: `instructions` is never more than what the machine was found to have.
        Instructions::Avx512 => return unsafe { x86::carry_words_of_eight(phase, rest, words) },
        // SAFETY: as above.
        Instructions::Avx2 => return unsafe { x86::carry_words_of_four(phase, rest, words) },
        Instructions::Portable => {}
    }
    let _ = instructions;
    let mut phase = phase;
    for word in words {
        *word = (0..WORD).fold(0, |bits, i| {
            let carry;
            (phase, carry) = phase.overflowing_add(rest);
            bits | u8::from(carry) << i
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::random_lines::Source;

    #[test]
    fn every_instruction_set_finds_the_same_carries() {
        let mut source = Source(21);
        for i in 0..2_000 {
            let rest = match i % 4 {
                0 => source.bits() >> (i % 60),
                1 => 0,
                2 => !(source.bits() >> (i % 60)),
                _ => source.bits(),
            };
            let phase = source.bits();
            let mut portable = vec![0; i % 37];
            carry_words(Instructions::Portable, phase, rest, &mut portable);
            for instructions in [Instructions::Avx2, Instructions::Avx512].map(|set| set.min(Instructions::best())) {
                let mut words = vec![0xff; portable.len()];
                carry_words(instructions, phase, rest, &mut words);
                assert_eq!(words, portable, "{instructions:?} {phase} {rest}");
            }
        }
    }

    #[test]
    fn a_carry_is_a_tick_more() {
        // Three eighths of a tick per reading, from one eighth.
        let eighth = 1_u64 << 61;
        let mut words = [0; 2];
        carry_words(Instructions::Portable, eighth, 3 * eighth, &mut words);
        // After eight readings the phase is 25 eighths: readings 3, 5 and 8 passed a whole tick.
        assert_eq!(words[0], 1 << 2 | 1 << 4 | 1 << 7);
    }
}
