//! Sine and cosine in lanes: the polynomials of the geometry, with the same operations for a pack of any width.

use super::lane::Lane;
use crate::geometry::{COSINE_SERIES as C, HALF_PI, SINC_SERIES as S};
use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_4};

/// Where the polynomials end.
pub(super) const LARGE: f64 = FRAC_PI_4;

/// Whether any |x| is past π/4, where the polynomials need their argument reduced.
#[inline(always)]
pub(super) fn any_large<T: Lane>(x: T) -> bool {
    T::any(x.splat(LARGE).less(x.abs()))
}

/// (sin x / x, cos x), with sinc 0 = 1.
#[inline(always)]
pub(super) fn sinc_cos<T: Lane>(x: T) -> (T, T) {
    if any_large(x) { sinc_cos_reduced(x) } else { sinc_cos_near_zero(x) }
}

/// a + b z.
#[inline(always)]
fn linear<T: Lane>(z: T, a: f64, b: f64) -> T {
    z.splat(a) + z * z.splat(b)
}

/// (sin x / x, cos x) for |x| <= π/4.
#[inline(always)]
pub(super) fn sinc_cos_near_zero<T: Lane>(x: T) -> (T, T) {
    let z = x * x;
    let z2 = z * z;
    let z4 = z2 * z2;
    let sinc = linear(z, 1.0, S[0]) + z2 * linear(z, S[1], S[2]) + z4 * (linear(z, S[3], S[4]) + z2 * z.splat(S[5]));
    let cosine =
        linear(z, 1.0, -0.5) + z2 * linear(z, C[0], C[1]) + z4 * (linear(z, C[2], C[3]) + z2 * linear(z, C[4], C[5]));
    (sinc, cosine)
}

/// The whole number nearest to x / period, 0 for |x| <= π/4.
#[inline(always)]
fn whole_periods<T: Lane>(x: T, inverse_period: f64) -> T {
    let near_zero = x.abs().less(x.splat(LARGE.next_up()));
    T::select(near_zero, x.splat(0.0), (x * x.splat(inverse_period) + x.splat(0.5)).floor())
}

/// x - n π/2 for a whole number n, with π/2 in three parts (Cody & Waite).
#[inline(always)]
fn less_quarter_turns<T: Lane>(x: T, n: T) -> T {
    ((x - n * x.splat(HALF_PI[0])) - n * x.splat(HALF_PI[1])) - n * x.splat(HALF_PI[2])
}

/// (sin x / x, cos x) for any x.
///
/// The absolute error grows as the spacing of the numbers around x, which is what the rounding of x itself costs.
#[inline(always)]
fn sinc_cos_reduced<T: Lane>(x: T) -> (T, T) {
    let (zero, one) = (x.splat(0.0), x.splat(1.0));
    let quarter_turns = whole_periods(x, FRAC_2_PI);
    let rest = less_quarter_turns(x, quarter_turns);
    let (sinc, cosine) = sinc_cos_near_zero(rest);
    let sine = sinc * rest;

    let quadrant = quarter_turns - x.splat(4.0) * (quarter_turns * x.splat(0.25)).floor();
    let (first, second, third) = (quadrant.equal(one), quadrant.equal(x.splat(2.0)), quadrant.equal(x.splat(3.0)));
    let swapped = T::either(first, third);
    let (sine, cosine) = (T::select(swapped, cosine, sine), T::select(swapped, sine, cosine));
    let sine = T::select(T::either(second, third), zero - sine, sine);
    let cosine = T::select(T::either(first, second), zero - cosine, cosine);

    let unreduced = quarter_turns.equal(zero);
    (T::select(unreduced, sinc, sine / T::select(unreduced, one, x)), cosine)
}

/// x less the nearest multiple of π, in \[-π/2, π/2\], and that multiple; x itself and 0 for |x| <= π/4.
#[inline(always)]
pub(super) fn folded_to_half_turn<T: Lane>(x: T) -> (T, T) {
    let half_turns = whole_periods(x, FRAC_1_PI);
    (less_quarter_turns(x, half_turns * x.splat(2.0)), half_turns)
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
