//! Where a run starts and restarts, fitted to the poses measured there: the only fit before an error is reported.
//!
//! The heading noise of a single pose would rotate everything after it: ten metres further on, that is some centimetres. So START is fitted
//! to the first poses of a section, each weighted by its own noise and by the usual noise of the wheels until then.

use super::drifts::Drifts;
use super::{Block, ObservedRun};
use crate::likelihood::{Column, Noise};
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;

/// Minimum standard deviation of a pose \[m, rad\].
const LEAST: f64 = 1e-4;
/// The first block alone determines START if the standard deviation of its mean is below this \[m, rad\].
const ENOUGH: (f64, f64) = (1e-3, 5e-4);

/// A stretch of a run in which nothing but START is fitted and, of a gyro, its own rate.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Its blocks.
    pub blocks: Range<usize>,
    /// How START is fitted; `None` where it is trusted.
    start: Option<Start>,
    /// Whether its blocks tell motion only, the first one none.
    relative: bool,
    /// Whether they tell headings only.
    headings_only: bool,
    /// How the own rate of a gyro is fitted.
    drifts: Option<Drifts>,
}

/// How START is fitted.
#[derive(Clone, Debug)]
enum Start {
    /// Its heading to headings, its position to positions: weights of the blocks.
    Posed { headings: Vec<f64>, positions: Vec<f64> },
    /// All of it to positions: weights of the blocks, and what solves for it.
    Placed { weights: Vec<f64>, solver: Matrix3<f64> },
}

impl ObservedRun {
    /// The stretches of a run, where single poses have this noise \[m, rad\].
    pub fn stretches(&self, noise: [f64; 2]) -> Vec<Stretch> {
        let begins = |(index, block): (usize, &Block)| (index == 0 || block.afresh).then_some(index);
        let begins: Vec<usize> = self.blocks.iter().enumerate().filter_map(begins).collect();
        let ends = begins.iter().skip(1).copied().chain([self.blocks.len()]);
        let stretch = |(begin, end): (&usize, usize)| {
            let blocks = *begin..end;
            let is_fitted = !self.relative && (*begin > 0 || self.start_seen);
            let (relative, headings_only) = (self.relative, self.headings_only);
            let drifts = self.drifts_of(*begin..end, noise[1]);
            Stretch {
                relative,
                headings_only,
                drifts,
                start: is_fitted.then(|| self.start_of(blocks.clone(), noise)),
                blocks,
            }
        };
        begins.iter().zip(ends).map(stretch).collect()
    }

    fn start_of(&self, blocks: Range<usize>, [position, heading]: [f64; 2]) -> Start {
        let usual = Noise::default();
        let own = |sd: f64, count: usize| (sd * sd).max(LEAST * LEAST) / count.max(1) as f64;
        let first = &self.blocks[blocks.start];
        // There are usually enough poses at rest; then later errors cannot be attributed to START.
        let sure = own(position, first.count) <= ENOUGH.0 * ENOUGH.0
            && first.headings > 0
            && own(heading, first.headings) <= ENOUGH.1 * ENOUGH.1;
        if sure {
            let alone = |k: usize| if k == 0 { 1.0 } else { 0.0 };
            let weights: Vec<f64> = (0..blocks.len()).map(alone).collect();
            return Start::Posed { headings: weights.clone(), positions: weights };
        }
        let (mut turned, mut gone) = (0.0, 0.0);
        let (mut positions, mut headings) = (Vec::new(), Vec::new());
        for (k, block) in self.blocks[blocks.clone()].iter().enumerate() {
            let growth = &block.growth;
            let further = |of: f64| if k > 0 { of } else { 0.0 };
            let turning = further(
                usual.heading_per_metre.powi(2) * growth.heading_per_metre[5]
                    + usual.heading_per_radian.powi(2) * growth.heading_per_radian[5],
            );
            (turned, gone) = (turned + turning, gone + further(growth.way));
            // The heading error accumulated since START moves the robot sideways.
            let aside = further((usual.forward_per_metre.powi(2) + turned * gone) * growth.way);
            positions.push((Some(own(position, block.count)), aside));
            headings.push(((block.headings > 0).then(|| own(heading, block.headings)), turning));
        }
        if headings.iter().any(|(own, _)| own.is_some()) {
            return Start::Posed { headings: of_first(&headings), positions: of_first(&positions) };
        }
        let mut sum = 0.0;
        let weigh = |(own, aside): &(Option<f64>, f64)| {
            sum += aside;
            1.0 / (own.unwrap_or(0.0) + sum)
        };
        let weights: Vec<f64> = positions.iter().map(weigh).collect();
        let mut products = Matrix3::identity() * 1e-6;
        for (block, p) in self.blocks[blocks.clone()].iter().zip(&weights) {
            let [x, y] = self.away(&blocks, block);
            products += Matrix3::new(1.0, 0.0, -y, 0.0, 1.0, x, -y, x, x * x + y * y) * *p;
        }
        Start::Placed { weights, solver: products.try_inverse().unwrap_or_else(Matrix3::zeros) }
    }

    /// Where a block is, seen from the first of a stretch.
    fn away(&self, blocks: &Range<usize>, block: &Block) -> [f64; 2] {
        let from = &self.blocks[blocks.start].place;
        [block.place.x - from.x, block.place.y - from.y]
    }
}

/// Weights that best estimate the first value of a random walk from all its measured values: each has measurement noise, and the walk has a
/// step between any two. Generalised least squares, by the information filter from the last value back.
fn of_first(values: &[(Option<f64>, f64)]) -> Vec<f64> {
    let mut weights = vec![0.0; values.len()];
    let (mut information, mut shares) = (0.0, vec![0.0; values.len()]);
    for (k, (own, _)) in values.iter().enumerate().rev() {
        let later = values.get(k + 1).map_or(0.0, |(_, step)| information / (1.0 + information * step));
        information = later + own.map_or(0.0, |own| 1.0 / own);
        shares[k] = if information > 0.0 { later / information } else { 0.0 };
    }
    let mut passed = 1.0;
    for (weight, share) in weights.iter_mut().zip(shares) {
        *weight = passed * (1.0 - share);
        passed *= share;
    }
    weights
}

impl Stretch {
    /// Residual of a column in the stretch after START, and the own rate of a gyro, are fitted: (x, y, heading) per block. Where headings only
    /// were measured, positions are those to which they lead.
    pub fn less_start(&self, run: &ObservedRun, column: &Column) -> Vec<[f64; 3]> {
        let Some(drifts) = &self.drifts else { return self.followed(run, self.less_start_alone(run, column)) };
        self.followed(run, self.less_start_alone(run, &drifts.less(run, column)))
    }

    /// Where headings only were measured, the positions to which they lead.
    fn followed(&self, run: &ObservedRun, mut left: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
        if self.headings_only {
            let own = &run.blocks[self.blocks.clone()];
            let [mut x, mut y, mut turned] = [0.0; 3];
            for k in 0..left.len() {
                let before = turned;
                turned = left[k][2];
                if k > 0 {
                    let (from, to, half) = (&own[k - 1].place, &own[k].place, 0.5 * (before + turned));
                    (x, y) = (x - half * (to.y - from.y), y + half * (to.x - from.x));
                }
                left[k] = [x, y, turned];
            }
        }
        left
    }

    fn less_start_alone(&self, run: &ObservedRun, column: &Column) -> Vec<[f64; 3]> {
        let own = &run.blocks[self.blocks.clone()];
        let values = &column[self.blocks.clone()];
        let away = |block: &Block| run.away(&self.blocks, block);
        let start = match &self.start {
            None => return values.to_vec(),
            Some(Start::Posed { headings, positions }) => {
                let turned: f64 = values.iter().zip(headings).map(|(value, weight)| weight * value[2]).sum();
                let mut start = Vector3::new(0.0, 0.0, turned);
                for ((block, value), weight) in own.iter().zip(values).zip(positions) {
                    let [x, y] = away(block);
                    start[0] += weight * (value[0] + y * turned);
                    start[1] += weight * (value[1] - x * turned);
                }
                start
            }
            Some(Start::Placed { weights, solver }) => {
                let mut sums = Vector3::zeros();
                for ((block, value), weight) in own.iter().zip(values).zip(weights) {
                    let [x, y] = away(block);
                    sums += Vector3::new(value[0], value[1], x * value[1] - y * value[0]) * *weight;
                }
                solver * sums
            }
        };
        let left = |(block, value): (&Block, &[f64; 3])| {
            let [x, y] = away(block);
            [value[0] - start[0] + y * start[2], value[1] - start[1] - x * start[2], value[2] - start[2]]
        };
        own.iter().zip(values).map(left).collect()
    }

    /// The blocks whose errors are reported: where START is fitted, the first determines it.
    pub fn told(&self) -> Range<usize> {
        self.blocks.start + usize::from(self.start.is_some() || self.relative)..self.blocks.end
    }
}

#[cfg(test)]
mod tests {
    use super::of_first;
    use nalgebra::{DMatrix, DVector};

    /// Oracle: 1ᵀC⁻¹/1ᵀC⁻¹1 with C the covariance of a random walk seen with noise.
    #[test]
    fn the_first_value_of_a_walk_is_told_by_generalised_least_squares() {
        let values = [(Some(0.4), 0.0), (Some(1.0), 0.3), (None, 0.2), (Some(0.1), 0.5), (Some(0.2), 0.0)];
        let seen: Vec<usize> = (0..5).filter(|k| values[*k].0.is_some()).collect();
        let walk = |k: usize| values[..=k].iter().map(|(_, step)| step).sum::<f64>();
        let covariance = DMatrix::from_fn(4, 4, |i, j| {
            let own = if i == j { values[seen[i]].0.unwrap() } else { 0.0 };
            walk(seen[i].min(seen[j])) + own
        });
        let solved = covariance.cholesky().unwrap().solve(&DVector::from_element(4, 1.0));
        let expected = &solved / solved.sum();
        let found = of_first(&values);
        assert_eq!(found[2], 0.0);
        for (k, index) in seen.iter().enumerate() {
            assert!((found[*index] - expected[k]).abs() < 1e-12, "{found:?} {expected:?}");
        }
        assert_eq!(of_first(&[(Some(1.0), 0.0)]), [1.0]);
    }
}
