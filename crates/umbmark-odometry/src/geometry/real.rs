//! The scalars of the plane: `f64` for values, [`Dual`] for values with exact derivatives.

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// How many derivatives a [`Dual`] carries.
pub const LANES: usize = 8;

/// A number carrying derivatives in several directions at once; so many columns of a Jacobian are one evaluation with this type.
///
/// Value, trigonometry and branches are shared by all directions, and each direction's derivative is computed as if it were alone.
///
/// ```
/// use umbmark_odometry::geometry::{Dual, Real};
/// // By x in the first lane, by y in the second.
/// let product = Dual::by_itself(2.0, 0) * Dual::by_itself(3.0, 1);
/// assert_eq!((product.re, product.eps[0], product.eps[1]), (6.0, 3.0, 2.0));
/// assert_eq!(Dual::from(5.0).recip().eps[0], 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
// The derivatives fill a line of the cache: none is stored into two of them.
#[repr(C, align(64))]
pub struct Dual {
    /// Its derivatives.
    pub eps: [f64; LANES],
    /// The value.
    pub re: f64,
}

/// What the geometry computes with. Implemented by `f64` and [`Dual`] only.
///
/// Trigonometry goes through [`Real::sinc_cos`], whose polynomials use only additions and multiplications: the same
/// bits on every machine, where the system's mathematics library promises none.
pub trait Real:
    Copy
    + core::fmt::Debug
    + PartialEq
    + Send
    + Sync
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign<f64>
    + SubAssign<f64>
    + MulAssign<f64>
    + DivAssign<f64>
{
    /// (sin x / x, cos x), with sinc 0 = 1; absolute error below 3e-16 for |x| up to 1e5.
    fn sinc_cos(self) -> (Self, Self);

    /// The value without its derivatives.
    fn value(self) -> f64;

    /// 1/x.
    fn recip(self) -> Self;

    /// (sin x, cos x).
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (sinc, cosine) = self.sinc_cos();
        (sinc * self, cosine)
    }

    /// e^x by `libm`, the same bits on every machine.
    fn exponential(self) -> Self;

    /// Whether it is several numbers side by side, so that wide registers are worth while.
    const WIDE: bool;

    /// Any other function of this number, from its value and its slope here. Where this number does not change, the slope
    /// need not be finite.
    fn mapped(self, value: f64, slope: f64) -> Self;
}

impl Real for f64 {
    const WIDE: bool = false;

    #[inline]
    fn sinc_cos(self) -> (f64, f64) {
        if self.abs() <= core::f64::consts::FRAC_PI_4 {
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
    fn recip(self) -> f64 {
        1.0 / self
    }

    #[inline]
    fn sine_cosine(self) -> (f64, f64) {
        if self.abs() <= core::f64::consts::FRAC_PI_4 {
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

impl Dual {
    /// A number that carries its derivative by itself in this lane.
    ///
    /// # Panics
    /// Where there is no such lane.
    pub fn by_itself(re: f64, lane: usize) -> Dual {
        let mut number = Dual::from(re);
        number.eps[lane] = 1.0;
        number
    }

    /// A number with this value, and this of each derivative.
    #[inline(always)]
    fn with(self, re: f64, eps: impl Fn(f64) -> f64) -> Dual {
        Dual { re, eps: self.eps.map(eps) }
    }

    /// A number with this value, and this of each pair of derivatives.
    #[inline(always)]
    fn joined(self, other: Dual, re: f64, eps: impl Fn(f64, f64) -> f64) -> Dual {
        Dual { re, eps: core::array::from_fn(|lane| eps(self.eps[lane], other.eps[lane])) }
    }
}

impl From<f64> for Dual {
    #[inline]
    fn from(re: f64) -> Dual {
        Dual { re, eps: [0.0; LANES] }
    }
}

impl Neg for Dual {
    type Output = Dual;

    #[inline]
    fn neg(self) -> Dual {
        self.with(-self.re, |e| -e)
    }
}

impl Add for Dual {
    type Output = Dual;

    #[inline]
    fn add(self, other: Dual) -> Dual {
        self.joined(other, self.re + other.re, |e, o| e + o)
    }
}

impl Sub for Dual {
    type Output = Dual;

    #[inline]
    fn sub(self, other: Dual) -> Dual {
        self.joined(other, self.re - other.re, |e, o| e - o)
    }
}

impl Mul for Dual {
    type Output = Dual;

    #[inline]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products is a sum")]
    fn mul(self, other: Dual) -> Dual {
        self.joined(other, self.re * other.re, |e, o| e * other.re + o * self.re)
    }
}

impl Div for Dual {
    type Output = Dual;

    #[inline]
    fn div(self, other: Dual) -> Dual {
        let inverse = 1.0 / other.re;
        self.joined(other, self.re * inverse, |e, o| (e * other.re - o * self.re) * inverse * inverse)
    }
}

impl Add<f64> for Dual {
    type Output = Dual;

    #[inline]
    fn add(self, other: f64) -> Dual {
        Dual { re: self.re + other, ..self }
    }
}

impl Sub<f64> for Dual {
    type Output = Dual;

    #[inline]
    fn sub(self, other: f64) -> Dual {
        Dual { re: self.re - other, ..self }
    }
}

impl Mul<f64> for Dual {
    type Output = Dual;

    #[inline]
    fn mul(self, other: f64) -> Dual {
        self.with(self.re * other, |e| e * other)
    }
}

impl Div<f64> for Dual {
    type Output = Dual;

    #[inline]
    fn div(self, other: f64) -> Dual {
        self.with(self.re / other, |e| e / other)
    }
}

macro_rules! assign {
    ($assign:ident, $method:ident, $operator:tt, $($other:ty),*) => {$(
        impl $assign<$other> for Dual {
            #[inline]
            fn $method(&mut self, other: $other) {
                *self = *self $operator other;
            }
        }
    )*};
}

assign!(AddAssign, add_assign, +, Dual, f64);
assign!(SubAssign, sub_assign, -, Dual, f64);
assign!(MulAssign, mul_assign, *, Dual, f64);
assign!(DivAssign, div_assign, /, Dual, f64);

impl Real for Dual {
    const WIDE: bool = true;

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
        let fall = -sinc * x;
        (self.with(sinc, |e| slope * e), self.with(cosine, |e| fall * e))
    }

    #[inline]
    fn value(self) -> f64 {
        self.re
    }

    #[inline]
    fn recip(self) -> Dual {
        let value = 1.0 / self.re;
        let slope = -value * value;
        self.with(value, |e| slope * e)
    }

    #[inline]
    fn exponential(self) -> Dual {
        let value = libm::exp(self.re);
        self.with(value, |e| value * e)
    }

    #[inline]
    fn mapped(self, value: f64, slope: f64) -> Dual {
        self.with(value, |e| if e == 0.0 { 0.0 } else { slope * e })
    }
}

/// The angle of (x, y) from the x axis \[rad\], in (-π, π]: atan2 by `libm`, with its exact derivative.
#[inline]
pub fn direction<T: Real>(y: T, x: T) -> T {
    let (across, along) = (y.value(), x.value());
    // The second term is 0, and its derivative that of the angle.
    (y * along - x * across) / (along * along + across * across) + libm::atan2(across, along)
}

/// Coefficients of z, z², ... z⁶ in sinc x = 1 + ..., with z = x² and |x| <= π/4.
pub const SINC_SERIES: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// Coefficients of z², z³, ... z⁷ in cos x = 1 - z/2 + ..., with z = x² and |x| <= π/4.
pub const COSINE_SERIES: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// π/2 in three parts; a multiple of the first below 2^20 is exact.
pub const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// (sin x / x, cos x) for |x| <= π/4: minimax polynomials in x² of degree 12 and 14.
#[inline]
pub fn sinc_cos_near_zero(x: f64) -> (f64, f64) {
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
pub fn sin_cos_reduced(x: f64) -> (f64, f64) {
    if !(x.abs() < 1e5) {
        return libm::sincos(x);
    }
    // Halves away from zero, as `round`, which without SSE 4.1 is a call of the system's library.
    let turns = x * core::f64::consts::FRAC_2_PI;
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
    use num_dual::{Dual64, DualNum};

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
            let slope = Dual::by_itself(x, 0).sinc_cos().0.eps[0];
            // Oracle: a central difference of libm's sin(x)/x in a step where its rounding is 1e-10.
            let h = 1e-4;
            let sinc = |v: f64| if v == 0.0 { 1.0 } else { libm::sin(v) / v };
            let numeric = (8.0 * (sinc(x + h) - sinc(x - h)) - (sinc(x + 2.0 * h) - sinc(x - 2.0 * h))) / (12.0 * h);
            assert!((slope - numeric).abs() < 1e-10, "{x}: {slope} {numeric}");
        }
    }

    #[test]
    fn a_direction_has_the_value_of_libm_and_the_derivative_of_differences_all_round() {
        for k in 0..24 {
            let (sine, cosine) = libm::sincos(f64::from(k) * 0.27 - 3.1);
            let (x, y) = (2.0 * cosine, 2.0 * sine);
            assert_eq!(direction(y, x), libm::atan2(y, x));
            let own = |re: f64, eps: f64| Dual { re, eps: [eps; LANES] };
            let exact = direction(own(y, 0.3), own(x, -0.7));
            let h = 1e-6;
            let numeric = (libm::atan2(y + 0.3 * h, x - 0.7 * h) - libm::atan2(y - 0.3 * h, x + 0.7 * h)) / (2.0 * h);
            assert!((exact.eps[0] - numeric).abs() < 1e-8 && exact.re == libm::atan2(y, x), "{k}: {exact:?} {numeric}");
        }
    }

    /// Oracle: num-dual's number with one derivative. 1000 pairs of numbers, a derivative of its own in each lane.
    #[test]
    fn each_lane_has_the_bits_of_a_number_with_that_derivative_alone() {
        // Knuth's linear congruential generator; its upper bits, between -2 and 2.
        let mut state = 4_u64;
        let mut drawn = || {
            let mut number = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 * 0.5_f64.powi(51) - 2.0
            };
            Dual { re: number(), eps: core::array::from_fn(|_| number()) }
        };
        for _ in 0..1000 {
            let (a, b, c) = (drawn(), drawn(), drawn().re);
            let own = [-a, a + b, a - b, a * b, a / b, a + c, a - c, a * c, a / c, a.recip(), a.exponential()];
            for lane in 0..LANES {
                let [x, y] = [a, b].map(|d| Dual64::new(d.re, d.eps[lane]));
                let exponential = Dual64::new(libm::exp(x.re), libm::exp(x.re) * x.eps);
                let alone = [-x, x + y, x - y, x * y, x / y, x + c, x - c, x * c, x / c, x.recip(), exponential];
                for (operation, (own, alone)) in own.iter().zip(alone).enumerate() {
                    assert_eq!((own.re, own.eps[lane]), (alone.re, alone.eps), "{operation}: {x} {y} {c}");
                }
                let (own, system) = (a.sine_cosine(), x.sin_cos());
                for (own, system) in [(own.0, system.0), (own.1, system.1)] {
                    assert!((own.eps[lane] - system.eps).abs() < 1e-12 * (1.0 + system.eps.abs()), "{x}");
                }
            }
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
            let grown = Dual::by_itself(x, 0).exponential();
            let (value, slope) = (grown.re, grown.eps[0]);
            assert_eq!(value, x.exponential());
            assert!((value / oracle - 1.0).abs() < 1e-13 && slope == value, "{x}: {value} {oracle} {slope}");
        }
    }
}
