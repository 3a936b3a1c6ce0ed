//! Python bindings: the extension module `umbmark._umbmark`, which the package `umbmark` makes comfortable.
//!
//! One file for each room of `umbmark-core` that Python sees, and two for `umbmark-plot`. Robots, paths, models and datasets are frozen classes here.
//! Results cross as the documents that `--json` prints ([`umbmark_core::result`]); the package decodes them into typed
//! classes. Every call has three steps: arguments are read under the interpreter lock, the work runs without it (`work`),
//! and its result is handed over.

mod arrays;
mod calibrate;
mod checkpoint;
mod dataset;
mod diagnose;
mod effect;
mod figure;
mod keys;
mod model;
mod monte_carlo;
mod paper;
mod parameters;
mod path;
mod plan;
mod preset;
mod report;
mod robot;
mod run;
mod score;
mod sensitivity;
mod simulate;
mod sweep;
mod tolerance;
mod work;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_io::whole_file::FileError;
use umbmark_io::{DatasetError, Existing, Words};

/// The odometry error of wheeled robots: UMBmark.
#[pymodule]
mod _umbmark {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::calibrate::{calibrate, calibrate_gears, export};
    #[pymodule_export]
    use super::checkpoint::merge;
    #[pymodule_export]
    use super::dataset::{Dataset, init, inspect, load_dataset};
    #[pymodule_export]
    use super::diagnose::{compare, diagnose, fit, learn, solve};
    #[pymodule_export]
    use super::effect::{effects, formula_variables};
    #[pymodule_export]
    use super::figure::{Figure, figure, kinds};
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::monte_carlo::{Ensemble, Study};
    #[pymodule_export]
    use super::paper::paper;
    #[pymodule_export]
    use super::path::Path;
    #[pymodule_export]
    use super::plan::{plan, separate};
    #[pymodule_export]
    use super::preset::presets;
    #[pymodule_export]
    use super::report::{report, write};
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::run::Run;
    #[pymodule_export]
    use super::score::{score_arrays, score_dataset};
    #[pymodule_export]
    use super::sensitivity::{Sobol, sensitivity};
    #[pymodule_export]
    use super::simulate::simulate;
    #[pymodule_export]
    use super::sweep::sweep;
    #[pymodule_export]
    use super::tolerance::tolerance;

    #[pymodule_init]
    fn add_version(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", umbmark_core::VERSION)
    }
}

/// What the core refuses, in its own words.
fn refused(error: impl std::error::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What is wrong with a file of a data set, or why one is not written, in Python's words.
fn refused_data(error: DatasetError) -> PyErr {
    PyValueError::new_err(error.worded(&Words { replace: "say replace=True", before: "", between: "=" }))
}

/// Why a file is not written, in Python's words.
fn unwritten(error: FileError) -> PyErr {
    PyValueError::new_err(match error {
        FileError::Exists(_) => format!("{error}; replace=True replaces it"),
        error => error.to_string(),
    })
}

/// A file that is there is kept, unless it may be replaced.
fn existing(replace: bool) -> Existing {
    if replace { Existing::Replace } else { Existing::Keep }
}

/// A word of a few, by name.
fn choice<T: Copy>(name: &str, word: &str, choices: &[(&str, T)]) -> PyResult<T> {
    choices.iter().find(|(known, _)| *known == word).map(|(_, value)| *value).ok_or_else(|| {
        let known: Vec<&str> = choices.iter().map(|(known, _)| *known).collect();
        PyValueError::new_err(format!("{name} must be one of {}, got \"{word}\"", known.join(", ")))
    })
}

/// Refuses what is no probability.
fn probability(name: &str, value: f64) -> PyResult<()> {
    if value > 0.0 && value < 1.0 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name} must be between 0 and 1, both excluded, got {value}")))
}

/// A result as the document that the package decodes.
fn json(result: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(result).map_err(refused)
}

/// A result as Python's own dicts, lists and numbers.
fn as_python<'py>(py: Python<'py>, result: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json(result)?,))
}
