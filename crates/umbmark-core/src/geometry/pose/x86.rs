//! The same motion compiled for wider registers.

use super::{Displacement2, Pose2};
use crate::geometry::Dual;

#[target_feature(enable = "avx512f,avx512dq")]
pub(in crate::geometry) fn advance_by_eight(pose: &mut Pose2<Dual>, by: &Displacement2<Dual>) {
    pose.advance_plainly(by);
}

#[target_feature(enable = "avx2")]
pub(in crate::geometry) fn advance_by_four(pose: &mut Pose2<Dual>, by: &Displacement2<Dual>) {
    pose.advance_plainly(by);
}
