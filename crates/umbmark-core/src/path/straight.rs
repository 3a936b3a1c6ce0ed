//! The straight line.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::{DefaultValue, Parameter};

/// One straight leg: the length shows E_s, the heading E_d. Its two directions are the same.
pub static STRAIGHT: Shape = Shape {
    name: "straight",
    about: "one straight leg, open: the length shows the scale, the heading the wheel-diameter ratio",
    parameters: &[Parameter {
        name: "length_m",
        flag: "length",
        unit: "m",
        default: DefaultValue::Value(10.0),
        typical: 10.0,
        bounds: SIDE_BOUNDS,
        meaning: "length of the leg",
        choices: &[],
    }],
    closed: false,
    moves: |values| Ok(vec![Move::Straight { length: values[0] }]),
};
