//! `tracks`: measured runs beside the odometry and a model, pose by pose.

use std::sync::Arc;

use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use umbmark_core::effect;
use umbmark_core::geometry::{Pose2, wrap};
use umbmark_core::likelihood::{Noise, Observed, ObservedRun};
use umbmark_core::replay::ReplayError;

use crate::dataset::Dataset;
use crate::model::Model;
use crate::refused;
use crate::work::watched;

/// Rows of x, y and heading; NaN where there is none.
type Rows = Vec<[f64; 3]>;

/// What was measured of a run, and what odometry and a model make of it.
struct Track {
    run: String,
    direction: Option<&'static str>,
    time: Vec<f64>,
    /// Odometry, model, measurement, residuals, and where noise is known, whitened residuals.
    rows: [Rows; 4],
    whitened: Option<Rows>,
}

/// A run by name and direction: times, odometry, model, measurement, residuals, whitened residuals.
type Arrays<'py> = (String, Option<&'static str>, Bound<'py, PyArray1<f64>>, [Array<'py>; 4], Option<Array<'py>>);
type Array<'py> = Bound<'py, PyArray2<f64>>;

/// The tracks of a dataset beside a model.
#[pyfunction]
pub fn tracks<'py>(py: Python<'py>, data: &Dataset, model: &Model) -> PyResult<Vec<Arrays<'py>>> {
    let (shared, noise) = (Arc::clone(&data.0), model.noise);
    let robot = shared.nominal_robot().map_err(refused)?.clone();
    let model = model.of_data(py, &shared)?;
    let made = watched(py, 0, None, move |_| -> Result<Vec<Track>, ReplayError> {
        let observed = Observed::new(&shared, &robot)?;
        let nominal = effect::Model::new(&robot);
        let along = observed.along(&model);
        // The fit's own residuals: without terms of second order in headings.
        let mut linear = observed;
        linear.runs.iter_mut().for_each(|run| run.linear = true);
        let linear = linear.along(&model);
        let runs = along.runs.iter().zip(&linear.runs);
        Ok(runs.map(|(run, linear)| track(run, linear, &nominal, &model, noise.as_ref())).collect())
    })?;
    let array = |rows: &Rows| {
        let array = Array2::from_shape_fn((rows.len(), 3), |(row, column)| rows[row][column]);
        PyArray2::from_owned_array(py, array)
    };
    let arrays = |track: &Track| {
        let time = PyArray1::from_slice(py, &track.time);
        let whitened = track.whitened.as_ref().map(array);
        (track.run.clone(), track.direction, time, track.rows.each_ref().map(array), whitened)
    };
    Ok(made.map_err(refused)?.iter().map(arrays).collect())
}

fn track(
    run: &ObservedRun,
    linear: &ObservedRun,
    nominal: &effect::Model,
    model: &effect::Model,
    noise: Option<&Noise>,
) -> Track {
    let chain = model.chain();
    let rows = |poses: Vec<Pose2>| -> Rows { poses.iter().map(|pose| [pose.x, pose.y, pose.heading]).collect() };
    let (odometry, modelled) = (rows(run.track.poses(&nominal.chain())), rows(run.track.poses(&chain)));
    let measured: Rows = run.seen.iter().map(|(x, y, heading)| [*x, *y, heading.unwrap_or(f64::NAN)]).collect();
    let residual =
        |(seen, told): (&[f64; 3], &[f64; 3])| [seen[0] - told[0], seen[1] - told[1], wrap(seen[2] - told[2])];
    let residuals = measured.iter().zip(&modelled).map(residual).collect();
    let whitened = noise.map(|noise| {
        let white = noise.whiten(linear, &[&linear.residuals_along(&chain)]);
        let mut rows: Rows = vec![[f64::NAN; 3]; run.seen.len()];
        let mut before = None;
        let mut coordinate = 0;
        for (value, block) in white.values.iter().zip(&white.block) {
            coordinate = if before == Some(*block) { coordinate + 1 } else { 0 };
            before = Some(*block);
            let Some(found) = run.blocks.get(*block) else { continue };
            rows[found.first + found.count - 1][coordinate] = *value;
        }
        rows
    });
    Track {
        run: run.name.clone(),
        direction: run.direction.map(umbmark_core::path::Direction::name),
        time: run.track.sights().iter().map(|sight| sight.time).collect(),
        rows: [odometry, modelled, measured, residuals],
        whitened,
    }
}
