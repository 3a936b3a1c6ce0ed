//! Statistics of a stream of numbers in constant memory.

use sketches_ddsketch::{Config, DDSketch};

/// Count, mean, standard deviation, extremes and quantiles.
///
/// Moments by Welford's update within a chunk and Chan's between chunks; quantiles by a DDSketch whose relative error is
/// [`Statistics::QUANTILE_ERROR`] for values beyond a micrometre (or microradian), whose bins are integers. Taken in the
/// same chunks in the same order, everything is the same to the last bit however the work was shared out.
///
/// Sources: Chan, Golub & LeVeque (1983), The American Statistician 37(3); Masson, Rim & Lee (2019), PVLDB 12(12).
#[derive(Clone)]
pub struct Statistics {
    moments: Moments,
    sketch: DDSketch,
}

#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    fn of(values: impl Iterator<Item = f64>) -> Moments {
        values.fold(Moments::default(), |m, value| {
            let count = m.count + 1;
            let before = value - m.mean;
            let mean = m.mean + before / count as f64;
            Moments { count, mean, squares: m.squares + before * (value - mean) }
        })
    }

    fn then(&self, next: &Moments) -> Moments {
        if self.count == 0 || next.count == 0 {
            return if self.count == 0 { *next } else { *self };
        }
        let (a, b) = (self.count as f64, next.count as f64);
        let gap = next.mean - self.mean;
        let total = a + b;
        Moments {
            count: self.count + next.count,
            mean: self.mean + gap * (b / total),
            squares: self.squares + next.squares + gap * gap * (a * b / total),
        }
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
    /// Relative error of a quantile.
    pub const QUANTILE_ERROR: f64 = 5e-5;

    const MAX_BINS: u32 = 1 << 18;
    const SMALLEST: f64 = 1e-6;

    /// Nothing counted yet.
    pub fn new() -> Statistics {
        let config = Config::new(Self::QUANTILE_ERROR, Self::MAX_BINS, Self::SMALLEST);
        Statistics { moments: Moments::default(), sketch: DDSketch::new(config) }
    }

    /// Takes a chunk of numbers.
    pub fn take(&mut self, chunk: impl Iterator<Item = f64> + Clone) {
        self.moments = self.moments.then(&Moments::of(chunk.clone()));
        chunk.for_each(|value| self.sketch.add(value));
    }

    /// How many numbers were taken.
    pub fn count(&self) -> u64 {
        self.moments.count
    }

    /// Their mean.
    pub fn mean(&self) -> f64 {
        self.moments.mean
    }

    /// Their standard deviation, with n - 1; NaN for fewer than two.
    pub fn std_dev(&self) -> f64 {
        let Moments { count, squares, .. } = self.moments;
        if count < 2 { f64::NAN } else { (squares / (count - 1) as f64).sqrt() }
    }

    /// Standard error of the mean, std_dev/√n: the Monte Carlo error.
    pub fn std_error(&self) -> f64 {
        self.std_dev() / (self.count() as f64).sqrt()
    }

    /// The value below which a share `q` of the numbers lies, q in [0, 1]; NaN where there are none.
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
        sample.chunks(100).for_each(|chunk| statistics.take(chunk.iter().copied()));
        let n = sample.len() as f64;
        let mean = sample.iter().sum::<f64>() / n;
        let variance = sample.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        assert!((statistics.mean() - mean).abs() < 1e-14);
        assert!((statistics.std_dev() - variance.sqrt()).abs() < 1e-14);
        sample.sort_by(f64::total_cmp);
        for q in [0.05, 0.25, 0.5, 0.95] {
            let exact = sample[(q * (n - 1.0)) as usize];
            assert!((statistics.quantile(q) / exact - 1.0).abs() < 3e-4, "{q}");
            assert!((statistics.share_below(exact) - q).abs() < 5e-3, "{q} {}", statistics.share_below(exact));
        }
        assert_eq!((statistics.min(), statistics.max()), (sample[0], sample[sample.len() - 1]));
    }

    #[test]
    fn another_size_of_chunk_moves_the_last_bits_at_most() {
        let sample = draws(5000);
        let chunked = |size: usize| {
            sample.chunks(size).fold(Statistics::new(), |mut all, chunk| {
                all.take(chunk.iter().copied());
                all
            })
        };
        let (all, parts) = (chunked(5000), chunked(77));
        assert_eq!(all.count(), parts.count());
        assert!((all.mean() - parts.mean()).abs() < 1e-15 && (all.std_dev() - parts.std_dev()).abs() < 1e-14);
        assert_eq!(all.quantile(0.9), parts.quantile(0.9));
    }

    #[test]
    fn quantiles_of_one_number_are_that_number() {
        let mut one = Statistics::new();
        one.take([0.447_123_456].into_iter());
        assert_eq!([0.0, 0.05, 0.5, 1.0].map(|q| one.quantile(q)), [0.447_123_456; 4]);
        assert!(one.std_dev().is_nan() && Statistics::new().quantile(0.5).is_nan());
    }
}
