//! The same loops compiled for wider registers.

use super::LookUps;
use crate::engine::WheelLine;

#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn fill_by_eight(look_ups: &mut LookUps, line: &WheelLine, shares: &[f64], origin: i32) {
    look_ups.fill(line, shares, origin);
}

#[target_feature(enable = "avx2")]
pub(super) fn fill_by_four(look_ups: &mut LookUps, line: &WheelLine, shares: &[f64], origin: i32) {
    look_ups.fill(line, shares, origin);
}
