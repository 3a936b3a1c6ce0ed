//! Shares and correlations with their 95 % intervals.

use umbmark_core::stats::normal_quantile;

/// A share and its interval (Wilson), in per cent: "12.3 (11.7 to 12.9) %".
pub fn share(count: usize, of: usize) -> String {
    let [low, high] = wilson(count, of);
    format!("{:.1} ({:.1} to {:.1}) %", 100.0 * count as f64 / of as f64, 100.0 * low, 100.0 * high)
}

fn wilson(count: usize, of: usize) -> [f64; 2] {
    let (z, n) = (normal_quantile(0.975), of as f64);
    let p = count as f64 / n;
    let centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    [centre - half, centre + half]
}

/// Mean, standard deviation and standard error of the mean.
pub fn moments(values: &[f64]) -> [f64; 3] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let sd = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt();
    [mean, sd, sd / n.sqrt()]
}

/// A quantile of some values.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((p * (sorted.len() - 1) as f64).round() as usize).min(sorted.len() - 1)]
}

/// Spearman's rank correlation with its interval (Fisher's z, standard error 1.03/√(n - 3)).
pub fn rank_correlation(a: &[f64], b: &[f64]) -> [f64; 3] {
    let (a, b) = (ranks(a), ranks(b));
    let mean = 0.5 * (a.len() - 1) as f64;
    let product: f64 = a.iter().zip(&b).map(|(a, b)| (a - mean) * (b - mean)).sum();
    let squares: f64 = a.iter().map(|a| (a - mean) * (a - mean)).sum();
    let rho = product / squares;
    let half = normal_quantile(0.975) * 1.03 / (a.len() as f64 - 3.0).sqrt();
    [rho, (rho.atanh() - half).tanh(), (rho.atanh() + half).tanh()]
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    for (rank, index) in order.into_iter().enumerate() {
        ranks[index] = rank as f64;
    }
    ranks
}

/// The share of pairs that both numbers put in the same order.
pub fn pairs_alike(a: &[f64], b: &[f64]) -> f64 {
    let (mut alike, mut all) = (0, 0);
    for i in 0..a.len() {
        for j in 0..i {
            alike += usize::from((a[i] < a[j]) == (b[i] < b[j]));
            all += 1;
        }
    }
    alike as f64 / all as f64
}
