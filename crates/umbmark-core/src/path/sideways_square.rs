//! The square of UMBmark, driven to the side.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;

/// Four legs to the side and four quarter turns on the spot: what the square shows of legs ahead, it shows of legs to the side.
pub static SHAPE: Shape = Shape {
    name: "sideways_square",
    about: "four straight legs to the side, each followed by a quarter turn on the spot: the path of UMBmark for robots that move sideways",
    parameters: &[Parameter::shape("side_m", "side", "m", 4.0, SIDE_BOUNDS, "length of a side")],
    closed: true,
    flows: false,
    moves: |values| {
        let corner = [Move::Slide { ahead: 0.0, left: values[0] }, Move::Turn { angle: FRAC_PI_2 }];
        Ok([corner; 4].concat())
    },
};
