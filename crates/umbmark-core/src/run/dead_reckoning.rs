//! The pose that the nominal robot computes from its ticks, and the return error that follows.

use super::{ReferencePose, ReturnError, TickLog};
use crate::drive::{Robot, WheelTravel};
use crate::geometry::{Pose2, mean_angle, wrap};

/// Which measurement gives the end pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndPose {
    /// The last one.
    Last,
    /// The mean of the second half of those taken while both counters rest at the end; during the first half, the robot or a delayed
    /// measurement may still be moving.
    Standing,
}

/// Pose after each sample, every step an exact circular arc.
pub fn computed_poses(log: &TickLog, robot: &Robot) -> Vec<Pose2> {
    let mut poses = Vec::with_capacity(log.time.len());
    for_each_pose(log, robot, |pose| poses.push(*pose));
    poses
}

/// The computed pose at the end of the track, if it has one, and how much the robot has turned by the end of the log
/// \[rad\].
pub fn computed_end(log: &TickLog, robot: &Robot) -> (Option<Pose2>, f64) {
    let last = log.reference.last().map(|last| last.sample);
    let (mut sample, mut computed, mut turned) = (0, None, 0.0);
    for_each_pose(log, robot, |pose| {
        if Some(sample) == last {
            computed = Some(*pose);
        }
        (sample, turned) = (sample + 1, pose.heading);
    });
    (computed, turned)
}

#[inline]
pub(super) fn for_each_pose(log: &TickLog, robot: &Robot, mut visit: impl FnMut(&Pose2)) {
    let (per_tick, drive) = (robot.metres_per_tick(), &robot.drive);
    let (mut pose, mut left, mut right) = (Pose2::IDENTITY, 0.0, 0.0);
    let asides = log.asides(robot);
    let mut aside = 0.0;
    for (sample, (l, r)) in log.left.iter().zip(&log.right).enumerate() {
        let travel = WheelTravel { left: (l - left) * per_tick.left, right: (r - right) * per_tick.right };
        let mut motion = drive.displacement(&travel);
        if let Some([to, _]) = asides.get(sample) {
            (motion.sideways, aside) = (to - aside, *to);
        }
        pose = pose.moved(&motion);
        (left, right) = (*l, *r);
        visit(&pose);
    }
}

/// Absolute minus computed pose at the end of the track, if it has one.
pub fn return_error(log: &TickLog, computed: &Pose2, end: EndPose) -> Option<ReturnError> {
    let last = log.reference.last()?;
    let absolute = match end {
        EndPose::Last => *last,
        EndPose::Standing => {
            let standing = standing_at_end(log);
            mean_pose(&standing[standing.len() / 2..]).unwrap_or(*last)
        }
    };
    Some(ReturnError {
        x: absolute.x - computed.x,
        y: absolute.y - computed.y,
        heading: absolute.heading.map(|heading| wrap(heading - computed.heading)),
    })
}

/// The measurements taken before the first count moved.
pub fn standing_at_start(log: &TickLog) -> &[ReferencePose] {
    let moved = (0..log.time.len()).find(|i| !log.is_at_rest(0, *i));
    let end = log.reference.partition_point(|pose| moved.is_none_or(|moved| pose.sample < moved));
    &log.reference[..end]
}

/// The measurements taken at the same counts as the last one, up to it.
pub fn standing_at_end(log: &TickLog) -> &[ReferencePose] {
    let Some(last) = log.reference.last() else { return &[] };
    let moving = (0..last.sample).rev().find(|i| !log.is_at_rest(*i, last.sample));
    let start = log.reference.partition_point(|pose| moving.is_some_and(|moving| pose.sample <= moving));
    &log.reference[start..]
}

/// A pose of a robot at rest counts if it lies within this many median distances of the others, or within this distance \[m, rad\].
const NEAR: f64 = 8.0;
const AT_LEAST: (f64, f64) = (0.02, 0.02);

/// The robust mean of nearly equal poses, some of which may be wrong; its heading has the full turns of the first one.
pub fn mean_pose(poses: &[ReferencePose]) -> Option<ReferencePose> {
    let middle = |of: &dyn Fn(&ReferencePose) -> f64| {
        let mut values: Vec<f64> = poses.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let (x, y) = (middle(&|p| p.x)?, middle(&|p| p.y)?);
    let away = |p: &ReferencePose| libm::hypot(p.x - x, p.y - y);
    let straight = poses.iter().find(|p| away(p) <= AT_LEAST.0).and_then(|p| p.heading).unwrap_or(0.0);
    let turn = |p: &ReferencePose| p.heading.map_or(0.0, |heading| wrap(heading - straight));
    let turned = middle(&turn)?;
    let off = |p: &ReferencePose| wrap(turn(p) - turned).abs();
    let (far, much) = (NEAR * middle(&away)?, NEAR * middle(&off)?);
    let near = |p: &&ReferencePose| away(p) <= far.max(AT_LEAST.0) && off(p) <= much.max(AT_LEAST.1);
    let near: Vec<ReferencePose> = poses.iter().filter(near).copied().collect();
    mean_of(if near.is_empty() { poses } else { &near })
}

fn mean_of(poses: &[ReferencePose]) -> Option<ReferencePose> {
    let first = *poses.first()?;
    let n = poses.len() as f64;
    let x = first.x + poses.iter().map(|p| p.x - first.x).sum::<f64>() / n;
    let y = first.y + poses.iter().map(|p| p.y - first.y).sum::<f64>() / n;
    let heading = mean_angle(poses.iter().filter_map(|p| p.heading));
    Some(ReferencePose { sample: first.sample, x, y, heading })
}
