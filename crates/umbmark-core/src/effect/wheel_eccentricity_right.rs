//! Run-out of the right wheel.

use super::wheel_eccentricity_left::{COSINE, RUN_OUT, SINE, run_out};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::WheelEccentricityRight;

pub(super) static EFFECT: Entry = Entry::of::<WheelEccentricityRight>().wheels::<WheelEccentricityRight>();

impl Effect for WheelEccentricityRight {
    const ABOUT: About = About {
        name: "wheel_eccentricity_right",
        title: "run-out of the right wheel",
        acts_on: ActsOn::Wheels,
        parameters: &[
            Parameter {
                flag: "eccentricity-right-cosine",
                meaning: "amplitude in the cosine of the right wheel's angle since START",
                ..COSINE
            },
            Parameter {
                flag: "eccentricity-right-sine",
                meaning: "amplitude in the sine of the right wheel's angle since START",
                ..SINE
            },
        ],
        equation: "s_R ← s_R + c (cos φ₁ - cos φ₀) + s (sin φ₁ - sin φ₀),  φ the wheel's angle since START",
        physics: RUN_OUT,
        signature: "The same as run-out of the left wheel, with the opposite sign in heading: a wave of amplitude e/b that repeats with \
                    each wheel revolution. Return poses show almost nothing.",
        confused_with: &["wheel_eccentricity_left"],
        separated_by: "plotting the track over the wheel's angle: in turns the wheels roll in opposite directions, so their waves \
                       differ",
        source: "geometry of an off-centre wheel; 0.3 mm is assumed",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        run_out(p, robot, "right")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}
