//! Sine and cosine in lanes: the polynomials of the geometry, with the same operations for a pack of any width.

use super::lane::Lane;
use crate::geometry::{COSINE_SERIES as C, HALF_PI, SINC_SERIES as S};
use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_4};

/// Whether any |x| is past π/4, where the polynomials need their argument reduced.
#[inline(always)]
pub(super) fn any_large<T: Lane>(x: T) -> bool {
    T::any(x.splat(FRAC_PI_4).less(x.abs()))
}

/// (sin x / x, cos x), with sinc 0 = 1.
#[inline(always)]
pub(super) fn sinc_cos<T: Lane>(x: T) -> (T, T) {
    if any_large(x) { sinc_cos_reduced(x) } else { sinc_cos_near_zero(x) }
}

/// (sin x / x, cos x) for |x| <= π/4.
#[inline(always)]
pub(super) fn sinc_cos_near_zero<T: Lane>(x: T) -> (T, T) {
    let c = |value| x.splat(value);
    let z = x * x;
    let z2 = z * z;
    let z4 = z2 * z2;
    let sinc = (c(1.0) + z * c(S[0])) + z2 * (c(S[1]) + z * c(S[2])) + z4 * ((c(S[3]) + z * c(S[4])) + z2 * c(S[5]));
    let cosine = (c(1.0) - c(0.5) * z)
        + z2 * (c(C[0]) + z * c(C[1]))
        + z4 * ((c(C[2]) + z * c(C[3])) + z2 * (c(C[4]) + z * c(C[5])));
    (sinc, cosine)
}

/// (sin x / x, cos x) for any x: subtracts the nearest multiple of π/2 in three parts (Cody & Waite).
///
/// The absolute error grows as the spacing of the numbers around x, which is what the rounding of x itself costs.
#[inline(always)]
fn sinc_cos_reduced<T: Lane>(x: T) -> (T, T) {
    let c = |value| x.splat(value);
    let near_zero = x.abs().less(c(FRAC_PI_4.next_up()));
    let quarter_turns = T::select(near_zero, c(0.0), (x * c(FRAC_2_PI) + c(0.5)).floor());
    let rest = ((x - quarter_turns * c(HALF_PI[0])) - quarter_turns * c(HALF_PI[1])) - quarter_turns * c(HALF_PI[2]);
    let (sinc, cosine) = sinc_cos_near_zero(rest);
    let sine = sinc * rest;

    let quadrant = quarter_turns - c(4.0) * (quarter_turns * c(0.25)).floor();
    let (one, two, three) = (quadrant.equal(c(1.0)), quadrant.equal(c(2.0)), quadrant.equal(c(3.0)));
    let swapped = T::either(one, three);
    let (sine, cosine) = (T::select(swapped, cosine, sine), T::select(swapped, sine, cosine));
    let sine = T::select(T::either(two, three), c(0.0) - sine, sine);
    let cosine = T::select(T::either(one, two), c(0.0) - cosine, cosine);

    let unreduced = quarter_turns.equal(c(0.0));
    (T::select(unreduced, sinc, sine / T::select(unreduced, c(1.0), x)), cosine)
}

/// x less the nearest multiple of π, in \[-π/2, π/2\], and that multiple; x itself and 0 for |x| <= π/4.
#[inline(always)]
pub(super) fn folded_to_half_turn<T: Lane>(x: T) -> (T, T) {
    let c = |value| x.splat(value);
    let near_zero = x.abs().less(c(FRAC_PI_4.next_up()));
    let turns = T::select(near_zero, c(0.0), (x * c(FRAC_1_PI) + c(0.5)).floor());
    let halves = turns * c(2.0);
    (((x - halves * c(HALF_PI[0])) - halves * c(HALF_PI[1])) - halves * c(HALF_PI[2]), turns)
}

/// -1 where the whole number n is odd, 1 where it is even.
#[inline(always)]
pub(super) fn alternating_sign<T: Lane>(n: T) -> T {
    let half = n * n.splat(0.5);
    n.splat(1.0) - n.splat(4.0) * (half - half.floor())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Real;

    #[test]
    fn near_zero_the_bits_are_those_of_the_geometry() {
        for k in -100_000..=100_000 {
            let x = f64::from(k) * (FRAC_PI_4 / 100_000.0);
            let (sinc, cosine) = sinc_cos(x);
            let (expected_sinc, expected_cosine) = Real::sinc_cos(x);
            assert_eq!((sinc.to_bits(), cosine.to_bits()), (expected_sinc.to_bits(), expected_cosine.to_bits()), "{x}");
        }
    }

    #[test]
    fn far_from_zero_sine_and_cosine_agree_with_libm_to_the_rounding_of_the_angle() {
        for k in -300_000..300_000_i32 {
            for x in [f64::from(k) * 1.234_567e-4, f64::from(k) * 0.249_9, f64::from(k) * 997.3] {
                let (sinc, cosine) = sinc_cos(x);
                let (s, c) = libm::sincos(x);
                let tolerance = 5e-16 + f64::EPSILON * (x.abs() - 1e6).max(0.0);
                assert!((sinc * x - s).abs() <= tolerance && (cosine - c).abs() <= tolerance, "{x}");
            }
        }
    }

    #[test]
    fn folding_subtracts_whole_half_turns() {
        for k in -20_000..20_000 {
            let x = f64::from(k) * 1.3e-3;
            let (rest, turns) = folded_to_half_turn(x);
            assert!(rest.abs() <= 1.570_796_4 && (rest + turns * std::f64::consts::PI - x).abs() < 4e-15, "{x}");
            assert_eq!(turns, turns.floor());
            let sign = alternating_sign(turns);
            assert!((sign * libm::cos(rest) - libm::cos(x)).abs() < 4e-15, "{x}");
        }
    }
}
