//! Recorded runs with the poses that were measured on the way, gathered into blocks.

mod blocks;
mod columns;
mod drifts;
mod laid;
mod pieces;
mod readings;
mod resolution;
mod starts;
mod steps;
mod uneven;
mod walk;

use super::knowledge::Knowledge;
use crate::dataset::{Dataset, Levels};
use crate::drive::Robot;
use crate::effect::{Chain, Model, RunContext, TestKind};
use crate::geometry::{Pose2, wrap};
use crate::path::{Direction, Path};
use crate::replay::{Moment, ReplayError, Track};
use crate::run::{Run, StartKnown};
use crate::setup::{RunSetup, Setup};
pub use drifts::Gyro;
pub use starts::Stretch;

pub(crate) use blocks::BLOCK;
use blocks::blocks;
use rayon::prelude::*;
use std::sync::Arc;

/// START poses closer to each other than this \[m, rad\] are the same mark on the floor.
const ONE_PLACE: (f64, f64) = (0.10, 0.10);
/// A pose counts as measured at START if the robot had moved less than this \[m\].
const AT_START: f64 = 0.03;
/// A delay that the motion of a run shows is known where it is this multiple of its standard error.
const KNOWN: f64 = 2.0;
/// Minimum number of blocks of a run.
const FEWEST: usize = 3;

/// One (x, y, heading) per block.
pub type Column = Vec<[f64; 3]>;

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
    /// Of a gyro, the variance that its own noise adds to the heading, times g gᵀ \[rad²\].
    pub heading_by_gyro: [f64; 6],
    /// Σ dr f fᵀ over the pieces, f the direction of the heading: xx, xy, yy.
    pub forward: [f64; 3],
    /// Way driven \[m\].
    pub way: f64,
    /// Mean way of both wheels, Σ dr \[m\]: also in turns on the spot the wheels slip, and move the axle.
    pub rolled: f64,
}

/// Neighbouring observations of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its first observation.
    pub first: usize,
    /// How many there are.
    pub count: usize,
    /// How many of them have a position.
    pub positions: usize,
    /// How many of them have a heading.
    pub headings: usize,
    /// Mean predicted position of the tracked point, and mean predicted heading of the robot.
    pub place: Pose2,
    /// Mean rate of change of the predicted pose of what is tracked \[m/s, m/s, rad/s\].
    pub velocity: [f64; 3],
    /// How a gyro's heading moves here for what it adds in the run, see [`Gyro`]; else zero.
    pub drifts: [[f64; 3]; 2],
    /// Variance that a gyro's own noise adds to the heading since the block before \[rad²\].
    pub wander: f64,
    /// How the error grows from the last observation of the previous block to the last of this one.
    pub growth: Growth,
    /// The same, each piece weighted by the share of the block's observations that see it: the covariance of what is added to the error
    /// until its end with what is added to the mean of its observations.
    pub growth_seen: Growth,
    /// The same, weighted by the square of that share: the covariance of what is added to the mean.
    pub growth_of_mean: Growth,
    /// Which quarter of the way it lies in, from 0.
    pub unit: usize,
    /// Whether the run restarts here, because what happened before it was not noise; see
    /// [`Outlier`](super::Outlier) and [`Jump`](crate::setup::Jump).
    pub afresh: bool,
    /// Whether the track jumps before it.
    pub jumped: bool,
    /// Variances of the reference in it, in units of those of one measurement: how many steps are added up to it where the reference tells
    /// motion only, else 1.
    pub steps: f64,
    /// Variances of the mean of its observations that the resolution of the counters gives: of a coordinate \[m²\] and of the heading
    /// \[rad²\].
    pub resolution: [f64; 2],
    /// How far its observations are from the predicted poses, in the mean, because the wheels did not turn evenly between readings
    /// \[m, m, rad\].
    pub beside: [f64; 3],
}

/// A run, ready to be predicted.
#[derive(Clone, Debug)]
pub struct ObservedRun {
    /// Its name.
    pub name: String,
    /// The name of the run whose log it is, or is a piece of.
    pub log: String,
    /// Its sense.
    pub direction: Option<Direction>,
    /// Its believed travel.
    pub track: Arc<Track>,
    /// Measured poses without the wrong ones: x, y \[m\] and, where it was measured, heading \[rad\].
    pub measured: Arc<[(f64, f64, Option<f64>)]>,
    /// The same, aligned with the prediction where the run starts and restarts.
    pub seen: Arc<[(f64, f64, Option<f64>)]>,
    /// The moments of the observations, by the model about which the run is linearised.
    pub moments: Arc<[Moment]>,
    /// True poses at these moments, by the same model.
    pub places: Arc<[Pose2]>,
    /// The poses in blocks.
    pub blocks: Vec<Block>,
    /// Whether terms of second order in heading errors are removed from the residuals, as in a fit near its optimum.
    pub linear: bool,
    /// Whether the pose at START was measured or follows from the poses; otherwise the frame is trusted.
    pub start_seen: bool,
    /// Whether the reference tells only the motion from each block to the next. Residuals and derivatives are then those of this motion,
    /// turned into the frame of the room, and zero in the first block and where the run restarts.
    pub relative: bool,
    /// Whether the reference tells headings only. Residuals and derivatives of positions are then zero.
    pub headings_only: bool,
    /// Of a gyro, what is known of it before the fit.
    pub gyro: Option<Gyro>,
    /// How far the left and the right wheel roll in one count \[m\]; 0 where readings are not whole counts.
    pub counts: [f64; 2],
    /// Nominal distance of the wheels \[m\].
    pub wheelbase: f64,
    /// Times at which the counters were read, since the log began \[s\]; none of a run that was not recorded.
    pub readings: Arc<[f64]>,
}

/// All runs of the regular test that were observed on the way.
#[derive(Clone, Debug)]
pub struct Observed {
    /// The nominal robot.
    pub robot: Robot,
    /// The runs, in the order of the dataset; a long one in pieces.
    pub runs: Vec<ObservedRun>,
    /// The path that all of them were to follow, where it is known.
    pub path: Option<Path>,
    /// What was found of the experiment before anything was fitted.
    pub setup: Arc<Setup>,
    /// The conditions of the runs, by the names of their logs.
    pub conditions: Arc<[Levels]>,
    /// What is known of the numbers of a model besides the runs.
    pub knowledge: Arc<Knowledge>,
}

impl Observed {
    /// Gathers the runs of a dataset that have ticks and absolute poses in at least three places. Wrong poses are left out, and those
    /// between slow readings of counters that did not turn evenly. Runs whose clocks differ are each laid on their own. Runs restart where
    /// their track jumps, and long runs are cut into pieces.
    pub fn new(data: &Dataset, robot: &Robot) -> Result<Observed, ReplayError> {
        let (laid, setup) = Setup::on_own_clocks(&data.runs, robot, data.path.as_ref());
        let mut runs = Vec::new();
        let (mut session_distance, mut before, mut first_start) = (0.0, 0, None);
        for (index, run) in laid.iter().enumerate() {
            if data.begins_session(index) {
                (session_distance, before) = (0.0, runs.len());
            }
            if run.test != TestKind::Systematic {
                continue;
            }
            let place = RunContext { run: runs.len() - before, session_distance, direction: run.direction };
            let origin = run.log.as_ref().map_or(Pose2::IDENTITY, |log| match log.start.known {
                StartKnown::Given => Pose2::IDENTITY,
                _ => in_one_room(first_start.get_or_insert(log.start.pose()), &log.start.pose()),
            });
            if let Some(observed) = ObservedRun::new(run, robot, place, setup.of_run(&run.name), origin)? {
                session_distance += observed.track.length();
                runs.push(observed);
            }
        }
        let runs = pieces::cut(runs, robot);
        let conditions = Levels::of(data).into();
        let (robot, path, setup) = (robot.clone(), data.path.clone(), Arc::new(setup));
        Ok(Observed { robot, runs, path, setup, conditions, knowledge: Arc::default() })
    }

    /// Believed travel of the runs.
    pub fn tracks(&self) -> impl Iterator<Item = &Track> {
        self.runs.iter().map(|run| run.track.as_ref())
    }

    /// Smallest and largest x and y of what the reference measured, in its own frame; `None` where it measured no positions.
    pub(crate) fn extent(&self) -> Option<[[f64; 2]; 2]> {
        let of_run = |run: &ObservedRun| {
            let positions = if run.headings_only || run.relative { &[] } else { &run.measured[..] };
            let room = run.track.sights().first().and_then(|sight| sight.room).unwrap_or(Pose2::IDENTITY);
            let in_room = move |(x, y, _): &(f64, f64, Option<f64>)| room.compose(&Pose2::new(*x, *y, 0.0));
            positions.iter().map(in_room).collect::<Vec<_>>()
        };
        let places = self.runs.iter().flat_map(of_run);
        places.fold(None, |extent, Pose2 { x, y, .. }| {
            let [least, most] = extent.unwrap_or([[x, y]; 2]);
            Some([[least[0].min(x), least[1].min(y)], [most[0].max(x), most[1].max(y)]])
        })
    }

    /// The same runs as they were measured, restarting only where the track jumps.
    pub(crate) fn whole(&self) -> Observed {
        let mut observed = self.clone();
        observed.runs.iter_mut().for_each(|run| run.linear = false);
        observed.runs.iter_mut().flat_map(|run| &mut run.blocks).for_each(|block| block.afresh = block.jumped);
        observed
    }

    /// Mean duration of the pieces that long runs were cut into \[s\], where there are any.
    pub(crate) fn piece(&self) -> Option<f64> {
        let pieces = self.runs.iter().filter(|run| run.name != run.log);
        let (sum, count) = pieces.fold((0.0, 0), |(sum, count), piece| (sum + pieces::duration(piece), count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Whether a heading was measured anywhere.
    pub(crate) fn has_headings(&self) -> bool {
        self.runs.iter().any(|run| run.blocks.iter().any(|block| block.headings > 0))
    }

    /// Whether the runs turn: where they do not, rotations and turn rates are single counts.
    pub(crate) fn turns(&self) -> bool {
        self.setup.mounting.is_none_or(|mounting| mounting.turns)
    }

    /// The same runs in pieces of about so many seconds, each with its own START.
    pub(super) fn in_pieces(&self, seconds: f64) -> Observed {
        let runs = self.runs.iter().flat_map(|run| pieces::of_about(run, seconds, &self.robot)).collect();
        Observed { runs, ..self.clone() }
    }

    /// The same runs, with the noise growing along the poses that `model` predicts.
    ///
    /// A rotation error moves the robot perpendicular to its true path; computed for a path that is a degree off, it would seem to move it
    /// along the path.
    pub fn along(&self, model: &Model) -> Observed {
        let chain = model.chain();
        let mut observed = self.clone();
        observed.runs.par_iter_mut().for_each(|run| run.lay_along(&chain));
        observed
    }
}

/// A START pose in the frame of the first one of the session. Poses near the same mark count as the same place, because robots are placed
/// by hand.
fn in_one_room(first: &Pose2, start: &Pose2) -> Pose2 {
    let seen = first.between(start);
    let seen = Pose2::new(seen.x, seen.y, wrap(seen.heading));
    let near = libm::hypot(seen.x, seen.y) <= ONE_PLACE.0 && seen.heading.abs() <= ONE_PLACE.1;
    if near { Pose2::IDENTITY } else { seen }
}

/// What was measured of a run.
struct Seen<'a> {
    measured: Arc<[(f64, f64, Option<f64>)]>,
    jumps: &'a [usize],
    start_seen: bool,
    /// Of a reference that tells motion only, how many of its steps are added up to each measurement; empty of others.
    added: Vec<f64>,
    headings_only: bool,
    gyro: Option<Gyro>,
    counts: [f64; 2],
    readings: Arc<[f64]>,
}

impl ObservedRun {
    fn new(
        run: &Run,
        robot: &Robot,
        place: RunContext,
        found: Option<&RunSetup>,
        origin: Pose2,
    ) -> Result<Option<ObservedRun>, ReplayError> {
        let Some(log) = &run.log else { return Ok(None) };
        let late =
            found.and_then(|found| found.delay).filter(|delay| delay.is_beyond(KNOWN)).map_or(0.0, |delay| delay.value);
        let uneven = readings::between_readings(log, robot, late);
        let is_lost = |pose: usize| uneven[pose] || found.is_some_and(|found| found.is_lost(pose));
        let mut kept: Vec<usize> = (0..log.reference.len()).filter(|pose| !is_lost(*pose)).collect();
        let relative = log.relative && !log.headings_only;
        if relative {
            kept = steps::apart(log, robot, &kept);
        }
        let samples = kept.iter().map(|pose| log.reference[*pose].sample);
        let room = log.start.pose().compose(&origin.inverse());
        let track = Track::from_log_seen(log, robot, place, samples)?.beginning_at(origin).seen_in(room);
        let in_room = |pose: &usize| {
            let r = &log.reference[*pose];
            if origin == Pose2::IDENTITY {
                return (r.x, r.y, r.heading);
            }
            let at = origin.compose(&Pose2::new(r.x, r.y, r.heading.unwrap_or(0.0)));
            (at.x, at.y, r.heading.map(|_| at.heading))
        };
        let measured: Arc<[_]> = kept.iter().map(in_room).collect();
        let jumps = found.iter().flat_map(|found| &found.jumps);
        let jumps: Vec<usize> = jumps.map(|jump| kept.partition_point(|pose| *pose < jump.pose)).collect();
        let at_start = track.seen_after().first().is_some_and(|made| track.way_before(*made) < AT_START);
        let start_seen = at_start || log.start.known == StartKnown::OnTheWay;
        let added: Vec<f64> = if relative { steps::added_up(&kept) } else { Vec::new() };
        let readings = (0..log.time.len()).filter(|sample| !log.is_put_in(*sample));
        let readings = readings.map(|sample| log.time[sample] - log.time[0]).collect();
        let (counts, headings_only, gyro) = (log.count_lengths(robot), log.headings_only, Gyro::of(log));
        let seen = Seen { measured, jumps: &jumps, start_seen, added, headings_only, gyro, counts, readings };
        let observed = ObservedRun::laid(&run.name, run.direction, track, seen, &Model::new(robot));
        Ok((observed.blocks.len() >= FEWEST).then_some(observed))
    }

    /// A run yet to be driven, as a model predicts it; it will be measured as another one was.
    pub fn planned(track: Track, direction: Direction, like: &ObservedRun, model: &Model) -> ObservedRun {
        let headings = like.blocks.iter().any(|block| block.headings > 0);
        let measured = track.sights().iter().map(|_| (0.0, 0.0, headings.then_some(0.0))).collect();
        let added = if like.relative { vec![1.0; track.sights().len()] } else { Vec::new() };
        let ObservedRun { headings_only, gyro, .. } = *like;
        let (counts, readings) = ([0.0; 2], [].into());
        let seen = Seen { measured, jumps: &[], start_seen: true, added, headings_only, gyro, counts, readings };
        ObservedRun::laid("", Some(direction), track, seen, model)
    }

    /// A run in blocks, linearised about a model. No block contains observations from both sides of a jump.
    fn laid(
        name: &str,
        direction: Option<Direction>,
        track: Track,
        Seen { measured, jumps, start_seen, added, headings_only, gyro, counts, readings }: Seen,
        model: &Model,
    ) -> ObservedRun {
        let chain = model.chain();
        let relative = !added.is_empty();
        let mut blocks = blocks(&track, &measured, jumps, (&chain, relative));
        blocks.iter_mut().zip(&added).for_each(|(block, steps)| block.steps = *steps);
        blocks.iter_mut().filter(|_| headings_only).for_each(|block| block.positions = 0);
        let (name, log, track, seen) = (name.to_owned(), name.to_owned(), Arc::new(track), Arc::clone(&measured));
        let (moments, places) = ([].into(), [].into());
        let mut observed = ObservedRun {
            name,
            log,
            direction,
            track,
            measured,
            seen,
            moments,
            places,
            blocks,
            linear: false,
            start_seen,
            relative,
            headings_only,
            gyro,
            counts,
            wheelbase: model.robot().drive.wheelbase(),
            readings,
        };
        observed.resolve();
        observed.let_drift();
        observed.lay_along(&chain);
        observed
    }

    /// Restarts the run at a block.
    pub(super) fn start_afresh(&mut self, block: usize, chain: &Chain<f64>) {
        self.blocks[block].afresh = true;
        self.lay_measured(chain);
    }

    /// Position of each block along the run \[m\]: distance driven, plus travel of the wheels in turns.
    pub fn rolled(&self, wheelbase: f64) -> Vec<f64> {
        let along = |way: &mut f64, block: &Block| {
            *way += block.growth.way + 0.5 * wheelbase * block.growth.heading_per_radian[5];
            Some(*way)
        };
        self.blocks.iter().scan(0.0, along).collect()
    }

    /// How many pieces of the track, and which share of the next, are made on the mean of a block's observations.
    pub fn made_at(&self, block: &Block) -> f64 {
        let moments = &self.moments[block.first..block.first + block.count];
        moments.iter().map(Moment::reached).sum::<f64>() / moments.len() as f64
    }
}
