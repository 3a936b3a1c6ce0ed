//! What whole counts hide of a pose.

use crate::drive::Robot;
use crate::run::TickLog;

/// Standard deviations \[m, rad\] that the resolution of the counters gives each pose; none where readings are not whole numbers.
///
/// A wheel stands anywhere within its count: a uniform distribution, with the variance t²/12 for ticks of length t. The middle of the axle
/// has (t_L² + t_R²)/48, and the heading (t_L² + t_R²)/(12 b²).
pub(super) fn resolution<'l>(mut logs: impl Iterator<Item = &'l TickLog>, robot: &Robot) -> [f64; 2] {
    let are_whole = |counts: &[f64]| counts.iter().all(|count| count.fract() == 0.0);
    if !logs.all(|log| are_whole(&log.left) && are_whole(&log.right)) {
        return [0.0; 2];
    }
    let per_tick = robot.metres_per_tick();
    let squares = per_tick.left * per_tick.left + per_tick.right * per_tick.right;
    [(squares / 48.0).sqrt(), (squares / 12.0).sqrt() / robot.drive.wheelbase()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the mean square of the pose error over wheels that stand anywhere within their counts.
    #[test]
    fn a_pose_is_as_uncertain_as_wheels_that_stand_anywhere_within_their_counts() {
        let robot = Robot::labmate();
        let log = TickLog { time: vec![0.0, 1.0], left: vec![0.0, 7.0], right: vec![0.0, 9.0], ..TickLog::default() };
        let found = resolution([&log].into_iter(), &robot);
        let (per_tick, steps) = (robot.metres_per_tick(), 400);
        let within = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) - 0.5;
        let mut squares = [0.0; 2];
        for (left, right) in (0..steps).flat_map(|left| (0..steps).map(move |right| (within(left), within(right)))) {
            let [left, right] = [left * per_tick.left, right * per_tick.right];
            squares[0] += (0.5 * (left + right)).powi(2);
            squares[1] += ((right - left) / robot.drive.wheelbase()).powi(2);
        }
        for (found, square) in found.into_iter().zip(squares) {
            let expected = (square / f64::from(steps * steps)).sqrt();
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
        let parts = TickLog { right: vec![0.0, 9.5], ..log };
        assert_eq!(resolution([&parts].into_iter(), &robot), [0.0; 2]);
    }
}
