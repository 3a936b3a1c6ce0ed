//! The bumps of the extended UMBmark test.

use super::bumps::{HEIGHT, PROFILE, WHEEL_RADIUS, lost_travel};
use super::words::{deg, mm, size};
use super::{About, ActsOn, Bump, BumpLaw, Effect, Entry, Stretch, TestKind};
use crate::drive::{DriveKind, DriveKinds, Robot, Wheel};
use crate::parameter::Parameter;
use crate::path::Direction;
use crate::random::Stream;
use umbmark_odometry::law::PlacedBumps;

pub(super) static EFFECT: Entry = Entry::of::<PlacedBumps>().wheels::<PlacedBumps>().bumps::<PlacedBumps>().of_floor();

impl Effect for PlacedBumps {
    const ABOUT: About = About {
        name: "placed_bumps",
        title: "bumps of the extended UMBmark test",
        acts_on: ActsOn::Wheels,
        parameters: &[
            Parameter::count(
                "count",
                "bumps",
                10.0,
                (0.0, 1000.0),
                "bumps placed on the first leg of each run of the extended test",
            ),
            HEIGHT,
            WHEEL_RADIUS,
            PROFILE,
            Parameter::size(
                "lost_per_m",
                "bump-loss",
                "m/m",
                9e-3,
                (0.0, 0.5),
                "share of its travel that the inside wheel loses on the first leg, in place of single bumps",
            ),
        ],
        equation: "D lost per bump, or s_in ← (1 - l) s_in on the first leg.  \
                   edge: D = 2R(ψ - sin ψ), cos ψ = 1 - h/R;  cable: D = 2(R + h/2)(φ - sin φ), cos φ = (R - h/2)/(R + h/2)",
        physics: "During the first leg, a cable is laid ten times under the wheel on the inside of the square. Each time the wheel \
                  counts travel that the body does not make. `bump-loss` is the even loss l that a track shows: ten bumps of 3.5 mm on \
                  4 m are 0.009. This loss acts in runs of both tests, the bumps only in those of the extended test.",
        signature: "Each bump turns the heading by D/b towards the inside wheel. The return heading error is their sum, wherever the \
                    bumps are; the return position depends on where they are.",
        confused_with: &["start_pose", "floor_slope_yaw"],
        separated_by: "subtracting the result of the regular test, as Eq. (5) does",
        source: "Borenstein & Feng (1995), section 3.3 and Table II",
    };

    const DRIVES: DriveKinds = DriveKinds::DIFFERENTIAL.and(DriveKind::Synchro).and(DriveKind::Clapper);

    fn means(p: &[f64], robot: &Robot) -> String {
        let (single, share) = (lost_travel(p[1], p[2], p[3]), p[4]);
        let turned = |lost: f64| deg(lost / robot.drive.wheelbase());
        if share > 0.0 {
            return format!(
                "On the first leg the inside wheel loses {} on each metre, which turns the robot by {}.",
                mm(share),
                turned(share)
            );
        }
        format!(
            "Each of {} bumps costs the inside wheel {}, which turns the robot by {}.",
            size(p[0]),
            mm(single),
            turned(single)
        )
    }

    fn varies(p: &[f64]) -> bool {
        p[4] != 0.0
    }
}

impl BumpLaw for PlacedBumps {
    fn bumps(p: &[f64], stretch: &Stretch, _stream: &mut Stream, met: &mut Vec<Bump>) {
        if stretch.test != TestKind::Bumps || stretch.index != 0 {
            return;
        }
        let across = stretch.across();
        let (wheel, rolled) = match stretch.direction {
            Direction::Ccw => (Wheel::Left, across.left),
            Direction::Cw => (Wheel::Right, across.right),
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
    use crate::effect::tests::{ccw_and_cw, stops_with};

    #[test]
    fn ten_bumps_lie_evenly_on_the_first_leg_under_the_inside_wheel_of_the_extended_test_only() {
        let met = |index, direction, test| {
            let stretch = Stretch { index, direction, test, travel: WheelTravel { left: 4.0, right: 4.0 }, left: 0.0 };
            let mut met = Vec::new();
            PlacedBumps::bumps(&[10.0, 0.01, 0.075, 0.0, 0.0], &stretch, &mut Stream::new(0, 0, 0), &mut met);
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

    #[test]
    fn an_even_loss_turns_the_robot_to_the_inside_along_the_first_leg_and_nowhere_else() {
        for loss in [9e-3, 1e-3] {
            for (direction, sign) in ccw_and_cw() {
                let stops = stops_with(&[("placed_bumps", "lost_per_m", loss)], direction);
                for (index, stop) in stops.iter().enumerate() {
                    let turned = std::f64::consts::FRAC_PI_2 * f64::from(index.div_ceil(2) as u8) + 4.0 * loss / 0.34;
                    assert!((stop.heading - sign * turned).abs() < 1e-12, "{direction:?} {index}: {stop:?}");
                }
            }
        }
    }
}
