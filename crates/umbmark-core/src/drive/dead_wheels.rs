//! Three wheels that roll beside the driven ones and are only counted.

use super::kinematics::{Kinematics, Spelling};
use super::rollers::{RollerWheel, Rollers};
use super::{DifferentialDrive, DriveError};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_2;

/// The nominal kinematics of three tracking wheels, whatever drives the robot: two along, left and right of its centre, and one across.
///
/// With the ways w of the wheels, ahead and to the left positive, the width W between the first two, and the place x of the third ahead of the centre:
///
/// ```text
/// ahead = (w₁ + w₂)/2,  left = w₃ - x turn,  turn = (w₂ - w₁)/W
/// ```
///
/// They are omni wheels: they slide sideways freely. Its axle is that of the first two. Source: kinematics; three-wheel localisers of Road Runner and
/// of other robots of FTC and VEX.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadWheelsDrive {
    axle: DifferentialDrive,
    ahead: f64,
    diameters: [f64; 3],
}

impl DeadWheelsDrive {
    /// Tracking wheels from the distance of the left one from the right one, from how far the one across stands ahead of the centre, and from their diameters
    /// \[m\]: left, right, across.
    pub fn new(width: f64, ahead: f64, diameters: [f64; 3]) -> Result<Self, DriveError> {
        let mean = 0.5 * (diameters[0] + diameters[1]);
        DeadWheelsDrive { axle: DifferentialDrive::of_axle(width, mean), ahead, diameters }.checked()
    }

    /// Diameters of its wheels \[m\].
    pub fn wheel_diameters(&self) -> [f64; 3] {
        self.diameters
    }
}

const DIAMETER: Parameter = Parameter::shape("wheel_diameter_m", "", "m", 0.05, (1e-3, 10.0), "diameter of all wheels");

const ALL_WHEELS: &[&str] = &["wheel_diameter_1_m", "wheel_diameter_2_m", "wheel_diameter_3_m"];

impl Kinematics for DeadWheelsDrive {
    const NAME: &'static str = "dead_wheels";

    const ABOUT: &'static str = "Three wheels that are counted and not driven, two along and one across, on a robot that may also move sideways. Those along count up \
         as it drives ahead, the one across as it moves to the left.";

    const WHEELS: &'static [&'static str] = &["1", "2", "3"];

    const IS_DRIVEN: bool = false;

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "wheel_distance_width_m",
            "",
            "m",
            0.3,
            (1e-3, 100.0),
            "distance of the left wheel's contact point from the right one",
        ),
        Parameter::shape(
            "across_wheel_ahead_m",
            "",
            "m",
            -0.1,
            (-100.0, 100.0),
            "how far the wheel across stands ahead of the middle of the other two; negative behind it",
        ),
        Parameter { name: "wheel_diameter_1_m", meaning: "diameter of the left wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_2_m", meaning: "diameter of the right wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_3_m", meaning: "diameter of the wheel across", ..DIAMETER },
    ];

    const SPELLINGS: &'static [Spelling] = &[
        Spelling { parameter: DIAMETER, of: ALL_WHEELS, factor: 1.0 },
        Spelling {
            parameter: Parameter::shape("wheel_radius_m", "", "m", 0.025, (5e-4, 5.0), "radius of all wheels"),
            of: ALL_WHEELS,
            factor: 2.0,
        },
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["along_diameter_ratio", "wheelbase", "roller_scale"];

    const OWN_EFFECTS: &'static [&'static str] = &["across_diameter_ratio", "across_wheel_offset"];

    const EFFECTS: &'static [&'static str] = &["wheelbase"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        DeadWheelsDrive::new(values[0], values[1], [values[2], values[3], values[4]])
    }

    fn values(&self) -> Vec<f64> {
        [self.axle.wheelbase(), self.ahead].into_iter().chain(self.diameters).collect()
    }

    /// The drive as its odometry must believe it to be, for a ratio of the right wheel's diameter to the left one's, of all distances, and of all
    /// diameters.
    fn corrected(&self, [sides, distance, scale]: [f64; 3]) -> Result<Self, DriveError> {
        let left = 2.0 * scale / (1.0 + sides);
        let [a, b, c] = self.diameters;
        let diameters = [a * left, b * left * sides, c * scale];
        DeadWheelsDrive::new(self.axle.wheelbase() * distance, self.ahead * distance, diameters)
    }

    /// For a ratio of the diameter across to those along, and a place across \[m\] ahead of the believed one.
    fn also_corrected(&self, own: &[f64]) -> Result<Self, DriveError> {
        let [a, b, c] = self.diameters;
        DeadWheelsDrive::new(self.axle.wheelbase(), self.ahead + own[1], [a, b, c * own[0]])
    }

    fn wheel_layout(&self) -> [f64; 2] {
        [self.ahead / (0.5 * self.axle.wheelbase()), 0.0]
    }

    fn rollers(&self) -> Option<Rollers> {
        let wheel = |at: [f64; 2], rolls: f64, diameter: f64| RollerWheel { at, rolls, roller: 0.0, diameter };
        let (half, [a, b, c]) = (0.5 * self.axle.wheelbase(), self.diameters);
        Rollers::new(vec![
            wheel([0.0, half], 0.0, a),
            wheel([0.0, -half], 0.0, b),
            wheel([self.ahead, 0.0], FRAC_PI_2, c),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the equations above.
    #[test]
    fn its_ways_mean_the_motion_of_the_equations() {
        let rollers = DeadWheelsDrive::new(0.3, -0.1, [0.05; 3]).unwrap().rollers().unwrap();
        for [w1, w2, w3] in [[0.1, 0.2, -0.3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            let motion = rollers.motion(&[w1, w2, w3]);
            let turn = (w2 - w1) / 0.3;
            assert!((motion.forward - 0.5 * (w1 + w2)).abs() < 1e-14, "{motion:?}");
            assert!((motion.sideways - (w3 + 0.1 * turn)).abs() < 1e-14, "{motion:?}");
            assert!((motion.rotation - turn).abs() < 1e-13, "{motion:?}");
        }
    }

    #[test]
    fn corrected_wheels_have_the_true_lengths() {
        let known = DeadWheelsDrive::new(0.3, -0.1, [0.05; 3]).unwrap().corrected([1.02, 1.1, 0.99]).unwrap();
        let [a, b, c] = known.wheel_diameters();
        assert!((b / a - 1.02).abs() < 1e-15 && ((a + b) / 2.0 - 0.0495).abs() < 1e-15 && (c - 0.0495).abs() < 1e-15);
        assert!((known.axle.wheelbase() - 0.33).abs() < 1e-15 && (known.ahead + 0.11).abs() < 1e-15);
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(DeadWheelsDrive::new(0.0, 0.1, [0.05; 3]).is_err());
        assert!(DeadWheelsDrive::new(0.3, f64::NAN, [0.05; 3]).is_err());
    }
}
