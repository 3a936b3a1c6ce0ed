//! The quantisation of the encoders.

use super::words::mm;
use super::{About, ActsOn, Effect, Entry, MeasurementLaw};
use crate::drive::Robot;
use crate::geometry::{Pose2, Real};
use crate::parameter::{DefaultValue, Parameter};
use crate::random::Stream;

/// The rounding of each counter when a pose is measured.
pub struct EncoderResolution;

pub(super) static EFFECT: Entry = Entry::of::<EncoderResolution>().measured::<EncoderResolution>();

impl Effect for EncoderResolution {
    const ABOUT: About = About {
        name: "encoder_resolution",
        title: "resolution of the encoders",
        acts_on: ActsOn::Odometry,
        parameters: &[
            Parameter::size(
                "quantum_m",
                "encoder-quantum",
                "m",
                2.36e-4,
                (0.0, 1.0),
                "travel of a wheel per count that it is read to",
            ),
            Parameter {
                default: DefaultValue::OfRobot(|robot| robot.wheelbase()),
                ..Parameter::shape(
                    "wheelbase_m",
                    "encoder-quantum-wheelbase",
                    "m",
                    0.34,
                    (1e-3, 100.0),
                    "distance between the wheels that are counted",
                )
            },
        ],
        equation: "(forward, Δθ) ← (forward, Δθ) + ((e_L + e_R)/2, (e_R - e_L)/b),  e_w uniform in ±q/2",
        physics: "An encoder gives the wheel's angle only to within half a count. Simulations already count the robot's own \
                  ticks: this effect adds a coarser reading, or represents the counts in a model.",
        signature: "The scatter does not grow with the length of the path: q/(b√6) in heading and q/√24 along the path.",
        confused_with: &["wheel_noise", "reference_noise"],
        separated_by: "comparing the scatter of poses at rest with that of driven ones; an encoder with finer counts",
        source: "variance q²/12 of rounding; a count of the assumed LabMate is 0.236 mm",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("A count of {} leaves the travel of each wheel uncertain by half of that, either way.", mm(p[0]))
    }
}

impl MeasurementLaw for EncoderResolution {
    fn measured(p: &[f64], stream: &mut Stream, pose: &mut Pose2) {
        if p[0] == 0.0 {
            return;
        }
        let mut rounding = || p[0] * (stream.uniform() - 0.5);
        let (left, right) = (rounding(), rounding());
        let (sine, cosine) = pose.heading.sine_cosine();
        let forward = 0.5 * (left + right);
        pose.x += forward * cosine;
        pose.y += forward * sine;
        pose.heading += (right - left) / p[1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scatter_is_that_of_rounding_along_the_heading_only() {
        let (n, q, b) = (20_000, 1e-3, 0.34);
        let mut stream = Stream::new(7, 0, 0);
        let (mut heading, mut along) = (0.0, 0.0);
        for _ in 0..n {
            let mut pose = Pose2::new(1.0, 2.0, 0.5 * std::f64::consts::PI);
            EncoderResolution::measured(&[q, b], &mut stream, &mut pose);
            heading += (pose.heading - 0.5 * std::f64::consts::PI).powi(2);
            along += (pose.y - 2.0).powi(2);
            assert!((pose.x - 1.0).abs() < 1e-15 && (pose.y - 2.0).abs() <= 0.5 * q);
        }
        // The sum of two uniform numbers has kurtosis 2.4: its standard deviation is known to sqrt(1.4/4n).
        let n = f64::from(n);
        let tolerance = 4.0 * (1.4 / (4.0 * n)).sqrt();
        assert!(((heading / n).sqrt() / (q / (b * 6_f64.sqrt())) - 1.0).abs() < tolerance);
        assert!(((along / n).sqrt() / (q / 24_f64.sqrt()) - 1.0).abs() < tolerance);
    }
}
