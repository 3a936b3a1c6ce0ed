//! What wheels with rollers did beside the motion that the wheels of an axle would make too.

use super::TickLog;
use crate::drive::Robot;

impl TickLog {
    /// Whether the counts of two samples are the same.
    pub fn is_at_rest(&self, from: usize, to: usize) -> bool {
        self.left[from] == self.left[to]
            && self.right[from] == self.right[to]
            && self.rollers.iter().all(|counts| counts[from] == counts[to])
    }

    /// The way to the left since START, and what the wheels disagree on, at each sample \[m\]; nothing of a robot without rollers, and of one
    /// whose wheels were not recorded one by one.
    ///
    /// Both are sums of what the body did in its own frame from sample to sample.
    pub fn asides(&self, robot: &Robot) -> Vec<[f64; 2]> {
        let Some(rollers) = robot.drive.rollers().filter(|rollers| rollers.wheels().len() == self.rollers.len()) else {
            return Vec::new();
        };
        let per_count = rollers.metres_per_count(robot.encoder.ticks_per_revolution());
        let mut ways = vec![0.0; per_count.len()];
        let of = |sample: usize| {
            for ((way, counts), per_count) in ways.iter_mut().zip(&self.rollers).zip(&per_count) {
                *way = counts[sample] * per_count;
            }
            [rollers.motion(&ways).sideways, rollers.disagreement(&ways)]
        };
        (0..self.time.len()).map(of).collect()
    }

    /// Way from each sample to the next, ahead and sideways together \[m\].
    pub fn ways(&self, robot: &Robot) -> Vec<f64> {
        let (per_tick, asides) = (robot.metres_per_tick(), self.asides(robot));
        let way = |i: usize| {
            let (left, right) = (self.left[i + 1] - self.left[i], self.right[i + 1] - self.right[i]);
            let ahead = 0.5 * (left * per_tick.left + right * per_tick.right).abs();
            asides.get(i + 1).map_or(ahead, |[to, _]| libm::hypot(ahead, to - asides[i][0]))
        };
        (0..self.time.len().saturating_sub(1)).map(way).collect()
    }
}
