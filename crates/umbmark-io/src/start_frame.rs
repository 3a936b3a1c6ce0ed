//! Tracks in the frame of the room, re-expressed in the frame of START.
//!
//! The poses of a log are meant to be in the frame of START: origin where the robot's odometry was set to zero, x axis
//! along its heading. Then the poses measured before the first motion lie at the origin but for noise and for the
//! misplacement of the robot by hand, and they are kept. A track that begins farther away than anyone misplaces a robot
//! is in the frame of the room; it is turned and shifted by the mean of the poses measured before the first motion. Where none
//! was, START follows from the first poses on the way and from what the counts say until then; where headings were not
//! measured, its heading follows from the first way.

use super::error::DatasetError;
use umbmark_core::dataset::TickLog;
use umbmark_core::drive::Robot;
use umbmark_core::geometry::{Pose2, wrap};
use umbmark_core::run::dead_reckoning::{computed_poses, mean_pose, standing_at_start};
use umbmark_core::run::{ReferencePose, Start, StartKnown};

/// Misplacement by hand stays below these \[m, rad\].
const HAND: (f64, f64) = (0.10, 0.10);
/// Odometry errs by less than this share of the way and of the turns.
const ODOMETRY: f64 = 0.1;
/// A pose behind this share of the way does not say where START was.
const LATE: f64 = 0.5;
/// Less is not worth a word \[m, rad\].
const SMALL: (f64, f64) = (0.010, 0.010);
/// A heading is told from the first way of this length \[m\], or of what there is, but of no less than the second.
const WAY: (f64, f64) = (1.5, 0.2);

/// Moves the track of a log into the frame of START, where it is not there yet.
pub(super) fn move_to_start(
    file: &str,
    log: &mut TickLog,
    robot: Option<&Robot>,
    warnings: &mut Vec<String>,
) -> Result<(), DatasetError> {
    let standing = mean_pose(standing_at_start(log));
    let Some(first) = standing.or_else(|| log.reference.first().copied()) else { return Ok(()) };
    let believed = robot.map(|robot| computed_poses(log, robot)).unwrap_or_default();
    let expected = if standing.is_some() { Some(Pose2::IDENTITY) } else { believed.get(first.sample).copied() };
    let Some(expected) = expected else { return Ok(()) };
    let distance = libm::hypot(first.x - expected.x, first.y - expected.y);
    let turn = wrap(first.heading.map_or(0.0, |heading| heading - expected.heading));
    let beyond = |limit: (f64, f64)| distance > limit.0 || turn.abs() > limit.1;
    let (mut way, mut turned, mut whole) = (0.0, 0.0, 0.0);
    for (sample, pair) in believed.windows(2).enumerate() {
        let step = libm::hypot(pair[1].x - pair[0].x, pair[1].y - pair[0].y);
        whole += step;
        if standing.is_none() && sample < first.sample {
            way += step;
            turned += wrap(pair[1].heading - pair[0].heading).abs();
        }
    }
    // Poses at the end of a run are what it is asked for; they do not say where it began.
    if standing.is_none() && way > LATE * whole {
        return Ok(());
    }
    let hand = (HAND.0 + ODOMETRY * way, HAND.1 + ODOMETRY * turned);
    let known = if standing.is_some() { StartKnown::AtRest } else { StartKnown::OnTheWay };
    if !beyond(hand) {
        if beyond(SMALL) && standing.is_some() {
            let place = place(distance, turn);
            warnings.push(format!("{file}: the track starts {place}; taken as misplacement of the robot at START"));
        }
        return Ok(());
    }
    let start = match first.heading {
        Some(heading) => Pose2::new(first.x, first.y, heading).compose(&expected.inverse()),
        None => {
            let heading = first_course(log, &believed).ok_or_else(|| DatasetError::NoStartHeading {
                file: file.to_owned(),
                distance: (distance * 1e3).round() / 1e3,
            })?;
            let turned = Pose2::new(0.0, 0.0, heading).compose(&expected);
            Pose2::new(first.x - turned.x, first.y - turned.y, heading)
        }
    };
    for pose in &mut log.reference {
        let seen = start.between(&Pose2::new(pose.x, pose.y, pose.heading.unwrap_or(start.heading)));
        (pose.x, pose.y, pose.heading) = (seen.x, seen.y, pose.heading.map(|_| seen.heading));
    }
    let Pose2 { x, y, heading } = start;
    log.start = Start { x, y, heading, known };
    let place = place(libm::hypot(x, y), wrap(heading));
    warnings.push(match (known, first.heading) {
        (StartKnown::OnTheWay, _) => format!(
            "{file}: no pose was measured before the robot moved; its START, {place}, follows from the first poses on the way"
        ),
        (_, None) => format!(
            "{file}: the track starts {place}; taken as positions in the room, and turned into the frame of START by the first way"
        ),
        _ => format!("{file}: the track starts {place}; taken as poses in the room, and turned into the frame of START"),
    });
    Ok(())
}

/// A place, for people.
fn place(distance: f64, turn: f64) -> String {
    format!("{distance:.3} m and {:.1} deg from the origin", turn.to_degrees())
}

/// The heading of START in the frame of positions: that by which the first way of the counts lies best along them.
fn first_course(log: &TickLog, believed: &[Pose2]) -> Option<f64> {
    let mut gone = 0.0;
    let mut before: Option<&Pose2> = None;
    let near = log.reference.iter().take_while(|pose| {
        let at = &believed[pose.sample];
        let from = before.unwrap_or(at);
        gone += libm::hypot(at.x - from.x, at.y - from.y);
        before = Some(at);
        gone <= WAY.0
    });
    let near: Vec<&ReferencePose> = if believed.is_empty() { return None } else { near.collect() };
    let n = near.len() as f64;
    let mean = |of: &dyn Fn(&ReferencePose) -> f64| near.iter().map(|pose| of(pose)).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.x), mean(&|p| p.y));
    let (bx, by) = (mean(&|p| believed[p.sample].x), mean(&|p| believed[p.sample].y));
    let (mut dot, mut cross, mut spread) = (0.0, 0.0, 0.0_f64);
    for pose in near {
        let at = &believed[pose.sample];
        let (u, v, a, b) = (at.x - bx, at.y - by, pose.x - x, pose.y - y);
        (dot, cross) = (dot + u * a + v * b, cross + u * b - v * a);
        spread = spread.max(libm::hypot(u, v));
    }
    (spread > 0.5 * WAY.1).then(|| libm::atan2(cross, dot))
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::drive::DifferentialDrive;

    fn robot() -> Robot {
        let mut robot = Robot::labmate();
        robot.drive = DifferentialDrive::new(0.5, 0.2, 0.2).unwrap().into();
        robot
    }

    /// A quarter of a circle of 1 m, seen from `room` at every tenth of 100 samples from sample `first` on; the robot rests for
    /// the first `rest` samples.
    fn log(room: Pose2, rest: usize, first: usize, with_heading: bool) -> TickLog {
        let robot = robot();
        let per_tick = robot.metres_per_tick().left;
        let angle = |k: usize| std::f64::consts::FRAC_PI_2 * k.saturating_sub(rest) as f64 / (100 - rest) as f64;
        let seen = |sample: usize| {
            let a = angle(sample);
            let at = room.compose(&Pose2::new(libm::sin(a), 1.0 - libm::cos(a), a));
            ReferencePose { sample, x: at.x, y: at.y, heading: with_heading.then_some(wrap(at.heading)) }
        };
        let of = |radius: f64| (0..=100).map(|k| radius * angle(k) / per_tick).collect();
        TickLog {
            time: (0..=100).map(|k| 0.1 * f64::from(k)).collect(),
            left: of(0.75),
            right: of(1.25),
            reference: (first..=100).step_by(5).map(seen).collect(),
            ..TickLog::default()
        }
    }

    #[test]
    fn poses_in_the_room_are_seen_from_start_whether_it_was_measured_at_rest_or_not_and_with_headings_or_without() {
        let room = Pose2::new(3.0, -2.0, 2.5);
        for (rest, first, with_heading) in
            [(20, 0, true), (20, 0, false), (0, 10, true), (0, 10, false), (20, 40, true)]
        {
            let mut moved = log(room, rest, first, with_heading);
            let expected = log(Pose2::IDENTITY, rest, first, with_heading);
            let mut warnings = Vec::new();
            move_to_start("file", &mut moved, Some(&robot()), &mut warnings).unwrap();
            for (found, expected) in moved.reference.iter().zip(&expected.reference) {
                let off = libm::hypot(found.x - expected.x, found.y - expected.y);
                assert!(off < 0.01, "{rest} {first} {with_heading}: {found:?} {expected:?}");
            }
            let known = if rest > first { StartKnown::AtRest } else { StartKnown::OnTheWay };
            assert_eq!((moved.start.known, warnings.len()), (known, 1), "{warnings:?}");
            assert!(libm::hypot(moved.start.x - 3.0, moved.start.y + 2.0) < 0.01);
        }
    }

    #[test]
    fn poses_from_start_stay_what_they_are() {
        for (rest, first) in [(20, 0), (0, 10), (20, 40)] {
            let given = log(Pose2::new(0.03, 0.02, 0.02), rest, first, true);
            let mut kept = given.clone();
            move_to_start("file", &mut kept, Some(&robot()), &mut Vec::new()).unwrap();
            assert_eq!(kept, given);
        }
    }

    #[test]
    fn a_wrong_pose_at_rest_does_not_move_start() {
        let mut given = log(Pose2::new(3.0, -2.0, 2.5), 20, 0, true);
        given.reference[1].x += 5.0;
        move_to_start("file", &mut given, Some(&robot()), &mut Vec::new()).unwrap();
        assert!(libm::hypot(given.start.x - 3.0, given.start.y + 2.0) < 1e-9, "{:?}", given.start);
    }
}
