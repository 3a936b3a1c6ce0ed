//! The scalars of the plane: `f64` for values, [`Dual`] for values with an exact derivative.

use num_dual::{Dual64, DualNum};

/// A number carrying one directional derivative; a Jacobian column is one evaluation with this type.
pub type Dual = Dual64;

/// What the geometry computes with. Implemented by `f64` and [`Dual`] only.
///
/// Trigonometry goes through [`Real::sinc_cos`], whose polynomials use only additions and multiplications: the same
/// bits on every machine, where the system's mathematics library promises none.
pub trait Real: DualNum<Primitive = f64> + Copy + Send + Sync {
    /// (sin x / x, cos x), with sinc 0 = 1; absolute error below 3e-16 for |x| up to 1e5.
    fn sinc_cos(self) -> (Self, Self);

    /// The value without its derivative.
    fn value(self) -> f64;

    /// (sin x, cos x).
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (sinc, cosine) = self.sinc_cos();
        (sinc * self, cosine)
    }

    /// e^x by `libm`, the same bits on every machine.
    fn exponential(self) -> Self;

    /// Any other function of this number, from its value and its slope here. Where this number does not change, the slope
    /// need not be finite.
    fn mapped(self, value: f64, slope: f64) -> Self;
}

impl Real for f64 {
    #[inline]
    fn sinc_cos(self) -> (f64, f64) {
        if self.abs() <= std::f64::consts::FRAC_PI_4 {
            sinc_cos_near_zero(self)
        } else {
            let (sine, cosine) = sin_cos_reduced(self);
            (sine / self, cosine)
        }
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn sine_cosine(self) -> (f64, f64) {
        if self.abs() <= std::f64::consts::FRAC_PI_4 {
            let (sinc, cosine) = sinc_cos_near_zero(self);
            (sinc * self, cosine)
        } else {
            sin_cos_reduced(self)
        }
    }

    #[inline]
    fn exponential(self) -> f64 {
        libm::exp(self)
    }

    #[inline]
    fn mapped(self, value: f64, _slope: f64) -> f64 {
        value
    }
}

impl Real for Dual {
    /// Always inlined: mostly one of the two is not wanted.
    #[inline(always)]
    fn sinc_cos(self) -> (Dual, Dual) {
        let x = self.re;
        let (sinc, cosine) = x.sinc_cos();
        // d sinc/dx = (cos x - sinc x) / x cancels near 0, where its series takes over.
        let slope = if x.abs() < 0.4 {
            let z = x * x;
            -x * (1.0 / 3.0 - z * (1.0 / 30.0 - z * (1.0 / 840.0 - z * (1.0 / 45360.0 - z / 3_991_680.0))))
        } else {
            (cosine - sinc) / x
        };
        (Dual::new(sinc, slope * self.eps), Dual::new(cosine, -sinc * x * self.eps))
    }

    #[inline]
    fn value(self) -> f64 {
        self.re
    }

    #[inline]
    fn exponential(self) -> Dual {
        let value = libm::exp(self.re);
        Dual::new(value, value * self.eps)
    }

    #[inline]
    fn mapped(self, value: f64, slope: f64) -> Dual {
        Dual::new(value, if self.eps == 0.0 { 0.0 } else { slope * self.eps })
    }
}

/// Coefficients of z, z², ... z⁶ in sinc x = 1 + ..., with z = x² and |x| <= π/4.
pub(crate) const SINC_SERIES: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// Coefficients of z², z³, ... z⁷ in cos x = 1 - z/2 + ..., with z = x² and |x| <= π/4.
pub(crate) const COSINE_SERIES: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// π/2 in three parts; a multiple of the first below 2^20 is exact.
pub(crate) const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// (sin x / x, cos x) for |x| <= π/4: minimax polynomials in x² of degree 12 and 14.
#[inline]
pub(crate) fn sinc_cos_near_zero(x: f64) -> (f64, f64) {
    const S: [f64; 6] = SINC_SERIES;
    const C: [f64; 6] = COSINE_SERIES;
    // Estrin's scheme: independent halves, short dependency chain.
    let z = x * x;
    let z2 = z * z;
    let z4 = z2 * z2;
    let sinc = (1.0 + z * S[0]) + z2 * (S[1] + z * S[2]) + z4 * ((S[3] + z * S[4]) + z2 * S[5]);
    let cosine = (1.0 - 0.5 * z) + z2 * (C[0] + z * C[1]) + z4 * ((C[2] + z * C[3]) + z2 * (C[4] + z * C[5]));
    (sinc, cosine)
}

/// (sin x, cos x) after subtracting the nearest multiple of π/2, kept in three parts (Cody & Waite); past 1e5 `libm`
/// reduces with as many digits as it takes.
#[inline]
pub(crate) fn sin_cos_reduced(x: f64) -> (f64, f64) {
    if !(x.abs() < 1e5) {
        return libm::sincos(x);
    }
    // Halves away from zero, as `round`, which without SSE 4.1 is a call of the system's library.
    let turns = x * std::f64::consts::FRAC_2_PI;
    let whole = (turns + 0.5_f64.next_down().copysign(turns)) as i64;
    let quarter_turns = whole as f64;
    let rest = ((x - quarter_turns * HALF_PI[0]) - quarter_turns * HALF_PI[1]) - quarter_turns * HALF_PI[2];
    let (sinc, cosine) = sinc_cos_near_zero(rest);
    let sine = sinc * rest;
    match whole & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::first_derivative;

    #[test]
    fn sine_and_cosine_agree_with_libm_in_every_quadrant_and_both_signs() {
        let mut worst = 0.0_f64;
        for k in -400_000..400_000 {
            for x in [f64::from(k) * 1.234_567e-5, f64::from(k) * 0.249_9] {
                let (sine, cosine) = x.sine_cosine();
                let (s, c) = libm::sincos(x);
                worst = worst.max((sine - s).abs()).max((cosine - c).abs());
            }
        }
        assert!(worst < 3e-16, "{worst:e}");
        assert!(f64::NAN.sine_cosine().0.is_nan());
    }

    #[test]
    fn sinc_is_smooth_through_zero_and_its_derivative_is_exact_on_both_sides_of_the_series() {
        assert_eq!(0.0_f64.sinc_cos(), (1.0, 1.0));
        for x in [-9.0, -0.41, -0.39, -1e-3, 0.0, 1e-9, 0.2, 0.399, 0.401, 0.78, 0.79, 3.0] {
            let (_, slope) = first_derivative(|d: Dual| d.sinc_cos().0, x);
            // Oracle: a central difference of libm's sin(x)/x in a step where its rounding is 1e-10.
            let h = 1e-4;
            let sinc = |v: f64| if v == 0.0 { 1.0 } else { libm::sin(v) / v };
            let numeric = (8.0 * (sinc(x + h) - sinc(x - h)) - (sinc(x + 2.0 * h) - sinc(x - 2.0 * h))) / (12.0 * h);
            assert!((slope - numeric).abs() < 1e-10, "{x}: {slope} {numeric}");
        }
    }
    #[test]
    fn the_exponential_is_its_power_series_and_its_own_derivative() {
        for x in [-20.0_f64, -1.5, -1e-9, 0.0, 0.3, 2.0] {
            // Oracle: the series of e^(x/64), squared six times.
            let small = x / 64.0;
            let (mut sum, mut term) = (1.0, 1.0);
            for k in 1..16 {
                term *= small / f64::from(k);
                sum += term;
            }
            let oracle = (0..6).fold(sum, |power, _| power * power);
            let (value, slope) = first_derivative(|d: Dual| d.exponential(), x);
            assert_eq!(value, x.exponential());
            assert!((value / oracle - 1.0).abs() < 1e-13 && slope == value, "{x}: {value} {oracle} {slope}");
        }
    }
}
