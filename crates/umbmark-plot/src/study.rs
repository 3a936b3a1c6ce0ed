//! Everything that is known of a dataset beside one model, each part worked out when it is first asked for.

mod chance;
mod drives;
mod paths;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use umbmark_core::calibrate::{self, Calibration, Estimate, Method, calibrate};
use umbmark_core::compare::tracks::TrackErrors;
use umbmark_core::compare::{Comparison, compare_returns, track_errors};
use umbmark_core::conditions::{Conditions, conditions};
use umbmark_core::dataset::{Dataset, ReturnError};
use umbmark_core::diagnose::{self, Diagnosis, diagnose};
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::geometry::wrap;
use umbmark_core::inspect::Inspection;
use umbmark_core::learn::Learnt;
use umbmark_core::path::Direction;
use umbmark_core::replay::Track;
use umbmark_core::score::{Score, score_dataset};
use umbmark_core::solve::{Solution, solve};
use umbmark_core::watch::Watch;

pub use chance::Chance;
pub use drives::{Driven, Drives};
pub use paths::{Paths, RunPath};

/// Why something cannot be drawn, in a sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Absent(pub String);

impl Absent {
    pub(crate) fn because(why: impl std::fmt::Display) -> Absent {
        Absent(why.to_string())
    }
}

/// How a study is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Of all tests and simulations; 1 - `size` is the probability that intervals hold with.
    pub diagnose: diagnose::Options,
    /// Simulated tests of the model.
    pub trials: u64,
}

impl Default for Options {
    fn default() -> Options {
        Options { diagnose: diagnose::Options::default(), trials: 1000 }
    }
}

/// A dataset and a model of its robot: one that was given, or the one that the dataset teaches.
#[derive(Debug)]
pub struct Study {
    /// Its name.
    pub name: String,
    /// The runs.
    pub data: Arc<Dataset>,
    /// The model that was given, with its name.
    pub given: Option<(String, Model)>,
    /// How.
    pub options: Options,
    inspection: OnceLock<Inspection>,
    score: OnceLock<Result<Score, Absent>>,
    calibration: OnceLock<Result<Calibration, Absent>>,
    solution: OnceLock<Result<Solution, Absent>>,
    diagnosis: OnceLock<Result<Diagnosis, Absent>>,
    conditions: OnceLock<Result<Conditions, Absent>>,
    comparison: OnceLock<Result<Comparison, Absent>>,
    along: OnceLock<Result<Vec<TrackErrors>, Absent>>,
    chance: OnceLock<Result<Chance, Absent>>,
    paths: OnceLock<Result<Paths, Absent>>,
    stop: Arc<AtomicBool>,
    cut_short: AtomicBool,
}

impl Study {
    /// A study of a dataset; nothing is worked out yet.
    pub fn new(
        name: impl Into<String>,
        data: impl Into<Arc<Dataset>>,
        given: Option<(String, Model)>,
        options: Options,
    ) -> Study {
        Study {
            name: name.into(),
            data: data.into(),
            given,
            options,
            inspection: OnceLock::new(),
            score: OnceLock::new(),
            calibration: OnceLock::new(),
            solution: OnceLock::new(),
            diagnosis: OnceLock::new(),
            conditions: OnceLock::new(),
            comparison: OnceLock::new(),
            along: OnceLock::new(),
            chance: OnceLock::new(),
            paths: OnceLock::new(),
            stop: Arc::default(),
            cut_short: AtomicBool::new(false),
        }
    }

    /// The same study, of which nothing further is worked out once `stop` is set.
    pub fn stopped_by(self, stop: &Arc<AtomicBool>) -> Study {
        Study { stop: Arc::clone(stop), ..self }
    }

    /// Whether something was left out because it was stopped.
    pub fn is_partial(&self) -> bool {
        self.cut_short.load(Ordering::Relaxed)
    }

    /// Refuses to begin where it was stopped.
    pub(crate) fn begin(&self) -> Result<(), Absent> {
        if self.stop.load(Ordering::Relaxed) {
            self.cut_short.store(true, Ordering::Relaxed);
            return Err(Absent("The work was stopped before this part was finished.".into()));
        }
        Ok(())
    }

    /// The value of a part, worked out once.
    fn once<'a, T>(
        &self,
        cell: &'a OnceLock<Result<T, Absent>>,
        work: impl FnOnce() -> Result<T, Absent>,
    ) -> Result<&'a T, Absent> {
        if cell.get().is_none() {
            self.begin()?;
        }
        cell.get_or_init(work).as_ref().map_err(Clone::clone)
    }

    /// How the model was learnt; `progress` is told the share of the steps that are done.
    pub fn learn(&self, progress: &(dyn Fn(f64) + Sync)) -> Result<&Learnt, Absent> {
        self.solve(progress).map(|solution| &solution.learnt)
    }

    /// The one answer about the robot, from the model that was learnt.
    pub fn solution(&self) -> Result<&Solution, Absent> {
        self.solve(&|_| ())
    }

    fn solve(&self, progress: &(dyn Fn(f64) + Sync)) -> Result<&Solution, Absent> {
        if let Some((name, _)) = &self.given {
            return Err(Absent(format!("The model was given ({name}), not learnt.")));
        }
        self.once(&self.solution, || {
            let start = Model::new(self.data.nominal_robot().map_err(Absent::because)?);
            let watch = Watch::new(&self.stop, progress);
            let solution = solve(&self.data, &start, &self.options.diagnose, &watch).map_err(Absent::because)?;
            self.cut_short.fetch_or(solution.learnt.partial, Ordering::Relaxed);
            Ok(solution)
        })
    }

    /// The probability that intervals hold with.
    pub fn level(&self) -> f64 {
        1.0 - self.options.diagnose.size
    }

    /// What the dataset holds.
    pub fn inspection(&self) -> &Inspection {
        self.inspection.get_or_init(|| self.data.inspect())
    }

    /// The scores of the test.
    pub fn score(&self) -> Result<&Score, Absent> {
        self.once(&self.score, || score_dataset(&self.data, self.level()).map_err(Absent::because))
    }

    /// The calibration.
    pub fn calibration(&self) -> Result<&Calibration, Absent> {
        let work = || calibrate(&self.data, &calibrate::Options::default()).map_err(Absent::because);
        self.once(&self.calibration, work)
    }

    /// The exact fit of the calibration.
    pub fn exact(&self) -> Option<&Estimate> {
        self.calibration().ok()?.estimate(Method::Exact)
    }

    /// How the model was learnt.
    pub fn learnt(&self) -> Result<&Learnt, Absent> {
        self.learn(&|_| ())
    }

    /// What the model is missing.
    pub fn diagnosis(&self) -> Result<&Diagnosis, Absent> {
        match &self.given {
            None => self.learnt().map(|learnt| &learnt.diagnosis),
            Some((_, model)) => self
                .once(&self.diagnosis, || diagnose(&self.data, model, &self.options.diagnose).map_err(Absent::because)),
        }
    }

    /// Which numbers of the model, or of the usual first one, depend on the conditions of the runs.
    pub fn conditions(&self) -> Result<&Conditions, Absent> {
        self.once(&self.conditions, || {
            let model = match &self.given {
                Some((_, model)) => model.clone(),
                None => diagnose::first_model(&self.data).map_err(Absent::because)?,
            };
            let watch = Watch::new(&self.stop, &|_| ());
            let found = conditions(&self.data, &model, &self.options.diagnose, &watch);
            found.map_err(|why| Absent(format!("No conditions are compared: {why}.")))
        })
    }

    /// The model with its fitted parameters.
    pub fn model(&self) -> Result<&Model, Absent> {
        self.diagnosis().map(|diagnosis| &diagnosis.model)
    }

    /// What the model is called in sentences.
    pub fn model_name(&self) -> &str {
        self.given.as_ref().map_or("the learnt model", |(name, _)| name)
    }

    /// The nominal robot and the model, named.
    fn models(&self) -> Result<[(String, Model); 2], Absent> {
        let nominal = Model::new(self.data.nominal_robot().map_err(Absent::because)?);
        Ok([("nominal robot".to_owned(), nominal), (self.model_name().to_owned(), self.model()?.clone())])
    }

    /// The nominal robot and the model beside the return poses.
    pub fn comparison(&self) -> Result<&Comparison, Absent> {
        let work = || compare_returns(&self.data, &self.models()?, &self.options.diagnose).map_err(Absent::because);
        self.once(&self.comparison, work)
    }

    /// The errors of the nominal robot and of the model on the tracks.
    pub fn along(&self) -> Result<&[TrackErrors], Absent> {
        let work = || {
            let along = track_errors(&self.data, &self.models()?, &self.options.diagnose).map_err(Absent::because)?;
            match along.iter().flat_map(|errors| &errors.residuals).all(|run| run.measured.is_empty()) {
                true => Err(Absent("The runs were measured at their ends only, not on the way.".into())),
                false => Ok(along),
            }
        };
        self.once(&self.along, work).map(Vec::as_slice)
    }

    /// Simulated tests of the model.
    pub fn chance(&self) -> Result<&Chance, Absent> {
        self.once(&self.chance, || Chance::new(self))
    }

    /// Paths of the runs as measured, computed and modelled.
    pub fn paths(&self) -> Result<&Paths, Absent> {
        self.once(&self.paths, || Paths::new(self))
    }

    /// Return errors of a test and direction, each with the index of its run.
    pub fn returns(&self, test: TestKind, direction: Direction) -> Vec<(usize, ReturnError)> {
        let fits = |run: &umbmark_core::dataset::Run| run.test == test && run.direction == Some(direction);
        let runs = self.data.runs.iter().enumerate().filter(|(_, run)| fits(run));
        runs.filter_map(|(index, run)| Some((index, run.returned?))).collect()
    }

    /// Numbers of regular runs that returned, clockwise and counter-clockwise.
    pub fn counts(&self) -> [usize; 2] {
        Direction::BOTH.map(|direction| self.returns(TestKind::Systematic, direction).len())
    }

    /// The return error that the model predicts, without chance; `None` where path or model are not known.
    pub fn predicted_return(&self, direction: Direction) -> Option<ReturnError> {
        let (model, path) = (self.model().ok()?, self.data.path.as_ref()?);
        let end = Track::in_pieces(path, direction, model.robot()).end(&model.chain());
        let told = path.end(direction);
        Some(ReturnError { x: end.x - told.x, y: end.y - told.y, heading: Some(wrap(end.heading - told.heading)) })
    }
}
