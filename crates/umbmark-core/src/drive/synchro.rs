//! Synchro drive: all wheels driven by one motor and steered by another, as the Cybermotion K2A.
//!
//! The course is where the wheels point; the base below the turret keeps its heading as it was at START. A heading, believed
//! or measured, is that of the course: of the turret, which turns with the wheels.

use super::kinematics::Kinematics;
use super::{Counting, DifferentialDrive, DriveError, Encoder, Wheel, WheelTravel};
use crate::parameter::Parameter;
use std::f64::consts::{PI, TAU};
use umbmark_odometry::gearing::Gearing;

/// The nominal kinematics of a synchro drive of three wheels, 120 degrees apart, one straight ahead of the centre at START.
///
/// forward = π D n_d/N_d, rotation of the course = 2π n_s/N_s + e · forward, with the counts n of drive and steering, their N
/// per revolution, and the coupling e. Source: Everett (1995), Sensors for Mobile Robots, chapter 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SynchroDrive {
    axle: DifferentialDrive,
    steering_ticks: f64,
    coupling: f64,
}

impl SynchroDrive {
    /// A drive from the diameter of its wheel circle and of its wheels \[m\], the steering counts per revolution, and the
    /// coupling \[rad/m\].
    pub fn new(wheel_circle: f64, wheel_diameter: f64, steering_ticks: f64, coupling: f64) -> Result<Self, DriveError> {
        let axle = DifferentialDrive::of_axle(wheel_circle, wheel_diameter);
        SynchroDrive { axle, steering_ticks, coupling }.checked()
    }

    /// Metres per count of the drive, radians per count of the steering.
    fn per_count(&self, encoder: &Encoder) -> [f64; 2] {
        [PI * self.axle.wheel_diameter_left() / encoder.ticks_per_revolution(), TAU / self.steering_ticks]
    }

    /// Counts of drive and steering in a motion.
    fn gain(&self, encoder: &Encoder, forward: f64, rotation: f64) -> [f64; 2] {
        let [drive, steering] = self.per_count(encoder);
        [forward / drive, (rotation - self.coupling * forward) / steering]
    }
}

impl Kinematics for SynchroDrive {
    const NAME: &'static str = "synchro";

    const ABOUT: &'static str = "Wheels that are driven together and steered together.";

    const COUNTERS: [&'static str; 2] = ["drive", "steering"];

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "wheel_circle_m",
            "",
            "m",
            0.5,
            (1e-3, 100.0),
            "diameter of the circle that the wheels stand on",
        ),
        Parameter::shape(
            "wheel_diameter_m",
            "",
            "m",
            0.25,
            (1e-3, 100.0),
            "diameter of the wheels that the drive encoder counts",
        ),
        Parameter::shape(
            "steering_ticks_per_revolution",
            "",
            "",
            10_000.0,
            (1.0, 1e9),
            "counts of the steering per revolution of the wheels about the vertical",
        ),
        Parameter::size(
            "coupling_rad_per_m",
            "",
            "rad/m",
            1e-3,
            (-10.0, 10.0),
            "turn of the course per metre driven that the odometry reckons with",
        ),
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["steer_coupling", "steer_scale", "drive_scale"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        SynchroDrive::new(values[0], values[1], values[2], values[3])
    }

    fn values(&self) -> Vec<f64> {
        vec![self.axle.wheelbase(), self.axle.wheel_diameter_left(), self.steering_ticks, self.coupling]
    }

    /// The drive as its odometry must believe it to be, for true steer coupling e \[rad/m\], steer scale r and drive scale E_s.
    ///
    /// True forward = E_s f and true rotation = r (2π n_s/N_s + e₀ f) + e E_s f, with the believed f and e₀: so the wheels are D E_s,
    /// the steering counts N_s/r, and the coupling r e₀/E_s + e.
    fn corrected(&self, [coupling, steer_scale, drive_scale]: [f64; 3]) -> Result<Self, DriveError> {
        SynchroDrive::new(
            self.axle.wheelbase(),
            self.axle.wheel_diameter_left() * drive_scale,
            self.steering_ticks / steer_scale,
            steer_scale * self.coupling / drive_scale + coupling,
        )
    }

    fn counting(&self, encoder: &Encoder, forward: f64, rotation: f64) -> Option<Counting> {
        let [drive, steering] = self.per_count(encoder);
        Some(Counting {
            per_count: [self.axle.wheel_travel(drive, drive * self.coupling), self.axle.wheel_travel(0.0, steering)],
            gain: self.gain(encoder, forward, rotation),
            held: 0,
        })
    }

    fn gearing(&self, encoder: &Encoder) -> Gearing {
        Gearing::Synchro { per_count: self.per_count(encoder), coupling: self.coupling }
    }

    /// The counts that gained this travel, from a reading on.
    fn reading(&self, encoder: &Encoder, before: [f64; 2], travel: &WheelTravel) -> [f64; 2] {
        let moved = self.axle.displacement(travel);
        let gain = self.gain(encoder, moved.forward, moved.rotation);
        [before[0] + gain[0], before[1] + gain[1]]
    }

    /// Travel of the axle's wheels by which the body falls behind where one of the three wheels must roll a way `lost` \[m\]
    /// longer than the others, as they cannot: all turn alike, so all three slip, and by as little as they can together.
    ///
    /// With wheels at (x_i, y_i) on a circle of radius ρ, least squares of their slips give forward = -D/3 and rotation =
    /// y_i D/(3ρ²). With two wheels the same rule gives the differential drive's D/2 and D/b. The bumped wheel is the outer
    /// one of its side, y = ρ √3/2.
    fn bumped(&self, wheel: Wheel, lost: f64) -> WheelTravel {
        let lean = if wheel == Wheel::Left { 1.0 } else { -1.0 };
        let radius = 0.5 * self.axle.wheelbase();
        let rotation = lean * 0.5 * 3.0_f64.sqrt() * lost / (3.0 * radius);
        self.axle.wheel_travel(-lost / 3.0, rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn carmel() -> (SynchroDrive, Encoder) {
        (SynchroDrive::new(0.5, 0.25, 10_000.0, 2e-3).unwrap(), Encoder::new(4000.0, None, None).unwrap())
    }

    #[test]
    fn counts_and_travel_undo_each_other_both_ways_round() {
        let (drive, encoder) = carmel();
        for (forward, rotation) in [(4.0, 0.0), (0.0, -1.5), (-0.3, 0.7)] {
            let counting = drive.counting(&encoder, forward, rotation).unwrap();
            let moved = drive.axle.displacement(&drive.travel(
                &encoder,
                [3.0, -5.0],
                [3.0 + counting.gain[0], -5.0 + counting.gain[1]],
            ));
            assert!((moved.forward - forward).abs() < 1e-12 && (moved.rotation - rotation).abs() < 1e-12, "{moved:?}");
            let linear = WheelTravel {
                left: counting.per_count[0].left * counting.gain[0] + counting.per_count[1].left * counting.gain[1],
                right: counting.per_count[0].right * counting.gain[0] + counting.per_count[1].right * counting.gain[1],
            };
            let again = drive.axle.displacement(&linear);
            assert!((again.forward - forward).abs() < 1e-12 && (again.rotation - rotation).abs() < 1e-12);
            let reading = drive.reading(&encoder, [3.0, -5.0], &linear);
            assert!((reading[0] - 3.0 - counting.gain[0]).abs() < 1e-8, "{reading:?}");
        }
    }

    /// Oracle: the twist of least squared slip of three wheels, by the normal equations.
    #[test]
    fn a_bump_is_shared_by_the_slip_of_three_wheels() {
        let (drive, _) = carmel();
        let rho = 0.25;
        let at = [0.0, 120.0_f64, 240.0].map(|degrees| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            (rho * cosine, rho * sine)
        });
        for (wheel, bumped) in [(Wheel::Left, 1), (Wheel::Right, 2)] {
            let (mut rows, mut right) = (Vec::new(), Vec::new());
            for (i, (x, y)) in at.iter().enumerate() {
                rows.extend([1.0, -y, 0.0, *x]);
                right.extend([if i == bumped { -3e-3 } else { 0.0 }, 0.0]);
            }
            let slips = DMatrix::from_row_slice(6, 2, &rows);
            let twist = slips.svd(true, true).solve(&DVector::from_vec(right), 1e-12).unwrap();
            let moved = drive.axle.displacement(&drive.bumped(wheel, 3e-3));
            assert!(
                (moved.forward - twist[0]).abs() < 1e-15 && (moved.rotation - twist[1]).abs() < 1e-14,
                "{moved:?} {twist}"
            );
        }
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(SynchroDrive::new(0.0, 0.25, 1e4, 0.0).is_err());
        assert!(SynchroDrive::new(0.5, 0.25, -1.0, 0.0).is_err());
        assert!(SynchroDrive::new(0.5, 0.25, 1e4, f64::NAN).is_err());
    }
}
