//! Inserts poses with their own times into a log.

use super::{ReferencePose, TickLog};
use crate::geometry::wrap;
use std::mem::take;

/// x, y \[m\], and the heading \[rad\] where it was measured.
pub type PoseRow = (f64, f64, Option<f64>);

/// Counts are not interpolated over more than this many usual steps, or `SHORT` if that is longer.
const GAP: f64 = 5.0;
/// Within this time, a robot that accelerates by 1 m/s² deviates from linear interpolation by 1.3 mm \[s\].
const SHORT: f64 = 0.1;

/// Inserts every pose into a log and replaces the log's own poses. At the time of a pose \[s\], by the clock of the ticks and increasing, a
/// sample is inserted whose counts are interpolated between its neighbours. A pose outside the ticks, or in a gap in which the wheels
/// turned, is skipped; returns the number of skipped poses. The first sample is START: if it has no pose, one is interpolated between the
/// poses before and after it.
pub fn place(log: &mut TickLog, times: &[f64], poses: &[PoseRow]) -> usize {
    let longest = (GAP * usual_step(&log.time)).max(SHORT);
    // What else is known of the log stays.
    let old = TickLog {
        time: take(&mut log.time),
        left: take(&mut log.left),
        right: take(&mut log.right),
        rollers: take(&mut log.rollers),
        ..TickLog::default()
    };
    log.reference.clear();
    let start = old.time.first().and_then(|first| start_pose(times, poses, *first));
    let (mut next, mut dropped) = (0, 0);
    let mut take_until = |log: &mut TickLog, time: f64| {
        while next < old.time.len() && old.time[next] <= time {
            push(log, old.time[next], (old.left[next], old.right[next]), old.rollers.iter().map(|counts| counts[next]));
            next += 1;
        }
        next
    };
    for (time, (x, y, heading)) in times.iter().zip(poses) {
        let after = take_until(log, *time);
        if log.time.last() != Some(time) {
            match between(&old, after, *time, longest) {
                Some((counts, share)) => {
                    let rolled = old.rollers.iter().map(|all| all[after - 1] + share * (all[after] - all[after - 1]));
                    push(log, *time, counts, rolled);
                }
                None => {
                    dropped += 1;
                    continue;
                }
            }
        }
        log.reference.push(ReferencePose { sample: log.time.len() - 1, x: *x, y: *y, heading: *heading });
    }
    take_until(log, f64::INFINITY);
    if log.reference.first().is_none_or(|pose| pose.sample > 0) {
        log.reference.splice(0..0, start);
    }
    dropped
}

fn push(log: &mut TickLog, time: f64, (left, right): (f64, f64), rollers: impl ExactSizeIterator<Item = f64>) {
    log.time.push(time);
    log.left.push(left);
    log.right.push(right);
    log.rollers.resize(rollers.len(), Vec::new());
    log.rollers.iter_mut().zip(rollers).for_each(|(counts, count)| counts.push(count));
}

/// Counts at a time between sample `after` and the previous one, and the share of the time between them, if they can be interpolated.
fn between(log: &TickLog, after: usize, time: f64, longest: f64) -> Option<((f64, f64), f64)> {
    let before = after.checked_sub(1)?;
    let seconds = log.time.get(after)? - log.time[before];
    let (left, right) = (log.left[after] - log.left[before], log.right[after] - log.right[before]);
    if seconds > longest && !log.is_at_rest(before, after) {
        return None;
    }
    let share = (time - log.time[before]) / seconds;
    Some(((log.left[before] + share * left, log.right[before] + share * right), share))
}

/// The pose at the first sample, between two poses with no gap between them.
fn start_pose(times: &[f64], poses: &[PoseRow], first: f64) -> Option<ReferencePose> {
    let after = times.partition_point(|time| *time <= first);
    let before = after.checked_sub(1)?;
    let seconds = times.get(after)? - times[before];
    if seconds > (GAP * usual_step(times)).max(SHORT) {
        return None;
    }
    let share = (first - times[before]) / seconds;
    let ((x, y, heading), (to_x, to_y, to_heading)) = (poses[before], poses[after]);
    let heading = heading.zip(to_heading).map(|(from, to)| from + share * wrap(to - from));
    Some(ReferencePose { sample: 0, x: x + share * (to_x - x), y: y + share * (to_y - y), heading })
}

/// The median step \[s\].
fn usual_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rests, drives, has a gap in which it drives, rests, has a gap in which it rests.
    fn log() -> TickLog {
        TickLog {
            time: vec![0.0, 0.1, 0.2, 0.3, 5.0, 5.1, 5.2, 9.0],
            left: vec![0.0, 0.0, 10.0, 20.0, 900.0, 900.0, 900.0, 900.0],
            right: vec![0.0, 0.0, 20.0, 40.0, 900.0, 900.0, 900.0, 900.0],
            ..TickLog::default()
        }
    }

    fn placed(times: &[f64]) -> (TickLog, usize) {
        let mut log = log();
        let poses: Vec<PoseRow> = times.iter().map(|time| (*time, 0.0, None)).collect();
        let dropped = place(&mut log, times, &poses);
        (log, dropped)
    }

    #[test]
    fn a_pose_at_the_time_of_a_sample_belongs_to_it_and_one_between_two_gets_a_sample_of_its_own() {
        let (log, dropped) = placed(&[0.2, 0.25]);
        assert_eq!(dropped, 0);
        assert_eq!(log.time, [0.0, 0.1, 0.2, 0.25, 0.3, 5.0, 5.1, 5.2, 9.0]);
        let at: Vec<(usize, f64)> = log.reference.iter().map(|pose| (pose.sample, pose.x)).collect();
        assert_eq!(at, [(2, 0.2), (3, 0.25)]);
        assert!((log.left[3] - 15.0).abs() < 1e-12 && (log.right[3] - 30.0).abs() < 1e-12);
    }

    #[test]
    fn poses_in_a_gap_with_motion_or_outside_of_the_log_are_left_out_and_counted() {
        for (times, left_out) in [(&[0.2, 2.0, 9.1][..], 2), (&[-1.5], 1)] {
            let (placed, dropped) = placed(times);
            assert_eq!(dropped, left_out);
            assert_eq!((&placed.time, &placed.left), (&log().time, &log().left));
            assert_eq!(placed.reference.len(), times.len() - left_out);
        }
    }

    #[test]
    fn wheels_with_the_same_counts_on_both_sides_of_a_gap_stood_there() {
        let (log, dropped) = placed(&[0.2, 7.0]);
        assert_eq!((dropped, log.time[7], log.left[7]), (0, 7.0, 900.0));
        assert_eq!(log.reference[1].sample, 7);
    }

    #[test]
    fn start_lies_between_the_poses_before_and_after_it() {
        let (log, dropped) = placed(&[-0.02, 0.06, 0.14]);
        assert_eq!((dropped, log.reference.len(), log.reference[0].sample), (1, 3, 0));
        assert!(log.reference[0].x.abs() < 1e-15);
    }
}
