//! A straight to the side.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;

/// One leg to the side, to the left in the counter-clockwise direction and to the right in the clockwise one: its length is that of ways to
/// the side alone.
pub static SHAPE: Shape = Shape {
    name: "slide",
    about: "one straight leg to the side, measured at its end: for robots that move sideways",
    parameters: &[Parameter::shape("length_m", "length", "m", 4.0, SIDE_BOUNDS, "length of the leg")],
    closed: false,
    flows: false,
    moves: |values| Ok(vec![Move::Slide { ahead: 0.0, left: values[0] }]),
};
