//! The bumps of the extended UMBmark test.

use super::bumps::{EXTRA_TRAVEL, HEIGHT, PROFILE, WHEEL_RADIUS, lost_travel};
use super::{About, ActsOn, Bump, Effect, Stretch, TestKind};
use crate::drive::Wheel;
use crate::parameter::{DefaultValue, Parameter};
use crate::path::Direction;
use crate::random::Stream;

/// Bumps spread evenly over the first leg, under the wheel on the inside of the path, in runs of the extended test only.
pub struct PlacedBumps;

impl Effect for PlacedBumps {
    const ABOUT: About = About {
        name: "placed_bumps",
        title: "bumps of the extended UMBmark test",
        acts_on: ActsOn::Wheels,
        parameters: &[
            Parameter {
                name: "count",
                flag: "bumps",
                unit: "",
                default: DefaultValue::Value(0.0),
                typical: 10.0,
                bounds: (0.0, 1000.0),
                meaning: "bumps placed on the first leg of each run of the extended test",
                choices: &[],
            },
            HEIGHT,
            WHEEL_RADIUS,
            PROFILE,
        ],
        equation: EXTRA_TRAVEL,
        physics: "A cable is laid ten times under the wheel that faces the inside of the square, during the first leg. Each \
                  time the wheel counts travel that the body does not make.",
        signature: "The heading turns by D/b per bump towards the inside wheel: the return heading error is the sum, whatever \
                    the places; the return position depends on the places.",
        confused_with: &["start_pose", "floor_slope_yaw"],
        separated_by: "subtracting the regular test, as Eq. (5) does",
        source: "Borenstein & Feng (1995), section 3.3 and Table II",
    };

    fn bumps(p: &[f64], stretch: &Stretch, _stream: &mut Stream, met: &mut Vec<Bump>) {
        if stretch.test != TestKind::Bumps || stretch.index != 0 {
            return;
        }
        let (wheel, rolled) = match stretch.direction {
            Direction::Ccw => (Wheel::Left, stretch.travel.left),
            Direction::Cw => (Wheel::Right, stretch.travel.right),
        };
        let lost = lost_travel(p[1], p[2], p[3]).copysign(rolled);
        let count = p[0].round();
        met.extend((0..count as usize).map(|i| Bump { at: (i as f64 + 0.5) / count, wheel, lost }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::WheelTravel;

    #[test]
    fn ten_bumps_lie_evenly_on_the_first_leg_under_the_inside_wheel_of_the_extended_test_only() {
        let met = |index, direction, test| {
            let stretch = Stretch { index, direction, test, travel: WheelTravel { left: 4.0, right: 4.0 } };
            let mut met = Vec::new();
            PlacedBumps::bumps(&[10.0, 0.01, 0.075, 0.0], &stretch, &mut Stream::new(0, 0, 0), &mut met);
            met
        };
        let left = met(0, Direction::Ccw, TestKind::Bumps);
        assert_eq!(left.len(), 10);
        assert!(left.iter().all(|b| b.wheel == Wheel::Left && b.lost > 0.0));
        let mean = left.iter().map(|b| b.at).sum::<f64>() / 10.0;
        assert!((mean - 0.5).abs() < 1e-12 && (left[0].at - 0.05).abs() < 1e-12);
        assert!(met(0, Direction::Cw, TestKind::Bumps).iter().all(|b| b.wheel == Wheel::Right));
        assert!(met(1, Direction::Ccw, TestKind::Bumps).is_empty());
        assert!(met(0, Direction::Ccw, TestKind::Systematic).is_empty());
    }
}
