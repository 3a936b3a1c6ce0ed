//! The square of UMBmark at a fixed heading.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;

/// Ahead, to the left, backward and to the right. The robot never turns, so the size of turns does not show; what bends a leg shows alone,
/// and that of legs ahead apart from that of legs to the side.
pub static SHAPE: Shape = Shape {
    name: "fixed_square",
    about: "four straight sides at a fixed heading, driven ahead, to the side, backward and to the other side: for robots that move sideways",
    parameters: &[Parameter::shape("side_m", "side", "m", 4.0, SIDE_BOUNDS, "length of a side")],
    closed: true,
    flows: false,
    moves: |values| Ok(around([values[0], 0.0])),
};

/// Four slides, the first by so much ahead and to the left \[m\], each a quarter turn to the left of the one before.
pub(super) fn around([mut ahead, mut left]: [f64; 2]) -> Vec<Move> {
    let side = |_| {
        let slide = Move::Slide { ahead, left };
        // No side is minus zero long.
        (ahead, left) = (0.0 - left, ahead);
        slide
    };
    (0..4).map(side).collect()
}
