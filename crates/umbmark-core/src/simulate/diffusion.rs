//! White wheel noise along a stretch of driving, as one normal draw of its end pose.

use crate::effect::WheelVariance;
use crate::geometry::{Displacement2, Real, sinc_cos_near_zero};
use crate::random::Stream;

/// The distribution of the end pose of a constant-twist stretch whose wheels roll with white noise.
///
/// With forward distance v, rotation ω and wheelbase b, a slip dη of a wheel at share t of the stretch moves the end by
///
/// g(t) = (e^(iωt)/2 ± (i/b) ∫_t^1 v e^(iωu) du, ±1/b)   (+ right wheel, - left wheel),
///
/// so that the end pose has covariance Σ_w var_w ∫ g gᵀ dt: exact to first order in the noise. To second order its mean moves by -½ v s² ∫
/// t e^(iωt) dt + (i/2) c ∫ e^(iωt) dt, with heading variance s² = Σ_w var_w/b² and the covariance c = (var_R - var_L)/(2b) of heading and
/// forward noise (midpoint convention, the limit of ever finer arcs). The scatter of the second-order term is neglected; for the paper's
/// leg it is 5 % of the standard deviation of the forward scatter.
///
/// All in the frame of the stretch's start. Source: covariances of Chong & Kleeman (1997) and Kelly (2004), in one form
/// for every arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffusion {
    mean: [f64; 2],
    /// Lower triangle of the Cholesky factor for (x, y, heading), by rows.
    factor: [f64; 6],
}

/// What the integrals over a stretch of rotation ω have in common, h = ω/2: smooth and even in ω, so that nothing is
/// divided by a rotation.
struct Integrals {
    /// sinc h
    sinc: f64,
    /// cos h
    cosine: f64,
    /// (sinc h - cos h) / ω²
    lag: f64,
    /// (1/2 - 3/2 sinc ω + cos² h) / ω⁴
    bow: f64,
    /// (1 - sinc ω) / 2ω²
    swing: f64,
}

/// Rotations up to which the integrals use their series; beyond this the closed forms lose less than two digits.
const SERIES_REACH: f64 = 2.0;

/// Terms of the series: the first omitted one is below 1e-17 of the sum for every rotation in range.
const TERMS: usize = 12;

/// Coefficients of ω^2k in the three integrals, k from 0.
const SERIES: [[f64; 3]; TERMS] = {
    let mut series = [[0.0; 3]; TERMS];
    // (2k + 3)!, 4^k and the sign of the term.
    let (mut factorial, mut power, mut sign) = (6.0, 1.0, 1.0);
    let mut k = 0;
    while k < TERMS {
        let n = k as f64;
        let next = (2.0 * n + 4.0) * (2.0 * n + 5.0);
        series[k] = [
            sign * (2.0 * n + 2.0) / (4.0 * factorial * power),
            sign * (n + 1.0) / (factorial * next),
            sign / (2.0 * factorial),
        ];
        factorial *= next;
        power *= 4.0;
        sign = -sign;
        k += 1;
    }
    series
};

impl Integrals {
    /// For any rotation ω.
    #[inline]
    fn new(rotation: f64) -> Integrals {
        let (sinc, cosine) = (0.5 * rotation).sinc_cos();
        if rotation.abs() <= SERIES_REACH {
            return Integrals::from_series(rotation, (sinc, cosine));
        }
        let (z, whole_sinc) = (rotation * rotation, sinc * cosine);
        let bow = (0.5 - 1.5 * whole_sinc + cosine * cosine) / (z * z);
        Integrals { sinc, cosine, lag: (sinc - cosine) / z, bow, swing: 0.5 * (1.0 - whole_sinc) / z }
    }

    /// The same for |ω| <= π/2, without a branch.
    #[inline(always)]
    fn of_small_turn(rotation: f64) -> Integrals {
        Integrals::from_series(rotation, sinc_cos_near_zero(0.5 * rotation))
    }

    #[inline(always)]
    fn from_series(rotation: f64, (sinc, cosine): (f64, f64)) -> Integrals {
        let z = rotation * rotation;
        let (mut lag, mut bow, mut swing) = (0.0, 0.0, 0.0);
        for [a, b, c] in SERIES.iter().rev() {
            (lag, bow, swing) = (lag * z + a, bow * z + b, swing * z + c);
        }
        Integrals { sinc, cosine, lag, bow, swing }
    }
}

/// What [`Diffusion::scatter`] is made of.
#[inline(always)]
pub fn normals(stream: &mut Stream) -> [f64; 3] {
    [stream.normal(), stream.normal(), stream.normal()]
}

impl Diffusion {
    /// The distribution for a stretch of true motion `motion` with wheel variances `variance`; `rotation_per_metre` is the
    /// rotation \[rad/m\] that a metre of difference between the wheels makes, 1/b.
    #[inline]
    pub fn new(motion: &Displacement2, variance: &WheelVariance, rotation_per_metre: f64) -> Diffusion {
        Diffusion::from_moments(moments(motion, variance, rotation_per_metre, &Integrals::new(motion.rotation)))
    }

    /// The same bits for rotations of a quarter turn or less, without a branch.
    #[inline(always)]
    pub fn of_small_turn(motion: &Displacement2, variance: &WheelVariance, rotation_per_metre: f64) -> Diffusion {
        let integrals = Integrals::of_small_turn(motion.rotation);
        Diffusion::from_moments(moments(motion, variance, rotation_per_metre, &integrals))
    }

    #[inline(always)]
    fn from_moments((mean, covariance): ([f64; 2], [f64; 6])) -> Diffusion {
        Diffusion { mean, factor: cholesky(covariance) }
    }

    /// How the noise moves the end of a stretch, seen from its start: (x, y) \[m\] and heading \[rad\], from three
    /// independent standard normal draws.
    #[inline(always)]
    pub fn scatter(&self, z: [f64; 3]) -> [f64; 3] {
        let f = &self.factor;
        [self.mean[0] + f[0] * z[0], self.mean[1] + f[1] * z[0] + f[2] * z[1], f[3] * z[0] + f[4] * z[1] + f[5] * z[2]]
    }
}

/// Mean (x, y) and lower triangle of the covariance of (x, y, heading), by rows; arguments as of [`Diffusion::new`], and
/// the integrals of the rotation.
///
/// Seen from the heading halfway, a stretch looks the same from either end: half of the integrals vanish, the others are
/// closed forms. Turned by half the rotation they are those seen from the start.
#[inline(always)]
fn moments(
    motion: &Displacement2,
    variance: &WheelVariance,
    rotation_per_metre: f64,
    integrals: &Integrals,
) -> ([f64; 2], [f64; 6]) {
    let (v, w, inverse_b) = (motion.forward, motion.rotation, rotation_per_metre);
    let (sum, difference) = (variance.right + variance.left, variance.right - variance.left);
    let Integrals { sinc, cosine, lag, bow, swing } = *integrals;
    let sine = sinc * (0.5 * w);
    let per_metre = v * inverse_b;
    let (along, lean) = (sum * per_metre, difference * per_metre);

    let x_x = sum * (0.125 * (1.0 + sinc * cosine)) + along * per_metre * (w * w * bow) - lean * (w * swing);
    let x_y = 0.25 * lean * sinc * sinc - 0.5 * along * per_metre * (sinc * w * lag);
    let y_y = sum * (0.25 * w * w * swing) + along * per_metre * (0.25 * sinc * sinc + swing) - lean * (w * swing);
    let x_h = inverse_b * (0.5 * difference * sinc - along * (w * lag));
    let y_h = inverse_b * (0.5 * along * sinc);
    let h_h = sum * inverse_b * inverse_b;

    let shortening = -0.5 * v * h_h;
    let mean = [0.5 * shortening * sinc, shortening * w * lag + 0.25 * difference * inverse_b * sinc];
    let turned = |[x, y]: [f64; 2]| [cosine * x - sine * y, sine * x + cosine * y];
    let (c_c, c_s, s_s) = (cosine * cosine, cosine * sine, sine * sine);
    let [x_h, y_h] = turned([x_h, y_h]);
    let covariance = [
        c_c * x_x - 2.0 * c_s * x_y + s_s * y_y,
        c_s * (x_x - y_y) + (c_c - s_s) * x_y,
        s_s * x_x + 2.0 * c_s * x_y + c_c * y_y,
        x_h,
        y_h,
        h_h,
    ];
    (turned(mean), covariance)
}

/// Lower Cholesky factor of a 3 x 3 covariance given and returned as its lower triangle by rows; a direction without
/// variance gets a zero column.
#[inline(always)]
fn cholesky(c: [f64; 6]) -> [f64; 6] {
    let root = |pivot: f64, size: f64| if pivot > 1e-14 * size { pivot.sqrt() } else { 0.0 };
    let over = |numerator: f64, root: f64| if root > 0.0 { numerator / root } else { 0.0 };
    let l00 = root(c[0], c[0]);
    let (l10, l20) = (over(c[1], l00), over(c[3], l00));
    let l11 = root(c[2] - l10 * l10, c[2]);
    let l21 = over(c[4] - l20 * l10, l11);
    let l22 = root(c[5] - l20 * l20 - l21 * l21, c[5]);
    [l00, l10, l11, l20, l21, l22]
}

#[cfg(test)]
mod tests;
