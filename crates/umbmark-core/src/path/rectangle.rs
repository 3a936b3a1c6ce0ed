//! The rectangle of the CLAPPER's test.

use super::Shape;
use super::square::{SIDE_BOUNDS, sides};
use crate::parameter::{DefaultValue, Parameter};

/// Two long and two short legs with quarter turns: 7 x 4 m in Borenstein & Feng (1995), section 4.5.
pub static RECTANGLE: Shape = Shape {
    name: "rectangle",
    about: "two long and two short legs, each followed by a quarter turn on the spot",
    parameters: &[
        Parameter {
            name: "length_m",
            flag: "length",
            unit: "m",
            default: DefaultValue::Value(7.0),
            typical: 7.0,
            bounds: SIDE_BOUNDS,
            meaning: "length of the first leg",
            choices: &[],
        },
        Parameter {
            name: "width_m",
            flag: "width",
            unit: "m",
            default: DefaultValue::Value(4.0),
            typical: 4.0,
            bounds: SIDE_BOUNDS,
            meaning: "length of the second leg",
            choices: &[],
        },
    ],
    closed: true,
    moves: |values| Ok(sides(&[values[0], values[1], values[0], values[1]])),
};
