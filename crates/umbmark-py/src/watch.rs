//! `watch`.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::drift::{Record, Restart, Watched};
use umbmark_core::result;
use umbmark_io::WatchState;

use crate::arguments::threads;
use crate::dataset::Dataset;
use crate::work::watched;
use crate::{json, refused};

/// Whether a robot that is tested again and again changes.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each of the function in Python")]
pub fn watch(
    py: Python<'_>,
    data: &Dataset,
    state: Option<PathBuf>,
    false_alarms: Option<f64>,
    runs_per_month: Option<i64>,
    restart: Option<String>,
    seed: u64,
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<(String, String)> {
    let data = Arc::clone(&data.0);
    let runs = |runs: i64| {
        let wrong = |_| PyValueError::new_err(format!("runs_per_month must be between 1 and 100000, got {runs}"));
        u32::try_from(runs).map_err(wrong)
    };
    let runs_per_month = runs_per_month.map(runs).transpose()?;
    let mut state = state.map(|file| WatchState::open(&file)).transpose().map_err(refused)?;
    let known = state.as_ref().and_then(WatchState::record).cloned();
    let mut record = Record::resumed(known, &data, false_alarms, runs_per_month).map_err(refused)?;
    let arrived = record.add(&data).map_err(refused)?;
    if let Some(run) = restart {
        record.restart(&if run == "now" { Restart::Now } else { Restart::At(run) }).map_err(refused)?;
    }
    let robot = data.nominal_robot().map_err(refused)?.clone();
    let path = data.path.clone();
    let known = record.clone();
    let found = watched(py, threads, None, move |_| Watched::of(&known, &robot, path.as_ref(), seed))?;
    if let Some(state) = &mut state {
        state.keep(&record).map_err(refused)?;
    }
    Ok((json(&result::Watched::new(&found, &arrived))?, told::watched(&found, &arrived)))
}
