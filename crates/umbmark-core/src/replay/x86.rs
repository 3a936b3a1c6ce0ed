//! The same replay compiled for wider registers.

use super::track::Track;
use crate::effect::{Chain, Evaluate};
use crate::geometry::Pose2;
use std::ops::Range;

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn drive_by_eight<T: Evaluate>(
    track: &Track,
    chain: &Chain<T>,
    from: Pose2<T>,
    pieces: Range<usize>,
) -> Pose2<T> {
    track.drive_plainly(chain, from, pieces)
}

#[target_feature(enable = "avx2")]
pub(super) fn drive_by_four<T: Evaluate>(
    track: &Track,
    chain: &Chain<T>,
    from: Pose2<T>,
    pieces: Range<usize>,
) -> Pose2<T> {
    track.drive_plainly(chain, from, pieces)
}
