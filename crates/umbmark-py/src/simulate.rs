//! `simulate`.

use pyo3::prelude::*;
use umbmark_core::effect::TestKind;
use umbmark_core::monte_carlo::draw_parameters;
use umbmark_core::path::Path as CorePath;
use umbmark_core::replay::check_on_path;
use umbmark_core::simulate::{is_extended, record_test};

use crate::dataset::Dataset;
use crate::model::Model;
use crate::path::Path;
use crate::refused;
use crate::work::watched;

/// One test, driven and recorded.
#[pyfunction]
pub fn simulate(
    py: Python<'_>,
    model: &Model,
    path: Option<&Path>,
    runs: [usize; 2],
    reference_rate_hz: f64,
    seed: u64,
    trial: u64,
) -> PyResult<Dataset> {
    let Model { model, draws, .. } = model.clone();
    let path = path.map_or_else(CorePath::umbmark, |path| path.0.clone());
    check_on_path(&model, &path).map_err(refused)?;
    let drawn = draw_parameters(&model, &draws, seed, trial).map_err(refused)?;
    let tests = &[TestKind::Systematic, TestKind::Bumps][..1 + usize::from(is_extended(&drawn))];
    let recorded =
        watched(py, 1, None, move |_| record_test(&drawn, &path, tests, runs, reference_rate_hz, [seed, trial]))?;
    Ok(Dataset::from(recorded.map_err(refused)?))
}
