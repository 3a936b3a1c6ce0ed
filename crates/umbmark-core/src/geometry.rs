//! The plane: rigid motions SE(2), angles, and the scalars they are made of.
//!
//! Poses, motions and [`Real`] are those of [`umbmark_odometry::geometry`], which robots compute with; here is what only large machines need.

mod eight;
mod instructions;
mod seeded;

pub(crate) use eight::{EIGHT, Eight, Scalar};
pub use instructions::Instructions;
pub(crate) use instructions::by_width;
pub use seeded::seeded;
pub(crate) use umbmark_odometry::geometry::{COSINE_SERIES, HALF_PI, SINC_SERIES, sinc_cos_near_zero};
pub use umbmark_odometry::geometry::{Displacement2, Dual, LANES, Pose2, Real, direction, mean_angle, wrap};
