//! `mc`: studies and what is known of them.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Instant;

use numpy::PyArray1;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyFloat};
use umbmark_cli::told;
use umbmark_core::engine::Update;
use umbmark_core::monte_carlo::{self as core, Batch, Metric, Shard, Statistics};
use umbmark_core::replay::check_on_path;
use umbmark_core::result::{self, MonteCarlo, NoiseFree, Told};
use umbmark_core::simulate::{Odometry, Phase};
use umbmark_io::checkpoint::Keeper;

use crate::arguments::{column, model, seed, threads, whole};
use crate::checkpoint::{CheckpointOptions, unusable};
use crate::model::Model;
use crate::path::Path;
use crate::work::{Watch, detached, watched, watched_to_its_end};
use crate::{choice, hash_of, json, refused};

const UPDATES: [(&str, Update); 3] = [("arc", Update::Arc), ("midpoint", Update::Midpoint), ("euler", Update::Euler)];
const PHASES: [(&str, Phase); 2] = [("random", Phase::Random), ("edge", Phase::Edge)];

/// A Monte Carlo study, described: whole UMBmark tests, each with its own random numbers. Frozen.
///
/// Parameters
/// ----------
/// model : Model
///     The robot and its effects; parameters with a distribution are drawn anew for each trial.
/// path : Path, optional
///     The path; the paper's 4 x 4 m square where none is given.
/// n : int, default 1000
///     Number of trials, each a whole test.
/// runs : int or tuple of int, default 5
///     Runs in each direction, or (cw, ccw).
/// seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
///     Seed of all random numbers: the same seed gives the same bits for any number of threads, shards and machines. None draws a
///     fresh one; ``seed`` has it.
/// odometry : str, default "robot"
///     How the robot computes its pose: "robot" (at the encoder rate where there is one, else at every tick), "ticks",
///     "tick_by_tick" (slow, the reference) or "continuous" (without quantisation).
/// update : str, default "arc"
///     How sampled odometry follows the counts: "arc", "midpoint" or "euler".
/// phase : str, default "random"
///     Where within a tick the wheels come to rest: "random" or "edge".
///
/// Raises
/// ------
/// ValueError
///     If the test cannot be driven, a number is out of range, or a word is unknown.
#[pyclass(frozen, module = "umbmark")]
pub struct Study {
    study: core::Study,
    noise_free: NoiseFree,
    odometry: String,
    update: String,
    phase: String,
}

#[pymethods]
impl Study {
    #[new]
    #[pyo3(signature = (model, path=None, *, n=1000, runs=None, seed=1, odometry="robot", update="arc", phase="random"))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        #[pyo3(from_py_with = model)] model: Model,
        path: Option<&Path>,
        #[pyo3(from_py_with = trials)] n: u64,
        runs: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = seed)] seed: u64,
        odometry: &str,
        update: &str,
        phase: &str,
    ) -> PyResult<Study> {
        let Model { model, draws, .. } = model;
        let base = core::Study::new(model, n, seed);
        let sampled = |update| match base.robot().encoder.rate() {
            Some(rate) => Odometry::Sampled { rate, update },
            None => Odometry::EveryTick,
        };
        let kinds = [
            ("robot", sampled(choice("update", update, &UPDATES)?)),
            ("ticks", Odometry::EveryTick),
            ("tick_by_tick", Odometry::EveryTickOneByOne),
            ("continuous", Odometry::Continuous),
        ];
        let study = core::Study {
            odometry: choice("odometry", odometry, &kinds)?,
            phase: choice("phase", phase, &PHASES)?,
            runs: runs.map_or(Ok([5, 5]), runs_of)?,
            path: path.map_or_else(|| base.path.clone(), |path| path.0.clone()),
            draws,
            ..base
        };
        check_on_path(&study.model, &study.path).map_err(refused)?;
        let noise_free = NoiseFree::of(&study).map_err(refused)?;
        let [odometry, update, phase] = [odometry, update, phase].map(str::to_owned);
        Ok(Study { study, noise_free, odometry, update, phase })
    }

    /// Number of trials.
    #[getter]
    fn n(&self) -> u64 {
        self.study.trials
    }

    /// Seed of all random numbers.
    #[getter]
    fn seed(&self) -> u64 {
        self.study.seed
    }

    /// The robot and its effects.
    #[getter]
    fn model(&self) -> Model {
        Model { draws: self.study.draws.clone(), ..self.study.model.clone().into() }
    }

    /// The path.
    #[getter]
    fn path(&self) -> Path {
        Path(self.study.path.clone())
    }

    /// Names of the metrics of a trial.
    #[getter]
    fn metrics(&self) -> Vec<&'static str> {
        self.study.metrics().into_iter().map(Metric::name).collect()
    }

    /// Run a shard of the study, or what is left of it.
    ///
    /// Parameters
    /// ----------
    /// shard : tuple of int, default (0, 1)
    ///     (index, count): the index-th, from 0, of so many shards of whole chunks of 256 trials.
    /// known : Ensemble, optional
    ///     What is done already of the same study and shard.
    /// checkpoint : path-like, optional
    ///     Write what is done to this file every two seconds and at the end, Ctrl-C included: the file of ``umbmark mc
    ///     --checkpoint``, which ``umbmark.merge`` reads.
    /// resume : bool, default False
    ///     Go on with the study of that file, where it is there.
    /// replace : bool, default False
    ///     Begin anew where that file is there.
    /// threads : int, default 0
    ///     Threads to use; 0 for all processors. No number depends on it.
    /// until_std_error_m : float, optional
    ///     Stop as soon as the standard error of the mean E_max,sys is this small, in m.
    /// keep : bool, default False
    ///     Whether to keep the metrics of every trial.
    /// progress : callable, optional
    ///     Called with the number of trials done.
    ///
    /// Returns
    /// -------
    /// ensemble : Ensemble
    ///     The statistics.
    /// trials : dict of str to ndarray of float64, shape (n,), or None
    ///     The metrics of every trial, where they were to be kept.
    /// trials_per_s : float
    ///     Speed.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If what is known, or the file, is of another study or shard; or the file exists and the caller did not say what to do.
    #[pyo3(signature = (shard=(0, 1), *, known=None, checkpoint=None, resume=false, replace=false, threads=0,
                        until_std_error_m=None, keep=false, progress=None))]
    #[allow(clippy::too_many_arguments)]
    fn run<'py>(
        &self,
        py: Python<'py>,
        shard: (u64, u64),
        known: Option<&Ensemble>,
        checkpoint: Option<PathBuf>,
        resume: bool,
        replace: bool,
        #[pyo3(from_py_with = threads)] threads: usize,
        until_std_error_m: Option<f64>,
        keep: bool,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Ensemble, Option<Bound<'py, PyDict>>, f64)> {
        let shard = Shard::new(shard.0, shard.1).map_err(refused)?;
        let checkpoint = checkpoint.map(|file| CheckpointOptions { file, resume, replace }.checkpoint());
        if checkpoint.is_some() && (known.is_some() || (keep && resume)) {
            return Err(PyValueError::new_err("what is known stands in the checkpoint: leave known, or keep, out"));
        }
        let told = self.told();
        let mut keeper = Keeper::of(checkpoint.as_ref()).map_err(unusable)?;
        let mut ensemble = match (known, &checkpoint) {
            (None, None) => core::Ensemble::new(&self.study, shard),
            (None, Some(checkpoint)) => checkpoint.begin(&self.study, shard, &told).map_err(unusable)?.ensemble,
            (Some(known), _) if known.0.is_of(&self.study, shard) => known.0.clone(),
            (Some(_), _) => return Err(PyValueError::new_err("what is known is of another study or shard")),
        };
        let study = self.study.clone();
        let metrics = study.metrics();
        let columns: Vec<usize> = (0..Metric::COUNT).filter(|i| metrics.contains(&Metric::ALL[*i])).collect();
        let watched = if checkpoint.is_some() { watched_to_its_end } else { watched };
        let outcome = watched(py, threads, progress, move |watch: &Watch| -> PyResult<_> {
            let (began, before) = (Instant::now(), ensemble.trials());
            let mut kept: Vec<Vec<f64>> = vec![Vec::new(); if keep { columns.len() } else { 0 }];
            let mut failure = None;
            let done = study.resume(&mut ensemble, &watch.stop, |batch: &Batch| {
                for (values, column) in kept.iter_mut().zip(&columns) {
                    values.extend(batch.rows.iter().map(|row| row[*column]));
                }
                watch.done.store(batch.ensemble.trials(), Ordering::Relaxed);
                failure = keeper.look(study.seed, &told, batch.ensemble).err();
                let reached = batch.ensemble.get(Metric::EMaxSys).map(Statistics::std_error);
                let precise = until_std_error_m.zip(reached).is_some_and(|(wanted, reached)| reached <= wanted);
                if precise || failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            done.map_err(refused)?;
            failure.map_or_else(|| keeper.keep(study.seed, &told, &ensemble), Err).map_err(unusable)?;
            let speed = (ensemble.trials() - before) as f64 / began.elapsed().as_secs_f64().max(1e-9);
            Ok((ensemble, kept, speed))
        });
        let (ensemble, kept, trials_per_s) = outcome??;
        let trials = keep.then(|| PyDict::new(py));
        if let Some(trials) = &trials {
            for (metric, values) in metrics.iter().zip(kept) {
                trials.set_item(metric.name(), PyArray1::from_vec(py, values))?;
            }
        }
        Ok((Ensemble(ensemble), trials, trials_per_s))
    }

    /// The document of an ensemble of this study, and its words.
    fn _document(&self, ensemble: &Ensemble, partial: bool, trials_per_s: Option<f64>) -> PyResult<(String, String)> {
        document(&ensemble.0, self.study.seed, partial, trials_per_s, &self.told())
    }

    fn __repr__(&self) -> String {
        let Study { study, .. } = self;
        let ([cw, ccw], path) = (study.runs, &study.path);
        let (robot, effects) = (&study.robot().name, study.model.parts().len());
        format!(
            "Study({} trials of {cw} cw + {ccw} ccw runs, {robot} with {effects} effects, {} of {:.6} m, seed {})",
            study.trials,
            path.shape().name,
            path.length(),
            study.seed
        )
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((Model, Path), Bound<'py, PyDict>)> {
        let keywords = PyDict::new(py);
        keywords.set_item("n", self.study.trials)?;
        keywords.set_item("runs", (self.study.runs[0], self.study.runs[1]))?;
        keywords.set_item("seed", self.study.seed)?;
        for (name, word) in [("odometry", &self.odometry), ("update", &self.update), ("phase", &self.phase)] {
            keywords.set_item(name, word)?;
        }
        Ok(((self.model(), self.path()), keywords))
    }
}

impl Study {
    /// What it is.
    fn told(&self) -> result::Study {
        let noisy = self.study.model.get("wheel_noise", "k_sqrt_m").is_some();
        let assumed: Vec<String> = (!noisy).then(|| "no wheel noise".to_owned()).into_iter().collect();
        let told = Told { assumed: &assumed, ..Told::default() };
        result::Study::new(&self.study, &self.noise_free, &told)
    }

    /// The study itself.
    pub fn core(&self) -> &core::Study {
        &self.study
    }
}

/// The document of an ensemble, and what the command prints of it but for the speed.
pub fn document(
    ensemble: &core::Ensemble,
    seed: u64,
    partial: bool,
    trials_per_s: Option<f64>,
    study: &result::Study,
) -> PyResult<(String, String)> {
    let text = told::ensemble(study, seed, ensemble, partial, None);
    Ok((json(&MonteCarlo::new(ensemble, seed, partial, trials_per_s, study))?, text))
}

/// A number of trials.
fn trials(given: &Bound<'_, PyAny>) -> PyResult<u64> {
    whole("n", given, 1, core::MAX_TRIALS)
}

/// A number of runs for both directions, or one for each.
pub fn runs_of(given: &Bound<'_, PyAny>) -> PyResult<[usize; 2]> {
    if let Ok(runs) = given.extract::<usize>() {
        return Ok([runs, runs]);
    }
    given.extract::<(usize, usize)>().map(|(cw, ccw)| [cw, ccw]).map_err(|_| {
        let words = "runs must be a whole number, 0 or more, or two of them, (cw, ccw)";
        PyValueError::new_err(format!("{words}, got {given}"))
    })
}

/// What a function gives of a number, or of each of shape (k,).
fn one_or_each<'py>(
    name: &str,
    given: &Bound<'py, PyAny>,
    of: impl Fn(f64) -> PyResult<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = given.py();
    if let Ok(number) = given.extract::<f64>() {
        return Ok(PyFloat::new(py, of(number)?).into_any());
    }
    let numbers: PyResult<Vec<f64>> = column(name, given)?.as_array().iter().map(|number| of(*number)).collect();
    Ok(PyArray1::from_vec(py, numbers?).into_any())
}

/// The statistics of the trials that are done: of a study, of a shard, or of shards merged. Frozen.
///
/// Sums and bins are integers, so ensembles merge in any order to the same bits, and what merges to a whole study equals it.
#[pyclass(frozen, eq, module = "umbmark")]
#[derive(PartialEq)]
pub struct Ensemble(pub core::Ensemble);

#[pymethods]
impl Ensemble {
    /// Trials done.
    #[getter]
    fn trials(&self) -> u64 {
        self.0.trials()
    }

    /// Ranges [first, end) of trials of the whole study that are not done.
    #[getter]
    fn missing(&self) -> Vec<(u64, u64)> {
        self.0.missing().into_iter().map(|range| (range.start, range.end)).collect()
    }

    /// Names of its metrics.
    #[getter]
    fn metrics(&self) -> Vec<&'static str> {
        self.0.statistics().map(|(metric, _)| metric.name()).collect()
    }

    /// Give this ensemble and others of the same study together.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If they belong to different studies, or have trials in common.
    #[pyo3(signature = (*others))]
    fn merge(&self, py: Python<'_>, others: Vec<Py<Ensemble>>) -> PyResult<Ensemble> {
        let merged = detached(py, || {
            let mut merged = self.0.clone();
            others.iter().try_for_each(|other| merged.merge(&other.get().0)).map(|()| merged)
        })?;
        merged.map(Ensemble).map_err(refused)
    }

    /// Mean of a metric in its unit; NaN without trials.
    fn mean(&self, metric: &str) -> PyResult<f64> {
        self.get(metric).map(Statistics::mean)
    }

    /// Standard deviation of a metric, n - 1; NaN with fewer than two trials.
    fn std_dev(&self, metric: &str) -> PyResult<f64> {
        self.get(metric).map(Statistics::std_dev)
    }

    /// Standard error of the mean of a metric.
    fn std_error(&self, metric: &str) -> PyResult<f64> {
        self.get(metric).map(Statistics::std_error)
    }

    /// Quantiles of a metric, to 5e-5 of their size: of a share in [0, 1], or of each of shape (k,).
    fn quantile<'py>(&self, metric: &str, shares: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let statistics = self.get(metric)?;
        let quantile = |share: f64| match (0.0..=1.0).contains(&share) {
            true => Ok(statistics.quantile(share)),
            false => Err(PyValueError::new_err(format!("shares must be between 0 and 1, got {share}"))),
        };
        one_or_each("shares", shares, quantile)
    }

    /// Share of the trials with a metric below a value, or below each of shape (k,).
    fn share_below<'py>(&self, metric: &str, values: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let statistics = self.get(metric)?;
        one_or_each("values", values, |value| Ok(statistics.share_below(value)))
    }

    fn __repr__(&self) -> String {
        let missing: u64 = self.0.missing().iter().map(|range| range.end - range.start).sum();
        format!("Ensemble({} trials, {missing} missing)", self.0.trials())
    }

    fn __hash__(&self) -> u64 {
        hash_of(&(self.0.trials(), self.0.statistics().map(|(_, s)| s.mean().to_bits()).collect::<Vec<_>>()))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        let text = serde_json::to_vec(&slf.get().0).map_err(refused)?;
        let packed = slf.py().import("zlib")?.call_method1("compress", (PyBytes::new(slf.py(), &text), 1))?;
        Ok((slf.getattr("_unpacked")?, (packed,)))
    }

    #[staticmethod]
    fn _unpacked(py: Python<'_>, packed: &Bound<'_, PyBytes>) -> PyResult<Ensemble> {
        let text = py.import("zlib")?.call_method1("decompress", (packed,))?;
        serde_json::from_slice(text.extract()?).map(Ensemble).map_err(refused)
    }
}

impl Ensemble {
    fn get(&self, metric: &str) -> PyResult<&Statistics> {
        let found = self.0.statistics().find(|(known, _)| known.name() == metric);
        found.map(|(_, statistics)| statistics).ok_or_else(|| {
            PyKeyError::new_err(format!("there is no metric \"{metric}\"; there are {}", self.metrics().join(", ")))
        })
    }
}
