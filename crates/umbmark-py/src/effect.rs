//! The catalogue of effects.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use umbmark_core::effect::{CATALOGUE, Formula};
use umbmark_core::result::Effect;

use crate::typed;

/// Give the catalogue of effects by their names, in the order in which they act.
///
/// Returns
/// -------
/// dict of str to Effect
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> umbmark.effects()["crab"].parameters[0].name
/// 'angle_rad'
#[pyfunction]
pub fn effects(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let catalogue = PyDict::new(py);
    for entry in CATALOGUE.iter().copied() {
        catalogue.set_item(entry.about.name, typed(py, "Effect", &Effect::from(entry))?)?;
    }
    Ok(catalogue)
}

/// The names of what formulas may depend on.
#[pyfunction]
pub fn formula_variables() -> Vec<&'static str> {
    Formula::variables().iter().map(|variable| variable.name).collect()
}
