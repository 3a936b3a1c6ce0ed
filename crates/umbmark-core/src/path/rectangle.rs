//! The rectangle of the CLAPPER's test.

use super::Shape;
use super::square::{SIDE_BOUNDS, sides};
use crate::parameter::Parameter;

/// Two long and two short legs with quarter turns: 7 x 4 m in Borenstein & Feng (1995), section 4.5.
pub static SHAPE: Shape = Shape {
    name: "rectangle",
    about: "two long and two short legs, each followed by a quarter turn on the spot",
    parameters: &[
        Parameter::shape("length_m", "length", "m", 7.0, SIDE_BOUNDS, "length of the first leg"),
        Parameter::shape("width_m", "width", "m", 4.0, SIDE_BOUNDS, "length of the second leg"),
    ],
    closed: true,
    flows: false,
    moves: |values| Ok(sides(&[values[0], values[1], values[0], values[1]])),
};
