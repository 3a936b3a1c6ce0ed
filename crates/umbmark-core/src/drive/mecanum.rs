//! Mecanum drive: four driven wheels at the corners of a rectangle, with rollers at 45 degrees.

use super::kinematics::{Kinematics, Spelling};
use super::rollers::{RollerWheel, Rollers};
use super::{DifferentialDrive, DriveError};
use crate::parameter::Parameter;
use std::f64::consts::FRAC_PI_4;

/// The nominal kinematics of a mecanum drive about the centre of its wheels: front left, front right, rear left, rear right.
///
/// With the ways w of the wheels, ahead positive, and D = length + track:
///
/// ```text
/// ahead = (w₁ + w₂ + w₃ + w₄)/4,  left = (-w₁ + w₂ + w₃ - w₄)/4,  turn = (-w₁ + w₂ - w₃ + w₄)/(2 D)
/// ```
///
/// What the wheels disagree on is (w₁ + w₂ - w₃ - w₄)/4. Its axle has wheels at a distance D, each with the mean way of one side. Source: Muir &
/// Neuman (1987), with the signs of `mecanum_drive_controller` of ROS 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MecanumDrive {
    axle: DifferentialDrive,
    length: f64,
    track: f64,
    diameters: [f64; 4],
}

impl MecanumDrive {
    /// A drive from the distance of its front wheels from its rear ones, of its left wheels from its right ones, and their diameters \[m\]: front
    /// left, front right, rear left, rear right.
    pub fn new(length: f64, track: f64, diameters: [f64; 4]) -> Result<Self, DriveError> {
        let mean = diameters.iter().sum::<f64>() / 4.0;
        MecanumDrive { axle: DifferentialDrive::of_axle(length + track, mean), length, track, diameters }.checked()
    }

    /// Diameters of its wheels \[m\].
    pub fn wheel_diameters(&self) -> [f64; 4] {
        self.diameters
    }
}

const DIAMETER: Parameter = Parameter::shape("wheel_diameter_m", "", "m", 0.15, (1e-3, 10.0), "diameter of all wheels");

const ALL_WHEELS: &[&str] = &["wheel_diameter_1_m", "wheel_diameter_2_m", "wheel_diameter_3_m", "wheel_diameter_4_m"];

impl Kinematics for MecanumDrive {
    const NAME: &'static str = "mecanum";

    const ABOUT: &'static str = "Four driven wheels at the corners of a rectangle, with rollers at 45 degrees: it also moves sideways. All count up as it drives ahead.";

    const WHEELS: &'static [&'static str] = &["1", "2", "3", "4"];

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "wheel_distance_length_m",
            "",
            "m",
            0.3,
            (1e-3, 100.0),
            "distance of the front wheels' contact points from the rear ones",
        ),
        Parameter::shape(
            "wheel_distance_width_m",
            "",
            "m",
            0.3,
            (1e-3, 100.0),
            "distance of the left wheels' contact points from the right ones",
        ),
        Parameter { name: "wheel_diameter_1_m", meaning: "diameter of the front left wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_2_m", meaning: "diameter of the front right wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_3_m", meaning: "diameter of the rear left wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_4_m", meaning: "diameter of the rear right wheel", ..DIAMETER },
    ];

    const SPELLINGS: &'static [Spelling] = &[
        Spelling { parameter: DIAMETER, of: ALL_WHEELS, factor: 1.0 },
        Spelling {
            parameter: Parameter::shape("wheel_radius_m", "", "m", 0.075, (5e-4, 5.0), "radius of all wheels"),
            of: ALL_WHEELS,
            factor: 2.0,
        },
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["side_diameter_ratio", "wheelbase", "roller_scale"];

    const OWN_EFFECTS: &'static [&'static str] = &["diagonal_diameter_ratio", "axle_diameter_ratio"];

    const EFFECTS: &'static [&'static str] = &["wheelbase"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        MecanumDrive::new(values[0], values[1], [values[2], values[3], values[4], values[5]])
    }

    fn values(&self) -> Vec<f64> {
        [self.length, self.track].into_iter().chain(self.diameters).collect()
    }

    /// The drive as its odometry must believe it to be, for a ratio of the right wheels' diameters to the left ones', of the distances of its
    /// wheels, and of all diameters.
    fn corrected(&self, [sides, distance, scale]: [f64; 3]) -> Result<Self, DriveError> {
        let left = 2.0 * scale / (1.0 + sides);
        let [a, b, c, d] = self.diameters;
        let right = left * sides;
        MecanumDrive::new(self.length * distance, self.track * distance, [a * left, b * right, c * left, d * right])
    }

    /// For ratios of the diameters of front left and rear right to the others, and of the front ones to the rear ones.
    fn also_corrected(&self, own: &[f64]) -> Result<Self, DriveError> {
        let [diagonal, axle] = [own[0], own[1]].map(|ratio| (ratio - 1.0) / (ratio + 1.0));
        let of = |wheel: usize, ahead: f64, left: f64| {
            self.diameters[wheel] * (1.0 + ahead * left * diagonal) * (1.0 + ahead * axle)
        };
        let diameters = [of(0, 1.0, 1.0), of(1, 1.0, -1.0), of(2, -1.0, 1.0), of(3, -1.0, -1.0)];
        MecanumDrive::new(self.length, self.track, diameters)
    }

    fn rollers(&self) -> Option<Rollers> {
        let wheel = |ahead: f64, left: f64, diameter: f64| RollerWheel {
            at: [0.5 * ahead * self.length, 0.5 * left * self.track],
            rolls: 0.0,
            roller: -ahead * left * FRAC_PI_4,
            diameter,
        };
        let [a, b, c, d] = self.diameters;
        Rollers::new(vec![wheel(1.0, 1.0, a), wheel(1.0, -1.0, b), wheel(-1.0, 1.0, c), wheel(-1.0, -1.0, d)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the equations of the OptiOdom data, where wheels 2 and 4 count up when they roll back.
    #[test]
    fn its_ways_mean_the_published_motion() {
        let drive = MecanumDrive::new(0.205, 0.215, [0.06; 4]).unwrap();
        let rollers = drive.rollers().unwrap();
        for [w1, w2, w3, w4] in [[0.1, 0.2, -0.3, 0.05], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]] {
            let motion = rollers.motion(&[w1, -w2, w3, -w4]);
            assert!((motion.forward - (w1 - w2 + w3 - w4) / 4.0).abs() < 1e-15, "{motion:?}");
            assert!((motion.sideways - (-w1 - w2 + w3 + w4) / 4.0).abs() < 1e-15, "{motion:?}");
            assert!((motion.rotation + (w1 + w2 + w3 + w4) / (2.0 * 0.42)).abs() < 1e-14, "{motion:?}");
            let apart = rollers.disagreement(&[w1, -w2, w3, -w4]);
            assert!((apart - (w1 - w2 - w3 + w4) / 4.0).abs() < 1e-15, "{apart}");
        }
    }

    #[test]
    fn its_axle_rolls_as_the_means_of_its_sides() {
        let drive = MecanumDrive::new(0.2, 0.3, [0.1; 4]).unwrap();
        let ways = [0.1, 0.25, 0.3, -0.05];
        let motion = drive.rollers().unwrap().motion(&ways);
        let travel = drive.axle.wheel_travel(motion.forward, motion.rotation);
        assert!((travel.left - 0.2).abs() < 1e-15 && (travel.right - 0.1).abs() < 1e-15, "{travel:?}");
    }

    #[test]
    fn a_corrected_mecanum_drive_has_the_true_lengths() {
        let drive = MecanumDrive::new(0.2, 0.3, [0.1, 0.1, 0.1, 0.1]).unwrap();
        let known = drive.corrected([1.02, 1.1, 0.99]).unwrap();
        let [a, b, c, d] = known.wheel_diameters();
        assert!((b / a - 1.02).abs() < 1e-15 && (d / c - 1.02).abs() < 1e-15);
        assert!(((a + b + c + d) / 4.0 - 0.099).abs() < 1e-15 && (known.axle.wheelbase() - 0.55).abs() < 1e-15);
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(MecanumDrive::new(0.2, -0.3, [0.1; 4]).is_err());
        assert!(MecanumDrive::new(0.2, 0.3, [0.1, 0.1, f64::NAN, 0.1]).is_err());
    }
}
