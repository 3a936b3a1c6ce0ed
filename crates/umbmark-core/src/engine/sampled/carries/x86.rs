//! Carry words with the comparisons of AVX2 and AVX-512.

use std::arch::x86_64::*;

/// The phases after readings 1 to 8.
fn first_eight(phase: u64, rest: u64) -> [i64; 8] {
    std::array::from_fn(|i| phase.wrapping_add(rest.wrapping_mul(i as u64 + 1)) as i64)
}

#[target_feature(enable = "avx512f")]
pub(super) fn carry_words_of_eight(phase: u64, rest: u64, words: &mut [u8]) {
    let [a, b, c, d, e, f, g, h] = first_eight(phase, rest);
    let mut phases = _mm512_setr_epi64(a, b, c, d, e, f, g, h);
    let step = _mm512_set1_epi64(rest.wrapping_mul(8) as i64);
    let rest = _mm512_set1_epi64(rest as i64);
    for word in words {
        // A sum that wrapped is less than what was added.
        *word = _mm512_cmplt_epu64_mask(phases, rest);
        phases = _mm512_add_epi64(phases, step);
    }
}

#[target_feature(enable = "avx2")]
pub(super) fn carry_words_of_four(phase: u64, rest: u64, words: &mut [u8]) {
    // There are only signed comparisons; flipping the top bit makes them unsigned, and addition does not mind.
    let flipped = |value: i64| value ^ i64::MIN;
    let [a, b, c, d, e, f, g, h] = first_eight(phase, rest).map(flipped);
    let mut low = _mm256_setr_epi64x(a, b, c, d);
    let mut high = _mm256_setr_epi64x(e, f, g, h);
    let step = _mm256_set1_epi64x(rest.wrapping_mul(8) as i64);
    let rest = _mm256_set1_epi64x(flipped(rest as i64));
    for word in words {
        let low_carries = _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(rest, low)));
        let high_carries = _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(rest, high)));
        *word = (low_carries | high_carries << 4) as u8;
        low = _mm256_add_epi64(low, step);
        high = _mm256_add_epi64(high, step);
    }
}
