//! A rectangle with round corners, for robots that cannot turn on the spot.

use super::square::SIDE_BOUNDS;
use super::{Move, Shape};
use crate::parameter::{Parameter, ParameterError};
use std::f64::consts::FRAC_PI_2;

/// Four straight legs and four quarter circles. START is where the first corner's arc would begin if it came before the first leg: at
/// the end of the last arc.
pub static SHAPE: Shape = Shape {
    name: "rounded_rectangle",
    about: "two long and two short legs with quarter circles for corners: for robots that cannot turn on the spot",
    parameters: &[
        side("length_m", "length", 4.0, "length of the first side, corners included"),
        side("width_m", "width", 4.0, "length of the second side, corners included"),
        side("corner_radius_m", "corner-radius", 1.0, "radius of the corners"),
    ],
    closed: true,
    flows: false,
    moves: |values| {
        let [length, width, radius] = [values[0], values[1], values[2]];
        let most = 0.5 * length.min(width);
        if radius > most {
            let allowed = format!("between {} and {most} m (half of the shorter side)", SIDE_BOUNDS.0);
            return Err(ParameterError { name: "corner_radius_m", value: radius, allowed }.into());
        }
        let side = |side: f64| {
            let straight = side - 2.0 * radius;
            let leg = (straight > 0.0).then_some(Move::Straight { length: straight });
            leg.into_iter().chain([Move::Arc { radius, angle: FRAC_PI_2 }])
        };
        Ok([length, width, length, width].into_iter().flat_map(side).collect())
    },
};

const fn side(name: &'static str, flag: &'static str, usual: f64, meaning: &'static str) -> Parameter {
    Parameter::shape(name, flag, "m", usual, SIDE_BOUNDS, meaning)
}
