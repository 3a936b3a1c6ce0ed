//! Differential drive: two driven wheels on one axle.

use super::kinematics::{Kinematics, Spelling};
use super::{DriveError, Encoder};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

pub use umbmark_odometry::travel::WheelTravel;

/// The nominal kinematics of a differential drive.
///
/// forward = (s_R + s_L)/2, rotation = (s_R - s_L)/b, with wheel travels s_L, s_R and wheelbase b: Crowley & Reignier
/// (1992), as used by Borenstein & Feng (1995).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferentialDrive {
    wheelbase: f64,
    wheel_diameter_left: f64,
    wheel_diameter_right: f64,
}

impl DifferentialDrive {
    /// b.
    pub const WHEELBASE: Parameter = Parameter::shape(
        "wheelbase_m",
        "wheelbase",
        "m",
        0.340,
        (1e-3, 100.0),
        "b: distance of the two wheels' contact points",
    );

    /// D of both wheels.
    pub const WHEEL_DIAMETER: Parameter =
        Parameter::shape("wheel_diameter_m", "wheel-diameter", "m", 0.150, (1e-3, 10.0), "diameter of both wheels");

    /// A drive from its wheelbase and wheel diameters \[m\].
    pub fn new(wheelbase: f64, wheel_diameter_left: f64, wheel_diameter_right: f64) -> Result<Self, DriveError> {
        DifferentialDrive { wheelbase, wheel_diameter_left, wheel_diameter_right }.checked()
    }

    /// The axle of another drive, which knows the bounds of its numbers.
    pub(super) fn of_axle(wheelbase: f64, wheel_diameter: f64) -> Self {
        DifferentialDrive { wheelbase, wheel_diameter_left: wheel_diameter, wheel_diameter_right: wheel_diameter }
    }

    /// b \[m\]: distance between the contact points of the two drive wheels.
    #[doc(alias = "track_width")]
    #[doc(alias = "wheel_separation")]
    pub fn wheelbase(&self) -> f64 {
        self.wheelbase
    }

    /// D_L \[m\].
    pub fn wheel_diameter_left(&self) -> f64 {
        self.wheel_diameter_left
    }

    /// D_R \[m\].
    pub fn wheel_diameter_right(&self) -> f64 {
        self.wheel_diameter_right
    }

    /// Travel of each wheel per encoder tick \[m\]: π D / (ticks per revolution).
    pub fn metres_per_tick(&self, encoder: &Encoder) -> WheelTravel {
        let per_diameter = std::f64::consts::PI / encoder.ticks_per_revolution();
        WheelTravel { left: self.wheel_diameter_left * per_diameter, right: self.wheel_diameter_right * per_diameter }
    }

    /// Body motion of the axle's centre for given wheel travels, at constant ratio of the wheel speeds.
    #[inline(always)]
    pub fn displacement<T: Real>(&self, travel: &WheelTravel<T>) -> Displacement2<T> {
        travel.displacement(self.wheelbase)
    }

    /// Wheel travels that make the axle's centre advance `forward` \[m\] while the body turns by `rotation` \[rad\].
    #[inline]
    pub fn wheel_travel(&self, forward: f64, rotation: f64) -> WheelTravel {
        WheelTravel::of(forward, rotation, self.wheelbase)
    }
}

const BOTH_WHEELS: &[&str] = &["wheel_diameter_left_m", "wheel_diameter_right_m"];

/// Both diameters as one number.
pub(super) const ONE_DIAMETER: Spelling =
    Spelling { parameter: DifferentialDrive::WHEEL_DIAMETER, of: BOTH_WHEELS, factor: 1.0 };

/// The same as a radius.
pub(super) const ONE_RADIUS: Spelling = Spelling {
    parameter: Parameter::shape("wheel_radius_m", "", "m", 0.075, (5e-4, 5.0), "radius of both wheels"),
    of: BOTH_WHEELS,
    factor: 2.0,
};

impl Kinematics for DifferentialDrive {
    const NAME: &'static str = "differential";

    const ABOUT: &'static str = "Two driven wheels on one axle.";

    const PARAMETERS: &'static [Parameter] = &[
        Self::WHEELBASE,
        Parameter { name: "wheel_diameter_left_m", meaning: "diameter of the left wheel", ..Self::WHEEL_DIAMETER },
        Parameter { name: "wheel_diameter_right_m", meaning: "diameter of the right wheel", ..Self::WHEEL_DIAMETER },
    ];

    const SPELLINGS: &'static [Spelling] = &[
        Spelling {
            parameter: Parameter { name: "wheel_separation_m", ..Self::WHEELBASE },
            of: &["wheelbase_m"],
            factor: 1.0,
        },
        Spelling {
            parameter: Parameter { name: "track_width_m", ..Self::WHEELBASE },
            of: &["wheelbase_m"],
            factor: 1.0,
        },
        ONE_DIAMETER,
        ONE_RADIUS,
    ];

    const HAS_AXLE_WHEELS: bool = true;

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        DifferentialDrive::new(values[0], values[1], values[2])
    }

    fn values(&self) -> Vec<f64> {
        vec![self.wheelbase, self.wheel_diameter_left, self.wheel_diameter_right]
    }

    fn axle(&self) -> &DifferentialDrive {
        self
    }

    fn corrected(&self, [e_d, e_b, e_s]: [f64; 3]) -> Result<Self, DriveError> {
        let left = 2.0 * e_s / (1.0 + e_d);
        let (left, right) = (self.wheel_diameter_left * left, self.wheel_diameter_right * left * e_d);
        DifferentialDrive::new(self.wheelbase * e_b, left, right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wheel_travel_and_displacement_undo_each_other() {
        let drive = DifferentialDrive::new(0.34, 0.15, 0.15).unwrap();
        for (forward, rotation) in [(4.0, 0.0), (0.0, -1.5), (-0.3, 0.7)] {
            let d = drive.displacement(&drive.wheel_travel(forward, rotation));
            assert!((d.forward - forward).abs() < 1e-15 && (d.rotation - rotation).abs() < 1e-15);
        }
    }

    #[test]
    fn the_right_wheel_alone_turns_the_body_to_the_left() {
        let drive = DifferentialDrive::new(0.5, 0.15, 0.15).unwrap();
        let d = drive.displacement(&WheelTravel { left: 0.0, right: 0.1 });
        assert_eq!((d.forward, d.rotation), (0.05, 0.2));
    }

    #[test]
    fn impossible_lengths_are_refused_with_the_offending_value() {
        for (bad, text) in [(-0.34, "-0.34"), (0.0, "0"), (500.0, "500"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
            let error = DifferentialDrive::new(bad, 0.15, 0.15).unwrap_err().to_string();
            assert_eq!(error, format!("wheelbase_m must be between 0.001 and 100 m, got {text}"));
        }
    }
}
