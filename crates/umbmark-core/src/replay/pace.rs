//! Wheel speeds of a recorded run.

use crate::dataset::TickLog;
use crate::drive::WheelTravel;
use umbmark_odometry::pace::{Reading, between, speeds, window};

/// Speeds of the left and the right wheel at each sample \[m/s\]: (s(t + h) - s(t - h))/2h with h = 0.05 s, counts between samples
/// interpolated; at the ends of the log over the available part of that window.
///
/// At h = 0.05 s a tick of 0.2 mm is 2 mm/s, and a ramp of half a second is followed.
pub(super) fn wheel_speeds(log: &TickLog, per_tick: &WheelTravel) -> Vec<[f64; 2]> {
    let (mut early, mut late) = (Cursor::default(), Cursor::default());
    let speed = |time: &f64| {
        let window = window(*time, log.time[0], log.time[log.time.len() - 1]);
        speeds(window, early.at(log, window[0]), late.at(log, window[1]), per_tick)
    };
    log.time.iter().map(speed).collect()
}

/// A cursor in a log that advances with time.
#[derive(Default)]
struct Cursor(usize);

impl Cursor {
    /// Both counts at a time, linear between samples.
    fn at(&mut self, log: &TickLog, time: f64) -> [f64; 2] {
        while self.0 + 1 < log.time.len() && log.time[self.0 + 1] <= time {
            self.0 += 1;
        }
        let reading = |i: usize| Reading { time: log.time[i], ticks: [log.left[i], log.right[i]] };
        between(&reading(self.0), &reading((self.0 + 1).min(log.time.len() - 1)), time)
    }
}

/// Speeds to the left at each sample \[m/s\], of ways to the left since START and by the same window; nothing where there are none.
pub(super) fn speeds_aside(log: &TickLog, asides: &[[f64; 2]]) -> Vec<f64> {
    if asides.is_empty() {
        return Vec::new();
    }
    let ends = (log.time[0], log.time[log.time.len() - 1]);
    let at = |time: f64| {
        let after = log.time.partition_point(|t| *t <= time).clamp(1, log.time.len().max(2) - 1);
        let after = after.min(log.time.len() - 1);
        let before = after.saturating_sub(1);
        let span = log.time[after] - log.time[before];
        let share = if span > 0.0 { (time - log.time[before]) / span } else { 0.0 };
        asides[before][0] + share * (asides[after][0] - asides[before][0])
    };
    let speed = |time: &f64| {
        let [from, to] = window(*time, ends.0, ends.1);
        if to > from { (at(to) - at(from)) / (to - from) } else { 0.0 }
    };
    log.time.iter().map(speed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_a_cruise_and_a_stop_have_their_speeds() {
        let time: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.01).collect();
        let position = |t: f64| {
            if t < 1.0 {
                500.0 * t * t
            } else if t < 3.0 {
                500.0 + 1000.0 * (t - 1.0)
            } else {
                2500.0
            }
        };
        let left: Vec<f64> = time.iter().map(|t| position(*t)).collect();
        let right = left.iter().map(|l| -l).collect();
        let log = TickLog { time, left, right, ..TickLog::default() };
        let speeds = wheel_speeds(&log, &WheelTravel { left: 1e-3, right: 1e-3 });
        for (sample, expected) in [(50, 0.5), (200, 1.0), (350, 0.0)] {
            assert!((speeds[sample][0] - expected).abs() < 1e-9 && (speeds[sample][1] + expected).abs() < 1e-9);
        }
    }
}
