//! Three omni wheels that point round a circle.

use super::kinematics::{Kinematics, Spelling};
use super::rollers::{RollerWheel, Rollers};
use super::{DifferentialDrive, DriveError};
use crate::parameter::Parameter;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

/// The nominal kinematics of a base on three omni wheels, 120 degrees apart: front right, front left, rear.
///
/// With the ways w of the wheels, clockwise round the base positive, and their distance L from its centre:
///
/// ```text
/// ahead = (-w₁ + w₂)/√3,  left = (-w₁ - w₂ + 2 w₃)/3,  turn = -(w₁ + w₂ + w₃)/(3 L)
/// ```
///
/// Its axle has wheels at a distance of 2 L. Source: Pin & Killough (1994); the order and the signs are those of the OptiOdom data (Sousa et al.,
/// 2022).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Omni3Drive {
    axle: DifferentialDrive,
    distance: f64,
    diameters: [f64; 3],
}

impl Omni3Drive {
    /// A drive from the distance of its wheels from the centre, and their diameters \[m\]: front right, front left, rear.
    pub fn new(distance: f64, diameters: [f64; 3]) -> Result<Self, DriveError> {
        let mean = diameters.iter().sum::<f64>() / 3.0;
        Omni3Drive { axle: DifferentialDrive::of_axle(2.0 * distance, mean), distance, diameters }.checked()
    }

    /// Diameters of its wheels \[m\].
    pub fn wheel_diameters(&self) -> [f64; 3] {
        self.diameters
    }
}

const DIAMETER: Parameter = Parameter::shape("wheel_diameter_m", "", "m", 0.10, (1e-3, 10.0), "diameter of all wheels");

const ALL_WHEELS: &[&str] = &["wheel_diameter_1_m", "wheel_diameter_2_m", "wheel_diameter_3_m"];

impl Kinematics for Omni3Drive {
    const NAME: &'static str = "omni3";

    const ABOUT: &'static str = "Three omni wheels, 120 degrees apart, that point round a circle: it also moves sideways. All count up as it turns clockwise.";

    const WHEELS: &'static [&'static str] = &["1", "2", "3"];

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "wheel_distance_m",
            "",
            "m",
            0.2,
            (1e-3, 100.0),
            "distance of the wheels' contact points from the centre",
        ),
        Parameter { name: "wheel_diameter_1_m", meaning: "diameter of the front right wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_2_m", meaning: "diameter of the front left wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_3_m", meaning: "diameter of the rear wheel", ..DIAMETER },
    ];

    const SPELLINGS: &'static [Spelling] = &[
        Spelling { parameter: DIAMETER, of: ALL_WHEELS, factor: 1.0 },
        Spelling {
            parameter: Parameter::shape("wheel_radius_m", "", "m", 0.05, (5e-4, 5.0), "radius of all wheels"),
            of: ALL_WHEELS,
            factor: 2.0,
        },
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["front_diameter_ratio", "wheelbase", "roller_scale"];

    const OWN_EFFECTS: &'static [&'static str] = &["rear_diameter_ratio"];

    const EFFECTS: &'static [&'static str] = &["wheelbase"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        Omni3Drive::new(values[0], [values[1], values[2], values[3]])
    }

    fn values(&self) -> Vec<f64> {
        [self.distance].into_iter().chain(self.diameters).collect()
    }

    /// The drive as its odometry must believe it to be, for a ratio of the front left wheel's diameter to the front right one's, of the
    /// distances of its wheels, and of all diameters.
    fn corrected(&self, [fronts, distance, scale]: [f64; 3]) -> Result<Self, DriveError> {
        let right = 2.0 * scale / (1.0 + fronts);
        let [a, b, c] = self.diameters;
        Omni3Drive::new(self.distance * distance, [a * right, b * right * fronts, c * scale])
    }

    /// For a ratio of the rear wheel's diameter to the mean of the front ones'; the mean of all stays.
    fn also_corrected(&self, own: &[f64]) -> Result<Self, DriveError> {
        let front = 3.0 / (2.0 + own[0]);
        let [a, b, c] = self.diameters;
        Omni3Drive::new(self.distance, [a * front, b * front, c * front * own[0]])
    }

    fn rollers(&self) -> Option<Rollers> {
        let wheel = |from_ahead: f64, diameter: f64| {
            let (sine, cosine) = libm::sincos(from_ahead);
            let at = [self.distance * cosine, self.distance * sine];
            RollerWheel { at, rolls: from_ahead - FRAC_PI_2, roller: 0.0, diameter }
        };
        let [a, b, c] = self.diameters;
        Rollers::new(vec![wheel(-FRAC_PI_3, a), wheel(FRAC_PI_3, b), wheel(PI, c)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the equations of the OptiOdom data.
    #[test]
    fn its_ways_mean_the_published_motion() {
        let rollers = Omni3Drive::new(0.195, [0.102; 3]).unwrap().rollers().unwrap();
        for [w1, w2, w3] in [[0.1, 0.2, -0.3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            let motion = rollers.motion(&[w1, w2, w3]);
            assert!((motion.forward - (w2 - w1) / 3.0_f64.sqrt()).abs() < 1e-15, "{motion:?}");
            assert!((motion.sideways - (2.0 * w3 - w1 - w2) / 3.0).abs() < 1e-15, "{motion:?}");
            assert!((motion.rotation + (w1 + w2 + w3) / (3.0 * 0.195)).abs() < 1e-14, "{motion:?}");
        }
    }

    #[test]
    fn a_corrected_base_has_the_true_lengths() {
        let known = Omni3Drive::new(0.2, [0.1; 3]).unwrap().corrected([1.02, 1.1, 0.99]).unwrap();
        let [a, b, c] = known.wheel_diameters();
        assert!((b / a - 1.02).abs() < 1e-15 && ((a + b) / 2.0 - 0.099).abs() < 1e-15 && (c - 0.099).abs() < 1e-15);
        assert!((known.axle.wheelbase() - 0.44).abs() < 1e-15);
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(Omni3Drive::new(0.0, [0.1; 3]).is_err() && Omni3Drive::new(0.2, [0.1, 0.1, f64::NAN]).is_err());
    }
}
