//! Four omni wheels that point round a circle.

use super::kinematics::{Kinematics, Spelling};
use super::rollers::{RollerWheel, Rollers};
use super::{DifferentialDrive, DriveError};
use crate::parameter::Parameter;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The nominal kinematics of a base on four omni wheels, 90 degrees apart, anti-clockwise from the first one.
///
/// With the ways w of the wheels, clockwise round the base positive, their distance L from its centre, and the directions θ in which they stand, the first
/// at the offset:
///
/// ```text
/// ahead = (w₁ sin θ₁ + ... + w₄ sin θ₄)/2,  left = -(w₁ cos θ₁ + ... + w₄ cos θ₄)/2,  turn = -(w₁ + w₂ + w₃ + w₄)/(4 L)
/// ```
///
/// What the wheels disagree on is (w₁ - w₂ + w₃ - w₄)/4. With an offset of 0 the first wheel stands in front (+), with one of 45 degrees in front on the
/// left (x). Its axle has wheels at a distance of 2 L. Source: Campion, Bastin & D'Andréa-Novel (1996), with the angles and signs of
/// `omni_wheel_drive_controller` of ROS 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Omni4Drive {
    axle: DifferentialDrive,
    distance: f64,
    offset: f64,
    diameters: [f64; 4],
}

impl Omni4Drive {
    /// A drive from the distance of its wheels from the centre \[m\], the direction of the first one from straight ahead \[rad\], and their diameters
    /// \[m\], anti-clockwise from the first.
    pub fn new(distance: f64, offset: f64, diameters: [f64; 4]) -> Result<Self, DriveError> {
        let mean = diameters.iter().sum::<f64>() / 4.0;
        Omni4Drive { axle: DifferentialDrive::of_axle(2.0 * distance, mean), distance, offset, diameters }.checked()
    }

    /// Diameters of its wheels \[m\].
    pub fn wheel_diameters(&self) -> [f64; 4] {
        self.diameters
    }

    /// Directions in which its wheels stand, from straight ahead \[rad\].
    fn directions(&self) -> [f64; 4] {
        [0.0, FRAC_PI_2, PI, -FRAC_PI_2].map(|place| self.offset + place)
    }
}

const DIAMETER: Parameter = Parameter::shape("wheel_diameter_m", "", "m", 0.10, (1e-3, 10.0), "diameter of all wheels");

const ALL_WHEELS: &[&str] = &["wheel_diameter_1_m", "wheel_diameter_2_m", "wheel_diameter_3_m", "wheel_diameter_4_m"];

impl Kinematics for Omni4Drive {
    const NAME: &'static str = "omni4";

    const ABOUT: &'static str = "Four omni wheels, 90 degrees apart, that point round a circle: it also moves sideways. All count up as it turns clockwise.";

    const WHEELS: &'static [&'static str] = &["1", "2", "3", "4"];

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "wheel_distance_m",
            "",
            "m",
            0.2,
            (1e-3, 100.0),
            "distance of the wheels' contact points from the centre",
        ),
        Parameter::shape(
            "wheel_offset_rad",
            "",
            "rad",
            FRAC_PI_4,
            (-PI, PI),
            "direction of the first wheel from the centre, from straight ahead to the left: 0 for wheels in front, on both sides and behind, \
             0.7854 for wheels at the corners of a square",
        ),
        Parameter { name: "wheel_diameter_1_m", meaning: "diameter of the first wheel", ..DIAMETER },
        Parameter {
            name: "wheel_diameter_2_m",
            meaning: "diameter of the second wheel, anti-clockwise round the base",
            ..DIAMETER
        },
        Parameter { name: "wheel_diameter_3_m", meaning: "diameter of the third wheel", ..DIAMETER },
        Parameter { name: "wheel_diameter_4_m", meaning: "diameter of the fourth wheel", ..DIAMETER },
    ];

    const SPELLINGS: &'static [Spelling] = &[
        Spelling { parameter: DIAMETER, of: ALL_WHEELS, factor: 1.0 },
        Spelling {
            parameter: Parameter::shape("wheel_radius_m", "", "m", 0.05, (5e-4, 5.0), "radius of all wheels"),
            of: ALL_WHEELS,
            factor: 2.0,
        },
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["omni_side_ratio", "wheelbase", "roller_scale"];

    const OWN_EFFECTS: &'static [&'static str] = &["omni_axle_ratio", "omni_pair_ratio"];

    const EFFECTS: &'static [&'static str] = &["wheelbase"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        Omni4Drive::new(values[0], values[1], [values[2], values[3], values[4], values[5]])
    }

    fn values(&self) -> Vec<f64> {
        [self.distance, self.offset].into_iter().chain(self.diameters).collect()
    }

    /// The drive as its odometry must believe it to be, for a ratio of the diameters on the right to those on the left, of the distances of its wheels,
    /// and of all diameters.
    fn corrected(&self, [sides, distance, scale]: [f64; 3]) -> Result<Self, DriveError> {
        let to_the_left = self.directions().map(libm::sin);
        let most = libm::fmax(libm::fabs(to_the_left[0]), libm::fabs(to_the_left[1]));
        let off = (sides - 1.0) / (sides + 1.0) / most;
        let wheel = |k: usize| self.diameters[k] * scale * (1.0 - off * to_the_left[k]);
        Omni4Drive::new(self.distance * distance, self.offset, std::array::from_fn(wheel))
    }

    /// For ratios of the diameters in front to those behind, and of the first and third wheel to the others.
    fn also_corrected(&self, own: &[f64]) -> Result<Self, DriveError> {
        let ahead = self.directions().map(libm::cos);
        let most = libm::fmax(libm::fabs(ahead[0]), libm::fabs(ahead[1]));
        let [axle, pair] = [own[0], own[1]].map(|ratio| (ratio - 1.0) / (ratio + 1.0));
        let wheel = |k: usize| {
            let of_pair = if k.is_multiple_of(2) { pair } else { -pair };
            self.diameters[k] * (1.0 + axle / most * ahead[k]) * (1.0 + of_pair)
        };
        Omni4Drive::new(self.distance, self.offset, std::array::from_fn(wheel))
    }

    fn wheel_layout(&self) -> [f64; 2] {
        let (sine, cosine) = libm::sincos(2.0 * self.offset);
        [cosine, sine]
    }

    fn rollers(&self) -> Option<Rollers> {
        let directions = self.directions();
        let wheel = |k: usize| {
            let (sine, cosine) = libm::sincos(directions[k]);
            let at = [self.distance * cosine, self.distance * sine];
            RollerWheel { at, rolls: directions[k] - FRAC_PI_2, roller: 0.0, diameter: self.diameters[k] }
        };
        Rollers::new((0..4).map(wheel).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the equations above, with wheels in front, left, behind and right, and at the corners.
    #[test]
    fn its_ways_mean_the_motion_of_the_equations() {
        for [w1, w2, w3, w4] in [[0.1, 0.2, -0.3, 0.4], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, -0.2]] {
            let ways = [w1, w2, w3, w4];
            let plus = Omni4Drive::new(0.195, 0.0, [0.1; 4]).unwrap().rollers().unwrap();
            let motion = plus.motion(&ways);
            assert!((motion.forward - (w2 - w4) / 2.0).abs() < 1e-15, "{motion:?}");
            assert!((motion.sideways - (w3 - w1) / 2.0).abs() < 1e-15, "{motion:?}");
            assert!((motion.rotation + (w1 + w2 + w3 + w4) / (4.0 * 0.195)).abs() < 1e-14, "{motion:?}");
            let corners = Omni4Drive::new(0.195, FRAC_PI_4, [0.1; 4]).unwrap().rollers().unwrap();
            let motion = corners.motion(&ways);
            let root = 2.0 * 2.0_f64.sqrt();
            assert!((motion.forward - (w1 + w2 - w3 - w4) / root).abs() < 1e-15, "{motion:?}");
            assert!((motion.sideways - (w2 + w3 - w1 - w4) / root).abs() < 1e-15, "{motion:?}");
            for rollers in [plus, corners] {
                assert!((rollers.disagreement(&ways) - (w1 - w2 + w3 - w4) / 4.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_corrected_base_has_the_true_lengths() {
        let plus = Omni4Drive::new(0.2, 0.0, [0.1; 4]).unwrap().corrected([1.02, 1.1, 0.99]).unwrap();
        let [a, b, c, d] = plus.wheel_diameters();
        assert!((d / b - 1.02).abs() < 1e-15 && (a - 0.099).abs() < 1e-15 && (c - 0.099).abs() < 1e-15);
        let corners = Omni4Drive::new(0.2, FRAC_PI_4, [0.1; 4]).unwrap().corrected([1.02, 1.1, 0.99]).unwrap();
        let [a, b, c, d] = corners.wheel_diameters();
        assert!((d / a - 1.02).abs() < 1e-14 && (c / b - 1.02).abs() < 1e-14, "{a} {b} {c} {d}");
        assert!(((a + b + c + d) / 4.0 - 0.099).abs() < 1e-15 && (corners.axle.wheelbase() - 0.44).abs() < 1e-15);
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(Omni4Drive::new(0.0, 0.0, [0.1; 4]).is_err() && Omni4Drive::new(0.2, 4.0, [0.1; 4]).is_err());
        assert!(Omni4Drive::new(0.2, 0.0, [0.1, 0.1, f64::NAN, 0.1]).is_err());
    }
}
