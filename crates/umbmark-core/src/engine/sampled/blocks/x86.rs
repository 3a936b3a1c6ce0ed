//! The same loop compiled for wider registers.

use super::super::carries::x86::{Avx2Carries, Avx512Carries};
use super::{EqualPieces, Reached, Walk};

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn walk_by_eight(walk: &Walk, pieces: &EqualPieces, words: u32) -> Reached {
    // SAFETY: this is compiled for these instructions only.
    walk.along([0, 1].map(|i| unsafe { Avx512Carries::new(pieces.phase[i], pieces.rest[i]) }), words)
}

#[target_feature(enable = "avx2")]
pub(super) fn walk_by_four(walk: &Walk, pieces: &EqualPieces, words: u32) -> Reached {
    // SAFETY: as above.
    walk.along([0, 1].map(|i| unsafe { Avx2Carries::new(pieces.phase[i], pieces.rest[i]) }), words)
}
