//! Poses with times of their own, attached to the samples of a log.

use super::super::{ReferencePose, TickLog};
use super::track::TimedPlace;

/// A wheel that stands is taken to stand for so long before the first and after the last reading \[s\].
const STANDING: f64 = 1.0;
/// Between readings farther apart than this many usual intervals, and than `SHORT` \[s\], nobody knows how the wheels went.
const GAP: f64 = 10.0;
const SHORT: f64 = 0.5;

/// Puts each pose where it was measured: at the sample of the same time, or at a sample put in between two, with counts
/// between theirs. So no pose moves in time, and no motion is made up: poses in a gap in which the wheels moved, and
/// poses away from the ends of the log, are left out. Returns how many.
pub(super) fn attach(log: &mut TickLog, mut poses: Vec<TimedPlace>) -> usize {
    poses.sort_by(|a, b| a.time.total_cmp(&b.time));
    let all = poses.len();
    poses.dedup_by(|later, earlier| later.time == earlier.time);
    let gap = (GAP * usual_interval(&log.time)).max(SHORT);
    let mut merged = TickLog::default();
    let mut poses = poses.into_iter().peekable();
    for next in 0..=log.time.len() {
        let until = log.time.get(next).copied().unwrap_or(f64::INFINITY);
        while let Some(pose) = poses.next_if(|pose| pose.time < until) {
            if let Some((left, right)) = between(log, next, pose.time, gap) {
                push(&mut merged, (pose.time, left, right), Some(&pose));
            }
        }
        if next < log.time.len() {
            let pose = poses.next_if(|pose| pose.time == until);
            push(&mut merged, (until, log.left[next], log.right[next]), pose.as_ref());
        }
    }
    *log = merged;
    all - log.reference.len()
}

fn push(log: &mut TickLog, (time, left, right): (f64, f64, f64), pose: Option<&TimedPlace>) {
    let sample = log.time.len();
    log.time.push(time);
    log.left.push(left);
    log.right.push(right);
    let attached =
        pose.map(|pose| ReferencePose { sample, x: pose.place.x, y: pose.place.y, heading: pose.place.heading });
    log.reference.extend(attached);
}

/// Counts at a time before sample `next`, where they can be known.
fn between(log: &TickLog, next: usize, time: f64, gap: f64) -> Option<(f64, f64)> {
    let counts = |i: usize| (log.left[i], log.right[i]);
    let n = log.time.len();
    if next == 0 || next == n {
        let (end, beside) = if next == 0 { (0, 1) } else { (n.checked_sub(1)?, n.checked_sub(2)?) };
        let near = (time - log.time.get(end)?).abs() <= STANDING;
        return (near && beside < n && counts(end) == counts(beside)).then(|| counts(end));
    }
    let (before, after) = (counts(next - 1), counts(next));
    let seconds = log.time[next] - log.time[next - 1];
    if before != after && seconds > gap {
        return None;
    }
    let share = (time - log.time[next - 1]) / seconds;
    Some((before.0 + share * (after.0 - before.0), before.1 + share * (after.1 - before.1)))
}

/// The median interval \[s\].
fn usual_interval(times: &[f64]) -> f64 {
    let mut intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if intervals.is_empty() {
        return 0.0;
    }
    let middle = intervals.len() / 2;
    *intervals.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::super::track::Place;
    use super::*;

    fn log() -> TickLog {
        TickLog {
            time: vec![0.0, 0.1, 0.2, 0.3, 5.0, 5.1, 5.2],
            left: vec![0.0, 0.0, 10.0, 20.0, 900.0, 900.0, 900.0],
            right: vec![0.0, 0.0, 20.0, 40.0, 900.0, 900.0, 900.0],
            reference: Vec::new(),
        }
    }

    fn poses(times: &[f64]) -> Vec<TimedPlace> {
        times.iter().map(|time| TimedPlace { time: *time, place: Place { x: *time, y: 0.0, heading: None } }).collect()
    }

    #[test]
    fn a_pose_at_the_time_of_a_sample_belongs_to_it_and_one_between_two_gets_a_sample_of_its_own() {
        let mut log = log();
        assert_eq!(attach(&mut log, poses(&[0.25, 0.2])), 0);
        assert_eq!(log.time, [0.0, 0.1, 0.2, 0.25, 0.3, 5.0, 5.1, 5.2]);
        let at: Vec<(usize, f64)> = log.reference.iter().map(|pose| (pose.sample, pose.x)).collect();
        assert_eq!(at, [(2, 0.2), (3, 0.25)]);
        assert!((log.left[3] - 15.0).abs() < 1e-12 && (log.right[3] - 30.0).abs() < 1e-12);
    }

    #[test]
    fn poses_in_a_gap_with_motion_far_from_the_ends_or_at_the_same_time_are_left_out_and_counted() {
        let mut log = log();
        let before = log.clone();
        assert_eq!(attach(&mut log, poses(&[2.0, -1.5, 7.0, 0.2, 0.2])), 4);
        assert_eq!((&log.time, &log.left), (&before.time, &before.left));
        assert_eq!(log.reference.len(), 1);
    }

    #[test]
    fn a_robot_that_stands_at_the_ends_stands_there_a_little_longer() {
        let mut log = log();
        assert_eq!(attach(&mut log, poses(&[-0.4, 5.9])), 0);
        assert_eq!((log.left[0], log.left[8]), (0.0, 900.0));
        assert_eq!((log.reference[0].sample, log.reference[1].sample), (0, 8));
    }
}
