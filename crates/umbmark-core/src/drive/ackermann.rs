//! Ackermann and tricycle drive: an axle that cannot steer, and a wheel (or two that act as one) before it that can.

use super::kinematics::Kinematics;
use super::{Counting, DifferentialDrive, DriveError, Encoder, WheelTravel};
use crate::parameter::Parameter;
use std::f64::consts::{PI, TAU};
use umbmark_odometry::gearing::{Gearing, MOST_STEERING, Steering};

/// The nominal kinematics of a car or a tricycle, about the middle of its rear axle.
///
/// forward = π D n_d/N_d, rotation = forward · tan(δ)/W, with the steering angle δ = 2π n_s/N_s + δ₀ (absolute, left positive)
/// and the axle distance W. It steers while it stands: in a move the steering keeps still, and the robot drives an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AckermannDrive {
    axle: DifferentialDrive,
    axle_distance: f64,
    steering_ticks: f64,
    steering_zero: f64,
}

impl AckermannDrive {
    /// A drive from axle distance, track width and wheel diameter \[m\], the steering counts per revolution, and the angle
    /// \[rad\] where they are 0.
    pub fn new(
        axle_distance: f64,
        track_width: f64,
        wheel_diameter: f64,
        steering_ticks: f64,
        steering_zero: f64,
    ) -> Result<Self, DriveError> {
        let axle = DifferentialDrive::of_axle(track_width, wheel_diameter);
        AckermannDrive { axle, axle_distance, steering_ticks, steering_zero }.checked()
    }

    /// Angle of the steered wheel where its counter shows 0 \[rad\].
    pub fn steering_zero(&self) -> f64 {
        self.steering_zero
    }

    fn steering_gear(&self, encoder: &Encoder) -> Steering {
        Steering { per_count: self.per_count(encoder), zero: self.steering_zero, axle_distance: self.axle_distance }
    }

    /// Metres per count of the drive, radians per count of the steering.
    fn per_count(&self, encoder: &Encoder) -> [f64; 2] {
        [PI * self.axle.wheel_diameter_left() / encoder.ticks_per_revolution(), TAU / self.steering_ticks]
    }

    /// Rotation per metre at a count of the steering.
    fn curvature(&self, encoder: &Encoder, steering: f64) -> f64 {
        self.steering_gear(encoder).curvature(steering)
    }

    /// The count of the steering at which the robot turns so much \[rad/m\].
    fn steering(&self, encoder: &Encoder, curvature: f64) -> f64 {
        (libm::atan(curvature * self.axle_distance) - self.steering_zero) / self.per_count(encoder)[1]
    }

    /// The count of the steering halfway through a travel, where something moved.
    fn halfway(&self, encoder: &Encoder, travel: &WheelTravel) -> Option<f64> {
        let moved = self.axle.displacement(travel);
        (moved.forward != 0.0).then(|| self.steering(encoder, moved.rotation / moved.forward))
    }
}

impl Kinematics for AckermannDrive {
    const NAME: &'static str = "ackermann";

    const ABOUT: &'static str = "A driven axle and a steered wheel, or two, before it: cars and tricycles.";

    const COUNTERS: [&'static str; 2] = ["drive", "steering"];

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "axle_distance_m",
            "",
            "m",
            0.5,
            (1e-3, 100.0),
            "distance of the steered wheel from the rear axle",
        ),
        Parameter::shape("track_width_m", "", "m", 0.4, (1e-3, 100.0), "distance of the rear wheels' contact points"),
        Parameter::shape(
            "wheel_diameter_m",
            "",
            "m",
            0.15,
            (1e-3, 100.0),
            "diameter of the wheels that the drive encoder counts, on the rear axle",
        ),
        Parameter::shape(
            "steering_ticks_per_revolution",
            "",
            "",
            20_000.0,
            (1.0, 1e9),
            "counts of the steering per revolution of the steered wheel about the vertical",
        ),
        Parameter::size(
            "steering_zero_rad",
            "",
            "rad",
            5e-3,
            (-0.5, 0.5),
            "angle of the steered wheel where its counter shows 0, as the odometry reckons",
        ),
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["steering_zero", "steering_gain", "scale"];

    const OWN_EFFECTS: &'static [&'static str] = &["axle_distance"];

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn axle_distance(&self) -> f64 {
        self.axle_distance
    }

    const STEERS: bool = true;

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        AckermannDrive::new(values[0], values[1], values[2], values[3], values[4])
    }

    fn values(&self) -> Vec<f64> {
        let axle = &self.axle;
        vec![self.axle_distance, axle.wheelbase(), axle.wheel_diameter_left(), self.steering_ticks, self.steering_zero]
    }

    /// The drive as its odometry must believe it to be, for a true steering zero δ₀ \[rad\], gain g and scale E_s.
    ///
    /// The true angle is (1 + g)(2π n_s/N_s + believed zero + δ₀).
    fn corrected(&self, [zero, gain, scale]: [f64; 3]) -> Result<Self, DriveError> {
        AckermannDrive::new(
            self.axle_distance,
            self.axle.wheelbase(),
            self.axle.wheel_diameter_left() * scale,
            self.steering_ticks / (1.0 + gain),
            (1.0 + gain) * (self.steering_zero + zero),
        )
    }

    /// For a ratio of the true axle distance to the nominal one.
    fn also_corrected(&self, own: &[f64]) -> Result<Self, DriveError> {
        AckermannDrive::new(
            self.axle_distance * own[0],
            self.axle.wheelbase(),
            self.axle.wheel_diameter_left(),
            self.steering_ticks,
            self.steering_zero,
        )
    }

    /// `None` for a turn on the spot, and for one so tight that the wheel would have to be steered too far.
    fn counting(&self, encoder: &Encoder, forward: f64, rotation: f64) -> Option<Counting> {
        let tightest = libm::tan(MOST_STEERING) / self.axle_distance;
        if !(rotation.abs() <= tightest * forward.abs()) {
            return None;
        }
        let curvature = if rotation == 0.0 { 0.0 } else { rotation / forward };
        let held = self.steering(encoder, curvature).round();
        let drive = self.per_count(encoder)[0];
        let per_count = self.axle.wheel_travel(drive, drive * self.curvature(encoder, held));
        Some(Counting {
            per_count: [per_count, WheelTravel::default()],
            gain: [forward / drive, 0.0],
            held: held as i64,
        })
    }

    fn gearing(&self, encoder: &Encoder) -> Gearing {
        Gearing::Car(self.steering_gear(encoder))
    }

    /// The counts that gained this travel, from a reading on; the steering as it was where nothing moved.
    fn reading(&self, encoder: &Encoder, before: [f64; 2], travel: &WheelTravel) -> [f64; 2] {
        match self.halfway(encoder, travel) {
            None => before,
            Some(halfway) => {
                let forward = self.axle.displacement(travel).forward;
                [before[0] + forward / self.per_count(encoder)[0], 2.0 * halfway - before[1]]
            }
        }
    }

    /// It steers while it stands, ahead of the next move.
    fn standing(&self, encoder: &Encoder, before: [f64; 2], ahead: &[WheelTravel]) -> [f64; 2] {
        let steering = ahead.iter().find_map(|travel| self.halfway(encoder, travel));
        [before[0], steering.map_or(0.0, f64::round)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tricycle() -> (AckermannDrive, Encoder) {
        (AckermannDrive::new(0.5, 0.4, 0.15, 20_000.0, 1e-3).unwrap(), Encoder::new(2000.0, None, None).unwrap())
    }

    #[test]
    fn an_arc_is_driven_with_the_steering_held_at_the_nearest_count() {
        let (drive, encoder) = tricycle();
        for angle in [std::f64::consts::FRAC_PI_2, -std::f64::consts::FRAC_PI_2] {
            let counting = drive.counting(&encoder, 1.5 * angle.abs(), angle).unwrap();
            // atan(0.5 m / 1.5 m) less the zero, in counts of 2π/20000.
            let expected = ((0.5_f64 / 1.5).atan().copysign(angle) - 1e-3) / (TAU / 20_000.0);
            assert_eq!(counting.held, expected.round() as i64);
            let travel = counting.per_count[0].scaled(counting.gain[0]);
            let moved = drive.axle.displacement(&travel);
            assert!((moved.forward - 1.5 * angle.abs()).abs() < 1e-12);
            // Half a count of steering is 1.6e-4 rad: of the curvature, 1.6e-4 (1 + 1/9)/(1/3).
            assert!((moved.rotation / angle - 1.0).abs() < 6e-4, "{moved:?}");
        }
    }

    #[test]
    fn readings_undo_travels_and_turns_on_the_spot_are_impossible() {
        let (drive, encoder) = tricycle();
        let (before, after) = ([10.0, -40.0], [95.0, 32.0]);
        let travel = drive.travel(&encoder, before, after);
        let again = drive.reading(&encoder, before, &travel);
        assert!((again[0] - after[0]).abs() < 1e-9 && (again[1] - after[1]).abs() < 1e-6, "{again:?}");
        assert_eq!(drive.reading(&encoder, before, &WheelTravel::default()), before);
        assert!(drive.counting(&encoder, 0.0, 1.0).is_none() && drive.counting(&encoder, 0.01, 1.0).is_none());
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(AckermannDrive::new(-0.5, 0.4, 0.15, 1e4, 0.0).is_err());
        assert!(AckermannDrive::new(0.5, 0.4, 0.15, 1e4, f64::NAN).is_err());
    }
}
