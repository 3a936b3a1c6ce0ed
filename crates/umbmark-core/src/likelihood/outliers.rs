//! Collisions and glitches: places in a run whose innovation cannot be noise.
//!
//! The innovation of a block, scaled by the noise of all runs and the usual size in its own run, is a few standard deviations at most. If
//! it is ten, and far beyond the tails of this data, the robot was pushed or the reference jumped. The run restarts at such a block, as if
//! the robot had been placed there: neither the fit nor any test sees the jump. Jumps at the same place in several runs are an effect, not
//! an accident, and stay in the data. So do jumps if there are very many.

use super::fitted::{Fitted, Outlier};
use super::observed::{Observed, ObservedRun};
use crate::setup::{Jump, RunSetup};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Threshold in standard deviations, unless the noise has heavy tails: Gaussian noise exceeds it once in 1e21 blocks.
const BEYOND: f64 = 10.0;
/// The threshold is exceeded by at most this many blocks per data set, extrapolating the tail between these two quantiles.
const LEVEL: f64 = 0.01;
const TAIL: [f64; 2] = [0.05, 0.01];
/// A jump in another run is the same one where it exceeds this threshold \[standard deviations\] within [`NEAR`].
const ALIKE: f64 = 4.0;
/// Way (of a wheel, in a turn) within which two runs are at the same place \[m\].
const NEAR: f64 = 0.15;
/// A jump that this share of the other runs has too is an effect.
const SHARED: f64 = 0.2;
/// Where a greater share of all blocks exceeds the threshold, these are not accidents.
const MAX_SHARE: f64 = 0.01;
/// The same where the reference tells motion only: a match of two scans may fail.
const MAX_SHARE_OF_STEPS: f64 = 0.1;
/// Blocks at the beginning that determine START.
const SPENT: usize = 2;

/// A block that is beyond noise, by run and number.
pub(super) type BlockIndex = (usize, usize);

impl Observed {
    /// The jumps that were found before anything was fitted.
    pub(super) fn jumps(&self) -> Vec<Outlier> {
        let of = |(found, jump): (&RunSetup, &Jump)| Outlier {
            run: found.run.clone(),
            time: jump.time,
            moved: jump.moved,
            turned: jump.turned,
            deviations: jump.deviations,
        };
        self.setup.jumps().map(of).collect()
    }
}

impl Fitted {
    /// Blocks with outlying innovations at which the run does not yet restart.
    pub(super) fn beyond_noise(&self) -> BTreeSet<(BlockIndex, u64)> {
        let wheelbase = self.observed.robot.drive.wheelbase();
        let runs: Vec<Vec<f64>> = self.observed.runs.par_iter().map(|run| self.deviations(run)).collect();
        let ways: Vec<Vec<f64>> = self.observed.runs.iter().map(|run| run.rolled(wheelbase)).collect();
        let shared = |run: usize, way: f64| {
            let there = |other: usize| {
                let mut blocks = ways[other].iter().zip(&runs[other]);
                blocks.any(|(w, d)| (w - way).abs() <= NEAR && *d > ALIKE)
            };
            let others = (0..runs.len()).filter(|other| *other != run);
            others.clone().filter(|other| there(*other)).count() as f64 >= (SHARED * others.count() as f64).max(1.0)
        };
        let least = BEYOND.max(beyond_tails(&runs, LEVEL));
        let beyond = |run: usize| runs[run].iter().enumerate().filter(|(_, d)| **d > least).map(|(block, _)| block);
        let places = (0..runs.len()).flat_map(|run| beyond(run).map(move |block| (run, block)));
        // Steps of a reference that tells motion only fail at any place, and often.
        let steps = self.observed.runs.iter().any(|run| run.relative);
        let alone = places.filter(|(run, block)| steps || !shared(*run, ways[*run][*block]));
        let found: BTreeSet<_> = alone.map(|place| (place, runs[place.0][place.1].to_bits())).collect();
        let all: usize = self.observed.runs.iter().map(|run| run.blocks.len()).sum();
        let known = self.observed.runs.iter().flat_map(|run| &run.blocks).filter(|block| block.afresh).count();
        let most = if steps { MAX_SHARE_OF_STEPS } else { MAX_SHARE };
        if (found.len() + known) as f64 <= most * all as f64 { found } else { BTreeSet::new() }
    }

    /// Innovation of each block, in standard deviations of this run.
    fn deviations(&self, run: &ObservedRun) -> Vec<f64> {
        let white = self.noise.whiten(run, &[&run.residuals_along(&self.model.chain())]);
        let (mut squares, mut rows) = (vec![0.0; run.blocks.len()], vec![0.0; run.blocks.len()]);
        for (value, block) in white.values.iter().zip(&white.block) {
            squares[*block] += value * value;
            rows[*block] += 1.0;
        }
        let mean = |block: usize| if rows[block] > 0.0 { squares[block] / rows[block] } else { 0.0 };
        let mut sorted: Vec<f64> = (SPENT.min(squares.len())..squares.len()).map(mean).collect();
        sorted.sort_by(f64::total_cmp);
        // The median of a chi-squared with three degrees of freedom is 2.37.
        let usual = sorted.get(sorted.len() / 2).map_or(1.0, |median| median * 3.0 / 2.37).max(1.0);
        (0..squares.len()).map(|block| if block < SPENT { 0.0 } else { (squares[block] / usual).sqrt() }).collect()
    }

    /// Describes a disturbed place.
    pub(super) fn outlier(&self, (run, block): BlockIndex, deviations: f64) -> Outlier {
        let run = &self.observed.runs[run];
        let residuals = run.residuals_along(&self.model.chain());
        let before = |k: usize| if run.relative { 0.0 } else { residuals[block - 1][k] };
        let [dx, dy, turned] = [0, 1, 2].map(|k| residuals[block][k] - before(k));
        let measured = run.blocks[block].headings > 0 && run.blocks[block - 1].headings > 0;
        Outlier {
            run: run.name.clone(),
            time: run.track.sights()[run.blocks[block].first].time,
            moved: dx.hypot(dy),
            turned: measured.then_some(turned),
            deviations,
        }
    }
}

/// The threshold beyond the tails of all blocks, in standard deviations: a power law through two of their quantiles exceeds it in
/// this many blocks with probability `level`. Zero where there are too few blocks.
pub(super) fn beyond_tails(runs: &[Vec<f64>], level: f64) -> f64 {
    let mut all: Vec<f64> = runs.iter().flatten().copied().filter(|d| *d > 0.0).collect();
    all.sort_by(|a, b| b.total_cmp(a));
    let count = all.len() as f64;
    let [some, few] = TAIL.map(|share| all.get((share * count) as usize).copied().unwrap_or(0.0));
    if some <= 0.0 || few <= some {
        return 0.0;
    }
    let power = libm::log(TAIL[0] / TAIL[1]) / libm::log(few / some);
    few * libm::pow((TAIL[1] * count / level).max(1.0), 1.0 / power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Dataset;
    use crate::diagnose::first_model;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::geometry::wrap;
    use crate::likelihood::watched::watched;
    use crate::likelihood::{Noise, Observed};

    /// 3 + 3 squares of a robot with usual errors.
    fn data(effects: &[(&str, &str, f64)]) -> Dataset {
        let mut model = Model::new(&Robot::labmate());
        let usual = [
            ("wheelbase", "e_b", 0.993),
            ("wheel_noise", "k_sqrt_m", 4e-4),
            ("reference_noise", "position_sd_m", 8e-4),
            ("reference_noise", "heading_sd_rad", 8e-4),
        ];
        for (effect, parameter, value) in usual.iter().chain(effects) {
            model.set(effect, parameter, *value).unwrap();
        }
        watched(&model, 3, 5)
    }

    fn fitted(data: &Dataset) -> Fitted {
        let observed = Observed::new(data, &Robot::labmate()).unwrap();
        observed.fit(&first_model(data).unwrap(), &Noise::default(), &[]).unwrap()
    }

    /// The run turned by 3 degrees where it is after `at` of its poses: somebody kicked the robot.
    fn kicked(mut data: Dataset, run: usize, at: usize) -> Dataset {
        let poses = &mut data.runs[run].log.as_mut().unwrap().reference;
        let (sine, cosine) = libm::sincos(0.052);
        let pivot = poses[at];
        for pose in &mut poses[at..] {
            let (dx, dy) = (pose.x - pivot.x, pose.y - pivot.y);
            (pose.x, pose.y) = (pivot.x + cosine * dx - sine * dy, pivot.y + sine * dx + cosine * dy);
            pose.heading = pose.heading.map(|heading| wrap(heading + 0.052));
        }
        data
    }

    #[test]
    fn a_kicked_robot_is_named_with_run_and_time_and_changes_no_estimate_by_much() {
        let (plain, hurt) = (data(&[]), kicked(data(&[]), 1, 150));
        let (before, after) = (fitted(&plain), fitted(&hurt));
        assert_eq!(before.outliers, []);
        assert!((1..=2).contains(&after.outliers.len()), "{:?}", after.outliers);
        let log = hurt.runs[1].log.as_ref().unwrap();
        let time = log.time[log.reference[150].sample] - log.time[0];
        for outlier in &after.outliers {
            assert_eq!(outlier.run, hurt.runs[1].name);
            assert!((outlier.time - time).abs() < 0.3 && outlier.deviations > BEYOND, "{outlier:?} {time}");
        }
        let turned: f64 = after.outliers.iter().filter_map(|o| o.turned).sum();
        assert!((turned - 0.052).abs() < 0.01, "{turned}");
        let covariance = before.covariance.as_ref().unwrap();
        for (k, (a, b)) in before.model.values().zip(after.model.values()).enumerate() {
            let sd = covariance[(k, k)].sqrt();
            assert!(
                (a - b).abs() < sd,
                "{k}: {a} {b} ± {sd}; {:?}; {:?} {:?}",
                after.outliers,
                before.noise,
                after.noise
            );
        }
    }

    #[test]
    fn a_glitch_of_the_reference_is_left_out_and_is_no_jump() {
        let mut hurt = data(&[]);
        for pose in &mut hurt.runs[4].log.as_mut().unwrap().reference[300..302] {
            pose.x += 0.05;
        }
        let (plain, after) = (fitted(&data(&[])), fitted(&hurt));
        assert_eq!(after.outliers, []);
        let wrong: Vec<usize> = after.observed.setup.runs[4].wrong.iter().map(|wrong| wrong.pose).collect();
        assert_eq!(wrong, [300, 301]);
        assert!(after.observed.setup.runs.iter().enumerate().all(|(run, found)| run == 4 || found.wrong.is_empty()));
        for (a, b) in plain.model.values().zip(after.model.values()) {
            assert!((a - b).abs() < 2e-5, "{a} {b}");
        }
    }

    #[test]
    fn what_happens_in_every_run_is_no_accident() {
        assert_eq!(fitted(&data(&[("caster_kick", "kick_rad", 0.05)])).outliers, []);
    }
}
