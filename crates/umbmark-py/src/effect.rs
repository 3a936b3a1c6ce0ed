//! The catalogue of effects.

use pyo3::prelude::*;
use umbmark_core::document;
use umbmark_core::effect::{CATALOGUE, Formula};

/// The catalogue, as a document.
#[pyfunction]
pub fn effects() -> String {
    serde_json::Value::Array(CATALOGUE.iter().copied().map(document::about).collect()).to_string()
}

/// The names of what formulas may depend on.
#[pyfunction]
pub fn formula_variables() -> Vec<&'static str> {
    Formula::variables().iter().map(|variable| variable.name).collect()
}
