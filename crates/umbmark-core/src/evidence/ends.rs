//! Return poses as evidence: what was measured, in the frame in which both directions scatter alike.
//!
//! The noise of a robot's wheels mirrors with its path, so clockwise runs are mirrored (M = diag(1, -1, -1)) and the scatter
//! of both directions is pooled, with ν = n_cw + n_ccw - 2 degrees of freedom.

mod fitted;

use super::{Drive, Evidence, Fit, FitError, Level, correlations, end_poses, noise_shape, robot_of};
use crate::dataset::{Dataset, Levels};
use crate::drive::Robot;
use crate::effect::{Evaluate, Model, ModelError};
use crate::geometry::{Pose2, wrap};
use crate::likelihood::Knowledge;
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::setup::{Fault, Setup, Suspicion};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

pub(crate) use fitted::{Fitted, names};

/// Minimum number of runs in each direction for any test.
pub(crate) const FEWEST_RUNS: usize = 3;

/// A run comes back that ends within this share of its way from where it began.
const NEAR: f64 = 0.15;

/// Return poses, ready to be predicted.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    pub robot: Robot,
    pub path: Option<Path>,
    pub runs: Vec<End>,
    tracks: Vec<Arc<Believed>>,
    pub with_heading: bool,
    /// The conditions of the runs, by their names.
    pub conditions: Arc<[Levels]>,
    /// What was found of the data, where it was [examined](Ends::examined).
    pub setup: Arc<Setup>,
    /// Why these return errors are doubtful.
    pub doubts: Vec<Suspicion>,
    /// What is known of the numbers of a model besides the runs.
    knowledge: Arc<Knowledge>,
}

/// One run.
#[derive(Clone, Debug)]
pub(crate) struct End {
    /// Its name.
    pub name: String,
    /// The path's sense; runs of paths without one count as counter-clockwise.
    pub direction: Direction,
    /// Index of the track that the odometry reports.
    track: usize,
    /// Absolute pose at the end.
    seen: Pose2,
    /// Multiplies observed minus predicted: the inverse Cholesky factor of the scatter's shape.
    pub weight: Matrix3<f64>,
}

/// The track that the odometry reports, cut into the largest pieces that the effects allow.
#[derive(Debug)]
struct Believed {
    whole: Arc<Track>,
    /// `None` for a recorded track, which is already in small pieces.
    pieces: Option<Track>,
}

impl Believed {
    fn track(&self, varies: bool) -> &Track {
        self.pieces.as_ref().filter(|_| varies).unwrap_or(&self.whole)
    }
}

impl Ends {
    pub fn new(data: &Dataset) -> Result<Ends, FitError> {
        let robot = robot_of(data)?.clone();
        let drives = end_poses(data, &robot)?;
        let with_heading = drives.iter().all(|d| d.seen.iter().all(|s| s.heading.is_some()));
        let mut ends = Ends {
            robot,
            path: data.path.clone(),
            runs: Vec::new(),
            tracks: Vec::new(),
            with_heading,
            conditions: Levels::of(data).into(),
            setup: Arc::default(),
            doubts: Vec::new(),
            knowledge: Arc::default(),
        };
        for drive in drives {
            ends.push(drive);
        }
        Ok(ends)
    }

    /// The return poses of a dataset, with what is found of them before any fit.
    pub fn examined(data: &Dataset) -> Result<Ends, FitError> {
        let ends = Ends::new(data)?;
        let setup = Setup::of(&data.runs, &ends.robot, data.path.as_ref());
        let doubts = setup.suspicions(&data.runs);
        Ok(Ends { setup: Arc::new(setup), doubts, ..ends })
    }

    /// Whether the robot came back to START: it was told a path, or most runs end near where they began.
    pub fn come_back(&self) -> bool {
        let near = |end: &&End| {
            let way = self.tracks[end.track].whole.length();
            libm::hypot(end.seen.x, end.seen.y) <= NEAR * way
        };
        self.path.is_some() || 2 * self.runs.iter().filter(near).count() > self.runs.len()
    }

    fn push(&mut self, drive: Drive) {
        let direction = drive.direction.unwrap_or(Direction::Ccw);
        let Some(seen) = drive.seen.last() else { return };
        let known = self.tracks.iter().position(|t| drive.rolls_as(&t.whole));
        let track = known.unwrap_or_else(|| {
            let path = self.path.as_ref().filter(|_| !drive.recorded);
            let pieces = path.map(|path| Track::in_pieces(path, direction, &self.robot));
            self.tracks.push(Arc::new(Believed { whole: drive.track, pieces }));
            self.tracks.len() - 1
        });
        let seen = Pose2::new(seen.x, seen.y, seen.heading.unwrap_or(0.0));
        self.runs.push(End { name: drive.name, direction, track, seen, weight: drive.weight });
    }

    /// Whether the ticks of some run were recorded.
    pub fn is_recorded(&self) -> bool {
        self.tracks.iter().any(|track| track.pieces.is_none())
    }

    /// The same runs, with the ticks of the commanded path if it is known.
    fn as_meant(&self) -> Ends {
        let Some(path) = &self.path else { return self.clone() };
        // What was not recorded is taken to be what was meant.
        if !self.is_recorded() {
            return self.clone();
        }
        let meant = |direction: Direction| Believed {
            whole: Arc::new(Track::from_path(path, direction, &self.robot)),
            pieces: Some(Track::in_pieces(path, direction, &self.robot)),
        };
        let mut ends = self.clone();
        ends.tracks = Direction::BOTH.map(|direction| Arc::new(meant(direction))).into();
        ends.runs.iter_mut().for_each(|run| run.track = run.direction as usize);
        ends
    }

    /// Some of its runs, by their places.
    pub fn only(&self, runs: &[usize]) -> Ends {
        Ends { runs: runs.iter().map(|run| self.runs[*run].clone()).collect(), ..self.clone() }
    }

    /// How many coordinates an end pose has: 3, or 2 where headings were not measured.
    pub fn coordinates(&self) -> usize {
        if self.with_heading { 3 } else { 2 }
    }

    /// Number of runs clockwise and counter-clockwise.
    pub fn counts(&self) -> [usize; 2] {
        Direction::BOTH.map(|direction| self.runs.iter().filter(|run| run.direction == direction).count())
    }

    /// Whether both directions were driven often enough for a test.
    pub fn enough(&self) -> bool {
        self.counts().iter().all(|n| *n >= FEWEST_RUNS)
    }

    /// Tracks that differ, cut as the model needs it.
    pub fn tracks(&self, varies: bool) -> Vec<&Track> {
        self.tracks.iter().map(|t| t.track(varies)).collect()
    }

    /// Turns one value per track into one value per run.
    pub fn of_runs<'a, T>(&'a self, of_tracks: &'a [T]) -> impl Iterator<Item = (Direction, &'a T)> + 'a {
        self.runs.iter().map(|run| (run.direction, &of_tracks[run.track]))
    }

    /// Predicted end pose of every run, with values or derivatives.
    pub fn predict<T: Evaluate>(&self, model: &Model, values: &[T]) -> Vec<Pose2<T>> {
        let chain = model.chain_with(values);
        let varies = model.may_vary();
        let ends: Vec<Pose2<T>> = self.tracks.iter().map(|t| t.track(varies).end(&chain)).collect();
        self.runs.iter().map(|run| ends[run.track]).collect()
    }

    /// Observed minus predicted, run by run; heading 0 where it was not measured.
    pub fn residuals(&self, model: &Model) -> Vec<Vector3<f64>> {
        let values: Vec<f64> = model.values().collect();
        let predicted = self.predict::<f64>(model, &values);
        self.runs.iter().zip(predicted).map(|(run, pose)| self.residual(run, &pose)).collect()
    }

    fn residual(&self, run: &End, predicted: &Pose2) -> Vector3<f64> {
        let heading = if self.with_heading { wrap(run.seen.heading - predicted.heading) } else { 0.0 };
        Vector3::new(run.seen.x - predicted.x, run.seen.y - predicted.y, heading)
    }

    /// Return errors, absolute minus computed with the nominal robot, run by run.
    pub fn errors(&self) -> Vec<Vector3<f64>> {
        self.residuals(&Model::new(&self.robot))
    }

    /// The shape of the scatter of counter-clockwise runs with evenly noisy wheels.
    pub fn noise_shape(&self) -> Option<Matrix3<f64>> {
        let run = self.runs.iter().find(|run| run.direction == Direction::Ccw)?;
        Some(noise_shape::end_covariance(self.tracks[run.track].track(false), &self.robot.drive))
    }
}

impl Evidence for Ends {
    fn level(&self) -> Level {
        Level::Ends
    }

    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn setup(&self) -> &Arc<Setup> {
        &self.setup
    }

    fn faults(&self) -> Vec<Fault> {
        self.setup.all_faults().cloned().collect()
    }

    fn check(&self, model: &Model) -> Result<(), ModelError> {
        self.tracks(model.varies()).into_iter().try_for_each(|track| track.check(model))
    }

    fn know(&mut self, knowledge: Knowledge) {
        self.knowledge = Arc::new(knowledge);
    }

    fn fit(&self, model: &Model) -> Result<Fit, FitError> {
        self.check_columns()?;
        let fitted = Fitted::new(self, model)?;
        let leaves = fitted.leaves(self);
        let Fitted { model, estimates, covariance, ended, held, .. } = fitted;
        let correlations = correlations(covariance.as_ref());
        let (setup, knowledge) = (Arc::clone(&self.setup), Arc::clone(&self.knowledge));
        Ok(Fit {
            model,
            estimates,
            correlations,
            noise: None,
            outliers: Vec::new(),
            usual_noise: false,
            setup,
            taken: Vec::new(),
            ended,
            leaves,
            knowledge,
            held,
            without_priors: Vec::new(),
        })
    }
}

/// Components of a pose difference as seen in a counter-clockwise run.
pub(crate) fn mirrored(direction: Direction, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, direction.sign() * v.y, direction.sign() * v.z)
}
