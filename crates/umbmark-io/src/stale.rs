//! Poses that a tracking system repeated while the robot moved on.

use umbmark_core::dataset::{ReferencePose, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::geometry::Pose2;
use umbmark_core::run::dead_reckoning::computed_poses;

/// A pose that stays the same to the last bit while the robot drives so far, or turns so far, is stale \[m, rad\].
const MOVED: (f64, f64) = (0.005, 0.010);

/// Leaves out the repetitions of stale poses; says how many.
pub(super) fn drop_stale(file: &str, log: &mut TickLog, robot: &Robot, warnings: &mut Vec<String>) {
    let repeats =
        |pair: &[ReferencePose]| (pair[0].x, pair[0].y, pair[0].heading) == (pair[1].x, pair[1].y, pair[1].heading);
    if !log.reference.windows(2).any(repeats) {
        return;
    }
    let poses = computed_poses(log, robot);
    let mut repeated: Vec<usize> = Vec::new();
    let mut first = 0;
    for same in log.reference.chunk_by(|a, b| repeats(&[*a, *b])) {
        if same.len() > 1 && moved(&poses, &same[0], &same[same.len() - 1]) {
            repeated.extend(first + 1..first + same.len());
        }
        first += same.len();
    }
    let (stale, mut place, mut next) = (repeated.len(), 0, repeated.into_iter().peekable());
    log.reference.retain(|_| {
        place += 1;
        next.next_if_eq(&(place - 1)).is_none()
    });
    log.mended.stale = stale;
    if stale > 0 {
        warnings.push(format!(
            "{file}: {stale} poses repeat the one before while the wheels turn (stale) and were left out"
        ));
    }
}

/// Whether what was measured must have changed between two samples. A turn moves a heading, and the way a position.
fn moved(poses: &[Pose2], first: &ReferencePose, last: &ReferencePose) -> bool {
    let samples = &poses[first.sample..=last.sample];
    let from = samples[0];
    let turned = samples.iter().any(|pose| (pose.heading - from.heading).abs() > MOVED.1);
    let driven = samples.iter().any(|pose| libm::hypot(pose.x - from.x, pose.y - from.y) > MOVED.0);
    driven || (turned && first.heading.is_some())
}
