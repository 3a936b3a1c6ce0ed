//! Nominal robots and paths.

use schemars::JsonSchema;
use serde::Serialize;

use super::Keyed;
use crate::{drive, path};

/// A nominal robot.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RobotFacts {
    /// Its name.
    pub name: String,
    /// Its wheelbase, in m.
    pub wheelbase_m: f64,
    /// Diameter of its left wheel, in m.
    pub wheel_diameter_left_m: f64,
    /// Diameter of its right wheel, in m.
    pub wheel_diameter_right_m: f64,
    /// Ticks of an encoder per revolution of its wheel.
    pub ticks_per_revolution: f64,
    /// How often the encoders are read, in Hz; null where that is not known.
    pub encoder_rate_hz: Option<f64>,
    /// Bits of the counters; null where they do not roll over.
    pub counter_bits: Option<u32>,
}

impl From<&drive::Robot> for RobotFacts {
    fn from(robot: &drive::Robot) -> Self {
        RobotFacts {
            name: robot.name.clone(),
            wheelbase_m: robot.drive.wheelbase(),
            wheel_diameter_left_m: robot.drive.wheel_diameter_left(),
            wheel_diameter_right_m: robot.drive.wheel_diameter_right(),
            ticks_per_revolution: robot.encoder.ticks_per_revolution(),
            encoder_rate_hz: robot.encoder.rate(),
            counter_bits: robot.encoder.counter_bits(),
        }
    }
}

/// A size of a path, or its points.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Size {
    /// A size.
    Number(f64),
    /// Points, in m.
    Points(Vec<Vec<f64>>),
}

/// A path.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PathFacts {
    /// Its shape.
    pub shape: &'static str,
    /// Its sizes, in the units that their names carry, or its points.
    pub sizes: Keyed<Size>,
    /// Its length, in m.
    pub length_m: f64,
}

impl From<&path::Path> for PathFacts {
    fn from(path: &path::Path) -> Self {
        let shape = path.shape();
        let sizes = shape.parameters.iter().zip(path.values()).map(|(p, value)| (p.name, Size::Number(*value)));
        let points = || Size::Points(path.values().chunks(2).map(<[f64]>::to_vec).collect());
        let points = shape.parameters.is_empty().then(|| ("points_m", points()));
        PathFacts { shape: shape.name, sizes: sizes.chain(points).collect(), length_m: path.length() }
    }
}
