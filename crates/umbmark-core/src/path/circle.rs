//! The circle.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::TAU;

/// One arc of any number of turns: wheel speeds differ all the time, so what depends on speed or turn rate shows.
pub static SHAPE: Shape = Shape {
    name: "circle",
    about: "a circle, driven round one or more times without stopping",
    parameters: &[Parameter::shape("radius_m", "radius", "m", 1.0, SIDE_BOUNDS, "radius of the circle"), TURNS],
    closed: true,
    flows: false,
    moves: |values| Ok(vec![Move::Arc { radius: values[0], angle: TAU * values[1] }]),
};

pub(super) const TURNS: Parameter = Parameter::shape("turns", "turns", "", 1.0, (1e-3, 1e4), "number of full turns");
