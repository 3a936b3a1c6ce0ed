//! From the counts of a drive's two counters to travel of its axle.

use crate::travel::WheelTravel;

/// No wheel of a car is steered farther than this \[rad\]: at a right angle the robot would turn about its own axle.
pub const MOST_STEERING: f64 = 1.4;

/// A motion is that of a wheel that rolls forward, if it is steered by no more than this beyond a right angle \[rad\]; else the
/// wheel rolled backward.
const BEYOND: f64 = 0.17;

/// What the two counters of a drive mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gearing {
    /// Each counts a wheel of the axle: \[m\] per count.
    Wheels(WheelTravel),
    /// All wheels are driven by one motor and steered by another.
    Synchro {
        /// Metres per count of the drive, radians per count of the steering.
        per_count: [f64; 2],
        /// Turn of the course per metre driven \[rad/m\].
        coupling: f64,
    },
    /// The axle is driven, a wheel before it is steered.
    Car(Steering),
    /// The wheel before the axle is driven and steered.
    Tricycle(Steering),
}

/// A steered wheel and the counters of drive and steering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// Metres per count of the drive, radians per count of the steering.
    pub per_count: [f64; 2],
    /// Angle where the steering counts 0 \[rad\].
    pub zero: f64,
    /// Distance of the steered wheel from the axle \[m\].
    pub axle_distance: f64,
}

impl Steering {
    /// Rotation per metre of a car at a count of the steering \[rad/m\]: tan δ/W.
    pub fn curvature(&self, steering: f64) -> f64 {
        let angle = steering * self.per_count[1] + self.zero;
        libm::tan(angle.clamp(-MOST_STEERING, MOST_STEERING)) / self.axle_distance
    }

    /// Travel of the axle's wheels while the driven front wheel of a tricycle rolls so far \[m\] at a count of the steering.
    pub fn rolled(&self, wheelbase: f64, way: f64, steering: f64) -> WheelTravel {
        let angle = steering * self.per_count[1] + self.zero;
        WheelTravel::of(way * libm::cos(angle), way * libm::sin(angle) / self.axle_distance, wheelbase)
    }
}

impl Gearing {
    /// Travel of the wheels of an axle with this wheelbase \[m\] from one reading of the counters to another. A steering is taken halfway
    /// between the readings.
    pub fn travel(&self, wheelbase: f64, before: [f64; 2], after: [f64; 2]) -> WheelTravel {
        match self {
            Gearing::Wheels(per_count) => WheelTravel {
                left: (after[0] - before[0]) * per_count.left,
                right: (after[1] - before[1]) * per_count.right,
            },
            Gearing::Synchro { per_count: [drive, steering], coupling } => {
                let forward = (after[0] - before[0]) * drive;
                WheelTravel::of(forward, (after[1] - before[1]) * steering + coupling * forward, wheelbase)
            }
            Gearing::Car(car) => {
                let forward = (after[0] - before[0]) * car.per_count[0];
                WheelTravel::of(forward, forward * car.curvature(0.5 * (before[1] + after[1])), wheelbase)
            }
            Gearing::Tricycle(front) => {
                let way = (after[0] - before[0]) * front.per_count[0];
                front.rolled(wheelbase, way, 0.5 * (before[1] + after[1]))
            }
        }
    }

    /// Whether the second counter shows an angle from a zero of its own, not a way since START.
    pub fn steers(&self) -> bool {
        matches!(self, Gearing::Car(_) | Gearing::Tricycle(_))
    }
}

/// The way of the front wheel \[m\] and its steering angle \[rad\] in a motion of the rear axle's middle, `forward` \[m\] and
/// `across` \[m\] (axle distance times rotation): the inverse of w (cos δ, sin δ).
///
/// Two of them make the same motion. The wheel rolls forward where this needs no angle far beyond 90 degrees.
pub fn front_wheel(forward: f64, across: f64) -> (f64, f64) {
    if forward >= -libm::tan(BEYOND) * across.abs() {
        (libm::hypot(forward, across), libm::atan2(across, forward))
    } else {
        (-libm::hypot(forward, across), libm::atan2(-across, -forward))
    }
}

/// The widest counter that is unrolled.
pub const MAX_COUNTER_BITS: u32 = 62;

/// The change between two readings of a counter of `bits` bits, taken as the shorter way round: in [-2^(n-1), 2^(n-1)).
///
/// Right as long as a wheel moves less than half the counter's range between readings. Readings may be signed or
/// unsigned; only their difference modulo 2^n counts.
///
/// ```
/// # use umbmark_odometry::gearing::roll_over;
/// assert_eq!(roll_over(65533, 394, 16), 397);
/// assert_eq!(roll_over(169, 65410, 16), -295);
/// ```
pub fn roll_over(before: i64, after: i64, bits: u32) -> i64 {
    let unused = 64 - bits;
    (after.wrapping_sub(before) << unused) >> unused
}
