//! A planar motion known at instants, and between them by interpolation.

use crate::geometry::Pose2;
use crate::run::ReferenceTrack;

/// Steps longer than so many usual ones are gaps.
const GAP: f64 = 5.0;

/// Poses in the order of time; headings without leaps.
pub(super) struct Motion {
    pub time: Vec<f64>,
    pub poses: Vec<Pose2>,
    /// Whether the headings were measured.
    pub has_heading: bool,
    /// Steps longer than this \[s\] are gaps.
    pub gap: f64,
    /// The usual step \[s\].
    pub period: f64,
}

impl Motion {
    pub fn new(time: &[f64], poses: Vec<Pose2>, has_heading: bool) -> Motion {
        let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = steps.len() / 2;
        let period = if steps.is_empty() { 1.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 };
        Motion { time: time.to_vec(), poses, has_heading, gap: GAP * period, period }
    }

    pub fn of_track(track: &ReferenceTrack) -> Motion {
        let heading = |i: usize| track.heading.as_ref().map_or(0.0, |headings| headings[i]);
        let poses = (0..track.time.len()).map(|i| Pose2::new(track.x[i], track.y[i], heading(i))).collect();
        Motion::new(&track.time, poses, track.heading.is_some())
    }

    pub fn first(&self) -> f64 {
        self.time[0]
    }

    pub fn last(&self) -> f64 {
        self.time[self.time.len() - 1]
    }

    /// The pose at an instant; before the first and after the last one the robot stands.
    pub fn at(&self, time: f64) -> Pose2 {
        let after = self.time.partition_point(|t| *t <= time);
        let (Some(before), true) = (after.checked_sub(1), after < self.time.len()) else {
            return self.poses[after.min(self.time.len() - 1)];
        };
        let share = (time - self.time[before]) / (self.time[after] - self.time[before]);
        let (a, b) = (self.poses[before], self.poses[after]);
        let between = |a: f64, b: f64| a + share * (b - a);
        Pose2::new(between(a.x, b.x), between(a.y, b.y), between(a.heading, b.heading))
    }

    /// Whether an interval touches a gap.
    pub fn has_gap(&self, from: f64, to: f64) -> bool {
        let first = self.time.partition_point(|t| *t <= from).saturating_sub(1);
        let last = self.time.partition_point(|t| *t < to).min(self.time.len() - 1);
        self.time[first..=last].windows(2).any(|pair| pair[1] - pair[0] > self.gap)
    }
}
