//! Intervals, and quantiles of the usual distributions (thin over `statrs`).

pub(crate) mod robust;

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};
use statrs::function::{beta::beta_reg, gamma::ln_gamma};

/// A closed interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

impl Interval {
    /// `centre` ± `half_width`.
    pub fn around(centre: f64, half_width: f64) -> Interval {
        Interval { low: centre - half_width, high: centre + half_width }
    }

    /// Whether `value` lies in it.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Both ends times a positive number.
    pub fn scaled(&self, factor: f64) -> Interval {
        Interval { low: self.low * factor, high: self.high * factor }
    }
}

/// A quantity with its standard error and its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Measured {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Its 95 % interval.
    pub interval: Interval,
}

impl Measured {
    /// A value with the standard error of `parts` independent ones.
    pub(crate) fn of_parts(value: f64, std_error: f64, parts: usize) -> Measured {
        let half = student_t_quantile(0.975, parts.max(2) as f64 - 1.0) * std_error;
        Measured { value, std_error, interval: Interval::around(value, half) }
    }

    /// The quantity less a number that is known.
    pub(crate) fn less(&self, known: f64) -> Measured {
        let Interval { low, high } = self.interval;
        let interval = Interval { low: low - known, high: high - known };
        Measured { value: self.value - known, interval, ..*self }
    }

    /// Whether it is farther from zero than so many standard errors.
    pub fn is_beyond(&self, std_errors: f64) -> bool {
        self.value.abs() > std_errors * self.std_error
    }
}

/// The median, between the two middle ones where there are even many; `None` for no values.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

/// The value that Student's t with `degrees_of_freedom` stays below with `probability`.
///
/// NaN for a probability outside (0, 1) or degrees of freedom that are not positive; with infinitely many it is the normal quantile.
///
/// ```
/// # use umbmark_core::stats::student_t_quantile;
/// assert!((student_t_quantile(0.975, 8.0) - 2.306_004_135).abs() < 1e-8);
/// ```
pub fn student_t_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom == f64::INFINITY {
        return normal_quantile(probability);
    }
    quantile(StudentsT::new(0.0, 1.0, degrees_of_freedom), probability)
}

/// The value that chi-squared with `degrees_of_freedom` stays below with `probability`.
///
/// NaN for a probability outside (0, 1) or degrees of freedom that are not positive.
pub fn chi_squared_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    quantile(ChiSquared::new(degrees_of_freedom), probability)
}

/// The value that a standard normal draw stays below with `probability`; NaN for one outside (0, 1).
pub fn normal_quantile(probability: f64) -> f64 {
    quantile(Normal::new(0.0, 1.0), probability)
}

/// The probability that a standard normal draw stays below `value`.
pub fn standard_normal_share(value: f64) -> f64 {
    0.5 * libm::erfc(-value * std::f64::consts::FRAC_1_SQRT_2)
}

/// The value that F with these degrees of freedom stays below with `probability`; NaN for one outside (0, 1).
pub fn f_quantile(probability: f64, degrees_of_freedom: [f64; 2]) -> f64 {
    quantile(FisherSnedecor::new(degrees_of_freedom[0], degrees_of_freedom[1]), probability)
}

/// The probability that F with these degrees of freedom exceeds `f`.
///
/// NaN for degrees of freedom that are not positive, or an F that is no number.
///
/// ```
/// # use umbmark_core::stats::f_upper_tail;
/// assert!((f_upper_tail(3.112_250, [4.0, 14.0]) - 0.05).abs() < 1e-6);
/// ```
pub fn f_upper_tail(f: f64, degrees_of_freedom: [f64; 2]) -> f64 {
    match FisherSnedecor::new(degrees_of_freedom[0], degrees_of_freedom[1]) {
        Ok(_) if f == f64::INFINITY => 0.0,
        Ok(distribution) if !f.is_nan() => distribution.sf(f),
        _ => f64::NAN,
    }
}

/// Natural logarithm of [`f_upper_tail`], also where that is below every number.
///
/// There the tail is I_x(ν/2, n/2) with x = ν/(ν + n f), by its series x^a (1 - x)^b Σ ((a + b)_k/(a + 1)_k) x^k / (a B(a, b)).
///
/// Source: Abramowitz & Stegun, 26.5.4 and 26.6.2.
pub(crate) fn ln_f_upper_tail(f: f64, degrees_of_freedom: [f64; 2]) -> f64 {
    let tail = f_upper_tail(f, degrees_of_freedom);
    if tail > f64::MIN_POSITIVE || !f.is_finite() {
        return libm::log(tail);
    }
    let [n, nu] = degrees_of_freedom;
    let (a, b, x) = (0.5 * nu, 0.5 * n, nu / (nu + n * f));
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while term > f64::EPSILON * sum {
        term *= (a + b + k) / (a + 1.0 + k) * x;
        sum += term;
        k += 1.0;
    }
    let ln_beta = libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
    a * libm::log(x) + b * libm::log1p(-x) + libm::log(sum) - libm::log(a) - ln_beta
}

/// The probability that F with these degrees of freedom \[a, b\] and this non-centrality λ exceeds `f`: the power of a test.
///
/// A mixture over Poisson numbers j with mean λ/2 of the probabilities that Beta(a/2 + j, b/2) exceeds a f/(a f + b). NaN for degrees of freedom that are not positive, or a negative
/// λ or f.
///
/// ```
/// # use umbmark_core::stats::noncentral_f_upper_tail;
/// // scipy.stats.ncf.sf(5.317655, 1, 8, 10.507)
/// assert!((noncentral_f_upper_tail(5.317_655, [1.0, 8.0], 10.507) - 0.809_635_4).abs() < 1e-6);
/// ```
pub fn noncentral_f_upper_tail(f: f64, [a, b]: [f64; 2], noncentrality: f64) -> f64 {
    let finite = [a, b, noncentrality].iter().all(|x| x.is_finite());
    if !(finite && a > 0.0 && b > 0.0 && noncentrality >= 0.0 && f >= 0.0) {
        return f64::NAN;
    }
    if noncentrality == 0.0 {
        return f_upper_tail(f, [a, b]);
    }
    let (mean, below) = (0.5 * noncentrality, b / (a * f + b));
    let term = |j: f64| {
        let weight = libm::exp(j * libm::log(mean) - ln_gamma(j + 1.0) - mean);
        weight * beta_reg(0.5 * b, 0.5 * a + j, below)
    };
    // Poisson probabilities beyond so many standard deviations add nothing.
    let reach = 10.0 + 10.0 * (mean + 1.0).sqrt();
    let numbers = (mean - reach).max(0.0) as u64..=(mean + reach) as u64;
    numbers.map(|j| term(j as f64)).sum::<f64>().min(1.0)
}

/// The probability that Student's t with `degrees_of_freedom` is farther from 0 than `t`.
pub fn t_two_sided(t: f64, degrees_of_freedom: f64) -> f64 {
    f_upper_tail(t * t, [1.0, degrees_of_freedom])
}

/// The probability that chi-squared with `degrees_of_freedom` exceeds `x`; NaN where that means nothing.
pub fn chi_squared_upper_tail(x: f64, degrees_of_freedom: f64) -> f64 {
    ChiSquared::new(degrees_of_freedom).map_or(f64::NAN, |distribution| distribution.sf(x))
}

fn quantile<D: ContinuousCDF<f64, f64>, E>(distribution: Result<D, E>, probability: f64) -> f64 {
    match distribution {
        Ok(distribution) if probability > 0.0 && probability < 1.0 => distribution.inverse_cdf(probability),
        _ => f64::NAN,
    }
}

/// The value that Hotelling's T² of two coordinates stays below with `probability`, for a covariance estimated with
/// `degrees_of_freedom` ν.
///
/// T² = 2ν/(ν - 1) · F(2, ν - 1), and F with 2 degrees of freedom above has the closed form
/// P(T² > t) = (1 + t/ν)^(-(ν - 1)/2). Infinite for ν ≤ 1, where every centre is possible.
///
/// ```
/// # use umbmark_core::stats::hotelling_quantile;
/// assert!((hotelling_quantile(0.95, 8.0) - 2.0 * 8.0 / 7.0 * 4.737_414).abs() < 1e-5);
/// ```
pub fn hotelling_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom <= 1.0 {
        return f64::INFINITY;
    }
    degrees_of_freedom * (libm::pow(1.0 - probability, -2.0 / (degrees_of_freedom - 1.0)) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: printed tables of the distributions.
    /// With two degrees of freedom the tail is (ν/(ν + 2 f))^(ν/2); with others, the series meets the tail where both are known.
    #[test]
    fn the_logarithm_of_a_tail_goes_on_below_every_number() {
        for (f, nu) in [(3.0, 20.0), (4500.0, 6000.0), (1e6, 1e5)] {
            let exact = 0.5 * nu * libm::log(nu / (nu + 2.0 * f));
            let found = ln_f_upper_tail(f, [2.0, nu]);
            assert!((found / exact - 1.0).abs() < 1e-11, "{f} {nu}: {found} {exact}");
        }
        // Between the last f whose tail is a number and the first whose tail is none.
        for n in [1.0, 3.0, 40.0] {
            let at = |f: f64| ln_f_upper_tail(f, [n, 4000.0]);
            let edge = (0..200).fold([1.0, 1e6], |[low, high], _| {
                let middle = 0.5 * (low + high);
                if f_upper_tail(middle, [n, 4000.0]) > f64::MIN_POSITIVE { [middle, high] } else { [low, middle] }
            });
            let [above, below] = [at(edge[0] * (1.0 - 1e-9)), at(edge[1] * (1.0 + 1e-9))];
            assert!((above - below).abs() < 1e-3 && above > below, "{n}: {above} {below}");
        }
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (p, df, t) in
            [(0.975, 1.0, 12.706204736), (0.975, 8.0, 2.306004135), (0.05, 4.0, -2.131847), (0.9875, 8.0, 2.751524)]
        {
            assert!((student_t_quantile(p, df) - t).abs() < 2e-5 * t.abs(), "{p} {df}: {}", student_t_quantile(p, df));
        }
        assert_eq!(student_t_quantile(0.975, f64::INFINITY), normal_quantile(0.975));
        for (p, df, x) in [(0.025, 16.0, 6.907664), (0.975, 16.0, 28.845351), (0.5, 8.0, 7.344121)] {
            assert!((chi_squared_quantile(p, df) - x).abs() < 1e-5 * x, "{p} {df}: {}", chi_squared_quantile(p, df));
        }
        for (p, df, x) in
            [(0.95, [4.0, 14.0], 3.112_250), (0.025, [4.0, 14.0], 1.0 / 8.683_8), (0.975, [14.0, 4.0], 8.683_8)]
        {
            assert!((f_quantile(p, df) - x).abs() < 1e-4 * x, "{p} {df:?}: {}", f_quantile(p, df));
        }
    }

    /// f, degrees of freedom, non-centrality, probability.
    const NCF: [(f64, [f64; 2], f64, f64); 8] = [
        (5.317655, [1.0, 8.0], 10.507, 0.809635443585),
        (5.317655, [1.0, 8.0], 0.3, 0.077364898644),
        (3.1, [4.0, 14.0], 7.5, 0.430856711169),
        (40.0, [1.0, 4.0], 250.0, 0.999874069788),
        (4.2, [1.0, 58.0], 3.7, 0.454317743984),
        (12.0, [1.0, 8.0], 30.0, 0.944595522560),
        (5000.0, [1.0, 8.0], 9000.0, 0.927808023009),
        (0.5, [2.0, 6.0], 1.0, 0.743156963484),
    ];

    /// Oracle: scipy.stats.ncf.sf.
    #[test]
    fn the_power_of_an_f_test_is_that_of_scipy() {
        for (f, freedom, noncentrality, power) in NCF {
            let got = noncentral_f_upper_tail(f, freedom, noncentrality);
            assert!((got - power).abs() < 1e-9, "{f} {freedom:?} {noncentrality}: {got} {power}");
        }
        let central = noncentral_f_upper_tail(5.3, [1.0, 8.0], 0.0);
        assert!((central - f_upper_tail(5.3, [1.0, 8.0])).abs() < 1e-15);
        assert!(noncentral_f_upper_tail(5.3, [1.0, 8.0], -1.0).is_nan());
        assert!(noncentral_f_upper_tail(5.3, [1.0, 0.0], 1.0).is_nan());
    }

    #[test]
    fn what_has_no_quantile_is_not_a_number() {
        assert!(student_t_quantile(1.0, 8.0).is_nan() && student_t_quantile(0.5, 0.0).is_nan());
        assert!(chi_squared_quantile(-0.1, 8.0).is_nan() && chi_squared_quantile(f64::NAN, 8.0).is_nan());
        assert_eq!(hotelling_quantile(0.95, 1.0), f64::INFINITY);
    }
}
