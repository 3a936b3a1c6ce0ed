//! A tricycle whose front wheel is driven and steered: forklifts, tugs, and the robot of OptiOdom.

use super::kinematics::Kinematics;
use super::{Counting, DifferentialDrive, DriveError, Encoder, WheelTravel};
use crate::parameter::Parameter;
use std::f64::consts::{PI, TAU};
use umbmark_odometry::gearing::{Gearing, Steering, front_wheel};

/// The nominal kinematics of a tricycle with a driven front wheel, about the middle of its rear axle.
///
/// forward = w cos δ, rotation = w sin δ / W, with the way of the front wheel w = π D n_d/N_d, its steering angle
/// δ = 2π n_s/N_s + δ₀ (absolute, left positive) and its distance W from the rear axle. At δ = 90 degrees the robot turns on the spot.
/// Between two readings the mean of both angles applies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TricycleDrive {
    axle: DifferentialDrive,
    axle_distance: f64,
    steering_ticks: f64,
    steering_zero: f64,
}

impl TricycleDrive {
    /// A drive from axle distance, track width and diameter of the front wheel \[m\], the steering counts per revolution, and the
    /// angle \[rad\] where they are 0.
    pub fn new(
        axle_distance: f64,
        track_width: f64,
        wheel_diameter: f64,
        steering_ticks: f64,
        steering_zero: f64,
    ) -> Result<Self, DriveError> {
        let axle = DifferentialDrive::of_axle(track_width, wheel_diameter);
        TricycleDrive { axle, axle_distance, steering_ticks, steering_zero }.checked()
    }

    /// Angle of the front wheel where its counter shows 0 \[rad\].
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

    /// Travel of the axle's wheels while the front wheel rolls so far \[m\] at a count of the steering.
    fn rolled(&self, encoder: &Encoder, way: f64, steering: f64) -> WheelTravel {
        self.steering_gear(encoder).rolled(self.axle.wheelbase(), way, steering)
    }

    /// The counts that the drive gains over a motion, and the count of the steering in it.
    fn counts(&self, encoder: &Encoder, forward: f64, rotation: f64) -> [f64; 2] {
        let (way, angle) = front_wheel(forward, rotation * self.axle_distance);
        let [drive, steering] = self.per_count(encoder);
        [way / drive, (angle - self.steering_zero) / steering]
    }
}

impl Kinematics for TricycleDrive {
    const NAME: &'static str = "tricycle";

    const ABOUT: &'static str = "A front wheel that is driven and steered, and an axle that rolls behind it.";

    const COUNTERS: [&'static str; 2] = ["drive", "steering"];

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "axle_distance_m",
            "",
            "m",
            0.5,
            (1e-3, 100.0),
            "distance of the front wheel from the rear axle",
        ),
        Parameter::shape("track_width_m", "", "m", 0.4, (1e-3, 100.0), "distance of the rear wheels' contact points"),
        Parameter::shape("wheel_diameter_m", "", "m", 0.15, (1e-3, 100.0), "diameter of the front wheel"),
        Parameter::shape(
            "steering_ticks_per_revolution",
            "",
            "",
            20_000.0,
            (1.0, 1e9),
            "counts of the steering per revolution of the front wheel about the vertical",
        ),
        Parameter::size(
            "steering_zero_rad",
            "",
            "rad",
            5e-3,
            (-0.5, 0.5),
            "angle of the front wheel where its counter shows 0, as the odometry reckons",
        ),
    ];

    const FIRST_EFFECTS: [&'static str; 3] = ["front_wheel_zero", "axle_distance", "scale"];

    const EFFECTS: &'static [&'static str] = &["axle_distance", "scale"];

    const STEERS: bool = true;

    const DRIVES_FRONT_WHEEL: bool = true;

    fn axle(&self) -> &DifferentialDrive {
        &self.axle
    }

    fn axle_distance(&self) -> f64 {
        self.axle_distance
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        TricycleDrive::new(values[0], values[1], values[2], values[3], values[4])
    }

    fn values(&self) -> Vec<f64> {
        let axle = &self.axle;
        vec![self.axle_distance, axle.wheelbase(), axle.wheel_diameter_left(), self.steering_ticks, self.steering_zero]
    }

    /// The drive as its odometry must believe it to be, for a true steering zero δ₀ \[rad\] beyond the believed one, a ratio of the
    /// axle distance and a scale E_s.
    fn corrected(&self, [zero, ratio, scale]: [f64; 3]) -> Result<Self, DriveError> {
        TricycleDrive::new(
            self.axle_distance * ratio,
            self.axle.wheelbase(),
            self.axle.wheel_diameter_left() * scale,
            self.steering_ticks,
            self.steering_zero + zero,
        )
    }

    /// The front wheel is held at the nearest count of its steering.
    fn counting(&self, encoder: &Encoder, forward: f64, rotation: f64) -> Option<Counting> {
        let [gain, steering] = self.counts(encoder, forward, rotation);
        let held = steering.round();
        let per_count = self.rolled(encoder, self.per_count(encoder)[0], held);
        Some(Counting { per_count: [per_count, WheelTravel::default()], gain: [gain, 0.0], held: held as i64 })
    }

    fn gearing(&self, encoder: &Encoder) -> Gearing {
        Gearing::Tricycle(self.steering_gear(encoder))
    }

    /// The counts that gained this travel, from a reading on; the steering as it was where nothing moved.
    fn reading(&self, encoder: &Encoder, before: [f64; 2], travel: &WheelTravel) -> [f64; 2] {
        if *travel == WheelTravel::default() {
            return before;
        }
        let moved = self.axle.displacement(travel);
        let [gain, steering] = self.counts(encoder, moved.forward, moved.rotation);
        [before[0] + gain, 2.0 * steering - before[1]]
    }

    /// It steers while it stands, ahead of the next move.
    fn standing(&self, encoder: &Encoder, before: [f64; 2], ahead: &[WheelTravel]) -> [f64; 2] {
        let next = ahead.iter().find(|travel| **travel != WheelTravel::default());
        let steering = next.map(|travel| {
            let moved = self.axle.displacement(travel);
            self.counts(encoder, moved.forward, moved.rotation)[1].round()
        });
        [before[0], steering.unwrap_or(before[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot(zero: f64) -> (TricycleDrive, Encoder) {
        (TricycleDrive::new(0.5, 0.4, 0.15, 20_000.0, zero).unwrap(), Encoder::new(2000.0, None, None).unwrap())
    }

    /// Oracle: the front wheel, stepped along its own heading a hundred thousand times, with the rear axle dragged behind it.
    #[test]
    fn the_rear_axle_follows_the_front_wheel_at_every_angle() {
        for degrees in [0.0_f64, 20.0, -20.0, 70.0, 90.0, -90.0, 100.0] {
            for way in [0.3, -0.3] {
                let (drive, encoder) = robot(2e-3);
                let angle = degrees.to_radians();
                let steering = (angle - 2e-3) * 20_000.0 / TAU;
                let counts = way * 2000.0 / (PI * 0.15);
                // The mean of both angles is what counts.
                let travel = drive.travel(&encoder, [5.0, steering - 300.0], [5.0 + counts, steering + 300.0]);
                let moved = drive.axle.displacement(&travel);
                let (mut front, mut rear, mut rolled) = ([0.5, 0.0], [0.0, 0.0], 0.0);
                let n = 100_000;
                for _ in 0..n {
                    let heading = f64::atan2(front[1] - rear[1], front[0] - rear[0]);
                    let step = way / f64::from(n);
                    front[0] += step * (heading + angle).cos();
                    front[1] += step * (heading + angle).sin();
                    // The rear axle moves along the body until it is half a metre behind again.
                    let (dx, dy) = (front[0] - rear[0], front[1] - rear[1]);
                    let ahead = dx * heading.cos() + dy * heading.sin();
                    let aside = -dx * heading.sin() + dy * heading.cos();
                    let drawn = ahead - (0.25 - aside * aside).sqrt();
                    rear[0] += drawn * heading.cos();
                    rear[1] += drawn * heading.sin();
                    rolled += drawn;
                }
                let heading = f64::atan2(front[1] - rear[1], front[0] - rear[0]);
                assert!((moved.forward - rolled).abs() < 1e-5, "{degrees} {moved:?} {rolled}");
                assert!((moved.rotation - heading).abs() < 1e-5, "{degrees} {moved:?} {heading}");
            }
        }
    }

    #[test]
    fn a_turn_on_the_spot_is_steered_by_a_right_angle_to_its_side() {
        let (drive, encoder) = robot(0.0);
        for rotation in [1.5, -1.5] {
            let counting = drive.counting(&encoder, 0.0, rotation).unwrap();
            assert_eq!(counting.held, if rotation > 0.0 { 5000 } else { -5000 });
            let way = counting.gain[0] * PI * 0.15 / 2000.0;
            assert!((way - 0.5 * 1.5).abs() < 1e-12, "{way}");
        }
        // Backward, and backward in a curve, the wheel rolls backward.
        let [back, straight] = drive.counts(&encoder, -1.0, 0.0);
        assert!(back < 0.0 && straight == 0.0);
        let [back, left] = drive.counts(&encoder, -1.0, -0.5);
        assert!(back < 0.0 && left > 0.0);
    }

    #[test]
    fn readings_undo_travels_also_a_little_beyond_a_right_angle() {
        let (drive, encoder) = robot(1e-3);
        for steering in [-5200.0, -5000.0, -40.0, 0.0, 32.0, 4990.0, 5000.0, 5001.0, 5300.0] {
            let (before, after) = ([10.0, steering - 7.0], [95.0, steering + 7.0]);
            let travel = drive.travel(&encoder, before, after);
            let again = drive.reading(&encoder, before, &travel);
            assert!((again[0] - after[0]).abs() < 1e-9 && (again[1] - after[1]).abs() < 1e-6, "{steering} {again:?}");
        }
        assert_eq!(drive.reading(&encoder, [1.0, 2.0], &WheelTravel::default()), [1.0, 2.0]);
    }

    #[test]
    fn a_corrected_tricycle_counts_the_true_motion() {
        let (drive, encoder) = robot(2e-3);
        let known = drive.corrected([5e-3, 1.02, 0.99]).unwrap();
        let told = known.axle.displacement(&known.travel(&encoder, [0.0, 1500.0], [500.0, 1500.0]));
        let (way, angle) = (500.0 * PI * 0.15 * 0.99 / 2000.0, 1500.0 * TAU / 20_000.0 + 7e-3);
        assert!((told.forward - way * angle.cos()).abs() < 1e-15);
        assert!((told.rotation - way * angle.sin() / 0.51).abs() < 1e-15);
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(TricycleDrive::new(-0.5, 0.4, 0.15, 1e4, 0.0).is_err());
        assert!(TricycleDrive::new(0.5, 0.4, 0.15, 1e4, f64::NAN).is_err());
    }
}
