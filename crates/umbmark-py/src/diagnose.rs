//! `compare`, `diagnose`, `fit`, `learn`, `solve`, `changed`, `conditions` and `survey`.

use std::convert::Infallible;
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::changed::changed as compared;
use umbmark_core::compare::{self as comparing, Compared};
use umbmark_core::conditions::conditions as divided;
use umbmark_core::diagnose::{self as core, Options, first_model};
use umbmark_core::evidence::FitError;
use umbmark_core::likelihood::Knowledge;
use umbmark_core::result::{self, Comparison, TrackComparison};
use umbmark_core::solve::{self as solving, Solution};
use umbmark_core::survey::survey as surveyed;
use umbmark_core::{effect, evidence};
use umbmark_io::Doubt;

use crate::arguments::threads;
use crate::dataset::Dataset;
use crate::model::Model;
use crate::work::{Watch, watched};
use crate::{actions, json, probability, refused};

/// Models beside measurements; without any, the nominal robot, and the first model fitted to the data.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    data: &Dataset,
    models: Vec<(String, Model)>,
    options: (f64, usize, u64),
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<(String, String)> {
    let options = options_of(options, return_poses)?;
    let shared = Arc::clone(&data.0);
    shared.nominal_robot().map_err(refused)?;
    let given = models.into_iter().map(|(name, model)| Ok((name, model.of_data(py, &shared)?)));
    let given: Vec<_> = given.collect::<PyResult<_>>()?;
    let found = watched(py, threads, None, move |_| -> Result<_, FitError> {
        let models = if given.is_empty() { comparing::usual_models(&shared, &options)? } else { given };
        let compared = comparing::compare(&shared, &models, &options)?;
        let text = told::comparison(&compared, &options);
        let document = match compared {
            Compared::Ends(comparison) => json(&Comparison::new(&comparison, &options)),
            Compared::Tracks(comparison) => json(&TrackComparison::new(&comparison, &options)),
        };
        Ok(document.map(|document| (document, text)))
    })?;
    found.map_err(refused)?
}

/// What a model is missing, and the model with its free parameters fitted.
#[pyfunction]
pub fn diagnose(
    py: Python<'_>,
    data: &Dataset,
    model: Option<&Model>,
    options: (f64, usize, u64),
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<(String, String, Model)> {
    let options = options_of(options, return_poses)?;
    let model = asked(py, data, model)?;
    let shared = Arc::clone(&data.0);
    watched(py, threads, None, move |_| {
        let diagnosis = core::diagnose(&shared, &model, &options).map_err(refused)?;
        let text = told::diagnosis(&shared, &diagnosis, &options);
        Ok((json(&result::Diagnosis::new(&diagnosis, &options))?, text, diagnosis.model.into()))
    })?
}

/// Names of parameters with two numbers each: bounds, or means and standard deviations.
type Pairs = Vec<(String, (f64, f64))>;

/// A model with its free effects fitted, those of `add` too, but for the parameters of `fix`, at their values or others; within bounds, and
/// with earlier measurements.
#[pyfunction]
pub fn fit(
    py: Python<'_>,
    data: &Dataset,
    model: Option<&Model>,
    add: Vec<String>,
    fix: Vec<(String, Option<f64>)>,
    knowledge: (Pairs, Pairs),
    level: f64,
) -> PyResult<(String, String, Model)> {
    probability("level", level)?;
    let knowledge = known(knowledge)?;
    let mut model = asked(py, data, model)?;
    for effect in &add {
        model.add(effect).map_err(refused)?.free = true;
    }
    for (name, value) in &fix {
        let (effect, parameter) = number_of("fix", name)?;
        value.map_or(Ok(()), |value| model.set(effect, parameter, value)).map_err(refused)?;
        model.fix(effect, parameter).map_err(refused)?;
    }
    if !model.is_free() {
        return Err(PyValueError::new_err(
            "no effect of the model is free: say free=True in the model, or add an effect",
        ));
    }
    let shared = Arc::clone(&data.0);
    let fit = move |_: &_| evidence::fit_knowing(&shared, &model, knowledge);
    let fitted = watched(py, 1, None, fit)?.map_err(refused)?;
    let (document, text) = (json(&result::Fitted::new(&fitted, level))?, told::fit(&fitted, level));
    Ok((document, text, Model { noise: fitted.noise, ..fitted.model.into() }))
}

/// Bounds and earlier measurements.
fn known((bounds, priors): (Pairs, Pairs)) -> PyResult<Knowledge> {
    let mut knowledge = Knowledge::default();
    for (name, (low, high)) in &bounds {
        let (effect, parameter) = number_of("bounds", name)?;
        knowledge.bound(effect, parameter, *low, *high).map_err(refused)?;
    }
    for (name, (mean, sd)) in &priors {
        let (effect, parameter) = number_of("priors", name)?;
        knowledge.measured(effect, parameter, *mean, *sd).map_err(refused)?;
    }
    Ok(knowledge)
}

fn number_of<'a>(argument: &str, name: &'a str) -> PyResult<(&'a str, &'a str)> {
    let refuse = || PyValueError::new_err(format!("{argument} must name EFFECT.PARAMETER, got \"{name}\""));
    name.split_once('.').ok_or_else(refuse)
}

/// The whole loop, from a model where one is given, and the model that was learnt.
#[pyfunction]
pub fn learn(
    py: Python<'_>,
    data: &Dataset,
    start: Option<&Model>,
    options: (f64, usize, u64),
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String, Model)> {
    let options = options_of(options, return_poses)?;
    let shared = Arc::clone(&data.0);
    let start = match start {
        Some(start) => start.of_data(py, &data.0)?,
        None => effect::Model::new(data.0.nominal_robot().map_err(refused)?),
    };
    let solution = solved(py, shared, start, options, threads, progress)?;
    let text = told::learnt(&data.0, &solution, &options);
    Ok((json(&result::Learnt::new(&solution, &options))?, text, model_of(solution)))
}

/// The one answer, and the model that it rests on.
#[pyfunction]
pub fn solve(
    py: Python<'_>,
    data: &Dataset,
    options: (f64, usize, u64),
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String, Model)> {
    let options = options_of(options, return_poses)?;
    let start = effect::Model::new(data.0.nominal_robot().map_err(refused)?);
    let solution = solved(py, Arc::clone(&data.0), start, options, threads, progress)?;
    let text = told::solution(&solution, &options);
    Ok((json(&result::Solution::new(&solution, &options, actions))?, text, model_of(solution)))
}

/// What changed of a robot between two tests.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each of the function in Python")]
pub fn changed(
    py: Python<'_>,
    before: &Dataset,
    after: &Dataset,
    start: Option<&Model>,
    options: (f64, usize, u64),
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let options = options_of(options, return_poses)?;
    let [first, second] = [before, after].map(|data| Arc::clone(&data.0));
    let start = match start {
        Some(start) => start.of_data(py, &first)?,
        None => effect::Model::new(first.nominal_robot().map_err(refused)?),
    };
    let work = move |told: &Watch| told.work(|watch| compared(&first, &second, &start, &options, watch));
    let found = watched(py, threads, progress, work)?.map_err(refused)?;
    Ok((json(&result::Changed::new(&found, &options))?, told::changed(&found)))
}

/// Which numbers of a robot depend on the conditions of its runs.
#[pyfunction]
pub fn conditions(
    py: Python<'_>,
    data: &Dataset,
    start: Option<&Model>,
    size: f64,
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    probability("size", size)?;
    let options = Options { size, ends_only: return_poses, ..Options::default() };
    let shared = Arc::clone(&data.0);
    let start = match start {
        Some(start) => start.of_data(py, &shared)?,
        None => first_model(&shared).map_err(refused)?,
    };
    let work = move |told: &Watch| told.work(|watch| divided(&shared, &start, &options, watch));
    let found = watched(py, threads, progress, work)?.map_err(refused)?;
    Ok((json(&result::Conditions::new(&found))?, told::conditions(&found)))
}

/// Many robots of one kind: a row each, and how far they are apart.
#[pyfunction]
pub fn survey(
    py: Python<'_>,
    robots: Vec<(String, Py<Dataset>)>,
    diagnosis: bool,
    options: (f64, usize, u64),
    return_poses: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let options = options_of(options, return_poses)?;
    let (names, data): (Vec<String>, Vec<_>) =
        robots.into_iter().map(|(name, data)| (name, Arc::clone(&data.get().0))).unzip();
    let work = move |told: &Watch| {
        let load = |place: usize| Ok::<_, Infallible>(Arc::clone(&data[place]));
        told.work(|watch| surveyed(&names, load, diagnosis, &options, watch))
    };
    let found = watched(py, threads, progress, work)?;
    Ok((json(&result::Survey::new(&found, &options))?, told::survey(&found)))
}

fn solved(
    py: Python<'_>,
    data: Arc<umbmark_core::dataset::Dataset>,
    start: effect::Model,
    options: Options,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Solution> {
    let work = move |told: &Watch| told.work(|watch| solving::solve(&data, &start, &options, watch));
    watched(py, threads, progress, work)?.map_err(refused)
}

/// The model that was learnt, with its noise and what speaks against it.
fn model_of(solution: Solution) -> Model {
    let doubt = solution.doubt().map(|because| Doubt { because, alone: !solution.learnt.is_in_doubt() });
    Model { noise: solution.learnt.noise, doubt, ..solution.learnt.model.into() }
}

/// The model that is asked about, the usual first one where none is given.
fn asked(py: Python<'_>, data: &Dataset, model: Option<&Model>) -> PyResult<effect::Model> {
    data.0.nominal_robot().map_err(refused)?;
    match model {
        Some(model) => model.of_data(py, &data.0),
        None => first_model(&data.0).map_err(refused),
    }
}

/// Size, draws and seed of tests, checked.
pub fn options_of((size, draws, seed): (f64, usize, u64), ends_only: bool) -> PyResult<Options> {
    probability("size", size)?;
    Ok(Options { size, draws, seed, ends_only, ..Options::default() })
}
