//! Poses between two readings of the counters, where the wheels did not turn evenly.
//!
//! Counts between two readings are not known. On a straight line between them a wheel that speeds up by a in an interval T is off by
//! a T²/8 in the middle: 5 mm for 1 m/s² and 0.2 s. A fit to many such poses takes that for an error of the robot.

use crate::drive::Robot;
use crate::run::TickLog;
use std::ops::Range;

/// Counts on that line may be off by this \[m\], or by this share of a count where that is more.
const UNEVEN: f64 = 0.2e-3;
const UNEVEN_COUNTS: f64 = 0.25;

/// Which poses of a log say nothing that the nearest pose to a reading does not say better, `late` being the delay of the poses \[s\].
pub(super) fn between_readings(log: &TickLog, robot: &Robot, late: f64) -> Vec<bool> {
    let readings: Vec<usize> = (0..log.time.len()).filter(|sample| !log.is_put_in(*sample)).collect();
    let mut left_out = vec![false; log.reference.len()];
    if readings.len() == log.time.len() {
        return left_out;
    }
    let per_tick = robot.metres_per_tick();
    let travel = |from: usize, to: usize| {
        [(log.left[to] - log.left[from]) * per_tick.left, (log.right[to] - log.right[from]) * per_tick.right]
    };
    let least = [per_tick.left, per_tick.right].map(|count| UNEVEN.max(UNEVEN_COUNTS * count.abs()));
    let intervals: Vec<Interval> = readings
        .windows(2)
        .map(|pair| Interval { times: log.time[pair[0]]..log.time[pair[1]], travel: travel(pair[0], pair[1]) })
        .collect();
    // The nearest pose to each reading, and how far from it.
    let mut nearest = vec![(f64::INFINITY, None); readings.len()];
    let mut unsure = Vec::new();
    for (pose, reference) in log.reference.iter().enumerate() {
        let moment = log.time[reference.sample] - late;
        let after = intervals.partition_point(|interval| interval.times.end <= moment);
        let Some(interval) = intervals.get(after).filter(|interval| interval.times.start <= moment) else { continue };
        let share = (moment - interval.times.start) / (interval.times.end - interval.times.start);
        let reading = after + usize::from(share > 0.5);
        let far = (moment - log.time[readings[reading]]).abs();
        if far < nearest[reading].0 {
            nearest[reading] = (far, Some(pose));
        }
        let off = interval.unevenness(&intervals, after).map(|off| 4.0 * share * (1.0 - share) * off);
        if off.iter().zip(least).any(|(off, least)| *off > least) {
            unsure.push(pose);
        }
    }
    unsure.into_iter().for_each(|pose| left_out[pose] = true);
    nearest.into_iter().filter_map(|(_, pose)| pose).for_each(|pose| left_out[pose] = false);
    left_out
}

/// What lies between two readings.
struct Interval {
    times: Range<f64>,
    /// Travel of the left and the right wheel \[m\].
    travel: [f64; 2],
}

impl Interval {
    fn speed(&self, wheel: usize) -> f64 {
        self.travel[wheel] / (self.times.end - self.times.start)
    }

    /// How far each wheel may be from the straight line in the middle \[m\], by the change of its speed from the interval before and to the
    /// one after.
    fn unevenness(&self, all: &[Interval], own: usize) -> [f64; 2] {
        let neighbours = [own.checked_sub(1), Some(own + 1)];
        let duration = self.times.end - self.times.start;
        [0, 1].map(|wheel| {
            let change = |other: &Interval| (other.speed(wheel) - self.speed(wheel)).abs();
            let changes = neighbours.into_iter().flatten().filter_map(|other| all.get(other)).map(change);
            changes.fold(0.0, f64::max) * duration / 8.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{PoseRow, place};

    const RATE: f64 = 5.0;

    /// Where a wheel is that rests for a second, speeds up at 0.5 m/s² for two, and goes on.
    fn way(t: f64) -> f64 {
        match t {
            _ if t < 1.0 => 0.0,
            _ if t < 3.0 => 0.25 * (t - 1.0).powi(2),
            _ => 1.0 + (t - 3.0),
        }
    }

    /// Readings five times a second of counters of 19 997 counts a metre, poses 107 times, put in between them.
    fn log(late: f64) -> (TickLog, Robot) {
        let mut robot = Robot::labmate();
        robot.encoder = crate::drive::Encoder::new(std::f64::consts::PI * 0.15 * 19_997.0, None, None).unwrap();
        let time: Vec<f64> = (0..=25).map(|k| f64::from(k) / RATE).collect();
        let counts = |ratio: f64| time.iter().map(|t| (ratio * 19_997.0 * way(*t)).round()).collect();
        let (left, right) = (counts(1.0), counts(1.0731));
        let mut log = TickLog { time, left, right, ..TickLog::default() };
        let times: Vec<f64> = (0..=533).map(|k| 0.00937 * f64::from(k)).collect();
        let poses: Vec<PoseRow> = times.iter().map(|t| (way(t - late), 0.0, Some(0.0))).collect();
        assert_eq!(place(&mut log, &times, &poses), 0);
        (log, robot)
    }

    #[test]
    fn on_a_ramp_only_the_nearest_poses_to_readings_stay_and_at_an_even_speed_and_at_rest_all_do() {
        for late in [0.0, 0.03, -0.07] {
            let (log, robot) = log(late);
            let left_out = between_readings(&log, &robot, late);
            let count = |from: f64, to: f64| {
                let inside = log.reference.iter().zip(&left_out).filter(|(pose, _)| {
                    let moment = log.time[pose.sample] - late;
                    moment > from + 1e-9 && moment < to - 1e-9
                });
                inside.fold([0, 0], |[kept, all], (_, left_out)| [kept + usize::from(!left_out), all + 1])
            };
            for (from, to) in [(0.1, 0.8), (3.2, 4.7)] {
                let [kept, all] = count(from, to);
                assert_eq!(kept, all, "{late} {from}");
            }
            let [kept, all] = count(1.0, 3.0);
            assert!(all > 190 && (9..=20).contains(&kept), "{late}: {kept} of {all}");
            // What stays is within the bound.
            for (pose, _) in log.reference.iter().zip(&left_out).filter(|(_, left_out)| !**left_out) {
                let moment = log.time[pose.sample] - late;
                if !(0.0..5.0).contains(&moment) {
                    continue;
                }
                let before = (moment * RATE + 1e-9).floor() / RATE;
                let share = (moment - before) * RATE;
                let line = way(before) + share * (way(before + 1.0 / RATE) - way(before));
                assert!((way(moment) - line).abs() < 2.0 * UNEVEN, "{late} {moment} {}", way(moment) - line);
            }
        }
    }

    #[test]
    fn poses_at_readings_all_stay() {
        let (mut log, robot) = log(0.0);
        log.reference.retain(|pose| log.left[pose.sample].fract() == 0.0);
        assert!(!between_readings(&log, &robot, 0.0).contains(&true));
    }
}
