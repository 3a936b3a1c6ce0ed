//! The square of UMBmark.

use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;

pub(super) const SIDE_BOUNDS: (f64, f64) = (1e-3, 1e4);

/// Four straight legs and four quarter turns on the spot: Borenstein & Feng (1995), section 3.
pub static SHAPE: Shape = Shape {
    name: "square",
    about: "four straight legs, each followed by a quarter turn on the spot: the path of UMBmark",
    parameters: &[Parameter::shape("side_m", "side", "m", 4.0, SIDE_BOUNDS, "length of a side")],
    closed: true,
    flows: false,
    moves: |values| Ok(sides(&[values[0]; 4])),
};

/// Legs of the given lengths \[m\], a quarter turn to the left after each.
pub(super) fn sides(lengths: &[f64]) -> Vec<Move> {
    lengths.iter().flat_map(|&length| [Move::Straight { length }, Move::Turn { angle: FRAC_PI_2 }]).collect()
}
