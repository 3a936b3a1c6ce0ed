//! `spin`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::drive::Robot;

/// What a turn on the spot takes.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Spin {
    /// Name of the robot.
    pub robot: String,
    /// How far each wheel rolls, in m.
    pub travel_m: f64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Spin {
    /// A whole turn of a robot.
    pub fn new(robot: &Robot) -> Spin {
        let travel_m = std::f64::consts::PI * robot.drive.wheelbase();
        Spin { robot: robot.name.clone(), travel_m, version: crate::VERSION }
    }
}
