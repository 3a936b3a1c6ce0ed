//! The same loop compiled for wider registers.

use super::gram_of;
use nalgebra::DMatrix;

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn gram_by_eight(values: &[f64], columns: usize) -> DMatrix<f64> {
    gram_of(values, columns)
}

#[target_feature(enable = "avx2")]
pub(super) fn gram_by_four(values: &[f64], columns: usize) -> DMatrix<f64> {
    gram_of(values, columns)
}
