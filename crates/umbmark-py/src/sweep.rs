//! `mc --sweep`.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::monte_carlo::{Axis, Metric, Quantity, Sweep};
use umbmark_core::result;
use umbmark_io::checkpoint::Keeper;

use crate::arguments::threads;
use crate::checkpoint::{CheckpointOptions, unusable};
use crate::monte_carlo::Study;
use crate::work::{Watch, watched, watched_to_its_end};
use crate::{json, refused};

/// A study on every point of a grid, as a document and in words; axes are (name, first, last, count), a checkpoint (file, resume, replace).
#[pyfunction]
pub fn sweep(
    py: Python<'_>,
    study: &Study,
    axes: Vec<(String, f64, f64, u64)>,
    checkpoint: Option<(PathBuf, bool, bool)>,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let study = study.core();
    let axis = |(name, first, last, count): &(String, f64, f64, u64)| {
        let quantity = Quantity::find(name, study).map_err(refused)?;
        Ok(Axis { quantity, first: *first, last: *last, count: *count })
    };
    let axes = axes.iter().map(axis).collect::<PyResult<Vec<Axis>>>()?;
    let sweep = Sweep::new(study, &axes).map_err(refused)?;
    let checkpoint = checkpoint.map(|(file, resume, replace)| CheckpointOptions { file, resume, replace }.checkpoint());
    let mut keeper = Keeper::of(checkpoint.as_ref()).map_err(unusable)?;
    let known = checkpoint.as_ref().map(|checkpoint| checkpoint.begin_sweep(&sweep)).transpose();
    let mut points = known.map_err(unusable)?.unwrap_or_default();
    let watched = if checkpoint.is_some() { watched_to_its_end } else { watched };
    watched(py, threads, progress, move |watch: &Watch| {
        let mut failure = None;
        let done = sweep.run(points.len() as u64, &watch.stop, |more| {
            points.extend(more);
            watch.done.store(points.len() as u64, Ordering::Relaxed);
            failure = keeper.look_at(&sweep, &points).err();
            if failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        done.map_err(refused)?;
        failure.map_or_else(|| keeper.keep_points(&sweep, &points), Err).map_err(unusable)?;
        Ok((json(&result::Sweep::new(&sweep, &points, &[]))?, told::sweep(&sweep, &points, Metric::EMaxSys)))
    })?
}
