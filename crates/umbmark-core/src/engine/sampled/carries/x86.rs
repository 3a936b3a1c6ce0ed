//! Carry words with the comparisons of AVX2 and AVX-512.

use super::Carries;
use std::arch::x86_64::*;

/// The phases after readings 1 to 8.
fn first_eight(phase: u64, rest: u64) -> [i64; 8] {
    std::array::from_fn(|i| phase.wrapping_add(rest.wrapping_mul(i as u64 + 1)) as i64)
}

/// A word by one comparison; whoever holds one runs on a machine with AVX-512F.
pub(in crate::engine::sampled) struct Avx512Carries {
    phases: __m512i,
    step: __m512i,
    rest: __m512i,
}

impl Avx512Carries {
    /// # Safety
    /// The machine must have AVX-512F.
    #[inline(always)]
    pub unsafe fn new(phase: u64, rest: u64) -> Avx512Carries {
        let [a, b, c, d, e, f, g, h] = first_eight(phase, rest);
        // SAFETY: guaranteed by the caller.
        unsafe {
            Avx512Carries {
                phases: _mm512_setr_epi64(a, b, c, d, e, f, g, h),
                step: _mm512_set1_epi64(rest.wrapping_mul(8) as i64),
                rest: _mm512_set1_epi64(rest as i64),
            }
        }
    }
}

impl Carries for Avx512Carries {
    #[inline(always)]
    fn word(&mut self) -> u8 {
        // SAFETY: `self` exists only where the instructions do.
        unsafe {
            // A sum that wrapped is less than what was added.
            let word = _mm512_cmplt_epu64_mask(self.phases, self.rest);
            self.phases = _mm512_add_epi64(self.phases, self.step);
            word
        }
    }
}

/// A word by two comparisons of four; whoever holds one runs on a machine with AVX2.
pub(in crate::engine::sampled) struct Avx2Carries {
    phases: [__m256i; 2],
    step: __m256i,
    rest: __m256i,
}

impl Avx2Carries {
    /// # Safety
    /// The machine must have AVX2.
    #[inline(always)]
    pub unsafe fn new(phase: u64, rest: u64) -> Avx2Carries {
        // There are only signed comparisons; flipping the top bit makes them unsigned, and addition does not mind.
        let flipped = |value: i64| value ^ i64::MIN;
        let [a, b, c, d, e, f, g, h] = first_eight(phase, rest).map(flipped);
        // SAFETY: guaranteed by the caller.
        unsafe {
            Avx2Carries {
                phases: [_mm256_setr_epi64x(a, b, c, d), _mm256_setr_epi64x(e, f, g, h)],
                step: _mm256_set1_epi64x(rest.wrapping_mul(8) as i64),
                rest: _mm256_set1_epi64x(flipped(rest as i64)),
            }
        }
    }
}

impl Carries for Avx2Carries {
    #[inline(always)]
    fn word(&mut self) -> u8 {
        // SAFETY: `self` exists only where the instructions do.
        unsafe {
            let [low, high] = self.phases;
            let low_carries = _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(self.rest, low)));
            let high_carries = _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(self.rest, high)));
            self.phases = [_mm256_add_epi64(low, self.step), _mm256_add_epi64(high, self.step)];
            (low_carries | high_carries << 4) as u8
        }
    }
}
