//! Linear fits that a few outliers do not change.
//!
//! First least absolute deviations, which tolerates up to half of all values being wrong; then Tukey's biweight, which is nearly as precise
//! as least squares on clean data (Huber & Ronchetti 2009, Robust Statistics).

use nalgebra::{DMatrix, SMatrix, SVector};

/// Steps of reweighted least squares for absolute deviations, and for the biweight.
const STEPS: [usize; 2] = [12, 8];
/// The biweight gives no weight beyond this many standard deviations: 95 % efficiency for normal values.
const BEYOND: f64 = 4.685;
/// Directions with less than this share of the strongest one's information are not estimated.
const SHOWN: f64 = 1e-9;
/// Share of the largest turns of a drive by which any may scatter.
pub(crate) const LARGE_SCATTER: f64 = 0.01;
/// A median absolute deviation times this is the standard deviation of normal values.
pub(crate) const DEVIATION: f64 = 1.482_602_218_505_602;

/// y ≈ x · values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line<const K: usize> {
    pub values: [f64; K],
    /// Standard deviation of the residuals, from their median size, where most observations are 0 over the others.
    pub scale: f64,
}

/// Fits rows of K columns to one observation each.
///
/// If observations are rounded to steps, one of exactly 0 only says that it is smaller than a step. Where most are 0, such rows are fitted
/// too, but the scatter is not measured by them: it would vanish.
pub(crate) fn fit<const K: usize>(rows: &[([f64; K], f64)]) -> Line<K> {
    fit_above(rows, 0.0)
}

/// The same, where no scatter is believed that is smaller than this share of the largest observation: where most of them are nearly 0, their
/// scatter is not that of the large ones, which would all be taken for outliers.
pub(crate) fn fit_above<const K: usize>(rows: &[([f64; K], f64)], share: f64) -> Line<K> {
    let believed = share * rows.iter().map(|(_, y)| y.abs()).fold(0.0, f64::max);
    let mut values = SVector::<f64, K>::zeros();
    let most_are_zero = 2 * rows.iter().filter(|(_, y)| *y == 0.0).count() > rows.len();
    let moved = || rows.iter().filter(|(_, y)| !most_are_zero || *y != 0.0);
    let size = median(moved().map(|(_, y)| y.abs())).max(f64::MIN_POSITIVE);
    let left = |values: &SVector<f64, K>, (x, y): &([f64; K], f64)| y - SVector::from(*x).dot(values);
    for _ in 0..STEPS[0] {
        let least = 1e-3 * size;
        values = weighted(rows, |row| 1.0 / left(&values, row).abs().max(least));
    }
    let mut scale = 0.0;
    for _ in 0..STEPS[1] {
        scale = (DEVIATION * median(moved().map(|row| left(&values, row).abs()))).max(believed);
        values = weighted(rows, |row| biweight(left(&values, row) / (BEYOND * scale).max(1e-12 * size)));
    }
    Line { values: values.into(), scale }
}

/// Tukey's weight of a value: 1 in the middle, 0 from 1 on.
pub(crate) fn biweight(off: f64) -> f64 {
    if off.abs() < 1.0 { (1.0 - off * off).powi(2) } else { 0.0 }
}

/// Weighted least squares; undetermined directions stay zero.
fn weighted<const K: usize>(rows: &[([f64; K], f64)], weight: impl Fn(&([f64; K], f64)) -> f64) -> SVector<f64, K> {
    let (mut products, mut score) = (SMatrix::<f64, K, K>::zeros(), SVector::<f64, K>::zeros());
    for row in rows {
        let (x, w) = (SVector::from(row.0), weight(row));
        products += x * x.transpose() * w;
        score += x * (w * row.1);
    }
    // Columns are scaled to unit length, so that the rank does not depend on units.
    let lengths = products.diagonal().map(f64::sqrt);
    let unit = SVector::<f64, K>::from_fn(|k, _| if lengths[k] > 0.0 { 1.0 / lengths[k] } else { 0.0 });
    let eigen = DMatrix::from_fn(K, K, |i, j| products[(i, j)] * unit[i] * unit[j]).symmetric_eigen();
    let mut solved = SVector::<f64, K>::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let along: f64 = (0..K).map(|k| vector[k] * score[k] * unit[k]).sum();
        if *value > SHOWN * K as f64 {
            solved += SVector::<f64, K>::from_fn(|k, _| vector[k] * unit[k] * along / value);
        }
    }
    solved
}

/// The median; 0 for no values.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// The quantile of this share; 0 for no values.
pub(crate) fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let place = ((share * values.len() as f64) as usize).min(values.len() - 1);
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// 400 values, of which 40 are large and scatter by 2 %, and the others nearly 0.
    #[test]
    fn few_large_values_among_many_small_ones_are_no_outliers_above_a_share() {
        let mut stream = Stream::new(4, 0, 0);
        let rows: Vec<([f64; 1], f64)> = (0..400)
            .map(|k| {
                let x = if k % 10 == 0 { 1.0 } else { 1e-3 * stream.normal() };
                ([x], 3.0 * x * (1.0 + 0.02 * stream.normal()) + 1e-4 * stream.normal())
            })
            .collect();
        let found = fit_above(&rows, 0.01);
        assert!((found.values[0] - 3.0).abs() < 0.03 && found.scale > 0.029, "{found:?}");
        assert!(fit(&rows).scale < 1e-3);
    }

    /// 400 values of seed 3, a third of them outliers.
    #[test]
    fn a_third_of_wild_values_moves_a_fit_by_no_more_than_its_own_scatter() {
        let mut stream = Stream::new(3, 0, 0);
        let rows: Vec<([f64; 2], f64)> = (0..400)
            .map(|k| {
                let x = [stream.normal(), 1.0];
                let wild = if k % 3 == 0 { 50.0 + 30.0 * stream.normal() } else { 0.0 };
                (x, 2.0 * x[0] - 1.0 + 0.1 * stream.normal() + wild)
            })
            .collect();
        let Line { values, scale } = fit(&rows);
        assert!((values[0] - 2.0).abs() < 0.03 && (values[1] + 1.0).abs() < 0.03, "{values:?}");
        assert!((0.08..0.2).contains(&scale), "{scale}");
    }

    /// Most rows are of a robot that hardly turns, and observations are in steps of 0.02; a few are wild.
    #[test]
    fn observations_of_exactly_zero_do_not_make_the_scatter_vanish() {
        let mut stream = Stream::new(5, 0, 0);
        let rows: Vec<([f64; 1], f64)> = (0..400)
            .map(|k| {
                let x = if k % 5 == 0 { 0.3 * stream.normal() } else { 1e-3 * stream.normal() };
                let wild = if k % 40 == 0 { 2.0 } else { 0.0 };
                ([x], 0.02 * (50.0 * (0.9 * x + wild)).round())
            })
            .collect();
        let Line { values, scale } = fit(&rows);
        assert!((values[0] - 0.9).abs() < 0.01 && (1e-3..0.03).contains(&scale), "{values:?} {scale}");
    }

    #[test]
    fn what_the_rows_do_not_show_stays_zero() {
        let rows: Vec<([f64; 2], f64)> = (0..50).map(|k| ([f64::from(k), 0.0], 3.0 * f64::from(k))).collect();
        let values = fit(&rows).values;
        assert!((values[0] - 3.0).abs() < 1e-9 && values[1] == 0.0, "{values:?}");
        assert_eq!(fit::<2>(&[]).values, [0.0; 2]);
    }
}
