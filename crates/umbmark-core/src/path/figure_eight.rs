//! The crossing figure-eight.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::TAU;

/// A full circle to the left, then one to the right, through START. To first order it shows E_d in the return heading
/// only and E_b in the return position only.
pub static SHAPE: Shape = Shape {
    name: "figure_eight",
    about: "a full circle to one side, then a full circle to the other, crossing at START",
    parameters: &[Parameter::shape("radius_m", "radius", "m", 2.0, SIDE_BOUNDS, "radius of each circle")],
    closed: true,
    flows: false,
    moves: |values| Ok([TAU, -TAU].map(|angle| Move::Arc { radius: values[0], angle }).to_vec()),
};
