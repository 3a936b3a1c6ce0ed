//! Poses of another clock, put into a log.

use super::super::reference_track::ReferenceTrack;
use super::super::{ReferencePose, TickLog};
use super::Alignment;
use crate::geometry::Pose2;

/// Counts are not interpolated over more than so many usual steps.
const GAP: f64 = 5.0;

/// Puts every pose of a track into a log, whose own poses it replaces: at the ticks' time of a pose a sample is put in, its
/// counts interpolated between its neighbours. A pose that falls into a gap of the ticks, or outside of them, belongs nowhere and
/// is left out; says how many were. The first sample is START: where no pose belongs to it, it has one between the poses before
/// and after it.
pub fn place(log: &mut TickLog, track: &ReferenceTrack, tick_time: impl Fn(f64) -> f64) -> usize {
    let longest = GAP * usual_step(&log.time);
    let old = std::mem::take(log);
    let start = old.time.first().and_then(|first| start_pose(track, *first, &tick_time));
    let (mut next, mut dropped) = (0, 0);
    let mut take_until = |log: &mut TickLog, time: f64| {
        while next < old.time.len() && old.time[next] <= time {
            log.time.push(old.time[next]);
            log.left.push(old.left[next]);
            log.right.push(old.right[next]);
            next += 1;
        }
        next
    };
    for (i, time) in track.time.iter().map(|time| tick_time(*time)).enumerate() {
        let after = take_until(log, time);
        let Some(before) = after.checked_sub(1) else {
            dropped += 1;
            continue;
        };
        if log.time[log.time.len() - 1] != time {
            if after == old.time.len() || old.time[after] - old.time[before] > longest {
                dropped += 1;
                continue;
            }
            let share = (time - old.time[before]) / (old.time[after] - old.time[before]);
            log.time.push(time);
            log.left.push(old.left[before] + share * (old.left[after] - old.left[before]));
            log.right.push(old.right[before] + share * (old.right[after] - old.right[before]));
        }
        let heading = track.heading.as_ref().map(|headings| headings[i]);
        log.reference.push(ReferencePose { sample: log.time.len() - 1, x: track.x[i], y: track.y[i], heading });
    }
    take_until(log, f64::INFINITY);
    if log.reference.first().is_none_or(|pose| pose.sample > 0) {
        log.reference.splice(0..0, start);
    }
    dropped
}

/// The pose at the first sample, between two poses with no gap between them.
fn start_pose(track: &ReferenceTrack, first: f64, tick_time: &impl Fn(f64) -> f64) -> Option<ReferencePose> {
    let after = track.time.partition_point(|time| tick_time(*time) <= first);
    let before = after.checked_sub(1)?;
    let (from, to) = (*track.time.get(before)?, *track.time.get(after)?);
    if to - from > GAP * usual_step(&track.time) {
        return None;
    }
    let share = (first - tick_time(from)) / (tick_time(to) - tick_time(from));
    let between = |values: &[f64]| values[before] + share * (values[after] - values[before]);
    let heading = track.heading.as_ref().map(|headings| between(headings));
    Some(ReferencePose { sample: 0, x: between(&track.x), y: between(&track.y), heading })
}

fn usual_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

impl ReferenceTrack {
    /// The track of the axle's centre and the robot's heading, where the alignment shows how the tracked body sits on the
    /// robot. Without headings the tracked point stays what it is.
    pub fn of_axle(&self, found: &Alignment) -> ReferenceTrack {
        let Some(headings) = &self.heading else { return self.clone() };
        let value = |measured: &Option<super::Measured>| measured.map_or(0.0, |m| m.value);
        let body = Pose2::new(value(&found.lever_ahead), value(&found.lever_left), value(&found.yaw));
        let axle = body.inverse();
        let poses = headings.iter().enumerate().map(|(i, h)| Pose2::new(self.x[i], self.y[i], *h).compose(&axle));
        let poses: Vec<Pose2> = poses.collect();
        ReferenceTrack {
            time: self.time.clone(),
            x: poses.iter().map(|pose| pose.x).collect(),
            y: poses.iter().map(|pose| pose.y).collect(),
            heading: Some(poses.iter().map(|pose| pose.heading).collect()),
        }
    }
}
