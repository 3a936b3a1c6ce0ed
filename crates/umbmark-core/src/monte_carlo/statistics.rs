//! Statistics of a stream of numbers in constant memory, the same whatever the order.

use serde::{Deserialize, Serialize};
use sketches_ddsketch::{Config, DDSketch};

mod written;

use written::Written;

/// Count, mean, standard deviation, extremes and quantiles of a stream of numbers.
///
/// Sums are integers in units of [`Statistics::RESOLUTION`], and quantiles come from a DDSketch, whose bins are integers
/// too. So the order in which numbers are taken, or in which parts are merged, does not matter to the last bit. A
/// quantile has a relative error of [`Statistics::QUANTILE_ERROR`] beyond a micrometre (or microradian).
///
/// Source of the sketch: Masson, Rim & Lee (2019), PVLDB 12(12).
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct Statistics {
    count: u64,
    sum: i128,
    squares: i128,
    sketch: DDSketch,
}

/// Whether they took the same numbers, as far as counts, sums, extremes and bins show.
impl PartialEq for Statistics {
    fn eq(&self, other: &Statistics) -> bool {
        Written::from(self) == Written::from(other)
    }
}

impl From<Statistics> for Written {
    fn from(statistics: Statistics) -> Written {
        Written::from(&statistics)
    }
}

impl std::fmt::Debug for Statistics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Statistics")
            .field("count", &self.count())
            .field("mean", &self.mean())
            .field("std_dev", &self.std_dev())
            .finish_non_exhaustive()
    }
}

impl Default for Statistics {
    fn default() -> Self {
        Statistics::new()
    }
}

impl Statistics {
    /// Unit of the sums: 2^-32 m or rad, a quarter of a nanometre.
    pub const RESOLUTION: f64 = 1.0 / 4_294_967_296.0;

    /// Numbers beyond this size, either way, are taken for this size: 2^20 m or rad. With it the sums hold 2^23 numbers of
    /// the greatest size, and 2^63 of one metre.
    pub const GREATEST: f64 = 1_048_576.0;

    /// Relative error of a quantile.
    pub const QUANTILE_ERROR: f64 = 5e-5;

    const MAX_BINS: u32 = 1 << 18;
    const SMALLEST: f64 = 1e-6;

    /// Sums of squares beyond this \[m²\] are cut off; the half of 2^127 units.
    const MOST_SQUARES: f64 = (1u128 << 126) as f64 * Self::RESOLUTION * Self::RESOLUTION;

    /// Nothing counted yet.
    pub fn new() -> Statistics {
        Statistics { count: 0, sum: 0, squares: 0, sketch: DDSketch::new(Self::config()) }
    }

    fn config() -> Config {
        Config::new(Self::QUANTILE_ERROR, Self::MAX_BINS, Self::SMALLEST)
    }

    /// Takes one more number.
    pub fn take(&mut self, value: f64) {
        let value = value.clamp(-Self::GREATEST, Self::GREATEST);
        // At most 2^52 of them.
        let units = (value / Self::RESOLUTION).round() as i64;
        self.count += 1;
        self.sum += i128::from(units);
        self.squares = self.squares.saturating_add(i128::from(units) * i128::from(units));
        self.sketch.add(value);
    }

    /// Takes all that `other` took.
    pub fn merge(&mut self, other: &Statistics) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares = self.squares.saturating_add(other.squares);
        self.sketch.merge(&other.sketch).expect("all sketches have one configuration");
    }

    /// How many numbers were taken.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; NaN for an empty set.
    pub fn mean(&self) -> f64 {
        self.sum as f64 / self.count as f64 * Self::RESOLUTION
    }

    /// Their standard deviation, with n - 1; NaN for fewer than two.
    pub fn std_dev(&self) -> f64 {
        if self.count < 2 {
            return f64::NAN;
        }
        // Squares about the whole part of the mean, in integers, so that nothing cancels.
        let n = i128::from(self.count);
        let (middle, rest) = (self.sum.div_euclid(n), self.sum.rem_euclid(n));
        let about_middle = self.squares - middle * (self.sum + rest);
        let about_mean = about_middle as f64 - rest as f64 * (rest as f64 / n as f64);
        (about_mean.max(0.0) / (n - 1) as f64).sqrt() * Self::RESOLUTION
    }

    /// Standard error of the mean, std_dev/√n: the Monte Carlo error.
    pub fn std_error(&self) -> f64 {
        self.std_dev() / (self.count() as f64).sqrt()
    }

    /// The value below which a share `q` of the numbers lies, q in [0, 1]; NaN for an empty set.
    pub fn quantile(&self, q: f64) -> f64 {
        let value = self.sketch.quantile(q.clamp(0.0, 1.0)).ok().flatten().unwrap_or(f64::NAN);
        value.max(self.min()).min(self.max())
    }

    /// Smallest number taken.
    pub fn min(&self) -> f64 {
        self.sketch.min().unwrap_or(f64::NAN)
    }

    /// Largest number taken.
    pub fn max(&self) -> f64 {
        self.sketch.max().unwrap_or(f64::NAN)
    }

    /// Share of the numbers that lie below `value`, to the resolution of the quantiles.
    pub fn share_below(&self, value: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.quantile(middle) < value {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn draws(n: usize) -> Vec<f64> {
        let mut stream = Stream::new(9, 0, 0);
        (0..n).map(|_| 0.3 + 0.05 * stream.normal()).collect()
    }

    #[test]
    fn moments_and_quantiles_are_those_of_the_sorted_sample() {
        let mut sample = draws(20_000);
        let mut statistics = Statistics::new();
        sample.iter().for_each(|value| statistics.take(*value));
        let n = sample.len() as f64;
        let mean = sample.iter().sum::<f64>() / n;
        let variance = sample.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        assert!((statistics.mean() - mean).abs() < 1e-11, "{} {mean}", statistics.mean());
        assert!((statistics.std_dev() - variance.sqrt()).abs() < 1e-11);
        sample.sort_by(f64::total_cmp);
        for q in [0.05, 0.25, 0.5, 0.95] {
            let exact = sample[(q * (n - 1.0)) as usize];
            assert!((statistics.quantile(q) / exact - 1.0).abs() < 3e-4, "{q}");
            assert!((statistics.share_below(exact) - q).abs() < 5e-3, "{q} {}", statistics.share_below(exact));
        }
        assert_eq!((statistics.min(), statistics.max()), (sample[0], sample[sample.len() - 1]));
    }

    #[test]
    fn the_order_of_numbers_and_of_parts_does_not_matter_to_the_last_bit() {
        let sample = draws(5000);
        let of = |values: &mut dyn Iterator<Item = f64>| {
            let mut statistics = Statistics::new();
            values.for_each(|value| statistics.take(value));
            statistics
        };
        let bits = |s: &Statistics| [s.mean(), s.std_dev(), s.quantile(0.1), s.quantile(0.9)].map(f64::to_bits);
        let forward = of(&mut sample.iter().copied());
        let mut parts = of(&mut sample[3000..].iter().copied());
        parts.merge(&of(&mut sample[..1234].iter().copied()));
        parts.merge(&of(&mut sample[1234..3000].iter().copied()));
        assert_eq!(bits(&forward), bits(&of(&mut sample.iter().rev().copied())));
        assert_eq!((bits(&forward), forward.count()), (bits(&parts), parts.count()));
    }

    #[test]
    fn what_is_written_does_not_depend_on_the_order_of_numbers_and_of_parts() {
        let sample: Vec<f64> = draws(5000).into_iter().map(|value| value - 0.3).collect();
        let of = |values: &[f64]| {
            let mut statistics = Statistics::new();
            values.iter().for_each(|value| statistics.take(*value));
            statistics
        };
        let whole = of(&sample);
        let thirds: Vec<Statistics> = sample.chunks(1700).map(of).collect();
        let text = |statistics: &Statistics| serde_json::to_string(statistics).unwrap();
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            let mut merged = Statistics::new();
            order.into_iter().for_each(|third: usize| merged.merge(&thirds[third]));
            assert!(merged == whole && text(&merged) == text(&whole), "{order:?}");
            let mut read: Statistics = serde_json::from_str(&text(&merged)).unwrap();
            read.merge(&whole);
            let mut twice = whole.clone();
            twice.merge(&whole);
            assert!(text(&read) == text(&twice) && read.quantile(0.3) == twice.quantile(0.3), "{order:?}");
        }
        assert!(whole != of(&sample[1..]));
    }

    /// Each number of a file changed by itself, and the whole taken from a larger file.
    #[test]
    fn statistics_that_cannot_be_true_are_refused() {
        let mut statistics = Statistics::new();
        draws(3000).iter().for_each(|value| statistics.take(value - 0.3));
        let good = serde_json::to_value(&statistics).unwrap();
        assert!(serde_json::from_value::<Statistics>(good.clone()).is_ok());
        let first = good["sketch"]["store"]["bins"].as_array().unwrap()[0].as_u64().unwrap();
        let sum: i128 = good["sum"].as_str().unwrap().parse().unwrap();
        let squares: i128 = good["squares"].as_str().unwrap().parse().unwrap();
        let forged = [
            ("/count", serde_json::json!(3001)),
            ("/sum", serde_json::json!((sum + (3000_i128 << 25)).to_string())),
            ("/sum", serde_json::json!(i128::MAX.to_string())),
            ("/sum", serde_json::json!("1e3")),
            ("/squares", serde_json::json!((squares + squares / 1000).to_string())),
            ("/squares", serde_json::json!((-squares).to_string())),
            ("/sketch", serde_json::Value::Null),
            ("/sketch/config/gamma", serde_json::json!(1.5)),
            ("/sketch/config/gamma", serde_json::json!(0.5)),
            ("/sketch/config/max_num_bins", serde_json::json!(7)),
            ("/sketch/store/bins/0", serde_json::json!(first + 1)),
            ("/sketch/store/bins", serde_json::json!([])),
            ("/sketch/store/bins", serde_json::json!([u64::MAX, u64::MAX])),
            ("/sketch/store/min_key", serde_json::json!(i32::MIN)),
            ("/sketch/store/max_key", serde_json::json!(i32::MAX)),
            ("/sketch/store/offset", serde_json::json!(i32::MAX)),
            ("/sketch/store/bin_limit", serde_json::json!(0)),
            ("/sketch/negative_store/count", serde_json::json!(u64::MAX)),
            ("/sketch/zero_count", serde_json::json!(u64::MAX)),
            ("/sketch/min", serde_json::json!(1e300)),
            ("/sketch/max", serde_json::json!(-1e300)),
        ];
        for (key, value) in forged {
            let mut changed = good.clone();
            *changed.pointer_mut(key).unwrap() = value;
            assert!(serde_json::from_value::<Statistics>(changed).is_err(), "{key}");
        }
        let empty = serde_json::to_value(Statistics::new()).unwrap();
        assert_eq!(serde_json::from_value::<Statistics>(empty).unwrap().count(), 0);
    }

    #[test]
    fn numbers_beyond_every_size_are_written_and_read() {
        for sample in [vec![f64::MAX; 3], vec![-1e30, 1e30], vec![0.0; 5], vec![1e-7, -1e-7, 0.0], vec![1e-6, 2e-6]] {
            let mut statistics = Statistics::new();
            sample.iter().for_each(|value| statistics.take(*value));
            let text = serde_json::to_string(&statistics).unwrap();
            let read: Statistics = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{sample:?}: {error}"));
            assert!(read == statistics);
        }
    }

    #[test]
    fn a_large_mean_does_not_drown_a_small_scatter() {
        let mut statistics = Statistics::new();
        (0..10_000).for_each(|i| statistics.take(50_000.0 + if i % 2 == 0 { 1e-6 } else { -1e-6 }));
        assert!((statistics.std_dev() / 1e-6 - 1.0).abs() < 1e-3, "{}", statistics.std_dev());
    }

    #[test]
    fn quantiles_of_one_number_are_that_number() {
        let mut one = Statistics::new();
        one.take(0.447_123_456);
        assert_eq!([0.0, 0.05, 0.5, 1.0].map(|q| one.quantile(q)), [0.447_123_456; 4]);
        assert!(one.std_dev().is_nan() && Statistics::new().quantile(0.5).is_nan());
    }
}
