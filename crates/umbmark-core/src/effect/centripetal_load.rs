//! The outer tyre gives way in arcs.

use super::words::{either, percent};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::CentripetalLoad;

/// On a leg, the robot turns as far as its wheels differ.
pub(super) static EFFECT: Entry = Entry::of::<CentripetalLoad>().wheels::<CentripetalLoad>().resting_on_others();

impl Effect for CentripetalLoad {
    const ABOUT: About = About {
        name: "centripetal_load",
        title: "tyres under centripetal load",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter::size(
            "s2_per_m",
            "centripetal-load",
            "s^2/m",
            1e-3,
            (-0.1, 0.1),
            "difference of the wheel radii per m/s^2 towards the centre of the arc, as a share",
        )],
        equation: "s_R ← (1 - c v ω/2) s_R,  s_L ← (1 + c v ω/2) s_L,  v and ω by the speeds of the rims",
        physics: "In a curve, load moves to the outer wheel, in proportion to the height of the centre of mass over the width of the \
                  robot. The load compresses the outer tyre, so its rolling radius becomes smaller.",
        signature: "A square shows nothing, because the robot either drives straight or turns on the spot. Circles come out too wide, \
                    and more so at higher speed. On arcs of a single speed it looks like E_b.",
        confused_with: &["wheelbase"],
        separated_by: "circles at a low and a high speed, in both directions",
        source: "load transfer on a linear tyre; 0.1 % per m/s² is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "In an arc at 1 m/s and 1 rad/s the outer wheel rolls {} {} than it counts, and the inner one as much the other way.",
            percent(0.5 * p[0]),
            either(p[0], "less", "more")
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle, stops_with, watched_with};

    /// Wheels of unequal size drive a bow on what the robot counts as a straight leg.
    #[test]
    fn the_turn_rate_is_that_of_the_rims() {
        let unequal = ("wheel_diameter_ratio", "e_d", 1.01);
        let curvature = 0.01 / 1.005 / 0.34;
        for (direction, _) in ccw_and_cw() {
            let leg = |c| stops_with(&[unequal, ("centripetal_load", "s2_per_m", c)], direction)[0].heading;
            // A leg of 4 m with ramps of 1 s to 0.2 m/s: the integral of v³ is 0.008 (cruise 19 s + 2/4 of a second).
            let lost = 0.01 * curvature * 0.008 * 19.5 / 0.34;
            assert!((leg(0.0) - leg(0.01) - lost).abs() < 1e-3 * lost, "{} {lost}", leg(0.0) - leg(0.01));
        }
    }

    #[test]
    fn a_circle_turns_too_little_by_the_acceleration_times_the_forward_way_over_the_wheelbase() {
        for c in [0.01, -0.01] {
            let model = [("centripetal_load", "s2_per_m", c)];
            for (direction, sign) in ccw_and_cw() {
                let (track, poses) = watched_with(&model, &circle(), direction);
                // The faster wheel's trapezoid sets v; v ω ds = v² κ ds summed over the believed pieces is the oracle.
                let squared: f64 = track.contexts().iter().map(|at| at.speed * at.turn_rate * at.length).sum();
                let end = poses[poses.len() - 1].heading;
                let expected = sign * std::f64::consts::TAU - c * squared / 0.34;
                assert!((end - expected).abs() < 1e-9, "{end} {expected}");
                let square = stops_with(&model, direction)[7];
                assert!(square.x.hypot(square.y) < 1e-9);
            }
        }
    }
}
