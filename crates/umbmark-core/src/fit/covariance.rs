//! Which parameters a Jacobian determines, and how well.

use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Singular values of the Jacobian with columns of unit length below this share of the largest count as zero.
pub const RANK_TOLERANCE: f64 = 1e-3;

/// Combinations of parameters that the data does not determine: directions in parameter space along which no residual changes, to first
/// order.
///
/// Singular vectors of the Jacobian with its columns scaled to unit length, with singular values below `tolerance` times the
/// largest; each is given in the parameters' own units with largest component ±1. Empty where every parameter is shown.
///
/// ```
/// use nalgebra::DMatrix;
/// use umbmark_core::fit::null_directions;
/// // Only the difference of two parameters is seen: their common change is not.
/// let null = null_directions(&DMatrix::from_row_slice(2, 2, &[1.0, -1.0, 2.0, -2.0]), 1e-3);
/// assert_eq!(null.len(), 1);
/// assert!((null[0][0] - null[0][1]).abs() < 1e-12);
/// ```
pub fn null_directions(jacobian: &DMatrix<f64>, tolerance: f64) -> Vec<DVector<f64>> {
    if jacobian.ncols() == 0 {
        return Vec::new();
    }
    let (triangle, lengths) = scaled_triangle(jacobian);
    let svd = triangle.svd(false, true);
    let Some(vectors) = svd.v_t else { return Vec::new() };
    let limit = tolerance * svd.singular_values.max();
    let null = (0..lengths.len()).filter(|i| svd.singular_values.get(*i).is_none_or(|s| *s <= limit));
    null.map(|i| {
        let direction = DVector::from_fn(lengths.len(), |j, _| vectors[(i, j)] / lengths[j]);
        let largest = direction[direction.iamax()];
        direction / largest
    })
    .collect()
}

/// (JᵀJ)⁻¹ by way of the triangle of J; `None` where it does not exist.
pub(super) fn inverse_information(jacobian: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (triangle, lengths) = scaled_triangle(jacobian);
    if !null_directions(jacobian, 1e-12).is_empty() {
        return None;
    }
    let inverse = triangle.solve_upper_triangular(&DMatrix::identity(lengths.len(), lengths.len()))?;
    let scaled = &inverse * inverse.transpose();
    Some(DMatrix::from_fn(lengths.len(), lengths.len(), |i, j| scaled[(i, j)] / (lengths[i] * lengths[j])))
}

/// The triangular factor of J, its columns scaled to unit length, and these lengths. Columns that are only rounding error are set to zero.
fn scaled_triangle(jacobian: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let lengths = column_lengths(jacobian);
    let mut scaled = jacobian.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column.scale_mut(if *length > 0.0 { 1.0 / length } else { 0.0 });
    }
    let rows = scaled.nrows().max(lengths.len());
    let lengths = lengths.into_iter().map(|length| if length > 0.0 { length } else { 1.0 }).collect();
    (scaled.resize_vertically(rows, 0.0).qr().r(), lengths)
}

/// Length of each column; 0 for one that is only rounding error beside the longest.
pub(super) fn column_lengths(jacobian: &DMatrix<f64>) -> Vec<f64> {
    const ROUNDING: f64 = 1e-12;
    let lengths: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    lengths.into_iter().map(|length| if length > ROUNDING * longest { length } else { 0.0 }).collect()
}

/// Covariance of fitted parameters, estimated by leaving out one group of residuals at a time.
///
/// C = (G - 1)/G Σ_g Δ_g Δ_gᵀ, with Δ_g = -(JᵀJ - J_gᵀJ_g)⁻¹ J_gᵀ r_g the change of the (linearised) estimate when the residuals of group g
/// are left out. Residuals may be correlated within a group in any way, and their variances may differ; only the groups must be
/// independent. With few groups it is too large rather than too small. This is the cluster jackknife, CR3 of the econometric literature
/// (Bell & McCaffrey 2002, Survey Methodology 28).
///
/// `None` for fewer than two groups, or if some parameter is undetermined once one of them is left out.
pub fn jackknife_covariance(
    jacobian: &DMatrix<f64>,
    residuals: &DVector<f64>,
    groups: &[Range<usize>],
) -> Option<DMatrix<f64>> {
    let columns = jacobian.ncols();
    let mut sum = DMatrix::zeros(columns, columns);
    for group in groups {
        let part = jacobian.rows(group.start, group.len());
        let rest = DMatrix::from_fn(jacobian.nrows() - group.len(), columns, |i, j| {
            jacobian[(if i < group.start { i } else { i + group.len() }, j)]
        });
        if !null_directions(&rest, RANK_TOLERANCE).is_empty() {
            return None;
        }
        let score = part.transpose() * residuals.rows(group.start, group.len());
        let change = inverse_information(&rest)? * score;
        sum += &change * change.transpose();
    }
    let count = groups.len() as f64;
    (groups.len() > 1).then(|| sum * ((count - 1.0) / count))
}
