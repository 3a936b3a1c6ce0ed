//! Means with intervals from the scatter between runs, and tests of these means.

use crate::stats::{Interval, student_t_quantile, t_two_sided};

/// A mean over runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// Its value.
    pub value: f64,
    /// Its interval by Student's t with one value per run; `None` for fewer than two runs.
    pub interval: Option<Interval>,
    /// How many runs it rests on.
    pub runs: usize,
}

/// A rate in one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sum {
    /// Sum of the errors, and amount of driving.
    pub error: f64,
    pub amount: f64,
    /// Number of ends of moves in it, where the robot stops or changes from driving to turning.
    pub ends: usize,
}

impl Mean {
    /// Σ error / Σ amount over runs.
    ///
    /// Interval: ± t · √(sd²(error - value · amount)/n + r² · ends) / mean amount, with r the `resolution` of the counters at one end. A
    /// robot that stops at the same counts makes the same error of less than a tick in every run, which the scatter does not show.
    pub(super) fn rate(runs: &[Sum], resolution: f64, confidence: f64) -> Option<Mean> {
        let n = runs.len();
        let (error, amount) = runs.iter().fold((0.0, 0.0), |(e, a), run| (e + run.error, a + run.amount));
        if amount <= 0.0 {
            return None;
        }
        let value = error / amount;
        let squares: f64 = runs.iter().map(|run| (run.error - value * run.amount).powi(2)).sum();
        let interval = (n > 1).then(|| {
            let variance = squares / ((n - 1) * n) as f64 + shared(runs.iter(), resolution);
            let error = variance.sqrt() / (amount / n as f64);
            Interval::around(value, student_t_quantile(0.5 + 0.5 * confidence, (n - 1) as f64) * error)
        });
        Some(Mean { value, interval, runs: n })
    }

    /// The mean of one value a run.
    pub(super) fn of(runs: &[f64], confidence: f64) -> Option<Mean> {
        let sums: Vec<Sum> = runs.iter().map(|value| Sum { error: *value, amount: 1.0, ends: 0 }).collect();
        Mean::rate(&sums, 0.0, confidence)
    }
}

/// Variance of a run's sum of errors that all runs may share, for the `resolution` of the counters.
pub(super) fn shared<'a>(runs: impl ExactSizeIterator<Item = &'a Sum>, resolution: f64) -> f64 {
    let n = runs.len().max(1) as f64;
    resolution * resolution * runs.map(|run| run.ends as f64).sum::<f64>() / n
}

/// Fewer runs do not determine their own scatter well enough for a test.
const FEWEST: usize = 3;

/// p of a mean of zero, by Student's t, where values share an error of variance `shared`; `None` below three values.
pub(super) fn p_of_zero(values: &[f64], shared: f64) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    p_of(mean, variance / n + shared, n - 1.0).filter(|_| values.len() >= FEWEST)
}

/// p of a slope of zero of values against positions, by Student's t; `None` below four values, or where all positions are one. Each value
/// counts by its weight: the amount of driving that it is the mean of.
///
/// Values at each of two ends may share an error of variance `shared`.
pub(super) fn p_of_slope(points: &[[f64; 2]], weights: &[f64], shared: f64) -> Option<f64> {
    let n = points.len() as f64;
    let all: f64 = weights.iter().sum();
    let weighted = || points.iter().zip(weights.iter().map(|weight| weight * n / all));
    let mean = |k: usize| weighted().map(|(p, w)| w * p[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let product =
        |i: usize, j: usize| weighted().map(|(p, w)| w * (p[i] - [x, y][i]) * (p[j] - [x, y][j])).sum::<f64>();
    let across = product(0, 0);
    let slope = product(0, 1) / across;
    let rest = (product(1, 1) - slope * product(0, 1)).max(0.0);
    p_of(slope, (rest / (n - 2.0) + 0.5 * n * shared) / across, n - 2.0)
        .filter(|_| points.len() > FEWEST && across > 0.0)
}

fn p_of(value: f64, variance: f64, freedom: f64) -> Option<f64> {
    let p = if variance > 0.0 { t_two_sided(value / variance.sqrt(), freedom) } else { f64::from(value == 0.0) };
    p.is_finite().then_some(p)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the density of t, integrated by Simpson's rule in Python.
    #[test]
    fn tests_are_students() {
        let p = p_of_zero(&[0.3, -0.1, 0.4, 0.2, 0.5], 0.0).unwrap();
        assert!((p - 0.064_985_9).abs() < 1e-6, "{p}");
        let p = p_of_slope(&[[0.0, 1.0], [1.0, 1.5], [2.0, 1.2], [3.0, 2.1], [4.0, 2.0]], &[3.0; 5], 0.0).unwrap();
        assert!((p - 0.067_038_0).abs() < 1e-6, "{p}");
        // Oracle: weighted least squares by the normal equations, in Python. The last value is far off and counts for little.
        let points = [[0.0, 1.0], [1.0, 1.5], [2.0, 1.2], [3.0, 2.1], [9.0, -4.0]];
        let p = p_of_slope(&points, &[3.0, 3.0, 3.0, 3.0, 0.01], 0.0).unwrap();
        assert!((p - 0.211997697).abs() < 1e-6, "{p}");
        assert!(p_of_zero(&[1.0, 2.0], 0.0).is_none() && p_of_slope(&[[1.0, 2.0]; 5], &[1.0; 5], 0.0).is_none());
    }

    #[test]
    fn a_rate_weighs_runs_by_what_they_drove_and_one_run_has_no_interval() {
        let run = |error, amount| Sum { error, amount, ends: 4 };
        let mean = Mean::rate(&[run(1.0, 1.0), run(6.0, 3.0)], 0.0, 0.95).unwrap();
        assert_eq!((mean.value, mean.runs), (1.75, 2));
        // Residuals -0.75 and 0.75, t of one degree of freedom 12.7062, mean weight 2.
        let half = 12.706_204_7 * 0.75 / 2.0;
        assert!((mean.interval.unwrap().high - 1.75 - half).abs() < 1e-6);
        // Equal runs that share an error of 0.5 at each of four ends: 1 in all.
        let mean = Mean::rate(&[run(2.0, 1.0), run(2.0, 1.0)], 0.5, 0.95).unwrap();
        assert!((mean.interval.unwrap().high - 2.0 - 12.706_204_7).abs() < 1e-6);
        assert!(Mean::of(&[1.0], 0.95).unwrap().interval.is_none() && Mean::of(&[], 0.95).is_none());
    }
}
