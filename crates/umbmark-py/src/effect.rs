//! The catalogue of effects.

use pyo3::prelude::*;
use umbmark_core::document;
use umbmark_core::effect::CATALOGUE;

/// The catalogue, as a document.
#[pyfunction]
pub fn effects() -> String {
    serde_json::Value::Array(CATALOGUE.iter().map(document::about).collect()).to_string()
}
