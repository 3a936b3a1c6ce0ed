//! What makes a robot move otherwise than its odometry believes: one type a law. `p` are its numbers, in the order of the catalogue of
//! effects (`umbmark effects NAME`), where causes and units are described too.
//!
//! The equations write s_L, s_R for the travel of the wheels \[m\], Δθ for the rotation of the body \[rad\].

mod counts;
mod floor;
mod gears;
mod grip;
mod steering;
mod wheels;

pub use counts::{EncoderSampling, EncoderSkew, MissedCounts, WheelLag};
pub use floor::{CarpetNap, FloorSlope, FloorSlopeYaw, PlacedBumps};
pub use gears::{BaseYaw, ContactTrail, DriveScale, SteerCoupling, SteerScale};
pub use grip::{
    AccelerationSlip, BodySpeedSlip, CasterKick, Crab, DirectionDependentWheelbase, ForwardSlip, LegKick, SpeedSlip,
    SpeedSlipLeft, SpeedSlipRight, SquaredForwardSlip, SquaredSpeedSlip, TurnSlip, TurnSlipRate,
};
pub use steering::{AxleDistance, FrontWheelGain, FrontWheelZero, SteeringGain, SteeringZero, Understeer};
pub use wheels::{
    Backlash, CentripetalLoad, DiameterDrift, Scale, WheelDiameterRatio, WheelEccentricityLeft, WheelEccentricityRight,
    Wheelbase,
};

use crate::context::Here;
use crate::geometry::{Displacement2, Real};
use crate::travel::WheelTravel;
use core::fmt;

/// A law of the wheels. Mark it and what it calls `#[inline(always)]`, so that derivatives use the widest registers of the machine.
pub trait WheelLaw {
    /// Changes believed into true wheel travel \[m\].
    fn wheels<T: Real>(p: &[T], at: &Here<T>, travel: &mut WheelTravel<T>);
}

/// A law of the body; see [`WheelLaw`].
pub trait BodyLaw {
    /// Changes the body motion that true wheel travel makes.
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>);
}

/// What a wheel rolls is at most twice, and at least half of what it counts; where it is not, play or a late reading makes most of a small
/// travel.
const SIZES: core::ops::Range<f64> = 0.5..2.0;

/// What a wheel rolled for each metre that it counted: the speed of its rim is so many times that of its counts.
#[inline(always)]
fn size<T: Real>(rolled: T, at: &Here<T>, wheel: usize) -> T {
    let size = rolled / at.wheel_travel[wheel];
    if SIZES.contains(&size.value()) { size } else { T::from(1.0) }
}

/// What a law changes.
#[derive(Clone, Copy)]
pub enum Acts {
    /// The travel of the wheels.
    Wheels(fn(&[f64], &Here, &mut WheelTravel)),
    /// The motion of the body.
    Body(fn(&[f64], &Here, &mut Displacement2)),
}

/// A law as data: what a [table](crate::Table) may hold.
pub struct Law {
    /// Its number in tables. It stays.
    pub code: u16,
    /// The effect's name in files.
    pub name: &'static str,
    /// How many numbers it has.
    pub parameters: usize,
    /// Whether it depends on the speeds of the wheels, or on which way the robot drives. Speeds are known half a
    /// [window](crate::pace::HALF_WINDOW) later.
    pub reads_speed: bool,
    /// What it changes.
    pub acts: Acts,
}

impl Law {
    const fn wheels<L: WheelLaw>(code: u16, name: &'static str, parameters: usize) -> Law {
        Law { code, name, parameters, reads_speed: false, acts: Acts::Wheels(L::wheels::<f64>) }
    }

    const fn body<L: BodyLaw>(code: u16, name: &'static str, parameters: usize) -> Law {
        Law { code, name, parameters, reads_speed: false, acts: Acts::Body(L::body::<f64>) }
    }

    const fn of_speed(self) -> Law {
        Law { reads_speed: true, ..self }
    }

    /// The law of this number in tables.
    pub fn of_code(code: u16) -> Option<&'static Law> {
        LAWS.iter().find(|law| law.code == code)
    }

    /// The law of an effect.
    pub fn named(name: &str) -> Option<&'static Law> {
        LAWS.iter().find(|law| law.name == name)
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Law) -> bool {
        self.code == other.code
    }
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.code, self.name)
    }
}

/// Every law that a table may hold.
pub static LAWS: [Law; 41] = [
    Law::wheels::<MissedCounts>(1, "missed_counts", 3).of_speed(),
    Law::wheels::<EncoderSkew>(2, "encoder_skew", 1).of_speed(),
    Law::body::<EncoderSampling>(3, "encoder_sampling", 1),
    Law::wheels::<WheelDiameterRatio>(4, "wheel_diameter_ratio", 1),
    Law::body::<Wheelbase>(5, "wheelbase", 1),
    Law::wheels::<Scale>(6, "scale", 1),
    Law::wheels::<WheelEccentricityLeft>(7, "wheel_eccentricity_left", 2),
    Law::wheels::<WheelEccentricityRight>(8, "wheel_eccentricity_right", 2),
    Law::wheels::<CentripetalLoad>(10, "centripetal_load", 1).of_speed(),
    Law::wheels::<Backlash>(11, "backlash", 1),
    Law::body::<DriveScale>(12, "drive_scale", 1),
    Law::body::<SteerScale>(13, "steer_scale", 1),
    Law::body::<SteerCoupling>(14, "steer_coupling", 1),
    Law::body::<ContactTrail>(15, "contact_trail", 1),
    Law::body::<BaseYaw>(16, "base_yaw", 2),
    Law::body::<FrontWheelZero>(17, "front_wheel_zero", 1),
    Law::body::<FrontWheelGain>(18, "front_wheel_gain", 1),
    Law::body::<AxleDistance>(19, "axle_distance", 1),
    Law::body::<SteeringZero>(20, "steering_zero", 1),
    Law::body::<SteeringGain>(21, "steering_gain", 1),
    Law::body::<Understeer>(22, "understeer", 1).of_speed(),
    Law::body::<Crab>(23, "crab", 1),
    Law::wheels::<SpeedSlip>(24, "speed_slip", 1).of_speed(),
    Law::wheels::<SpeedSlipLeft>(25, "speed_slip_left", 1).of_speed(),
    Law::wheels::<SpeedSlipRight>(26, "speed_slip_right", 1).of_speed(),
    Law::wheels::<AccelerationSlip>(27, "acceleration_slip", 1).of_speed(),
    Law::body::<TurnSlip>(28, "turn_slip", 1).of_speed(),
    Law::body::<TurnSlipRate>(29, "turn_slip_rate", 1).of_speed(),
    Law::body::<DirectionDependentWheelbase>(30, "direction_dependent_wheelbase", 1).of_speed(),
    Law::body::<CasterKick>(31, "caster_kick", 2).of_speed(),
    Law::body::<FloorSlope>(33, "floor_slope", 4).of_speed(),
    Law::body::<FloorSlopeYaw>(34, "floor_slope_yaw", 4).of_speed(),
    Law::body::<CarpetNap>(35, "carpet_nap", 2).of_speed(),
    Law::wheels::<PlacedBumps>(36, "placed_bumps", 5).of_speed(),
    Law::wheels::<WheelLag>(37, "wheel_lag", 2),
    // 9 and 32 were these with two numbers.
    Law::wheels::<DiameterDrift>(38, "diameter_drift", 4).of_speed(),
    Law::body::<LegKick>(39, "leg_kick", 3).of_speed(),
    Law::wheels::<BodySpeedSlip>(40, "body_speed_slip", 1).of_speed(),
    Law::wheels::<ForwardSlip>(41, "forward_slip", 1).of_speed(),
    Law::wheels::<SquaredSpeedSlip>(42, "squared_speed_slip", 1).of_speed(),
    Law::wheels::<SquaredForwardSlip>(43, "squared_forward_slip", 1).of_speed(),
];
