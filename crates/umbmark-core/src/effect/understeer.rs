//! Tyres that run wide in fast corners.

use super::words::{deg, either};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKind, DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::Understeer;

pub(super) static EFFECT: Entry = Entry::of::<Understeer>().body::<Understeer>();

impl Effect for Understeer {
    const ABOUT: About = About {
        name: "understeer",
        title: "understeer",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "rad_per_m_s2",
            "understeer",
            "rad/(m/s²)",
            0.02,
            (-10.0, 10.0),
            "steering lost per lateral acceleration; less than 0 oversteers",
        )],
        equation: "Δθ = forward · tan(δ - K v² κ)/W,  κ = believed Δθ/forward,  tan δ = W κ",
        physics: "The tyres of the steered wheel slip sideways more than those of the axle, in proportion to the side force.",
        signature: "Corners are too blunt, by an amount that grows with the square of the speed. At a single speed and radius it looks \
                    like an error of the steering gain.",
        confused_with: &["steering_gain"],
        separated_by: "the same circle at two speeds",
        source: "linear single-track model of vehicle dynamics; the size is assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::of(DriveKind::Ackermann);

    fn means(p: &[f64], _robot: &Robot) -> String {
        let less = either(p[0], "less", "more");
        format!("In a curve with 1 m/s² of side force the wheel acts as if it were steered by {} {less}.", deg(p[0]))
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_speeds, halfway_round_with};

    #[test]
    fn a_circle_opens_by_the_square_of_the_speed() {
        for k in [0.02, -0.02] {
            for (direction, sign) in ccw_and_cw() {
                let [left, right] = circle_speeds(direction);
                let speed = 0.5 * (left + right);
                let steering = (0.34_f64 / 2.0).atan() - k * speed * speed / 2.0;
                let half = 2.0 * std::f64::consts::PI;
                let expected = sign * half * (steering.tan() / 0.34 - 0.5);
                // The ramps are driven more slowly: 0.18 m of them on the first half's 6.28 m.
                let error = halfway_round_with(&[("understeer", "rad_per_m_s2", k)], direction);
                assert!((error / expected - 1.0).abs() < 0.03, "{error} {expected}");
            }
        }
    }
}
