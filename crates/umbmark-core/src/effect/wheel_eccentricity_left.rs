//! Run-out of the left wheel.

use super::words::{deg, mm};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::WheelEccentricityLeft;

pub(super) static EFFECT: Entry = Entry::of::<WheelEccentricityLeft>().wheels::<WheelEccentricityLeft>();

impl Effect for WheelEccentricityLeft {
    const ABOUT: About = About {
        name: "wheel_eccentricity_left",
        title: "run-out of the left wheel",
        acts_on: ActsOn::Wheels,
        parameters: &[
            Parameter {
                flag: "eccentricity-left-cosine",
                meaning: "amplitude in the cosine of the left wheel's angle since START",
                ..COSINE
            },
            Parameter {
                flag: "eccentricity-left-sine",
                meaning: "amplitude in the sine of the left wheel's angle since START",
                ..SINE
            },
        ],
        equation: "s_L ← s_L + c (cos φ₁ - cos φ₀) + s (sin φ₁ - sin φ₀),  φ the wheel's angle since START",
        physics: RUN_OUT,
        signature: "The heading has a wave of amplitude e/b that repeats with each wheel revolution, and the distance travelled has a \
                    wave of amplitude e/2. If the wave begins at its crest, its mean rotates the whole path, as a crab angle does. \
                    Return poses hardly show either.",
        confused_with: &["wheel_eccentricity_right"],
        separated_by: "plotting the track over the wheel's angle: in turns the wheels roll in opposite directions, so their waves \
                       differ",
        source: "geometry of an off-centre wheel; 0.3 mm is assumed",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        run_out(p, robot, "left")
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

pub(super) const RUN_OUT: &str = "The wheel turns about a point that is e off its centre, so its effective radius varies by e within \
     each revolution: on one half it rolls further than it counts, on the other half less.";

/// Meaning of the run-out of a wheel for the robot.
pub(super) fn run_out(p: &[f64], robot: &Robot, wheel: &str) -> String {
    let eccentricity = libm::hypot(p[0], p[1]);
    format!(
        "The {wheel} wheel runs out by {}: within each of its turns the heading swings by {} either way.",
        mm(eccentricity),
        deg(eccentricity / robot.drive.wheelbase())
    )
}

pub(super) const COSINE: Parameter = Parameter::size("cosine_m", "", "m", 3e-4, (-0.1, 0.1), "");

pub(super) const SINE: Parameter = Parameter::size("sine_m", "", "m", 3e-4, (-0.1, 0.1), "");

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn each_wheel_is_ahead_by_its_wave_at_the_angle_where_it_stops() {
        // 4 m on a wheel of 0.15 m are 53.33 rad.
        let angle: f64 = 4.0 / 0.075;
        for (side, sign) in [("left", -1.0), ("right", 1.0)] {
            let name = &*format!("wheel_eccentricity_{side}");
            for (c, s) in [(1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-4)] {
                let ahead = c * (libm::cos(angle) - 1.0) + s * libm::sin(angle);
                for (direction, _) in ccw_and_cw() {
                    let stop = stops_with(&[(name, "cosine_m", c), (name, "sine_m", s)], direction)[0];
                    assert!((stop.heading - sign * ahead / 0.34).abs() < 1e-12, "{stop:?}");
                    assert!((stop.x - 4.0 - 0.5 * ahead).abs() < 1e-6, "{stop:?}");
                }
            }
        }
    }
    #[test]
    fn in_a_turn_each_wheel_has_an_angle_of_its_own() {
        let c = 1e-4;
        for (direction, sign) in ccw_and_cw() {
            let turn = sign * 0.17 * std::f64::consts::FRAC_PI_2;
            for (name, way, side) in
                [("wheel_eccentricity_left", 4.0 - turn, -1.0), ("wheel_eccentricity_right", 4.0 + turn, 1.0)]
            {
                let ahead = c * (libm::cos(way / 0.075) - 1.0);
                let error =
                    stops_with(&[(name, "cosine_m", c)], direction)[1].heading - sign * std::f64::consts::FRAC_PI_2;
                assert!((error - side * ahead / 0.34).abs() < 1e-12, "{name} {direction:?}: {error}");
            }
        }
    }
}
