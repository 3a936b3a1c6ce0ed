//! The catalogue of effects.

use pyo3::prelude::*;
use umbmark_core::effect::{CATALOGUE, Formula};
use umbmark_core::result::Effect;

use crate::json;

/// The catalogue.
#[pyfunction]
pub fn effects() -> PyResult<String> {
    json(&CATALOGUE.iter().copied().map(Effect::from).collect::<Vec<_>>())
}

/// The names of what formulas may depend on.
#[pyfunction]
pub fn formula_variables() -> Vec<&'static str> {
    Formula::variables().iter().map(|variable| variable.name).collect()
}
