//! A square on its corner.

use super::fixed_square::around;
use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_1_SQRT_2;

/// Four sides at 45 degrees to the heading, which stays. On a mecanum drive, the wheels of one diagonal turn on each side and those of the
/// other stand, so each diagonal shows by itself.
pub static SHAPE: Shape = Shape {
    name: "diagonal_square",
    about: "four straight sides at 45 degrees to a fixed heading, a square on its corner: for robots that move sideways",
    parameters: &[Parameter::shape("side_m", "side", "m", 4.0, SIDE_BOUNDS, "length of a side")],
    closed: true,
    flows: false,
    moves: |values| Ok(first_to_the_right(FRAC_1_SQRT_2 * values[0])),
};

/// Ahead and to the right first: driven counter-clockwise, the square lies ahead of START and to both sides of it.
fn first_to_the_right(half: f64) -> Vec<Move> {
    around([half, -half])
}
