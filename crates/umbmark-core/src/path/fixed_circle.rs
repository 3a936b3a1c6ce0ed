//! A circle at a fixed heading.

use super::circle::TURNS;
use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::Parameter;
use std::f64::consts::TAU;

/// Sides of the polygon that a turn round the circle is driven as; it lies within 4e-5 of the radius of the circle.
const SIDES: f64 = 360.0;

/// The course goes round while the heading stays: every direction in which the base can move is driven, at wheel speeds that change all the
/// time. It is driven as a polygon, without stopping.
pub static SHAPE: Shape = Shape {
    name: "fixed_circle",
    about: "a circle at a fixed heading, driven round one or more times without stopping or turning: for robots that move sideways",
    parameters: &[Parameter::shape("radius_m", "radius", "m", 1.0, SIDE_BOUNDS, "radius of the circle"), TURNS],
    closed: true,
    flows: true,
    moves: |values| Ok(around(values[0], values[1])),
};

/// Chords of equal angle, the first of them ahead.
fn around(radius: f64, turns: f64) -> Vec<Move> {
    let count = (SIDES * turns).ceil().max(1.0);
    let step = TAU * turns / count;
    let chord = 2.0 * radius * libm::sin(0.5 * step);
    let side = |k: usize| {
        let (sine, cosine) = libm::sincos((k as f64 + 0.5) * step);
        Move::Slide { ahead: chord * cosine, left: chord * sine }
    };
    (0..count as usize).map(side).collect()
}
