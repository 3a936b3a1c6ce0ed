//! The same loop compiled for wider registers.

use super::{Block, Motion, WIDTH, all_ends};

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn all_ends_by_eight(blocks: &mut [Block], ends: &mut [[Motion; WIDTH]], rotation_per_metre: f64) {
    all_ends(blocks, ends, rotation_per_metre);
}

#[target_feature(enable = "avx2")]
pub(super) fn all_ends_by_four(blocks: &mut [Block], ends: &mut [[Motion; WIDTH]], rotation_per_metre: f64) {
    all_ends(blocks, ends, rotation_per_metre);
}
