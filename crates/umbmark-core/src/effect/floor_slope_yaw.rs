//! A sloping floor that turns the robot as it drives across and as it turns.

use super::words::{deg, whole_degrees};
use super::{About, ActsOn, Effect, Entry, at_work};
use crate::drive::{DriveKinds, Robot};
use crate::parameter::Parameter;
use umbmark_odometry::law::FloorSlopeYaw;

pub(super) static EFFECT: Entry = Entry::of::<FloorSlopeYaw>().body::<FloorSlopeYaw>().of_floor();

impl Effect for FloorSlopeYaw {
    const ABOUT: About = About {
        name: "floor_slope_yaw",
        title: "yaw on a sloping floor",
        acts_on: ActsOn::Body,
        parameters: &[
            Parameter::size(
                "cosine_rad_per_m",
                "slope-yaw-cosine",
                "rad/m",
                1e-3,
                (-1.0, 1.0),
                "turn per metre while heading as at START; opposite on the way back",
            ),
            Parameter::size(
                "sine_rad_per_m",
                "slope-yaw-sine",
                "rad/m",
                1e-3,
                (-1.0, 1.0),
                "turn per metre while heading to the left of START; opposite on the way back",
            ),
            Parameter::size(
                "turning_cosine",
                "slope-turning-cosine",
                "",
                5e-3,
                (-0.5, 0.5),
                "turn to the left per radian turned either way while heading as at START",
            ),
            Parameter::size(
                "turning_sine",
                "slope-turning-sine",
                "",
                5e-3,
                (-0.5, 0.5),
                "turn to the left per radian turned either way while heading to the left of START",
            ),
        ],
        equation: "Δθ ← Δθ + (c cos h + s sin h) · length + (p cos h + q sin h) · |rotation|,  h the mean heading in the room",
        physics: "When the robot drives across a slope, the lower wheel carries more load and is compressed, and the casters are pushed \
                  downhill. The robot turns, in proportion to the slope across its course. In a turn on the spot the tyres scrub and do \
                  not hold against a side force, so gravity swings the heavy end of the robot downhill, with the turn or against it.",
        signature: "Opposite sides of the square bend in opposite directions, so the heading error cancels. The position error does \
                    not: it is on one side in ccw and on the other in cw. Bumps on a single leg leave nearly the same error.",
        confused_with: &["placed_bumps", "base_yaw"],
        separated_by: "starting the square rotated by 90 or 180 degrees; a heading at each corner. Driving from turning: a straight leg \
                       alone, or a turn alone",
        source: "load transfer on a slope, 1 mrad per metre assumed; Coulomb friction of scrubbing tyres, 5 mrad per radian assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        let most = |p: &[f64]| (deg(libm::hypot(p[0], p[1])), whole_degrees(libm::atan2(p[1], p[0])));
        let turned = |p: &[f64], when: &str| {
            let (size, heading) = most(p);
            format!(
                "The floor turns the robot by up to {size} on each {when}: most to the left where it heads {heading} degrees from its \
                 heading at START"
            )
        };
        let (way, turn) = (&p[..2], &p[2..]);
        match (at_work(way), at_work(turn)) {
            (true, true) => {
                let (on_its_way, (size, there)) = (turned(way, "metre"), most(turn));
                format!("{on_its_way}; and by up to {size} on each radian that it turns, most at {there} degrees.")
            }
            (false, true) => format!("{}.", turned(turn, "radian that it turns")),
            _ => format!("{}.", turned(way, "metre")),
        }
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, model_with, stops_with};
    use std::f64::consts::TAU;

    #[test]
    fn what_it_means_tells_of_way_and_turns_where_they_matter() {
        let said = |values: &[(&str, f64)]| {
            let model: Vec<_> =
                values.iter().map(|(parameter, value)| ("floor_slope_yaw", *parameter, *value)).collect();
            model_with(&model).meaning("floor_slope_yaw").unwrap()
        };
        let (way, turn) = (("sine_rad_per_m", 0.02), ("turning_cosine", -0.01));
        let turned = "The floor turns the robot by up to";
        let most = "most to the left where it heads";
        let from = "degrees from its heading at START";
        assert_eq!(said(&[way]), format!("{turned} 1.15 deg on each metre: {most} 90 {from}."));
        assert_eq!(said(&[turn]), format!("{turned} 0.573 deg on each radian that it turns: {most} 180 {from}."));
        let both = "and by up to 0.573 deg on each radian that it turns, most at 180 degrees.";
        assert_eq!(said(&[way, turn]), format!("{turned} 1.15 deg on each metre: {most} 90 {from}; {both}"));
    }

    #[test]
    fn each_leg_turns_by_its_heading_in_the_room_and_the_sum_is_nothing() {
        for k in [1e-4, -1e-4] {
            for (direction, sign) in ccw_and_cw() {
                let cosine = stops_with(&[("floor_slope_yaw", "cosine_rad_per_m", k)], direction);
                assert!((cosine[0].heading - 4.0 * k).abs() < 1e-7);
                assert!((cosine[4].heading - cosine[3].heading + 4.0 * k).abs() < 1e-6);
                let sine = stops_with(&[("floor_slope_yaw", "sine_rad_per_m", k)], direction);
                assert!((sine[2].heading - sine[1].heading - sign * 4.0 * k).abs() < 1e-6);
                for end in [cosine[7], sine[7]] {
                    assert!((end.heading - sign * TAU).abs() < 1e-5, "{end:?}");
                }
                // Leg 1 bends by 4k and leg 3 back, 8k aside and 8k back; leg 2 between them is 4k off over 4 m.
                assert!((cosine[7].x + sign * 16.0 * k).abs() < 1e-5, "{:?}", cosine[7]);
            }
        }
    }

    /// Oracle: ∫ (p cos h + q sin h) |dh| over a quarter turn from h.
    #[test]
    fn each_turn_on_the_spot_is_off_by_its_headings_alike_in_both_senses_and_legs_are_not() {
        for k in [1e-4, -1e-4] {
            for (direction, sign) in ccw_and_cw() {
                for (name, integral) in
                    [("turning_cosine", (|h: f64| h.sin()) as fn(f64) -> f64), ("turning_sine", |h: f64| -h.cos())]
                {
                    let stops = stops_with(&[("floor_slope_yaw", name, k)], direction);
                    for turn in 0..4 {
                        let (from, to) = (stops[2 * turn].heading, stops[2 * turn + 1].heading);
                        let quarter = |turns: usize| sign * TAU / 4.0 * turns as f64;
                        let expected = k * sign * (integral(quarter(turn + 1)) - integral(quarter(turn)));
                        assert!(
                            (to - from - quarter(1) - expected).abs() < 1e-3 * k.abs(),
                            "{name} {turn} {direction:?}"
                        );
                        if turn > 0 {
                            assert_eq!(from, stops[2 * turn - 1].heading);
                        }
                    }
                }
            }
        }
    }
}
