//! `mc --sweep`.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

use pyo3::prelude::*;
use umbmark_core::document;
use umbmark_core::monte_carlo::{Axis, Quantity, Sweep, SweepError};

use crate::monte_carlo::Study;
use crate::refused;
use crate::work::watched;

/// A study on every point of a grid; axes are (name, first, last, count).
#[pyfunction]
pub fn sweep(
    py: Python<'_>,
    study: &Study,
    axes: Vec<(String, f64, f64, u64)>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let study = study.core();
    let axis = |(name, first, last, count): &(String, f64, f64, u64)| {
        let quantity = Quantity::find(name, study).map_err(refused)?;
        Ok(Axis { quantity, first: *first, last: *last, count: *count })
    };
    let axes = axes.iter().map(axis).collect::<PyResult<Vec<Axis>>>()?;
    let sweep = Sweep::new(study, &axes).map_err(refused)?;
    let found = watched(py, threads, progress, move |told| -> Result<_, SweepError> {
        let mut done = Vec::new();
        sweep.run(0, &told.stop, |points| {
            done.extend(points);
            told.done.store(done.len() as u64, Ordering::Relaxed);
            ControlFlow::Continue(())
        })?;
        Ok(document::sweep(&sweep, &done, &[]).to_string())
    })?;
    found.map_err(refused)
}
