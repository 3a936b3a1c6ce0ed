//! Residuals of a run and derivatives of its predicted poses, block by block.

use super::ObservedRun;
use crate::effect::{Chain, Evaluate};
use crate::geometry::{Dual, LANES, Pose2, wrap};
use crate::likelihood::observed::Column;

impl ObservedRun {
    /// Measured minus predicted poses, block by block.
    pub fn residuals(&self, chain: &Chain<f64>) -> Column {
        self.less(|seen| self.track.replay(chain, seen))
    }

    /// The same for the model about which the run is linearised, whose chain is given: nothing is replayed.
    pub fn residuals_along(&self, chain: &Chain<f64>) -> Column {
        self.less(|seen| self.sighted(chain, seen))
    }

    fn less(&self, predicted: impl FnOnce(&mut dyn FnMut(usize, &Pose2))) -> Column {
        let mut sums = Sums::<1>::new(self);
        predicted(&mut |i, pose| sums.add_residual(i, pose));
        self.residual_steps(sums.of_lane(0))
    }

    /// Derivatives of the predicted poses, block by block: those in the first `count` lanes.
    pub fn columns(&self, chain: &Chain<Dual>, count: usize) -> Vec<Column> {
        self.slopes(count, |seen| self.track.replay(chain, seen))
    }

    /// The same, and measured minus predicted poses.
    pub fn columns_and_residuals(&self, chain: &Chain<Dual>, count: usize) -> (Vec<Column>, Column) {
        let (mut slopes, mut left) = (Sums::<LANES>::new(self), Sums::<1>::new(self));
        self.track.replay(chain, |i, pose| {
            slopes.add_slope(i, pose);
            left.add_residual(i, &pose.value());
        });
        let slopes = (0..count).map(|lane| self.slope_steps(slopes.of_lane(lane))).collect();
        (slopes, self.residual_steps(left.of_lane(0)))
    }

    /// Derivatives by numbers that change only the measurement, at the model about which the run is linearised: by its chain without
    /// derivatives, and that with them.
    pub fn columns_of_sight(&self, (plain, chain): (&Chain<f64>, &Chain<Dual>), count: usize) -> Vec<Column> {
        self.slopes(count, |seen| match chain.filter() {
            Some(_) => self.track.replay_sight(plain, chain, seen),
            None => self.sighted(chain, seen),
        })
    }

    fn slopes(&self, count: usize, predicted: impl FnOnce(&mut dyn FnMut(usize, &Pose2<Dual>))) -> Vec<Column> {
        let mut sums = Sums::<LANES>::new(self);
        predicted(&mut |i, pose| sums.add_slope(i, pose));
        (0..count).map(|lane| self.slope_steps(sums.of_lane(lane))).collect()
    }

    /// Calls `seen` with what is measured of each place.
    pub(super) fn sighted<T: Evaluate>(&self, chain: &Chain<T>, seen: &mut dyn FnMut(usize, &Pose2<T>)) {
        if chain.filter().is_some() {
            return self.track.replay(chain, seen);
        }
        for (index, (place, moment)) in self.places.iter().zip(self.moments.iter()).enumerate() {
            seen(index, &chain.seen(&moment.sight, &place.lift()));
        }
    }

    /// Sum of the squared differences of successive residuals within blocks, halved and less what the resolution of the counters gives: the
    /// variance of one reference pose (position per coordinate \[m²\], heading \[rad²\]) times the number of differences, and that number. The
    /// chain is that of the model about which the run is linearised.
    pub fn scatter_within_blocks(&self, chain: &Chain<f64>) -> [(f64, usize); 2] {
        let mut raw = Vec::with_capacity(self.seen.len());
        self.sighted(chain, &mut |i, pose| {
            let (x, y, heading) = self.seen[i];
            raw.push((x - pose.x, y - pose.y, heading.map(|h| wrap(h - pose.heading))));
        });
        let (mut position, mut heading) = ((0.0, 0), (0.0, 0));
        for block in &self.blocks {
            for (index, pair) in (block.first..).zip(raw[block.first..block.first + block.count].windows(2)) {
                let (mut dx, mut dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
                let mut counted = self.hidden(self.have_turned(index).map(f64::from));
                if block.positions == 0 {
                    (dx, dy, counted[0]) = (0.0, 0.0, 0.0);
                }
                position = (position.0 + 0.25 * (dx * dx + dy * dy) - counted[0], position.1 + 1);
                if let (Some(a), Some(b)) = (pair[0].2, pair[1].2) {
                    heading = (heading.0 + 0.5 * (b - a) * (b - a) - counted[1], heading.1 + 1);
                }
            }
        }
        [position, heading]
    }
}

/// Means over blocks of several numbers at once, gathered in the order of the observations.
struct Sums<'a, const N: usize> {
    run: &'a ObservedRun,
    block: usize,
    means: Vec<[[f64; N]; 3]>,
}

impl<'a, const N: usize> Sums<'a, N> {
    fn new(run: &'a ObservedRun) -> Sums<'a, N> {
        Sums { run, block: 0, means: vec![[[0.0; N]; 3]; run.blocks.len()] }
    }

    fn of_lane(&self, lane: usize) -> Column {
        self.means.iter().map(|mean| mean.map(|lanes| lanes[lane])).collect()
    }

    fn add(&mut self, observation: usize, [x, y]: [[f64; N]; 2], heading: Option<[f64; N]>) {
        let blocks = &self.run.blocks;
        while observation >= blocks[self.block].first + blocks[self.block].count {
            self.block += 1;
        }
        let block = &blocks[self.block];
        let mean = &mut self.means[self.block];
        let (count, headings) = (block.count as f64, block.headings as f64);
        mean[0].iter_mut().zip(x).for_each(|(mean, x)| *mean += x / count);
        mean[1].iter_mut().zip(y).for_each(|(mean, y)| *mean += y / count);
        if let Some(heading) = heading {
            mean[2].iter_mut().zip(heading).for_each(|(mean, heading)| *mean += heading / headings);
        }
    }
}

impl Sums<'_, 1> {
    fn add_residual(&mut self, observation: usize, pose: &Pose2) {
        let (x, y, heading) = self.run.seen[observation];
        if self.run.headings_only {
            return self.add(observation, [[0.0]; 2], heading.map(|h| [wrap(h - pose.heading)]));
        }
        self.add(observation, [[x - pose.x], [y - pose.y]], heading.map(|h| [wrap(h - pose.heading)]));
    }
}

impl Sums<'_, LANES> {
    fn add_slope(&mut self, observation: usize, pose: &Pose2<Dual>) {
        let plane = if self.run.headings_only { [[0.0; LANES]; 2] } else { [pose.x.eps, pose.y.eps] };
        self.add(observation, plane, self.run.seen[observation].2.map(|_| pose.heading.eps));
    }
}
