//! Arguments of functions that Python calls here directly, read as the package reads those of its own functions.

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::model::Model;

/// What a function of `umbmark._arguments` makes of an argument.
fn read<'py>(
    function: &str,
    arguments: impl pyo3::call::PyCallArgs<'py>,
    py: Python<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("umbmark._arguments")?.call_method1(function, arguments)
}

/// A seed: a whole number, or what NumPy draws one from; None is a fresh one.
pub fn seed(given: &Bound<'_, PyAny>) -> PyResult<u64> {
    read("seed_of", (given,), given.py())?.extract()
}

/// A number of threads; 0 stands for all processors.
pub fn threads(given: &Bound<'_, PyAny>) -> PyResult<usize> {
    read("threads_of", (given,), given.py())?.extract()
}

/// A whole number within a range, both ends included.
pub fn whole(name: &str, given: &Bound<'_, PyAny>, least: u64, most: u64) -> PyResult<u64> {
    read("whole", (name, given, least, most), given.py())?.extract()
}

/// A number of any real type.
pub fn real(name: &str, given: &Bound<'_, PyAny>) -> PyResult<f64> {
    read("real", (name, given), given.py())?.extract()
}

/// A model.
pub fn model(given: &Bound<'_, PyAny>) -> PyResult<Model> {
    let checked = given.py().import("umbmark._scores")?.call_method1("a_model", (given,))?;
    Ok(checked.cast::<Model>()?.get().clone())
}

/// A whole number of either sign.
pub fn integer<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    read("integer", (name, given), given.py())
}

/// Numbers of any real type, shape (n,).
pub fn column<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArray1<'py, f64>> {
    read("column", (name, given), given.py())?.extract()
}

/// Whole numbers of any type, shape (n,).
pub fn indices<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArray1<'py, i64>> {
    read("indices", (name, given), given.py())?.extract()
}

/// Rows of x, y and heading of any real type, C-contiguous, shape (n, 3); NaN for a heading that was not measured.
pub fn poses<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArray2<'py, f64>> {
    read("poses", (name, given), given.py())?.extract()
}
