//! What whole counts hide of a pose.
//!
//! A wheel stands anywhere within its count: a uniform distribution, with the variance t²/12 for counts of length t. The middle of the axle
//! has (t_L² + t_R²)/48, and the heading (t_L² + t_R²)/(12 b²).

use super::TickLog;
use crate::drive::Robot;

/// Counts that are not whole and lie so near to the line between their neighbours were put in between readings \[counts\].
const ON_THE_LINE: f64 = 0.01;

impl TickLog {
    /// How far the left and the right wheel roll in one count \[m\]; 0 where readings are not whole counts.
    pub fn count_lengths(&self, robot: &Robot) -> [f64; 2] {
        let is_whole = |sample: &usize| self.left[*sample].fract() == 0.0 && self.right[*sample].fract() == 0.0;
        let mut readings = (0..self.time.len()).filter(|sample| is_whole(sample) || !self.is_put_in(*sample));
        let per_tick = robot.metres_per_tick();
        if readings.all(|sample| is_whole(&sample)) { [per_tick.left, per_tick.right] } else { [0.0; 2] }
    }

    /// Whether the counts of a sample were put in on the line between its neighbours, for a pose.
    pub fn is_put_in(&self, sample: usize) -> bool {
        let Some(before) = sample.checked_sub(1) else { return false };
        let after = sample + 1;
        if after >= self.time.len() || self.reference.binary_search_by_key(&sample, |pose| pose.sample).is_err() {
            return false;
        }
        let share = (self.time[sample] - self.time[before]) / (self.time[after] - self.time[before]);
        let is_whole = |counts: &[f64]| counts[sample].fract() == 0.0;
        let is_on_the_line = |counts: &[f64]| {
            let line = counts[before] + share * (counts[after] - counts[before]);
            (counts[sample] - line).abs() < ON_THE_LINE
        };
        let [left, right] = [&self.left[..], &self.right[..]];
        is_on_the_line(left) && is_on_the_line(right) && !(is_whole(left) && is_whole(right))
    }
}

/// Variances of a position \[m²\] and a heading \[rad²\] by wheels with counts of these lengths \[m\], and with these shares of the variance of
/// a single reading.
pub fn hidden(lengths: [f64; 2], shares: [f64; 2], wheelbase: f64) -> [f64; 2] {
    let [left, right] = [0, 1].map(|wheel| shares[wheel] * lengths[wheel] * lengths[wheel]);
    [(left + right) / 48.0, (left + right) / (12.0 * wheelbase * wheelbase)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{PoseRow, place};

    /// Oracle: the mean square of the pose error over wheels that stand anywhere within their counts.
    #[test]
    fn a_pose_is_as_uncertain_as_wheels_that_stand_anywhere_within_their_counts() {
        let robot = Robot::labmate();
        let log = TickLog { time: vec![0.0, 1.0], left: vec![0.0, 7.0], right: vec![0.0, 9.0], ..TickLog::default() };
        let found = hidden(log.count_lengths(&robot), [1.0; 2], robot.drive.wheelbase());
        let (per_tick, steps) = (robot.metres_per_tick(), 400);
        let within = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) - 0.5;
        let mut squares = [0.0; 2];
        for (left, right) in (0..steps).flat_map(|left| (0..steps).map(move |right| (within(left), within(right)))) {
            let [left, right] = [left * per_tick.left, right * per_tick.right];
            squares[0] += (0.5 * (left + right)).powi(2);
            squares[1] += ((right - left) / robot.drive.wheelbase()).powi(2);
        }
        for (found, square) in found.into_iter().zip(squares) {
            let expected = square / f64::from(steps * steps);
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn counts_are_whole_also_where_poses_lie_between_readings_and_parts_of_counts_are_not() {
        let robot = Robot::labmate();
        let time: Vec<f64> = (0..40).map(|k| 0.02 * f64::from(k)).collect();
        let counts: Vec<f64> = time.iter().map(|t| (431.0 * t * t).floor()).collect();
        let mut log = TickLog { time, left: counts.clone(), right: counts, ..TickLog::default() };
        let rows: Vec<PoseRow> = (0..11).map(|_| (0.0, 0.0, None)).collect();
        let times: Vec<f64> = (0..11).map(|k| 0.07 * f64::from(k) + 0.003).collect();
        place(&mut log, &times, &rows);
        assert!(log.left.iter().any(|count| count.fract() != 0.0));
        let per_tick = robot.metres_per_tick();
        assert_eq!(log.count_lengths(&robot), [per_tick.left, per_tick.right]);
        log.right.iter_mut().for_each(|count| *count *= 0.99);
        assert_eq!(log.count_lengths(&robot), [0.0; 2]);
    }
}
