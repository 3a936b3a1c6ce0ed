//! The pose that the nominal robot computes from its ticks, and the return error that follows.

use super::{ReferencePose, ReturnError, TickLog};
use crate::drive::{Robot, WheelTravel};
use crate::geometry::{Pose2, mean_angle, wrap};

/// Which measurement says where the robot stands at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EndPose {
    /// The last one.
    Last,
    /// The mean of those taken while both counters rest at the end, but for the first half of them, in which the robot
    /// or a delayed measurement may still be moving.
    Standing,
}

/// Pose after each sample, every step an exact circular arc.
pub(super) fn computed_poses(log: &TickLog, robot: &Robot) -> Vec<Pose2> {
    let per_tick = robot.metres_per_tick();
    let mut pose = Pose2::IDENTITY;
    let mut poses = Vec::with_capacity(log.time.len());
    let (mut left, mut right) = (0.0, 0.0);
    for (l, r) in log.left.iter().zip(&log.right) {
        let travel = WheelTravel { left: (l - left) * per_tick.left, right: (r - right) * per_tick.right };
        pose = pose.moved(&robot.drive.displacement(&travel));
        (left, right) = (*l, *r);
        poses.push(pose);
    }
    poses
}

/// Absolute minus computed pose at the end of the track, if it has one.
pub(super) fn return_error(log: &TickLog, computed: &[Pose2], end: EndPose) -> Option<ReturnError> {
    let last = log.reference.last()?;
    let absolute = match end {
        EndPose::Last => *last,
        EndPose::Standing => {
            let standing = standing_at_end(log);
            mean_pose(&standing[standing.len() / 2..]).unwrap_or(*last)
        }
    };
    let computed = computed.get(last.sample)?;
    Some(ReturnError {
        x: absolute.x - computed.x,
        y: absolute.y - computed.y,
        heading: absolute.heading.map(|heading| wrap(heading - computed.heading)),
    })
}

/// The measurements taken before the first count moved.
pub(super) fn standing_at_start(log: &TickLog) -> &[ReferencePose] {
    let moved = (0..log.time.len()).find(|i| log.left[*i] != log.left[0] || log.right[*i] != log.right[0]);
    let end = log.reference.partition_point(|pose| moved.is_none_or(|moved| pose.sample < moved));
    &log.reference[..end]
}

/// The measurements taken at the same counts as the last one, up to it.
pub(super) fn standing_at_end(log: &TickLog) -> &[ReferencePose] {
    let Some(last) = log.reference.last() else { return &[] };
    let counts = |i: usize| (log.left[i], log.right[i]);
    let moving = (0..last.sample).rev().find(|i| counts(*i) != counts(last.sample));
    let start = log.reference.partition_point(|pose| moving.is_some_and(|moving| pose.sample <= moving));
    &log.reference[start..]
}

/// The mean of poses that differ little; its heading counts full turns as the first one does.
pub(super) fn mean_pose(poses: &[ReferencePose]) -> Option<ReferencePose> {
    let first = *poses.first()?;
    let n = poses.len() as f64;
    let x = first.x + poses.iter().map(|p| p.x - first.x).sum::<f64>() / n;
    let y = first.y + poses.iter().map(|p| p.y - first.y).sum::<f64>() / n;
    let heading = mean_angle(poses.iter().filter_map(|p| p.heading));
    Some(ReferencePose { sample: first.sample, x, y, heading })
}
