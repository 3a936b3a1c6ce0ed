//! What a gyro adds to its headings: a rate of its own, and the growth of that in a run.
//!
//! Both are random numbers of a run: the likelihood holds them as such, and what is reported of a run is what they leave when they are fitted to
//! it, as START is.

use super::{Block, Column, ObservedRun};
use crate::geometry::Pose2;
use crate::likelihood::Noise;
use crate::run::TickLog;
use nalgebra::{Matrix2, Vector2};
use std::ops::Range;

/// Minimum standard deviation of a heading \[rad\].
const LEAST: f64 = 1e-4;
/// Standard deviation of a gyro's own rate in a run, less what was found of it before, and of the growth of that in a minute \[rad/s\]: wide,
/// so that what a run shows of them decides.
const RATE: f64 = 1e-2;
const GROWTH: f64 = 3e-3;
const MINUTE: f64 = 60.0;

/// What is known of a gyro before a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyro {
    /// Noise of its heading \[rad/√s\].
    pub noise: f64,
    /// Standard deviations of what it adds in a run.
    pub added: [f64; 2],
}

impl Gyro {
    /// That of a log; `None` where its reference is another one.
    pub fn of(log: &TickLog) -> Option<Gyro> {
        let (first, last) = log.reference.first().zip(log.reference.last())?;
        let seconds = log.time[last.sample] - log.time[first.sample];
        let added = [RATE, GROWTH * (seconds / MINUTE).sqrt()];
        (log.relative && log.headings_only).then(|| Gyro { noise: log.gyro_noise(), added })
    }
}

/// How a block's heading moves for what a gyro adds.
fn of(block: &Block) -> Vector2<f64> {
    Vector2::from(block.drifts.map(|drift| drift[2]))
}

impl ObservedRun {
    /// Sets how far the headings of the blocks move by a rate of 1 rad/s, and by one that grows by as much in the run.
    pub(super) fn let_drift(&mut self) {
        let Some(Gyro { noise, .. }) = self.gyro else { return };
        let mean = |block: &Block| {
            let own = &self.track.sights()[block.first..block.first + block.count];
            own.iter().map(|sight| sight.time).sum::<f64>() / own.len() as f64
        };
        let times: Vec<f64> = self.blocks.iter().map(mean).collect();
        let (Some(first), Some(last)) = (times.first(), times.last()) else { return };
        let (middle, whole) = (0.5 * (first + last), (last - first).max(f64::MIN_POSITIVE));
        let mut before = *first;
        for (block, time) in self.blocks.iter_mut().zip(&times) {
            block.wander = noise * noise * (time - std::mem::replace(&mut before, *time));
            let grown = 0.5 * ((time - middle).powi(2) - (first - middle).powi(2)) / whole;
            block.drifts = [time - first, grown].map(|moved| [0.0, 0.0, moved]);
        }
    }

    /// Standard deviations of what a gyro adds in a run; none of what is no gyro.
    #[inline(always)]
    pub(crate) fn drifts(&self) -> &[f64] {
        self.gyro.as_ref().map_or(&[], |gyro| &gyro.added)
    }

    /// How that is fitted to some blocks, single headings having this noise \[rad\]; `None` of what is no gyro.
    ///
    /// What is weighted is the step from one block to the next: both ends are measured, and the wheels turn it by noise.
    pub(super) fn drifts_of(&self, blocks: Range<usize>, heading: f64) -> Option<Drifts> {
        let gyro = self.gyro?;
        let usual = Noise::default();
        let weigh = |block: &Block| {
            let turning = usual.heading_per_metre.powi(2) * block.growth.heading_per_metre[5]
                + usual.heading_per_radian.powi(2) * block.growth.heading_per_radian[5];
            1.0 / (2.0 * heading.max(LEAST).powi(2) + turning + block.wander)
        };
        let own = &self.blocks[blocks.clone()];
        let weights: Vec<f64> = own.iter().skip(1).map(weigh).collect();
        let mut products = Matrix2::from_diagonal(&Vector2::from(gyro.added.map(|sd| 1.0 / (sd * sd))));
        for (pair, weight) in own.windows(2).zip(&weights) {
            let step = of(&pair[1]) - of(&pair[0]);
            products += step * step.transpose() * *weight;
        }
        Some(Drifts { blocks, weights, solver: products.try_inverse().unwrap_or_else(Matrix2::zeros) })
    }
}

impl Block {
    /// What a gyro's own noise adds since a place: as a turn of all that follows about the way from there.
    pub(super) fn wandering(&self, before: &Pose2) -> [f64; 6] {
        let g = [0.5 * (before.y + self.place.y), -0.5 * (before.x + self.place.x), 1.0];
        [g[0] * g[0], g[1] * g[0], g[1] * g[1], g[0], g[1], 1.0].map(|product| self.wander * product)
    }
}

/// How what a gyro adds is fitted to a stretch of a run.
#[derive(Clone, Debug)]
pub(super) struct Drifts {
    blocks: Range<usize>,
    /// Of the step that ends in each block but the first.
    weights: Vec<f64>,
    solver: Matrix2<f64>,
}

impl Drifts {
    /// A column without the part of it that a gyro adds.
    pub fn less(&self, run: &ObservedRun, column: &Column) -> Column {
        let (own, values) = (&run.blocks[self.blocks.clone()], &column[self.blocks.clone()]);
        let steps = own.windows(2).zip(values.windows(2)).zip(&self.weights);
        let sum = steps.fold(Vector2::zeros(), |sum, ((blocks, values), weight)| {
            sum + (of(&blocks[1]) - of(&blocks[0])) * (weight * (values[1][2] - values[0][2]))
        });
        let added = self.solver * sum;
        let mut left = column.clone();
        for (value, block) in left[self.blocks.clone()].iter_mut().zip(own) {
            value[2] -= of(block).dot(&added);
        }
        left
    }
}
