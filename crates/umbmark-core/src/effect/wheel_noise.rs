//! Random slip and unevenness, wheel by wheel.

use super::words::{deg, mm};
use super::{About, ActsOn, DiffusionLaw, Effect, Entry, WheelVariance};
use crate::drive::{DriveKinds, Robot, WheelTravel};
use crate::parameter::Parameter;

/// White noise on each wheel's travel over ground.
pub struct WheelNoise;

pub(super) static EFFECT: Entry = Entry::of::<WheelNoise>().diffusion::<WheelNoise>();

impl Effect for WheelNoise {
    const ABOUT: About = About {
        name: "wheel_noise",
        title: "wheel noise",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter::size(
            "k_sqrt_m",
            "wheel-noise",
            "m^0.5",
            1e-3,
            (0.0, 1.0),
            "square root of the variance of a wheel's travel per metre",
        )],
        equation: "var s_w = k² |s_w|, independent along the way and between the wheels; of a base on rollers, between the two sides of its course",
        physics: "Small slips, grains of dirt and unevenness add up like a random walk. On parquet, 4.0e-4 and 5.8e-4 m^0.5 were \
                  measured; 1e-3 gives the paper's scatter.",
        signature: "Only the scatter changes: the variance of the heading grows by 2 k²/b² per metre, and the scatter of the position \
                    with the distance to the power 3/2. Means do not change.",
        confused_with: &["bumps", "encoder_resolution"],
        separated_by: "the distribution of the heading increments of a track; a smoother floor",
        source: "Chong & Kleeman (1997), ICRA, accurate odometry and error modelling",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], robot: &Robot) -> String {
        let scattered = p[0] * libm::sqrt(10.0);
        format!(
            "After 10 m the travel of each wheel has scattered by {}, the heading by {} (one standard deviation).",
            mm(scattered),
            deg(scattered * std::f64::consts::SQRT_2 / robot.drive.wheelbase())
        )
    }
}

impl DiffusionLaw for WheelNoise {
    fn diffusion(p: &[f64], travel: &WheelTravel) -> WheelVariance {
        let per_metre = p[0] * p[0];
        WheelVariance { left: per_metre * travel.left.abs(), right: per_metre * travel.right.abs() }
    }
}
