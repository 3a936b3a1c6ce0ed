//! Tracked drive: two driven treads.

use super::kinematics::Kinematics;
use super::{DifferentialDrive, DriveError};
use crate::parameter::Parameter;

/// The nominal kinematics of a tracked robot: a differential drive whose wheels are its sprockets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedDrive {
    axle: DifferentialDrive,
}

impl Kinematics for TrackedDrive {
    const NAME: &'static str = "tracked";

    const ABOUT: &'static str = "Two driven treads.";

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape("tread_distance_m", "", "m", 0.4, (1e-3, 100.0), "distance of the treads' middles"),
        Parameter::shape("sprocket_left_m", "", "m", 0.15, (1e-3, 10.0), "diameter of the left sprocket"),
        Parameter::shape("sprocket_right_m", "", "m", 0.15, (1e-3, 10.0), "diameter of the right sprocket"),
    ];

    const EFFECTS: &'static [&'static str] = &["wheel_diameter_ratio", "wheelbase", "scale", "turn_slip"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        let axle = DifferentialDrive::new(values[0], values[1], values[2])?;
        TrackedDrive { axle }.checked()
    }

    fn values(&self) -> Vec<f64> {
        vec![self.axle.wheelbase(), self.axle.wheel_diameter_left(), self.axle.wheel_diameter_right()]
    }

    fn corrected(&self, first: [f64; 3]) -> Result<Self, DriveError> {
        TrackedDrive { axle: self.axle.corrected(first)? }.checked()
    }
}
