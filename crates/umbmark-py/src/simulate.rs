//! `simulate`.

use pyo3::prelude::*;
use umbmark_core::effect::TestKind;
use umbmark_core::monte_carlo::draw_parameters;
use umbmark_core::path::Path as CorePath;
use umbmark_core::replay::check_on_path;
use umbmark_core::simulate::{is_extended, record_test};

use crate::arguments::{model, real, seed, whole};
use crate::dataset::Dataset;
use crate::model::Model;
use crate::monte_carlo::runs_of;
use crate::path::Path;
use crate::refused;
use crate::work::watched;

/// Simulate one test and record it as a dataset.
///
/// Parameters
/// ----------
/// model : Model
///     The robot and its effects; parameters with a distribution are drawn once.
/// path : Path, optional
///     The path; the paper's 4 x 4 m square where none is given.
/// runs : int or tuple of int, default 5
///     Runs in each direction, or (cw, ccw).
/// reference_rate_hz : float, default 20
///     How often the absolute pose is measured on the way, in Hz; 0 for the end pose alone.
/// seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
///     Seed of all random numbers; None draws a fresh one.
/// trial : int, default 0
///     Which trial of this seed: each has random numbers of its own.
///
/// Returns
/// -------
/// Dataset
///     Ticks at the robot's encoder rate, or at 100 Hz, absolute poses and return errors; with bumps placed, the extended test
///     too.
///
/// Raises
/// ------
/// ValueError
///     If the test cannot be driven.
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> data = umbmark.simulate(umbmark.Model().add("wheelbase", e_b=1.01), runs=1)
/// >>> data.runs[0].name, data.returns("ccw").shape
/// ('cw_01', (1, 3))
#[pyfunction]
#[pyo3(signature = (model, path=None, *, runs=None, reference_rate_hz=20.0, seed=1, trial=0))]
pub fn simulate(
    py: Python<'_>,
    #[pyo3(from_py_with = model)] model: Model,
    path: Option<&Path>,
    runs: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = hertz)] reference_rate_hz: f64,
    #[pyo3(from_py_with = seed)] seed: u64,
    #[pyo3(from_py_with = trial)] trial: u64,
) -> PyResult<Dataset> {
    let runs = runs.map_or(Ok([5, 5]), runs_of)?;
    let Model { model, draws, .. } = model;
    let path = path.map_or_else(CorePath::umbmark, |path| path.0.clone());
    check_on_path(&model, &path).map_err(refused)?;
    let drawn = draw_parameters(&model, &draws, seed, trial).map_err(refused)?;
    let tests = &[TestKind::Systematic, TestKind::Bumps][..1 + usize::from(is_extended(&drawn))];
    let recorded =
        watched(py, 1, None, move |_| record_test(&drawn, &path, tests, runs, reference_rate_hz, [seed, trial]))?;
    Ok(Dataset::from(recorded.map_err(refused)?))
}

/// How often the pose is measured.
fn hertz(given: &Bound<'_, PyAny>) -> PyResult<f64> {
    real("reference_rate_hz", given)
}

/// Which trial of a seed.
fn trial(given: &Bound<'_, PyAny>) -> PyResult<u64> {
    whole("trial", given, 0, u64::MAX)
}
