//! The plane: rigid motions SE(2), angles, and the scalars they are made of.
//!
//! | type | meaning | components |
//! |---|---|---|
//! | [`Pose2`] | where a body is, `world_from_body` | x \[m\], y \[m\], heading \[rad\], counter-clockwise |
//! | [`Displacement2`] | a body-frame twist times a time: the logarithm of a motion | forward \[m\], sideways \[m\] (left positive), rotation \[rad\] |
//!
//! Everything is generic over [`Real`], so that the same code gives values (`f64`) and exact derivatives ([`Dual`]).

mod angle;
mod pose;
mod real;

pub use angle::{mean_angle, wrap};
pub use pose::{Displacement2, Pose2};
pub use real::{
    COSINE_SERIES, Dual, HALF_PI, LANES, Real, SINC_SERIES, direction, sin_cos_reduced, sinc_cos_near_zero,
};
