//! A sloping floor that lets the robot drift downhill.

use super::words::{mm, whole_degrees};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::FloorSlope;

pub(super) static EFFECT: Entry = Entry::of::<FloorSlope>().body::<FloorSlope>().of_floor();

impl Effect for FloorSlope {
    const ABOUT: About = About {
        name: "floor_slope",
        title: "drift on a sloping floor",
        acts_on: ActsOn::Body,
        parameters: &[
            Parameter {
                flag: "slope-x",
                meaning: "drift downhill along the heading at START, per metre driven",
                ..DRIFT_X
            },
            Parameter {
                flag: "slope-y",
                meaning: "drift downhill to the left of the heading at START, per metre driven",
                ..DRIFT_Y
            },
            Parameter::size(
                "slide_x_m_per_rad",
                "slope-slide-x",
                "m/rad",
                1e-3,
                (-1.0, 1.0),
                "slide along the heading at START per radian turned",
            ),
            Parameter::size(
                "slide_y_m_per_rad",
                "slope-slide-y",
                "m/rad",
                1e-3,
                (-1.0, 1.0),
                "slide to the left of the heading at START per radian turned",
            ),
        ],
        equation: "(forward, sideways) ← (forward, sideways) + R(-h) ((g_x, g_y) · length + (c_x, c_y) · |rotation|),  h the \
                   mean heading",
        physics: "Gravity pulls rolling tyres sideways. They respond with a slip angle of slope over cornering stiffness: a slope of 1 \
                  % and a stiffness of ten times the load per radian give 1 mm per metre. In a turn on the spot the tyres already \
                  scrub, and sliding friction does not hold the robot against a side force: it slides downhill while it turns, even on \
                  wide tyres that hold while they roll.",
        signature: "The return point is off by the drift times the length of the path, plus the slide times the rotation, equally in \
                    ccw and cw. The return heading is correct. No combination of E_d and E_b can produce this.",
        confused_with: &["carpet_nap", "start_pose"],
        separated_by: "starting the square rotated by 90 or 180 degrees. From carpet nap: turning the carpet. Slide from drift: a \
                       straight leg alone, or a turn alone",
        source: "linear tyre model, its stiffness assumed, and 3 mm per metre as a usual size; Coulomb friction, which points \
                 against the slip whatever its size, 1 mm per radian assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        let (drift, slide) = (&p[..2], &p[2..]);
        match (at_work(drift), at_work(slide)) {
            (true, true) => {
                let slide = mm(libm::hypot(slide[0], slide[1]));
                format!("{}, and {slide} on each radian of a turn.", carried(drift, "on each metre"))
            }
            (false, true) => format!("{}.", carried(slide, "on each radian of a turn")),
            _ => format!("{}.", carried(drift, "on each metre")),
        }
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

pub(super) const DRIFT: &str =
    "(forward, sideways) ← (forward, sideways) + R(-h) (g_x, g_y) · length,  h the mean heading";

/// Meaning of a drift in the room for the robot.
pub(super) fn carried(p: &[f64], when: &str) -> String {
    format!(
        "The floor carries the robot by {} {when}, towards {} degrees from its heading at START",
        mm(libm::hypot(p[0], p[1])),
        whole_degrees(libm::atan2(p[1], p[0]))
    )
}

pub(super) const DRIFT_X: Parameter = Parameter::size("drift_x", "", "m/m", 3e-3, (-1.0, 1.0), "");

pub(super) const DRIFT_Y: Parameter = Parameter::size("drift_y", "", "m/m", 3e-3, (-1.0, 1.0), "");

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, circle_end_with, model_with, stops_with};
    use crate::path::{Direction, Path, SQUARE, SpeedProfile};
    use crate::replay::Track;

    #[test]
    fn what_the_slope_means_tells_of_drift_and_slide_where_there_are_such() {
        let said = |values: &[(&str, f64)]| {
            let model: Vec<_> = values.iter().map(|(parameter, value)| ("floor_slope", *parameter, *value)).collect();
            model_with(&model).meaning("floor_slope").unwrap()
        };
        let (drift, slide) = (("drift_y", -3e-3), ("slide_x_m_per_rad", 2e-3));
        let carried = "The floor carries the robot by";
        let from = "from its heading at START";
        assert_eq!(said(&[drift]), format!("{carried} 3.00 mm on each metre, towards -90 degrees {from}."));
        assert_eq!(said(&[slide]), format!("{carried} 2.00 mm on each radian of a turn, towards 0 degrees {from}."));
        let both = "3.00 mm on each metre, towards -90 degrees from its heading at START, and 2.00 mm on each radian of a turn.";
        assert_eq!(said(&[drift, slide]), format!("{carried} {both}"));
    }

    #[test]
    fn the_robot_drifts_with_its_way_in_the_room_and_keeps_its_heading() {
        for name in ["floor_slope", "carpet_nap"] {
            for (x, y) in [(3e-3, 0.0), (0.0, -3e-3)] {
                let model = [(name, "drift_x", x), (name, "drift_y", y)];
                for (direction, sign) in ccw_and_cw() {
                    let stops = stops_with(&model, direction);
                    for (index, (corner_x, corner_y)) in
                        [(4.0, 0.0), (4.0, 4.0 * sign), (0.0, 4.0 * sign), (0.0, 0.0)].into_iter().enumerate()
                    {
                        let way = 4.0 * (index as f64 + 1.0);
                        let stop = stops[2 * index];
                        let off = (stop.x - corner_x - x * way, stop.y - corner_y - y * way);
                        assert!(off.0.abs() < 1e-12 && off.1.abs() < 1e-12, "{name} {stop:?}");
                    }
                    let circle = circle_end_with(&model, direction);
                    let way = 4.0 * std::f64::consts::PI;
                    assert!((circle.x - x * way).abs() < 1e-6 && (circle.y - y * way).abs() < 1e-6, "{circle:?}");
                }
            }
        }
    }

    #[test]
    fn the_slide_grows_with_the_rotation_and_not_with_the_way() {
        let model =
            model_with(&[("floor_slope", "slide_x_m_per_rad", 1e-3), ("floor_slope", "slide_y_m_per_rad", -2e-3)]);
        for side in [4.0, 1.0] {
            let path = Path::new(&SQUARE, &[side], SpeedProfile::default()).unwrap();
            for direction in Direction::BOTH {
                let end = Track::in_pieces(&path, direction, model.robot()).end(&model.chain());
                let turned = std::f64::consts::TAU;
                // The turn rate is that of the ramps' means: a thousandth.
                assert!((end.x - 1e-3 * turned).abs() < 1e-5 && (end.y + 2e-3 * turned).abs() < 2e-5, "{end:?}");
            }
        }
    }
}
