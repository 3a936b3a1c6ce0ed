//! Skid-steer drive: fixed wheels or a track on each side, which are driven together and slip sideways in turns.

use super::differential::{ONE_DIAMETER, ONE_RADIUS};
use super::kinematics::{Kinematics, Spelling};
use super::{DifferentialDrive, DriveError};
use crate::parameter::Parameter;

/// The nominal kinematics of a skid-steer drive.
///
/// forward = (s_R + s_L)/2, rotation = (s_R - s_L)/(m t), with the travels s_L, s_R of the sides, their distance t, and the multiplier m: each side
/// turns about a point beyond its wheels, and these two points are m t apart. Source: Mandow et al. (2007), Experimental kinematics for
/// wheeled skid-steer mobile robots; what drivers of such robots call the wheel separation multiplier.
///
/// Where the points lie ahead of or behind the middle of the sides, the robot moves sideways in turns. A reference cannot tell that from its tracked
/// point being elsewhere on the robot, which is the effect `marker_offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkidSteerDrive {
    track_width: f64,
    multiplier: f64,
    axle: DifferentialDrive,
}

impl SkidSteerDrive {
    /// A drive from the distance of its sides \[m\], the multiplier of it, and the diameters of the wheels of each side \[m\].
    pub fn new(
        track_width: f64,
        multiplier: f64,
        wheel_diameter_left: f64,
        wheel_diameter_right: f64,
    ) -> Result<Self, DriveError> {
        let values = [track_width, multiplier, wheel_diameter_left, wheel_diameter_right];
        for (parameter, value) in Self::PARAMETERS.iter().zip(values) {
            parameter.check(value)?;
        }
        let axle = DifferentialDrive::new(track_width * multiplier, wheel_diameter_left, wheel_diameter_right)?;
        Ok(SkidSteerDrive { track_width, multiplier, axle })
    }
}

impl Kinematics for SkidSteerDrive {
    const NAME: &'static str = "skid_steer";

    const ABOUT: &'static str = "Fixed wheels or a track on each side, which slip sideways in turns.";

    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            name: "track_width_m",
            flag: "",
            meaning: "distance of the left wheels' middle from the right wheels'",
            ..DifferentialDrive::WHEELBASE
        },
        Parameter::shape(
            "wheel_separation_multiplier",
            "",
            "",
            1.5,
            (0.1, 10.0),
            "how many times as far apart two wheels without slip would be that turn the robot as far",
        ),
        Parameter {
            name: "wheel_diameter_left_m",
            meaning: "diameter of the wheels on the left",
            ..DifferentialDrive::WHEEL_DIAMETER
        },
        Parameter {
            name: "wheel_diameter_right_m",
            meaning: "diameter of the wheels on the right",
            ..DifferentialDrive::WHEEL_DIAMETER
        },
    ];

    const SPELLINGS: &'static [Spelling] = &[
        Spelling {
            parameter: Parameter { name: "wheel_separation_m", flag: "", ..DifferentialDrive::WHEELBASE },
            of: &["track_width_m"],
            factor: 1.0,
        },
        ONE_DIAMETER,
        ONE_RADIUS,
    ];

    const HAS_AXLE_WHEELS: bool = true;

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        SkidSteerDrive::new(values[0], values[1], values[2], values[3])
    }

    fn values(&self) -> Vec<f64> {
        let diameters = [self.axle.wheel_diameter_left(), self.axle.wheel_diameter_right()];
        [[self.track_width, self.multiplier], diameters].concat()
    }

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn track_width(&self) -> f64 {
        self.track_width
    }

    fn corrected(&self, first: [f64; 3]) -> Result<Self, DriveError> {
        let axle = self.axle.corrected(first)?;
        let multiplier = axle.wheelbase() / self.track_width;
        SkidSteerDrive::new(self.track_width, multiplier, axle.wheel_diameter_left(), axle.wheel_diameter_right())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{Drive, WheelTravel};

    #[test]
    fn the_sides_turn_the_robot_as_wheels_that_are_further_apart_would() {
        let drive: Drive = SkidSteerDrive::new(0.4, 1.8, 0.2, 0.2).unwrap().into();
        let moved = drive.displacement(&WheelTravel { left: -0.18, right: 0.18 });
        assert!(moved.forward.abs() < 1e-15 && (moved.rotation - 0.36 / 0.72).abs() < 1e-15, "{moved:?}");
    }

    #[test]
    fn what_corrects_e_b_is_the_multiplier_and_not_the_distance_that_a_tape_measures() {
        let drive = SkidSteerDrive::new(0.4, 1.8, 0.2, 0.2).unwrap();
        let corrected = drive.corrected([1.01, 1.05, 0.99]).unwrap();
        let [track, multiplier, left, right] = corrected.values()[..] else { panic!() };
        assert_eq!(track, 0.4);
        assert!((multiplier - 1.8 * 1.05).abs() < 1e-12 && (right / left - 1.01).abs() < 1e-12);
        assert!((0.5 * (left + right) - 0.2 * 0.99).abs() < 1e-12);
    }

    #[test]
    fn impossible_numbers_are_refused_with_the_key() {
        let said = |track, multiplier| SkidSteerDrive::new(track, multiplier, 0.2, 0.2).unwrap_err().to_string();
        assert_eq!(said(0.4, 20.0), "wheel_separation_multiplier must be between 0.1 and 10, got 20");
        assert_eq!(said(-0.4, 1.5), "track_width_m must be between 0.001 and 100 m, got -0.4");
    }
}
