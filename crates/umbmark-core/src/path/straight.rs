//! The straight line.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;

/// One straight leg: the length shows E_s, the heading E_d. Its two directions are the same.
pub static SHAPE: Shape = Shape {
    name: "straight",
    about: "one straight leg, open: the length shows the scale, the heading the wheel-diameter ratio",
    parameters: &[Parameter::shape("length_m", "length", "m", 10.0, SIDE_BOUNDS, "length of the leg")],
    closed: false,
    flows: false,
    moves: |values| Ok(vec![Move::Straight { length: values[0] }]),
};
