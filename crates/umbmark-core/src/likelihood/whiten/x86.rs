//! The same filter compiled for wider registers.

use super::{Eight, Noise, ObservedRun, Whitened};

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn whiten_by_eight(noise: &Noise, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
    noise.whiten_plainly(run, columns)
}

#[target_feature(enable = "avx2")]
pub(super) fn whiten_by_four(noise: &Noise, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
    noise.whiten_plainly(run, columns)
}

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn products_by_eight(
    noise: &Noise<Eight>,
    run: &ObservedRun,
    columns: &[&[[f64; 3]]],
) -> (Vec<Eight>, Eight) {
    noise.products_plainly(run, columns)
}

#[target_feature(enable = "avx2")]
pub(super) fn products_by_four(
    noise: &Noise<Eight>,
    run: &ObservedRun,
    columns: &[&[[f64; 3]]],
) -> (Vec<Eight>, Eight) {
    noise.products_plainly(run, columns)
}
