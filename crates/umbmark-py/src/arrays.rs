//! NumPy arrays in.

use numpy::{PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// An array of return errors: rows of x in m, y in m and heading in rad, NaN where it was not measured.
pub struct ReturnErrors<'py>(PyReadonlyArray2<'py, f64>);

impl<'py> ReturnErrors<'py> {
    /// Reads an array of shape (n, 3), or (n, 2) without heading, where it lies; what lies otherwise is copied.
    ///
    /// `TypeError` for what is no plain array of float64: of a masked array the mask would be lost, and integers are more often
    /// millimetres or degrees by mistake than metres.
    pub fn new(name: &str, value: &Bound<'py, PyAny>) -> PyResult<ReturnErrors<'py>> {
        let wanted = format!("{name} must be a NumPy array of float64 with shape (n, 3) or (n, 2)");
        let Ok(untyped) = value.cast_exact::<PyUntypedArray>() else {
            return Err(PyTypeError::new_err(format!("{wanted}, got {}", value.get_type().name()?)));
        };
        if !untyped.dtype().is_equiv_to(&numpy::dtype::<f64>(value.py())) {
            return Err(PyTypeError::new_err(format!("{wanted}, got dtype {}", untyped.dtype().str()?)));
        }
        let array = match *untyped.shape() {
            [_, 3] if untyped.is_c_contiguous() && untyped.is_aligned() => value.clone(),
            [_, 3] => value.call_method1("copy", ("C",))?,
            [_, 2] => with_a_third_column(value)?,
            _ => {
                let shape = value.getattr("shape")?;
                return Err(PyValueError::new_err(format!("{wanted}, got shape {shape}")));
            }
        };
        Ok(ReturnErrors(array.cast::<PyArray2<f64>>()?.try_readonly()?))
    }

    /// Its rows.
    pub fn rows(&self) -> PyResult<&[[f64; 3]]> {
        Ok(self.0.as_slice()?.as_chunks().0)
    }
}

/// An array of shape (n, 2) with a column of NaN more.
fn with_a_third_column<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let numpy = value.py().import("numpy")?;
    let missing = numpy.call_method1("full", ((value.len()?, 1), f64::NAN))?;
    numpy.call_method1("hstack", ((value, missing),))
}
