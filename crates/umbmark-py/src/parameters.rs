//! Parameters that vary, from a file or from what a call says in the keys of one.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use umbmark_core::monte_carlo::Study;
use umbmark_core::sensitivity::Correlation;
use umbmark_io::{ParameterFile, parse_parameters, read_parameters};

use crate::{keys, refused};

/// What messages call parameters that are in no file.
const CALL: &str = "parameters";

/// The parameters of a file, or of a table of its keys.
pub fn read(given: &Bound<'_, PyAny>, study: &Study) -> PyResult<ParameterFile> {
    if let Ok(table) = given.cast::<PyDict>() {
        let text = keys::table(Some(table))?.to_string();
        return parse_parameters(CALL, &text, study).map_err(|error| keys::refused(&error));
    }
    read_parameters(given.extract::<PathBuf>()?, study).map_err(refused)
}

/// Correlations of two of them, by their places.
pub fn correlations(file: &ParameterFile) -> Vec<Correlation> {
    file.correlations.iter().map(|(of, value)| Correlation { of: *of, value: *value }).collect()
}
