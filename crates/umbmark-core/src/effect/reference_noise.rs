//! Noise of the absolute measurement.

use super::words::{deg, mm};
use super::{About, ActsOn, Effect, Entry, MeasurementLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::Pose2;
use crate::parameter::Parameter;
use crate::random::Stream;

/// Independent normal noise on every measured absolute pose.
pub struct ReferenceNoise;

const SCATTER: (f64, f64) = (0.0, 10.0);

pub(super) static EFFECT: Entry = Entry::of::<ReferenceNoise>().measured::<ReferenceNoise>();

impl Effect for ReferenceNoise {
    const ABOUT: About = About {
        name: "reference_noise",
        title: "noise of the absolute measurement",
        acts_on: ActsOn::Reference,
        parameters: &[
            Parameter::scatter(
                "position_sd_m",
                "reference-position-noise",
                "m",
                2e-3,
                SCATTER,
                "standard deviation of each coordinate",
            ),
            Parameter::scatter(
                "heading_sd_rad",
                "reference-heading-noise",
                "rad",
                2.6e-3,
                SCATTER,
                "standard deviation of the heading",
            ),
        ],
        equation: "measured = true + N(0, diag(sd²))",
        physics: "A tape can be read to about 2 mm, and a heading from two such readings to 0.15 degree. Motion capture has noise of \
                  its own.",
        signature: "The scatter does not grow with the length of the path.",
        confused_with: &["start_pose", "encoder_resolution"],
        separated_by: "measuring the same pose twice without driving",
        source: "usual sizes of tape and motion capture",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("A measured position scatters by {} along each axis, a heading by {}.", mm(p[0]), deg(p[1]))
    }
}

impl MeasurementLaw for ReferenceNoise {
    fn measured(p: &[f64], stream: &mut Stream, pose: &mut Pose2) {
        if p[0] > 0.0 {
            pose.x += p[0] * stream.normal();
            pose.y += p[0] * stream.normal();
        }
        if p[1] > 0.0 {
            pose.heading += p[1] * stream.normal();
        }
    }
}
