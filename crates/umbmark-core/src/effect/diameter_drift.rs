//! Wheel diameters that change as the robot drives.

use super::words::{either, mm};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::DiameterDrift;

pub(super) static EFFECT: Entry = Entry::of::<DiameterDrift>().wheels::<DiameterDrift>();

impl Effect for DiameterDrift {
    const ABOUT: About = About {
        name: "diameter_drift",
        title: "drift of the wheel diameters",
        acts_on: ActsOn::Wheels,
        parameters: &[
            Parameter::size(
                "per_m",
                "diameter-drift",
                "1/m",
                7.5e-5,
                (-0.1, 0.1),
                "change of D_R/D_L per metre since the run began",
            ),
            Parameter::size(
                "per_session_m",
                "diameter-drift-session",
                "1/m",
                7.5e-6,
                (-0.1, 0.1),
                "change of D_R/D_L per metre since the session began",
            ),
        ],
        equation: "s_R ← (1 + d/2) s_R,  s_L ← (1 - d/2) s_L,  d = k · way in the run + k' · way in the session",
        physics: "Tyres warm up, wear and lose air, or the battery or load moves. It happens to one wheel more than to the other.",
        signature: "Later legs curve more than earlier ones, so the path does not close as it would with a constant E_d. Over a session \
                    the return poses drift with the number of the run.",
        confused_with: &[],
        separated_by: "the heading along the track; cw and ccw runs in random order",
        source: "0.12 % over a run is assumed",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        let mean = 0.5 * (robot.drive.wheel_diameter_left() + robot.drive.wheel_diameter_right());
        let grown =
            |per_metre: f64| format!("{} {}", mm(10.0 * per_metre * mean), either(per_metre, "larger", "smaller"));
        format!(
            "Against the left wheel the right one gets {} in diameter over 10 m of a run, and {} over 10 m of the session.",
            grown(p[0]),
            grown(p[1])
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn the_heading_grows_as_the_square_of_the_way() {
        for k in [1e-5, -1e-5] {
            for name in ["per_m", "per_session_m"] {
                for (direction, sign) in ccw_and_cw() {
                    let stops = stops_with(&[("diameter_drift", name, k)], direction);
                    for leg in 0..4 {
                        let way = 4.0 * (f64::from(leg) + 1.0);
                        let error =
                            stops[2 * leg as usize].heading - sign * f64::from(leg) * std::f64::consts::FRAC_PI_2;
                        let expected = k * 0.5 * way * way / 0.34;
                        assert!((error - expected).abs() < 1e-10, "{error} {expected}");
                    }
                }
            }
        }
    }
}
