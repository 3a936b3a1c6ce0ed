//! The same distances compiled for wider registers.

use super::{EIGHT, Eight, Scores};

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn distances_by_eight(scores: &Scores, signs: &[Eight]) -> [f64; EIGHT] {
    scores.distances_plainly(signs)
}

#[target_feature(enable = "avx2")]
pub(super) fn distances_by_four(scores: &Scores, signs: &[Eight]) -> [f64; EIGHT] {
    scores.distances_plainly(signs)
}
