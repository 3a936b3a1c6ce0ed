//! Statistics of a stream of numbers in constant memory, the same whatever the order.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sketches_ddsketch::{Config, DDSketch};

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

/// The statistics as they stand in a file: integers of more than 64 bits as text, and no sketch of nothing, whose ends are
/// infinite. Equal statistics are written alike, whatever the order in which the numbers came.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
struct Written {
    count: u64,
    sum: String,
    squares: String,
    sketch: Option<Value>,
}

impl From<Statistics> for Written {
    fn from(s: Statistics) -> Written {
        let sketch = (s.count > 0).then(|| ordered(&s.sketch, s.sum as f64 * Statistics::RESOLUTION));
        Written { count: s.count, sum: s.sum.to_string(), squares: s.squares.to_string(), sketch }
    }
}

/// A sketch without what depends on the order in which it was filled: its own sum, which is rounded after each number, and the empty
/// bins beyond the outermost full ones.
fn ordered(sketch: &DDSketch, sum: f64) -> Value {
    let mut written = json!(sketch);
    written["sum"] = json!(sum);
    for store in ["store", "negative_store"] {
        let store = &mut written[store];
        let [first, last, offset] = ["min_key", "max_key", "offset"].map(|key| store[key].as_i64().unwrap_or(0));
        if let Some(bins) = store["bins"].as_array_mut().filter(|bins| !bins.is_empty()) {
            bins.truncate((last - offset + 1).max(0) as usize);
            bins.drain(..((first - offset).max(0) as usize).min(bins.len()));
            store["offset"] = json!(first);
        }
    }
    written
}

impl TryFrom<Written> for Statistics {
    type Error = String;

    fn try_from(written: Written) -> Result<Statistics, String> {
        let whole = |text: &str| text.parse().map_err(|_| format!("a sum must be a whole number, got \"{text}\""));
        let (sum, squares) = (whole(&written.sum)?, whole(&written.squares)?);
        let sketch: Option<DDSketch> =
            written.sketch.map(serde_json::from_value).transpose().map_err(|e| e.to_string())?;
        let sketch = sketch.unwrap_or_else(|| Statistics::new().sketch);
        if sketch.count() as u64 != written.count {
            return Err(format!("{} numbers in the sketch, {} in the sums", sketch.count(), written.count));
        }
        Ok(Statistics { count: written.count, sum, squares, sketch })
    }
}

/// Whether they took the same numbers, as far as counts, sums, extremes and bins show.
impl PartialEq for Statistics {
    fn eq(&self, other: &Statistics) -> bool {
        Written::from(self.clone()) == Written::from(other.clone())
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

    /// Nothing counted yet.
    pub fn new() -> Statistics {
        let config = Config::new(Self::QUANTILE_ERROR, Self::MAX_BINS, Self::SMALLEST);
        Statistics { count: 0, sum: 0, squares: 0, sketch: DDSketch::new(config) }
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
