//! True lengths, from nominal ones and ratios.

use super::estimate::Estimate;
use crate::drive::Robot;

/// The true lengths \[m\], as far as the ratios are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lengths {
    /// E_b times the nominal wheelbase.
    pub wheelbase: Option<f64>,
    /// Diameter of the left wheel.
    pub left: Option<f64>,
    /// Diameter of the right wheel.
    pub right: Option<f64>,
}

impl Estimate {
    /// The true lengths of a nominal robot.
    pub fn lengths(&self, robot: &Robot) -> Lengths {
        let (left, right) = self.correction.wheel_factors();
        let wheels = self.shown[0] || self.shown[2];
        Lengths {
            wheelbase: self.shown[1].then(|| robot.drive.wheelbase() * self.correction.e_b),
            left: wheels.then(|| robot.drive.wheel_diameter_left() * left),
            right: wheels.then(|| robot.drive.wheel_diameter_right() * right),
        }
    }
}
