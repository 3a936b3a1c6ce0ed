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
        Parameter {
            name: "tread_distance_m",
            flag: "",
            meaning: "distance of the treads' middles",
            ..DifferentialDrive::WHEELBASE
        },
        Parameter {
            name: "sprocket_left_m",
            flag: "",
            meaning: "diameter of the left sprocket",
            ..DifferentialDrive::WHEEL_DIAMETER
        },
        Parameter {
            name: "sprocket_right_m",
            flag: "",
            meaning: "diameter of the right sprocket",
            ..DifferentialDrive::WHEEL_DIAMETER
        },
    ];

    const HAS_AXLE_WHEELS: bool = true;

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
