//! Robots of the paper.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use umbmark_core::preset::PRESETS;

use crate::model::Model;
use crate::path::Path;
use crate::refused;

/// Give the robots of the paper's Table I, ready to be driven, with their paths.
///
/// Returns
/// -------
/// dict of str to tuple of Model and Path
///     By their names in flags, in the order of the table. The wheel noise is set to give the published sigma.
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> model, path = umbmark.presets()["trc-labmate-nocal"]
/// >>> round(umbmark.monte_carlo(model, path, n=1).noise_free.e_max_sys_m, 4)
/// 0.3056
#[pyfunction]
pub fn presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let presets = PyDict::new(py);
    for preset in PRESETS {
        let model = Model::from(preset.model().map_err(refused)?);
        presets.set_item(preset.name, (model, Path(preset.path())))?;
    }
    Ok(presets)
}
