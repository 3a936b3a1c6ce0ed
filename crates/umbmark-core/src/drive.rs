//! The nominal robot: what its odometry believes about itself.
//!
//! One file per kinematics; [`Encoder`] is what counts its wheel angles.

mod differential;
mod encoder;

pub use differential::{DifferentialDrive, WheelTravel};
pub use encoder::{Encoder, MAX_COUNTER_BITS, roll_over};

/// One of the two drive wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheel {
    /// The wheel to the left of the heading.
    Left,
    /// The wheel to the right of the heading.
    Right,
}

impl Wheel {
    /// Both wheels, in the order of every pair (left, right).
    pub const BOTH: [Wheel; 2] = [Wheel::Left, Wheel::Right];
}

impl std::fmt::Display for Wheel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Wheel::Left => "left",
            Wheel::Right => "right",
        })
    }
}

/// What makes a drive or an encoder impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// A length, count or rate that must be positive and finite is not.
    #[error("{quantity} must be positive and finite, got {value} {unit}")]
    NotPositive {
        /// What was meant.
        quantity: &'static str,
        /// What was given.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A counter of no or too many bits.
    #[error("counter_bits must be between 1 and {MAX_COUNTER_BITS}, got {0}")]
    CounterBits(u32),
}

fn positive(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, DriveError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(DriveError::NotPositive { quantity, value, unit }) }
}

/// A nominal robot: its drive and its encoders.
///
/// ```
/// use umbmark_core::drive::Robot;
/// let robot = Robot::labmate();
/// assert_eq!(robot.drive.wheelbase(), 0.340);
/// assert!((robot.metres_per_tick().left - 0.23562e-3).abs() < 1e-8);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// What people call it.
    pub name: String,
    /// Nominal kinematics.
    pub drive: DifferentialDrive,
    /// Encoders, the same kind on both wheels.
    pub encoder: Encoder,
}

impl Robot {
    /// The TRC LabMate of the paper: nominal wheelbase 0.340 m (section 4.1). The wheel diameter, 0.150 m, and 2000 ticks
    /// per wheel revolution are assumptions; the paper gives neither.
    pub fn labmate() -> Robot {
        Robot {
            name: "TRC LabMate".into(),
            drive: DifferentialDrive::new(0.340, 0.150, 0.150).expect("constants are positive"),
            encoder: Encoder::new(2000.0, None, None).expect("constants are positive"),
        }
    }

    /// Travel of each wheel per encoder tick \[m\]: π D / (ticks per revolution).
    pub fn metres_per_tick(&self) -> WheelTravel {
        let per_diameter = std::f64::consts::PI / self.encoder.ticks_per_revolution();
        WheelTravel {
            left: self.drive.wheel_diameter_left() * per_diameter,
            right: self.drive.wheel_diameter_right() * per_diameter,
        }
    }
}
