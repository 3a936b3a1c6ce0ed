//! Wheel diameters that change as the robot drives.

use super::words::{either, mm, size};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::{DefaultValue, Parameter};
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
            Parameter::size(
                "mean_per_m",
                "diameter-drift-mean",
                "1/m",
                7.5e-5,
                (-0.1, 0.1),
                "growth of both diameters per metre since the run began, as a share",
            ),
            Parameter {
                default: DefaultValue::Value(0.0),
                ..Parameter::shape(
                    "settles_per_m",
                    "diameter-drift-settles",
                    "1/m",
                    0.02,
                    (0.0, 10.0),
                    "rate at which the growth in the run dies away; 0 where it goes on",
                )
            },
        ],
        equation: "s_R ← (1 + d/2 + m) s_R,  s_L ← (1 - d/2 + m) s_L,  d = k w + k' · way in the session,  m = k\" w,  \
                   w = (1 - exp(-r · way in the run))/r",
        physics: "Tyres warm up, wear and lose air, or the battery or load moves. It happens to one wheel more than to the other, or \
                  to one only. What warms up settles, the more it has grown.",
        signature: "Later legs curve more than earlier ones, so the path does not close as it would with a constant E_d, and where \
                    the mean grows, later legs are longer. Over a session the return poses drift with the number of the run.",
        confused_with: &[],
        separated_by: "the heading along the track; cw and ccw runs in random order",
        source: "0.12 % over a run is assumed",
    };

    fn means(p: &[f64], robot: &Robot) -> String {
        let mean = 0.5 * (robot.drive.wheel_diameter_left() + robot.drive.wheel_diameter_right());
        let grown = |per_metre: f64, way: f64| {
            format!("{} {}", mm(way * per_metre * mean), either(per_metre, "larger", "smaller"))
        };
        let way = if p[3] > 0.0 { -libm::expm1(-10.0 * p[3]) / p[3] } else { 10.0 };
        let settles = match p[3] > 0.0 {
            true => format!(" What is in a run settles: after {} m, 63 % of it has come.", size(1.0 / p[3])),
            false => String::new(),
        };
        format!(
            "Over the first 10 m of a run, the left wheel gets {} in diameter, the right one {}; over 10 m of the session, the right one \
             gets {} against the left one.{settles}",
            grown(p[2] - 0.5 * p[0], way),
            grown(p[2] + 0.5 * p[0], way),
            grown(p[1], 10.0)
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(&p[..3])
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

    /// The integral of (1 - exp(-r s))/r over the first leg is (4 - (1 - exp(-4 r))/r)/r; nearly nothing must not jump where the series begins.
    #[test]
    fn what_settles_grows_as_its_integral_does_for_one_wheel_as_for_both() {
        for rate in [0.0, 1e-9, 2e-5, 3e-5, 0.02, 0.5] {
            let grown = match rate {
                r if r < 1e-6 => 8.0,
                r => (4.0 + libm::expm1(-4.0 * r) / r) / r,
            };
            for (direction, _) in ccw_and_cw() {
                let settles = ("diameter_drift", "settles_per_m", rate);
                let turned = stops_with(&[("diameter_drift", "per_m", 1e-5), settles], direction)[0];
                let longer = stops_with(&[("diameter_drift", "mean_per_m", 1e-3), settles], direction)[0];
                assert!((turned.heading - 1e-5 * grown / 0.34).abs() < 1e-8, "{rate}: {turned:?}");
                assert!(
                    (longer.x - 4.0 - 1e-3 * grown).abs() < 1e-5 && longer.heading.abs() < 1e-12,
                    "{rate}: {longer:?}"
                );
                // Only the right wheel grows: half of what it does is the mean's.
                let right = [("diameter_drift", "per_m", 1e-5), ("diameter_drift", "mean_per_m", 5e-6), settles];
                let right = stops_with(&right, direction)[0];
                assert!((right.heading - turned.heading).abs() < 1e-9, "{rate}: {right:?} {turned:?}");
            }
        }
    }
}
