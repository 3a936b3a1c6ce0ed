//! Statistics of a stream of numbers in constant memory.

use sketches_ddsketch::{Config, DDSketch};

/// Count, mean, standard deviation, extremes and quantiles.
///
/// Moments by Welford's and Chan's updates; quantiles by a DDSketch whose relative error is [`Statistics::QUANTILE_ERROR`]
/// for values beyond a micrometre (or microradian), whose bins are integers. Merged in a fixed order, everything is the
/// same to the last bit however the work was shared out.
///
/// Sources: Chan, Golub & LeVeque (1983), The American Statistician 37(3); Masson, Rim & Lee (2019), PVLDB 12(12).
#[derive(Clone)]
pub struct Statistics {
    count: u64,
    mean: f64,
    squares: f64,
    sketch: DDSketch,
}

impl std::fmt::Debug for Statistics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Statistics")
            .field("count", &self.count)
            .field("mean", &self.mean)
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
    /// Relative error of a quantile.
    pub const QUANTILE_ERROR: f64 = 5e-4;

    const MAX_BINS: u32 = 1 << 16;
    const SMALLEST: f64 = 1e-6;

    /// Nothing counted yet.
    pub fn new() -> Statistics {
        let config = Config::new(Self::QUANTILE_ERROR, Self::MAX_BINS, Self::SMALLEST);
        Statistics { count: 0, mean: 0.0, squares: 0.0, sketch: DDSketch::new(config) }
    }

    /// Takes one more number.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
        self.sketch.add(value);
    }

    /// Takes all that `other` took, after its own.
    pub fn merge(&mut self, other: &Statistics) {
        if other.count == 0 {
            return;
        }
        let (a, b) = (self.count as f64, other.count as f64);
        let gap = other.mean - self.mean;
        let total = a + b;
        self.mean += gap * (b / total);
        self.squares += other.squares + gap * gap * (a * b / total);
        self.count += other.count;
        self.sketch.merge(&other.sketch).expect("all sketches have one configuration");
    }

    /// How many numbers were taken.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Their standard deviation, with n - 1; NaN for fewer than two.
    pub fn std_dev(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { (self.squares / (self.count - 1) as f64).sqrt() }
    }

    /// Standard error of the mean, std_dev/√n: the Monte Carlo error.
    pub fn std_error(&self) -> f64 {
        self.std_dev() / (self.count as f64).sqrt()
    }

    /// The value below which a share `q` of the numbers lies, q in [0, 1]; NaN where there are none.
    pub fn quantile(&self, q: f64) -> f64 {
        self.sketch.quantile(q.clamp(0.0, 1.0)).ok().flatten().unwrap_or(f64::NAN)
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
        sample.iter().for_each(|v| statistics.add(*v));
        let n = sample.len() as f64;
        let mean = sample.iter().sum::<f64>() / n;
        let variance = sample.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        assert!((statistics.mean() - mean).abs() < 1e-14);
        assert!((statistics.std_dev() - variance.sqrt()).abs() < 1e-14);
        sample.sort_by(f64::total_cmp);
        for q in [0.05, 0.25, 0.5, 0.95] {
            let exact = sample[(q * (n - 1.0)) as usize];
            assert!((statistics.quantile(q) / exact - 1.0).abs() < 1.1e-3, "{q}");
            assert!((statistics.share_below(exact) - q).abs() < 5e-3, "{q} {}", statistics.share_below(exact));
        }
        assert_eq!((statistics.min(), statistics.max()), (sample[0], sample[sample.len() - 1]));
    }

    #[test]
    fn merging_chunks_is_taking_them_one_after_the_other() {
        let sample = draws(5000);
        let chunked = |size: usize| {
            sample.chunks(size).fold(Statistics::new(), |mut sum, chunk| {
                let mut part = Statistics::new();
                chunk.iter().for_each(|v| part.add(*v));
                sum.merge(&part);
                sum
            })
        };
        let (all, parts) = (chunked(5000), chunked(77));
        assert_eq!(all.count(), parts.count());
        assert!((all.mean() - parts.mean()).abs() < 1e-15 && (all.std_dev() - parts.std_dev()).abs() < 1e-14);
        assert_eq!(all.quantile(0.9), parts.quantile(0.9));
    }
}
