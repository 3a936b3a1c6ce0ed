//! The circle.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::{DefaultValue, Parameter};
use std::f64::consts::TAU;

/// One arc of any number of turns: wheel speeds differ all the time, so what depends on speed or turn rate shows.
pub static CIRCLE: Shape = Shape {
    name: "circle",
    about: "a circle, driven round one or more times without stopping",
    parameters: &[
        Parameter {
            name: "radius_m",
            flag: "radius",
            unit: "m",
            default: DefaultValue::Value(1.0),
            typical: 1.0,
            bounds: SIDE_BOUNDS,
            meaning: "radius of the circle",
            choices: &[],
        },
        TURNS,
    ],
    closed: true,
    moves: |values| Ok(vec![Move::Arc { radius: values[0], angle: TAU * values[1] }]),
};

pub(super) const TURNS: Parameter = Parameter {
    name: "turns",
    flag: "turns",
    unit: "",
    default: DefaultValue::Value(1.0),
    typical: 1.0,
    bounds: (1e-3, 1e4),
    meaning: "number of full turns",
    choices: &[],
};
