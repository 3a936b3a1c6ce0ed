//! NumPy arrays in.

use numpy::{PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use umbmark_core::dataset::ReturnError;

/// Reads an array of return errors: shape (n, 3) with x in m, y in m and heading in rad, or (n, 2) without heading.
///
/// A NaN heading was not measured. Any memory layout is read. `TypeError` for what is no plain array of float64: of a masked
/// array the mask would be lost, and integers are more often millimetres or degrees by mistake than metres.
pub fn return_errors(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<ReturnError>> {
    let wanted = format!("{name} must be a NumPy array of float64 with shape (n, 3) or (n, 2)");
    let Ok(untyped) = value.cast_exact::<PyUntypedArray>() else {
        return Err(PyTypeError::new_err(format!("{wanted}, got {}", value.get_type().name()?)));
    };
    if !untyped.dtype().is_equiv_to(&numpy::dtype::<f64>(value.py())) {
        return Err(PyTypeError::new_err(format!("{wanted}, got dtype {}", untyped.dtype().str()?)));
    }
    let width = match *untyped.shape() {
        [_, width @ (2 | 3)] => width,
        _ => {
            let shape = value.getattr("shape")?;
            return Err(PyValueError::new_err(format!("{wanted}, got shape {shape}")));
        }
    };
    let array = if untyped.is_c_contiguous() && untyped.is_aligned() {
        value.clone()
    } else {
        value.call_method1("copy", ("C",))?
    };
    let array = array.cast::<PyArray2<f64>>()?.try_readonly()?;
    let error = |row: &[f64]| ReturnError {
        x: row[0],
        y: row[1],
        heading: row.get(2).copied().filter(|heading| !heading.is_nan()),
    };
    Ok(array.as_slice()?.chunks_exact(width).map(error).collect())
}
