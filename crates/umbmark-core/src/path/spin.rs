//! Turns on the spot.

use super::circle::TURNS;
use super::{Move, Shape};
use std::f64::consts::TAU;

/// Full turns on the spot: E_d does nothing here, so E_b (with scrub) stands alone.
pub static SHAPE: Shape = Shape {
    name: "spin",
    about: "one or more full turns on the spot",
    parameters: &[TURNS],
    closed: true,
    flows: false,
    moves: |values| Ok(vec![Move::Turn { angle: TAU * values[0] }]),
};
