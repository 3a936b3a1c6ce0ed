//! The triangle.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::TAU;

/// Three equal legs, a third of a turn on the spot after each.
pub static SHAPE: Shape = Shape {
    name: "triangle",
    about: "three straight legs, each followed by a third of a turn on the spot",
    parameters: &[Parameter::shape("side_m", "side", "m", 4.0, SIDE_BOUNDS, "length of a side")],
    closed: true,
    flows: false,
    moves: |values| {
        let leg = [Move::Straight { length: values[0] }, Move::Turn { angle: TAU / 3.0 }];
        Ok([leg; 3].concat())
    },
};
