//! The cheapest way through the poses of a run (Viterbi 1967): which poses are kept, and where the track jumps.

use super::edges::{Edge, JUMP, LARGE, Sighting, Spread};

/// Costs, in half squares of standard deviations: of a jump, of the first skipped pose, and of each further one.
const COSTS: [f64; 3] = [0.5 * JUMP * JUMP, 32.0, 10.0];
/// Maximum number of consecutive wrong poses.
pub(super) const LONGEST: usize = 12;
/// No pose is skipped unless an edge nearby exceeds this many standard deviations.
const QUIET: f64 = 5.0;

/// The poses of a run that are kept, in order.
pub(super) struct Way {
    pub kept: Vec<usize>,
}

impl Way {
    pub fn cheapest(run: &[Sighting], spread: &Spread) -> Way {
        let loud: Vec<bool> =
            (0..run.len()).map(|k| k > 0 && spread.deviations(&run[k - 1], &run[k]) > QUIET).collect();
        let passed = |count: usize| if count == 0 { 0.0 } else { COSTS[1] + COSTS[2] * (count - 1) as f64 };
        let mut cost = vec![f64::INFINITY; run.len()];
        // How many poses back the way comes from; 0 where it begins.
        let mut back = vec![0u8; run.len()];
        for to in 0..run.len() {
            if to <= LONGEST {
                cost[to] = passed(to);
            }
            let first = to.saturating_sub(LONGEST + 1);
            // Without a large edge nearby, the path comes from the previous pose.
            let near = (first..=(to + 1).min(run.len() - 1)).any(|k| loud[k]);
            let from = if near { first } else { to.saturating_sub(1) };
            for from in from..to {
                let deviations = spread.deviations(&run[from], &run[to]);
                let own = cost[from] + passed(to - from - 1) + (0.5 * deviations * deviations).min(COSTS[0]);
                if own < cost[to] {
                    (cost[to], back[to]) = (own, (to - from) as u8);
                }
            }
        }
        let ends = run.len().saturating_sub(LONGEST + 1)..run.len();
        let last = ends.min_by(|a, b| {
            let of = |end: &usize| cost[*end] + passed(run.len() - 1 - end);
            of(a).total_cmp(&of(b))
        });
        let mut kept: Vec<usize> =
            std::iter::successors(last, |at| Some(*at - usize::from(back[*at])).filter(|from| from != at)).collect();
        kept.reverse();
        Way { kept }
    }

    /// The steps of the way of more than [`LARGE`] standard deviations.
    pub fn large_steps(&self, run: &[Sighting], spread: &Spread) -> Vec<Edge> {
        let steps = self.kept.windows(2).map(|pair| Edge::between(run, pair[0], pair[1], spread));
        steps.filter(|step| step.deviations > LARGE).collect()
    }
}
