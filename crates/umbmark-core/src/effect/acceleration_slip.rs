//! Slip under drive and brake.

use super::words::{either, percent};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::Robot;
use crate::parameter::Parameter;
use umbmark_odometry::law::AccelerationSlip;

pub(super) static EFFECT: Entry = Entry::of::<AccelerationSlip>().wheels::<AccelerationSlip>();

impl Effect for AccelerationSlip {
    const ABOUT: About = About {
        name: "acceleration_slip",
        title: "slip under acceleration",
        acts_on: ActsOn::Wheels,
        parameters: &[Parameter::size(
            "s2_per_m",
            "acceleration-slip",
            "s^2/m",
            0.02,
            (-1.0, 1.0),
            "share of the travel that is lost per m/s^2 of acceleration",
        )],
        equation: "s_w ← (1 - k d|v_w|/dt) s_w",
        physics: "A driven wheel creeps when it pulls: it turns further than it moves forward. When it brakes, the robot pushes it, and \
                  it turns less than it moves.",
        signature: "Each leg loses k v²/2 while the robot speeds up and gains it back while it slows down, so return poses and stops \
                    show nothing. While the robot drives, a track shows it behind its odometry.",
        confused_with: &["reference_delay"],
        separated_by: "driving at the same speed with another acceleration: a delay of the reference stays the same, this slip does not",
        source: "linear creep of a rolling tyre; 2 % per m/s² is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "While it gains 0.5 m/s in a second a wheel gets {} {} than it counts, and as much the other way while it brakes.",
            percent(0.5 * p[0]),
            either(p[0], "less far", "farther")
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{along_with, ccw_and_cw, circle_speeds, halfway_round_with, stops_with};

    #[test]
    fn the_robot_is_behind_by_half_k_v_squared_while_it_cruises_and_comes_right_at_the_stop() {
        for k in [0.1, -0.1] {
            let model = [("acceleration_slip", "s2_per_m", k)];
            for (direction, _) in ccw_and_cw() {
                let behind = along_with(&model, direction, 2.0);
                assert!((behind.forward + k * 0.02).abs() < 1e-4 * k.abs(), "{behind:?}");
                for (stop, believed) in stops_with(&model, direction).iter().zip(stops_with(&[], direction)) {
                    let off = (stop.x - believed.x).hypot(stop.y - believed.y);
                    assert!(off < 1e-3 * k.abs(), "{stop:?}");
                }
            }
        }
    }
    #[test]
    fn on_a_circle_the_faster_wheel_is_behind_by_more() {
        for (direction, _) in ccw_and_cw() {
            let [left, right] = circle_speeds(direction);
            let expected = 0.1 * 0.5 * (left * left - right * right) / 0.34;
            let error = halfway_round_with(&[("acceleration_slip", "s2_per_m", 0.1)], direction);
            assert!((error - expected).abs() < 1e-3 * expected.abs(), "{error} {expected}");
        }
    }
}
