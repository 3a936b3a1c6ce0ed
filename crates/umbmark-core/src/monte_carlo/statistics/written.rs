//! Statistics as they stand in a file, and whether they can be true.

use serde::{Deserialize, Serialize};
use serde_json::{from_value, json};
use sketches_ddsketch::{Config, DDSketch};

use super::Statistics;

/// Integers of more than 64 bits are text, and there is no sketch of nothing, whose ends are infinite. Equal statistics are written alike,
/// whatever the order in which the numbers came.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Written {
    count: u64,
    sum: String,
    squares: String,
    sketch: Option<Sketch>,
}

/// The fields of a [`DDSketch`], as its own crate writes them.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
struct Sketch {
    config: Config,
    store: Bins,
    negative_store: Bins,
    min: f64,
    max: f64,
    sum: f64,
    zero_count: u64,
}

/// The bins of one sign.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
struct Bins {
    bins: Vec<u64>,
    count: u64,
    min_key: i32,
    max_key: i32,
    /// Key of the first bin.
    offset: i32,
    bin_limit: usize,
    is_collapsed: bool,
}

/// Count, sum and sum of squares that the bins show.
#[derive(Clone, Copy, Default)]
struct Shown {
    count: u64,
    sum: f64,
    squares: f64,
}

impl From<&Statistics> for Written {
    fn from(s: &Statistics) -> Written {
        let sketch = (s.count > 0).then(|| Sketch::of(&s.sketch, s.sum as f64 * Statistics::RESOLUTION)).flatten();
        Written { count: s.count, sum: s.sum.to_string(), squares: s.squares.to_string(), sketch }
    }
}

impl TryFrom<Written> for Statistics {
    type Error = String;

    fn try_from(written: Written) -> Result<Statistics, String> {
        let whole = |text: &str| -> Result<i128, String> {
            text.parse().map_err(|_| format!("a sum must be a whole number, got \"{text}\""))
        };
        let (sum, squares) = (whole(&written.sum)?, whole(&written.squares)?);
        let Some(sketch) = written.sketch.filter(|_| written.count > 0) else {
            return match (written.count, sum, squares) {
                (0, 0, 0) => Ok(Statistics::new()),
                _ => Err("the sums have numbers, the sketch has none".into()),
            };
        };
        let shown = sketch.shown()?;
        if shown.count != written.count {
            return Err(format!("{} numbers in the sketch, {} in the sums", shown.count, written.count));
        }
        sketch.agrees(shown, sum as f64 * Statistics::RESOLUTION, squares as f64 * Statistics::RESOLUTION.powi(2))?;
        let sketch = from_value(json!(sketch)).map_err(|error| error.to_string())?;
        Ok(Statistics { count: written.count, sum, squares, sketch })
    }
}

impl Sketch {
    /// Without what depends on the order in which it was filled: its own sum, which is rounded after each number, and the empty bins beyond the
    /// outermost full ones.
    fn of(sketch: &DDSketch, sum: f64) -> Option<Sketch> {
        let mut written: Sketch = from_value(json!(sketch)).ok()?;
        written.sum = sum;
        written.store.trim();
        written.negative_store.trim();
        Some(written)
    }

    /// What its bins show, if it is whole in itself.
    fn shown(&self) -> Result<Shown, String> {
        if self.config != Statistics::config() {
            return Err("the sketch has bins of another width".into());
        }
        if !(self.min <= self.max && self.min.abs().max(self.max.abs()) <= Statistics::GREATEST) {
            return Err(format!("the sketch goes from {} to {}", self.min, self.max));
        }
        let (above, below) = (self.store.shown(&self.config)?, self.negative_store.shown(&self.config)?);
        let count = above.count.checked_add(below.count).and_then(|count| count.checked_add(self.zero_count));
        let count = count.ok_or("the sketch has too many numbers")?;
        Ok(Shown { count, sum: above.sum - below.sum, squares: above.squares + below.squares })
    }

    /// Whether sums can be those of the numbers in the bins, each of which is known to the width of its bin.
    fn agrees(&self, shown: Shown, sum: f64, squares: f64) -> Result<(), String> {
        // Collapsed bins have lost their smallest numbers; the squares of 2^23 of the greatest numbers are cut off.
        if self.store.is_collapsed || self.negative_store.is_collapsed || shown.squares > Statistics::MOST_SQUARES {
            return Ok(());
        }
        let n = shown.count as f64;
        let (width, zero) = (2.0 * Statistics::QUANTILE_ERROR, Statistics::SMALLEST);
        let size = (shown.squares * n).sqrt();
        if (sum - shown.sum).abs() > width * size + n * zero {
            return Err(format!("the sum is {sum}, the sketch shows {}", shown.sum));
        }
        if (squares - shown.squares).abs() > 2.0 * width * shown.squares + n * zero * zero {
            return Err(format!("the sum of squares is {squares}, the sketch shows {}", shown.squares));
        }
        Ok(())
    }
}

impl Bins {
    fn trim(&mut self) {
        if self.bins.is_empty() {
            return;
        }
        let (first, last) = (i64::from(self.min_key), i64::from(self.max_key));
        let offset = i64::from(self.offset);
        self.bins.truncate(usize::try_from(last - offset + 1).unwrap_or(0));
        self.bins.drain(..usize::try_from(first - offset).unwrap_or(0).min(self.bins.len()));
        self.offset = self.min_key;
    }

    fn shown(&self, config: &Config) -> Result<Shown, String> {
        let wrong = || "the bins of the sketch contradict their ends".to_owned();
        let limit = config.max_num_bins as usize;
        if self.bins.len() > limit || self.bin_limit != limit {
            return Err("the sketch has another number of bins".into());
        }
        let mut shown = Shown::default();
        for (key, &count) in (i64::from(self.offset)..).zip(&self.bins).filter(|(_, count)| **count > 0) {
            let key = i32::try_from(key).map_err(|_| wrong())?;
            if !(self.min_key..=self.max_key).contains(&key) {
                return Err(wrong());
            }
            let value = config.value(key);
            shown.count = shown.count.checked_add(count).ok_or_else(wrong)?;
            shown.sum += value * count as f64;
            shown.squares += value * value * count as f64;
        }
        let (first, last) = (i64::from(self.min_key), i64::from(self.max_key));
        let (offset, end) = (i64::from(self.offset), i64::from(self.offset) + self.bins.len() as i64);
        let ends = if self.count > 0 { offset <= first && first <= last && last < end } else { first > last };
        if shown.count != self.count || !shown.squares.is_finite() || !ends {
            return Err(wrong());
        }
        Ok(shown)
    }
}
