//! Wheels that follow late what was counted.

use super::words::{percent, size};
use super::{About, ActsOn, Effect, Entry};
use crate::drive::Robot;
use crate::parameter::Parameter;
use std::ops::Range;
use umbmark_odometry::law::WheelLag;

pub(super) static EFFECT: Entry = Entry::of::<WheelLag>().wheels::<WheelLag>();

/// Shares that wheels can follow late; with what is left for the error of an estimate.
const SHARES: Range<f64> = 0.25..1.25;

impl Effect for WheelLag {
    const ABOUT: About = About {
        name: "wheel_lag",
        title: "wheels that follow late, counts are commands",
        acts_on: ActsOn::Odometry,
        parameters: &[
            Parameter::share(
                "share",
                "wheel-lag",
                (-10.0, 10.0),
                "share of what is counted that the wheels follow late; 1 where counts are commands",
            ),
            Parameter::shape(
                "time_constant_s",
                "wheel-lag-time",
                "s",
                0.15,
                (0.02, 0.64),
                "time after which all but 1/e of a change of the commanded speed is followed",
            ),
        ],
        equation: "s_w ← s_w - κ Δℓ_w,  dℓ_w/dt = v_w - ℓ_w/τ,  only where the ticks were recorded",
        physics: "What is recorded is the speed that the wheels were told, not what encoders counted, and motors need time to reach it. A \
                  filter of the counted speed does the same.",
        signature: "The robot is behind by v τ while it drives and catches up when it stands still. Where it turns while it drives, it \
                    leaves the counted path, and does not come back to it. Return poses of a drive with stops hardly show it.",
        confused_with: &["reference_delay", "reference_filter"],
        separated_by: "quick changes of speed: a delay moves all of the motion, a lag rounds its corners; counts of encoders",
        source: "first-order response of a speed control loop; 0.15 s is assumed",
    };

    fn means(p: &[f64], _robot: &Robot) -> String {
        let share = if p[0] == 1.0 {
            "The wheels follow".to_owned()
        } else {
            format!("{} of the motion follows", percent(p[0]))
        };
        format!(
            "{share} what is counted with a time constant of {} ms: at 0.5 m/s the robot is {} mm behind.",
            size(1e3 * p[1]),
            size(1e3 * p[0] * 0.5 * p[1])
        )
    }

    /// Counts are commands or they are not: a small share, or far more than all, stands for something else, as a delay.
    fn is_credible(p: &[f64]) -> bool {
        SHARES.contains(&p[0])
    }

    fn varies(p: &[f64]) -> bool {
        p[0] != 0.0
    }
}

#[cfg(test)]
mod tests {
    use crate::dataset::{ReferencePose, TickLog};
    use crate::drive::Robot;
    use crate::effect::tests::{circle_end_with, model_with, recorded_log, stops_with};
    use crate::geometry::Pose2;
    use crate::path::Direction;
    use crate::replay::Track;

    const LATE: [(&str, &str, f64); 2] = [("wheel_lag", "share", 1.0), ("wheel_lag", "time_constant_s", 0.13)];

    /// How far behind the counted poses the robot is along START's heading, and how far it turned less, by the time of the pose.
    fn behind(log: &TickLog) -> Vec<(f64, Pose2)> {
        let track = Track::from_log(log, &Robot::labmate()).unwrap();
        let [told, real] = [&[][..], &LATE].map(|settings| track.poses(&model_with(settings).chain()));
        let of_pose = |(seen, (told, real)): (&ReferencePose, (&Pose2, &Pose2))| {
            let off = Pose2::new(told.x - real.x, told.y - real.y, told.heading - real.heading);
            (log.time[seen.sample], off)
        };
        log.reference.iter().zip(told.iter().zip(&real)).map(of_pose).collect()
    }

    #[test]
    fn the_robot_is_behind_by_speed_times_time_constant_while_it_cruises_and_not_where_it_rests() {
        let behind = behind(&recorded_log());
        let at = |time: f64| behind.iter().rfind(|(seen, _)| *seen <= time).unwrap().1;
        // After 1.4 s at 0.2 m/s all but e^-11 of the lag is there; after 1.9 s of rest all but e^-15 of it is gone.
        let cruising = at(1.86);
        assert!((cruising.x / (0.2 * 0.13) - 1.0).abs() < 5e-3, "{cruising:?}");
        let resting = at(3.86);
        assert!(resting.x.abs() < 2e-5 && resting.heading == 0.0, "{resting:?}");
    }

    #[test]
    fn a_turn_that_begins_before_the_leg_is_followed_leaves_the_counted_path() {
        let last = behind(&recorded_log()).last().unwrap().1;
        assert!(last.heading.abs() < 2e-5 && last.x.hypot(last.y) > 0.3e-3, "{last:?}");
    }

    #[test]
    fn where_only_returns_are_known_the_robot_has_come_to_rest() {
        for direction in Direction::BOTH {
            assert_eq!(stops_with(&LATE, direction), stops_with(&[], direction));
            assert_eq!(circle_end_with(&LATE, direction), circle_end_with(&[], direction));
        }
    }
}
