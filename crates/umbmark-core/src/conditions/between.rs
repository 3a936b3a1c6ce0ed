//! How far the values of levels are apart: their variance by restricted maximum likelihood, and each value drawn towards their mean by what its
//! own error leaves open.
//!
//! With values x_k of variance v_k and w_k = 1/(v_k + τ²), τ² maximises
//!
//! ```text
//! -½ Σ ln(v_k + τ²) - ½ ln Σ w_k - ½ Σ w_k (x_k - μ)²,    μ = Σ w_k x_k / Σ w_k
//! ```
//!
//! and the interval of τ is that of all τ with which Σ w_k (x_k - μ)² is what χ² of k - 1 degrees of freedom makes (Q profile).
//!
//! Sources: Raudenbush (2009), in The Handbook of Research Synthesis; Viechtbauer (2007), Statistics in Medicine 26, 37.

use crate::stats::{Interval, chi_squared_quantile};

/// Values of levels with the variance between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Between {
    /// τ: standard deviation between levels, in the unit of the value.
    pub deviation: f64,
    /// Its interval; the upper end is infinite where two levels leave it open.
    pub interval: Interval,
    /// Each value, drawn towards the mean.
    pub pooled: Vec<f64>,
    /// The mean of all levels, μ.
    pub mean: f64,
    /// Its standard error.
    pub mean_error: f64,
}

/// Steps of a search that halves; 2^-200 is nothing.
const HALVINGS: usize = 200;
/// A maximum in the logarithm is found to this, which changes the likelihood by nothing.
const FOUND: f64 = 1e-9;

/// Of values with their standard errors; `None` for fewer than two.
pub(crate) fn between(values: &[f64], errors: &[f64], level: f64) -> Option<Between> {
    if values.len() < 2 {
        return None;
    }
    let variances: Vec<f64> = errors.iter().map(|error| error * error).collect();
    let most = most(values, &variances);
    let square = likeliest(values, &variances);
    let (weights, mean) = weighted(values, &variances, square);
    let pooled = values.iter().zip(&variances).map(|(x, v)| mean + square / (square + v) * (x - mean)).collect();
    let freedom = (values.len() - 1) as f64;
    let end = |share: f64| {
        let limit = chi_squared_quantile(share, freedom);
        root(&|square| q(values, &variances, square) - limit, most)
    };
    let (low, high) = (end(0.5 + 0.5 * level), end(0.5 - 0.5 * level));
    Some(Between {
        deviation: square.sqrt(),
        interval: Interval { low: low.sqrt(), high: high.sqrt() },
        pooled,
        mean,
        mean_error: 1.0 / weights.sqrt(),
    })
}

/// Their mean and the standard deviation between them; `None` for fewer than two.
pub(crate) fn mean_and_deviation(values: &[f64], errors: &[f64]) -> Option<(f64, f64)> {
    if values.len() < 2 {
        return None;
    }
    let variances: Vec<f64> = errors.iter().map(|error| error * error).collect();
    let square = likeliest(values, &variances);
    Some((weighted(values, &variances, square).1, square.sqrt()))
}

/// The variance between levels under which their values are likeliest; where all errors are equal, it is that of the values less theirs.
fn likeliest(values: &[f64], variances: &[f64]) -> f64 {
    if variances.windows(2).all(|pair| pair[0] == pair[1]) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        return (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0) - variances[0]).max(0.0);
    }
    // The likelihood has one maximum for values as these.
    largest(&|square: f64| of_likelihood(values, variances, square), most(values, variances))
}

/// More than the variance between levels can be.
fn most(values: &[f64], variances: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let spread = most - values.iter().copied().fold(f64::INFINITY, f64::min);
    4.0 * spread * spread + variances.iter().sum::<f64>()
}

fn weighted(values: &[f64], variances: &[f64], square: f64) -> (f64, f64) {
    let weights = variances.iter().map(|v| 1.0 / (v + square));
    let all: f64 = weights.clone().sum();
    (all, values.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>() / all)
}

fn q(values: &[f64], variances: &[f64], square: f64) -> f64 {
    let (_, mean) = weighted(values, variances, square);
    values.iter().zip(variances).map(|(x, v)| (x - mean).powi(2) / (v + square)).sum()
}

fn of_likelihood(values: &[f64], variances: &[f64], square: f64) -> f64 {
    let (all, _) = weighted(values, variances, square);
    let logarithms: f64 = variances.iter().map(|v| libm::log(v + square)).sum();
    -0.5 * (logarithms + libm::log(all) + q(values, variances, square))
}

/// Where a function of a number from 0 to `most` is largest: 0, or by golden section over its logarithm.
fn largest(of: &dyn Fn(f64) -> f64, most: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let at = |x: f64| most * libm::exp(x);
    let (mut low, mut high) = (-40.0, 0.0);
    while high - low > FOUND {
        let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        if of(at(a)) >= of(at(b)) { high = b } else { low = a }
    }
    let found = at(0.5 * (low + high));
    // At the lower end of the search nothing is left to find.
    if found < 1e-12 * most || of(0.0) >= of(found) { 0.0 } else { found }
}

/// Where a falling function becomes zero: 0 where it begins below, infinity where it is not below within a million times `most`.
fn root(of: &dyn Fn(f64) -> f64, most: f64) -> f64 {
    if of(0.0) <= 0.0 {
        return 0.0;
    }
    let mut high = most.max(f64::MIN_POSITIVE);
    let farthest = 1e6 * high;
    while of(high) > 0.0 {
        high *= 4.0;
        if high > farthest {
            return f64::INFINITY;
        }
    }
    let mut low = 0.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if of(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: with equal errors REML is the sample variance less the square of the error, and Q = Σ(x - x̄)²/(v + τ²).
    #[test]
    fn with_equal_errors_the_variance_is_that_of_the_values_less_their_own() {
        let (values, error) = ([1.0, 3.0, 4.0, 8.0], 0.5);
        let found = between(&values, &[error; 4], 0.95).unwrap();
        let sum = 26.0;
        let square = sum / 3.0 - 0.25;
        assert!((found.deviation - f64::sqrt(square)).abs() < 1e-5, "{found:?}");
        assert!((found.pooled[3] - (4.0 + square / (square + 0.25) * 4.0)).abs() < 1e-5);
        for (end, share) in [(found.interval.low, 0.975), (found.interval.high, 0.025)] {
            let of_end = sum / chi_squared_quantile(share, 3.0) - 0.25;
            assert!((end - of_end.max(0.0).sqrt()).abs() < 1e-6, "{end} {of_end}");
        }
    }

    #[test]
    fn values_that_differ_by_less_than_their_errors_become_one() {
        let found = between(&[1.0, 1.2, 0.9], &[0.5, 0.4, 0.6], 0.95).unwrap();
        assert_eq!((found.deviation, found.interval.low), (0.0, 0.0));
        assert!(found.pooled.iter().all(|value| (value - found.pooled[0]).abs() < 1e-12));
        // An exact value pulls those that are not known to itself.
        let pulled = between(&[0.0, 2.0, 1.0], &[1e-3, 3.0, 3.0], 0.95).unwrap();
        assert!(pulled.pooled.iter().all(|value| value.abs() < 0.5), "{pulled:?}");
        assert_eq!(between(&[1.0], &[1.0], 0.95), None);
    }
}
