//! Python bindings: the extension module `umbmark._umbmark`, which the package `umbmark` re-exports.
//!
//! One file for each room of `umbmark-core` that Python sees. Every call has three steps: arrays are checked and read
//! under the interpreter lock (`arrays`), the work runs without it (`detached`), and its result is a frozen class whose
//! attributes carry their unit, under the names of the command's JSON keys.

mod arrays;
mod score;

use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// The odometry error of wheeled robots: UMBmark.
#[pymodule]
mod _umbmark {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::score::{Score, score};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", umbmark_core::VERSION)
    }
}

/// Runs `work` without the interpreter lock. A panic in it is a fault of this library and reaches Python as `RuntimeError`.
fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work)))
        .map_err(|_| PyRuntimeError::new_err(format!("a fault in umbmark {}: please report it", umbmark_core::VERSION)))
}

/// What the core refuses, in its own words.
fn refused(error: impl std::error::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}
