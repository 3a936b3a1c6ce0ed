//! Recorded runs with the poses that were measured on the way, gathered into blocks.

use super::fitting::Column;
use crate::dataset::{Dataset, Run};
use crate::drive::Robot;
use crate::effect::{Chain, Evaluate, Model, Place, TestKind};
use crate::geometry::{Dual, LANES, Pose2, wrap};
use crate::path::{Direction, Path};
use crate::replay::{ReplayError, Track};
use rayon::prelude::*;
use std::sync::Arc;

/// Poses measured within this way \[m\] and rotation \[rad\] are one observation: they share the noise of the wheels, and only
/// that of the reference is averaged.
const BLOCK: (f64, f64) = (0.03, 0.05);
/// A run falls into so many units, by the way driven.
const UNITS: f64 = 4.0;

/// How the random walk of the pose error grows from one block to the next, for unit noise.
///
/// In coordinates (q, θ) of the error that stay constant while nothing is added, δp = q + θ J p: a heading step at p adds
/// (-J p, 1), a position step adds (n, 0).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Growth {
    /// Σ ds g gᵀ over the pieces, g = (p_y, -p_x, 1), ds the way driven \[m\]: lower triangle by rows.
    pub heading_per_metre: [f64; 6],
    /// Σ |dθ| g gᵀ over the pieces \[rad\].
    pub heading_per_radian: [f64; 6],
    /// Σ ds f fᵀ over the pieces, f the direction of the heading: xx, xy, yy.
    pub forward: [f64; 3],
    /// Way driven \[m\].
    pub way: f64,
}

/// Neighbouring observations of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its first observation.
    pub first: usize,
    /// How many there are.
    pub count: usize,
    /// How many of them have a heading.
    pub headings: usize,
    /// Where the model has it, on average.
    pub place: Pose2,
    /// How its pose changes there, on average \[m/s, m/s, rad/s\].
    pub velocity: [f64; 3],
    /// How the error grows from the block before to this one.
    pub growth: Growth,
    /// Which quarter of the way it lies in, from 0.
    pub unit: usize,
    /// Whether the robot is taken to start anew here, because what happened before it was no noise; see
    /// [`Outlier`](super::Outlier).
    pub afresh: bool,
}

/// A run, ready to be predicted.
#[derive(Clone, Debug)]
pub struct ObservedRun {
    /// What it is called.
    pub name: String,
    /// Its sense.
    pub direction: Option<Direction>,
    /// Its believed travel.
    pub track: Arc<Track>,
    /// Measured poses: x, y \[m\] and, where it was measured, heading \[rad\].
    pub measured: Arc<[(f64, f64, Option<f64>)]>,
    /// The same, laid on the prediction where the run starts anew.
    pub seen: Arc<[(f64, f64, Option<f64>)]>,
    /// True poses at the observations, by the model that the run is laid along.
    pub places: Arc<[Pose2]>,
    /// The poses in blocks.
    pub blocks: Vec<Block>,
    /// Whether the pose at START was measured, so that the frame is not taken on trust.
    pub start_seen: bool,
}

/// All runs of the regular test that were observed on the way.
#[derive(Clone, Debug)]
pub struct Observed {
    /// The nominal robot.
    pub robot: Robot,
    /// The runs, in the order of the dataset.
    pub runs: Vec<ObservedRun>,
    /// The path that all of them were to follow, where it is known.
    pub path: Option<Path>,
}

impl Observed {
    /// Gathers the runs of a dataset that have ticks and absolute poses in at least three places.
    pub fn new(data: &Dataset, robot: &Robot) -> Result<Observed, ReplayError> {
        let mut runs = Vec::new();
        let mut session_distance = 0.0;
        for run in data.runs.iter().filter(|run| run.test == TestKind::Systematic) {
            let place = Place { run: runs.len(), session_distance, direction: run.direction };
            if let Some(observed) = ObservedRun::new(run, robot, place)? {
                session_distance += observed.track.length();
                runs.push(observed);
            }
        }
        Ok(Observed { robot: robot.clone(), runs, path: data.path.clone() })
    }

    /// Believed travel of the runs.
    pub fn tracks(&self) -> impl Iterator<Item = &Track> {
        self.runs.iter().map(|run| run.track.as_ref())
    }

    /// The same runs, none of which starts anew on the way.
    pub(super) fn whole(&self) -> Observed {
        let mut observed = self.clone();
        for run in &mut observed.runs {
            run.seen = Arc::clone(&run.measured);
            run.blocks.iter_mut().for_each(|block| block.afresh = false);
        }
        observed
    }

    /// The same runs, with the noise growing along the poses that `model` predicts.
    ///
    /// A rotation error moves the robot across its true path; taken across a path that is a degree off, it would seem to
    /// move it along.
    pub fn along(&self, model: &Model) -> Observed {
        let chain = model.chain();
        let mut observed = self.clone();
        observed.runs.par_iter_mut().for_each(|run| run.lay_along(&chain));
        observed
    }
}

impl ObservedRun {
    fn new(run: &Run, robot: &Robot, place: Place) -> Result<Option<ObservedRun>, ReplayError> {
        let Some(log) = &run.log else { return Ok(None) };
        let track = Track::from_log_at(log, robot, place)?;
        let seen: Arc<[_]> = log.reference.iter().map(|r| (r.x, r.y, r.heading)).collect();
        let start_seen = track.seen_after().first().is_some_and(|made| track.way_before(*made) < BLOCK.0);
        let chain = Model::new(robot).chain();
        let blocks = blocks(&track, &seen, &chain);
        let (name, direction, track) = (run.name.clone(), run.direction, Arc::new(track));
        let measured = Arc::clone(&seen);
        let mut observed =
            ObservedRun { name, direction, track, measured, seen, places: [].into(), blocks, start_seen };
        observed.lay_along(&chain);
        Ok((observed.blocks.len() >= 3).then_some(observed))
    }

    /// A run yet to be driven, as a model predicts it; `headings` says whether they will be measured.
    pub fn planned(track: Track, direction: Direction, headings: bool, model: &Model) -> ObservedRun {
        let seen: Arc<[_]> = track.sights().iter().map(|_| (0.0, 0.0, headings.then_some(0.0))).collect();
        let chain = model.chain();
        let blocks = blocks(&track, &seen, &chain);
        let (name, direction, track) = (String::new(), Some(direction), Arc::new(track));
        let measured = Arc::clone(&seen);
        let mut planned =
            ObservedRun { name, direction, track, measured, seen, places: [].into(), blocks, start_seen: true };
        planned.lay_along(&chain);
        planned
    }

    /// Starts anew at a block: what was measured from there on is laid on what the model predicts there, since turned by degrees
    /// it would be off by more than a small rotation moves it.
    pub(super) fn start_afresh(&mut self, block: usize, chain: &Chain<f64>) {
        let [dx, dy, turned] = self.residuals_along(chain)[block];
        let Block { first, place, .. } = self.blocks[block];
        let (sine, cosine) = libm::sincos(-turned);
        let laid = |(x, y, heading): (f64, f64, Option<f64>)| {
            let (ahead, aside) = (x - place.x - dx, y - place.y - dy);
            let (x, y) = (place.x + cosine * ahead - sine * aside, place.y + sine * ahead + cosine * aside);
            (x, y, heading.map(|heading| heading - turned))
        };
        let seen = self.seen.iter().enumerate();
        self.seen = seen.map(|(i, pose)| if i < first { *pose } else { laid(*pose) }).collect();
        self.blocks[block].afresh = true;
    }

    /// Places the blocks, and the growth of the error between them, along the poses that a model predicts.
    fn lay_along(&mut self, chain: &Chain<f64>) {
        let walk = Walk::new(&self.track, chain);
        self.places = self.track.seen_after().iter().map(|made| walk.places[*made]).collect();
        let mut before = 0;
        for block in &mut self.blocks {
            let own = &self.track.seen_after()[block.first..block.first + block.count];
            let middle = own[(own.len() - 1) / 2];
            let mean = |of: fn(&Pose2) -> f64| own.iter().map(|i| of(&walk.places[*i])).sum::<f64>() / own.len() as f64;
            block.place = Pose2::new(mean(|p| p.x), mean(|p| p.y), mean(|p| p.heading));
            block.velocity = walk.velocity(&self.track, own);
            block.growth = walk.growth(before, middle);
            before = middle;
        }
    }

    /// Measured minus predicted poses, block by block.
    pub fn residuals(&self, chain: &Chain<f64>) -> Column {
        self.less(|seen| self.track.replay(chain, seen))
    }

    /// The same by the model that the run is laid along, whose chain is given: nothing is replayed.
    pub fn residuals_along(&self, chain: &Chain<f64>) -> Column {
        self.less(|seen| self.sighted(chain, seen))
    }

    fn less(&self, predicted: impl FnOnce(&mut dyn FnMut(usize, &Pose2))) -> Column {
        let mut sums = Sums::<1>::new(self);
        predicted(&mut |i, pose| sums.add_residual(i, pose));
        sums.of_lane(0)
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
        ((0..count).map(|lane| slopes.of_lane(lane)).collect(), left.of_lane(0))
    }

    /// The derivatives by numbers that change nothing but the measurement, beside the model that the run is laid along.
    pub fn columns_of_sight(&self, chain: &Chain<Dual>, count: usize) -> Vec<Column> {
        self.slopes(count, |seen| self.sighted(chain, seen))
    }

    fn slopes(&self, count: usize, predicted: impl FnOnce(&mut dyn FnMut(usize, &Pose2<Dual>))) -> Vec<Column> {
        let mut sums = Sums::<LANES>::new(self);
        predicted(&mut |i, pose| sums.add_slope(i, pose));
        (0..count).map(|lane| sums.of_lane(lane)).collect()
    }

    /// Calls `seen` with what is measured of each place.
    fn sighted<T: Evaluate>(&self, chain: &Chain<T>, seen: &mut dyn FnMut(usize, &Pose2<T>)) {
        for (index, (place, sight)) in self.places.iter().zip(self.track.sights()).enumerate() {
            seen(index, &chain.seen(sight, &place.lift()));
        }
    }

    /// Mean squared difference of successive residuals within blocks, halved: variance of one reference pose (position
    /// per coordinate \[m²\], heading \[rad²\]) and how many differences it was taken from. The chain is that of the model that the run
    /// is laid along.
    pub fn scatter_within_blocks(&self, chain: &Chain<f64>) -> [(f64, usize); 2] {
        let mut raw = Vec::with_capacity(self.seen.len());
        self.sighted(chain, &mut |i, pose| {
            let (x, y, heading) = self.seen[i];
            raw.push((x - pose.x, y - pose.y, heading.map(|h| wrap(h - pose.heading))));
        });
        let (mut position, mut heading) = ((0.0, 0), (0.0, 0));
        for block in &self.blocks {
            for pair in raw[block.first..block.first + block.count].windows(2) {
                let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
                position = (position.0 + 0.25 * (dx * dx + dy * dy), position.1 + 1);
                if let (Some(a), Some(b)) = (pair[0].2, pair[1].2) {
                    heading = (heading.0 + 0.5 * (b - a) * (b - a), heading.1 + 1);
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
        self.add(observation, [[x - pose.x], [y - pose.y]], heading.map(|h| [wrap(h - pose.heading)]));
    }
}

impl Sums<'_, LANES> {
    fn add_slope(&mut self, observation: usize, pose: &Pose2<Dual>) {
        self.add(observation, [pose.x.eps, pose.y.eps], self.run.seen[observation].2.map(|_| pose.heading.eps));
    }
}

/// Cuts the observations of a track into blocks.
fn blocks(track: &Track, seen: &[(f64, f64, Option<f64>)], chain: &Chain<f64>) -> Vec<Block> {
    let walk = Walk::new(track, chain);
    let whole = walk.way.last().copied().unwrap_or(0.0);
    let mut blocks: Vec<Block> = Vec::new();
    let mut first = 0;
    while first < seen.len() {
        let begins = track.seen_after()[first];
        let together = |made: &usize| {
            walk.way[*made] - walk.way[begins] < BLOCK.0 && walk.turned[*made] - walk.turned[begins] < BLOCK.1
        };
        let count = track.seen_after()[first..].iter().take_while(|made| together(made)).count().max(1);
        let unit = (UNITS * walk.way[begins] / whole.max(f64::MIN_POSITIVE)).min(UNITS - 1.0) as usize;
        let headings = seen[first..first + count].iter().filter(|s| s.2.is_some()).count();
        blocks.push(Block {
            first,
            count,
            headings,
            place: Pose2::IDENTITY,
            velocity: [0.0; 3],
            growth: Growth::default(),
            unit,
            afresh: false,
        });
        first += count;
    }
    blocks
}

/// Where a model has the robot after each piece, and how far it has gone and turned.
struct Walk {
    places: Vec<Pose2>,
    way: Vec<f64>,
    turned: Vec<f64>,
}

impl Walk {
    fn new(track: &Track, chain: &Chain<f64>) -> Walk {
        let (mut pose, mut way, mut turned) = (chain.start(), 0.0, 0.0);
        let mut walk = Walk { places: vec![pose], way: vec![way], turned: vec![turned] };
        for (travel, at) in track.travel().iter().zip(track.contexts()) {
            let motion = chain.displacement(&at.headed(pose.heading), travel);
            pose.advance(&motion);
            way += motion.forward.abs();
            turned += motion.rotation.abs();
            walk.places.push(pose);
            walk.way.push(way);
            walk.turned.push(turned);
        }
        walk
    }

    /// Mean rate of change of the pose over the pieces that end at some observations.
    fn velocity(&self, track: &Track, own: &[usize]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for made in own.iter().filter(|made| **made > 0) {
            let at = &track.contexts()[made - 1];
            let (sine, cosine) = libm::sincos(self.places[*made].heading);
            for (total, rate) in sum.iter_mut().zip([at.speed * cosine, at.speed * sine, at.turn_rate]) {
                *total += rate / own.len() as f64;
            }
        }
        sum
    }

    fn growth(&self, from: usize, to: usize) -> Growth {
        let mut growth = Growth { way: self.way[to] - self.way[from], ..Growth::default() };
        for piece in from..to {
            let (a, b) = (&self.places[piece], &self.places[piece + 1]);
            let g = [0.5 * (a.y + b.y), -0.5 * (a.x + b.x), 1.0];
            let outer = [g[0] * g[0], g[1] * g[0], g[1] * g[1], g[0], g[1], 1.0];
            let (way, turned) = (self.way[piece + 1] - self.way[piece], self.turned[piece + 1] - self.turned[piece]);
            let (sine, cosine) = libm::sincos(0.5 * (a.heading + b.heading));
            for (sum, product) in growth.forward.iter_mut().zip([cosine * cosine, cosine * sine, sine * sine]) {
                *sum += way * product;
            }
            for (k, product) in outer.into_iter().enumerate() {
                growth.heading_per_metre[k] += way * product;
                growth.heading_per_radian[k] += turned * product;
            }
        }
        growth
    }
}
