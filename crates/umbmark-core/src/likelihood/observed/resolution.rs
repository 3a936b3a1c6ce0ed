//! What whole counts hide of a block of poses.
//!
//! Poses between which a wheel made no count share its error: a robot at rest is measured many times, but counted once.

use super::{Observed, ObservedRun};
use crate::run::resolution::hidden;

impl Observed {
    /// Standard deviations of a position and a heading \[m, rad\] that the resolution of the counters gives; 0 where it is not known.
    pub fn resolution(&self) -> [f64; 2] {
        let single = self.runs.iter().map(|run| run.hidden([1.0; 2]).map(f64::sqrt));
        single.reduce(|a, b| if a[1] < b[1] { a } else { b }).unwrap_or_default()
    }
}

impl ObservedRun {
    /// Determines what the counters' resolution gives the mean of each block.
    pub(super) fn resolve(&mut self) {
        let of = |block: &super::Block| {
            let mut squares = [0.0; 2];
            for (wheel, sum) in squares.iter_mut().enumerate() {
                let mut alike = 0.0;
                for observation in block.first..block.first + block.count {
                    alike += 1.0;
                    if observation + 1 == block.first + block.count || self.have_turned(observation)[wheel] {
                        *sum += alike * alike;
                        alike = 0.0;
                    }
                }
            }
            self.hidden(squares.map(|sum| sum / (block.count * block.count) as f64))
        };
        let found: Vec<[f64; 2]> = self.blocks.iter().map(of).collect();
        self.blocks.iter_mut().zip(found).for_each(|(block, found)| block.resolution = found);
    }

    /// Whether the left and the right wheel made a count from an observation to the next.
    pub(super) fn have_turned(&self, observation: usize) -> [bool; 2] {
        let seen_after = self.track.seen_after();
        let between = &self.track.travel()[seen_after[observation]..seen_after[observation + 1]];
        [between.iter().any(|travel| travel.left != 0.0), between.iter().any(|travel| travel.right != 0.0)]
    }

    /// Variances \[m², rad²\] of a pose whose wheels have these shares of the variance of a single count.
    pub(super) fn hidden(&self, shares: [f64; 2]) -> [f64; 2] {
        hidden(self.counts, shares, self.wheelbase)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Dataset;
    use crate::drive::{Encoder, Robot};
    use crate::effect::TestKind;
    use crate::run::{ReferencePose, Run, TickLog};

    /// Ten poses at rest share one error. On the way each wheel makes a count between any two poses, then only the left one.
    #[test]
    fn poses_without_a_count_between_them_share_the_error_of_the_counters() {
        let mut robot = Robot::labmate();
        robot.encoder = Encoder::new(100.0, None, None).unwrap();
        let left: Vec<f64> = (0..60_u32).map(|k| f64::from(k.saturating_sub(9))).collect();
        let right = left.iter().map(|count| count.min(25.0)).collect();
        let seen = |sample| ReferencePose { sample, x: 0.0, y: 0.0, heading: Some(0.0) };
        let time = (0..60).map(|k| 0.05 * f64::from(k)).collect();
        let log = TickLog { time, left, right, reference: (0..60).map(seen).collect(), ..TickLog::default() };
        let (name, test) = ("slow".into(), TestKind::Systematic);
        let run = Run { name, number: 1, direction: None, test, log: Some(log), returned: None };
        let runs = vec![run];
        let observed = Observed::new(&Dataset { runs, ..Dataset::default() }, &robot).unwrap();
        let run = &observed.runs[0];
        let single = run.hidden([1.0; 2]);
        let [left, right] = [run.hidden([1.0, 0.0]), run.hidden([0.0, 1.0])];
        let mut at_rest = 0;
        for block in &run.blocks {
            let n = block.count as f64;
            let share = |first_alike: f64| (first_alike * first_alike + n - first_alike) / (n * n);
            let expected: [f64; 2] = match block.first {
                0 => {
                    at_rest += 1;
                    single.map(|variance| variance * share(10.0))
                }
                first if first >= 35 => std::array::from_fn(|k| left[k] / n + right[k]),
                first if first + block.count <= 35 => single.map(|variance| variance / n),
                _ => continue,
            };
            for (found, expected) in block.resolution.into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-9, "{block:?} {expected}");
            }
        }
        assert_eq!(at_rest, 1);
    }
}
