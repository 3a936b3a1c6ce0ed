//! Python bindings: the extension module `umbmark._umbmark`, which the package `umbmark` makes comfortable.
//!
//! One file for each room of `umbmark-core` that Python sees, two for `umbmark-plot`, and one for `umbmark-web`. Robots, paths, models and datasets are frozen classes here.
//! Results cross as the documents that `--json` prints ([`umbmark_core::result`]); the package decodes them into typed
//! classes. Every call has three steps: arguments are read under the interpreter lock, the work runs without it (`work`),
//! and its result is handed over.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use umbmark_core::action::Action;
use umbmark_io::whole_file::FileError;
use umbmark_io::{DatasetError, Existing, Words};

use exception::{DataError, UmbmarkError, refused};

/// Each file of the module, with the functions and classes of it that Python has.
macro_rules! module {
    ($($file:ident $(: $($item:ident),+)?;)*) => {
        $(mod $file;)*

        /// The odometry error of wheeled robots: UMBmark.
        #[pymodule]
        mod _umbmark {
            use pyo3::prelude::*;

            $($(#[pymodule_export]
            use super::$file::{$($item),+};)?)*

            #[pymodule_init]
            fn add_version(module: &Bound<'_, PyModule>) -> PyResult<()> {
                super::exception::add(module)?;
                module.add("__version__", umbmark_core::VERSION)
            }
        }
    };
}

module! {
    apply: apply;
    arguments;
    calibrate: calibrate, calibrate_gears;
    checkpoint: merge;
    dataset: Dataset, inspect, load_dataset;
    diagnose: changed, compare, conditions, diagnose, fit, learn, solve, survey;
    effect: effects, formula_variables;
    exception;
    export: export;
    figure: Figure, figure, kinds;
    init: init;
    keys;
    model: Model;
    monte_carlo: Ensemble, Study;
    paper: paper;
    parameters;
    path: Path;
    plan: plan, separate;
    preset: presets;
    report: report, write;
    robot: Robot;
    run: Run;
    score: score_arrays, score_dataset;
    sensitivity: Sobol, sensitivity;
    simulate: simulate;
    stated;
    sweep: sweep;
    tolerance: tolerance;
    tracks: tracks;
    watch: watch;
    work;
    workbench: Server, serve;
}

/// How Python names its arguments in messages.
const WORDS: Words = Words { replace: "say replace=True", before: "", between: "=", actions: Some(actions) };

/// How Python names what is done next.
fn actions(action: Action) -> &'static str {
    match action {
        Action::ListEffects => "`umbmark.effects()`",
        Action::Begin => "`umbmark.init(folder)`",
        Action::CheckData => "`umbmark.inspect(data)`",
        Action::CheckLog => "`umbmark.inspect(log)`",
        Action::ReadReturns => "umbmark.inspect, umbmark.score, umbmark.calibrate",
        Action::Score => "`umbmark.score(data)`",
        Action::Learn => "`umbmark.learn(data)`",
        Action::WriteNumbers => "`umbmark.export(solution.model, to=\"ros2_control\")` (or toml, c, urdf)",
        Action::WriteFitted => "`umbmark.export(umbmark.fit(data).model, to=\"ros2_control\")`",
        Action::WriteTable => "`umbmark.export(solution.model, to=\"embedded\")`",
        Action::CorrectLogs => "`umbmark.apply(data, model)`",
        other => other.plain(),
    }
}

/// What is wrong with a file of a data set, or why one is not written, in Python's words.
fn refused_data(error: DatasetError) -> PyErr {
    DataError::new_err(error.worded(&WORDS))
}

/// Why a file is not written, in Python's words.
fn unwritten(error: FileError) -> PyErr {
    UmbmarkError::new_err(match error {
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

/// A hash for Python, equal for equal things.
fn hash_of(thing: &impl std::hash::Hash) -> u64 {
    let mut hasher = std::hash::DefaultHasher::new();
    thing.hash(&mut hasher);
    std::hash::Hasher::finish(&hasher)
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

/// A result as the package's class of this name.
fn typed<'py>(py: Python<'py>, class: &str, result: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("umbmark._documents")?.getattr(class)?;
    let keywords = [("type", class)].into_py_dict(py)?;
    py.import("msgspec")?.getattr("json")?.call_method("decode", (json(result)?,), Some(&keywords))
}

/// A result as Python's own dicts, lists and numbers.
fn as_python<'py>(py: Python<'py>, result: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json(result)?,))
}
