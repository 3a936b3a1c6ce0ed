//! A sloping floor that turns the robot as it drives across.

use super::words::deg;
use super::{About, ActsOn, Changes, Context, Effect, at_work};
use crate::drive::{Kinds, Robot};
use crate::geometry::{Displacement2, Real};
use crate::parameter::Parameter;

/// A rate of turn per metre that depends on the heading in the room.
pub struct FloorSlopeYaw;

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
        ],
        equation: "Δθ ← Δθ + (c cos h + s sin h) · length,  h the mean heading in the room",
        physics: "Across the slope the lower wheel carries more load and is compressed, and the casters are pushed downhill: \
                  the robot turns, the more the steeper it is across its way.",
        signature: "Opposite sides bend opposite ways: the heading comes right again and the position does not, off to one \
                    side in ccw and to the other in cw. Bumps on one leg leave nearly the same.",
        confused_with: &["placed_bumps", "base_yaw"],
        separated_by: "starting the square turned by 90 or 180 degrees; a heading at each corner",
        source: "load transfer on a slope; 1 mrad per metre is assumed",
    };

    const DRIVES: Kinds = Kinds::ALL;

    const CHANGES: Changes = Changes::BODY;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!(
            "The floor turns the robot by up to {} on each metre: most to the left where it heads {} degrees from its heading at START.",
            deg(libm::hypot(p[0], p[1])),
            libm::round(libm::atan2(p[1], p[0]).to_degrees())
        )
    }

    fn varies(p: &[f64]) -> bool {
        at_work(p)
    }

    fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>) {
        let (sine, cosine) = (at.heading + motion.rotation * 0.5).sine_cosine();
        motion.rotation += (p[0] * cosine + p[1] * sine) * at.length;
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{ccw_and_cw, stops_with};
    use std::f64::consts::TAU;

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
}
