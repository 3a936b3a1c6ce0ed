//! `apply`: corrected odometry as arrays.

use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_core::apply::{Corrected, apply_to_all};
use umbmark_core::geometry::Pose2;

use crate::dataset::Dataset;
use crate::model::Model;
use crate::refused;

/// A run by name: times, poses and, where noise is known, covariances.
type Arrays<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>);

/// The corrected odometry of each run that has a log.
#[pyfunction]
pub fn apply<'py>(py: Python<'py>, data: &Dataset, model: &Model, start: [f64; 3]) -> PyResult<Vec<Arrays<'py>>> {
    if let Some(drawn) = model.draws.first() {
        let (parameter, effect) = (drawn.parameter().name, drawn.effect());
        return Err(PyValueError::new_err(format!("{parameter} of {effect} is drawn; give it a value")));
    }
    let [x, y, heading] = start;
    let for_robot = model.of_data(py, &data.0)?;
    let corrected = apply_to_all(&data.0, &for_robot, model.noise.as_ref(), Pose2::new(x, y, heading));
    let corrected = corrected.map_err(refused)?;
    if corrected.is_empty() {
        return Err(PyValueError::new_err("no run has wheel counts, and odometry is made of them"));
    }
    Ok(corrected.iter().map(|(run, corrected)| arrays(py, &run.name, corrected)).collect())
}

fn arrays<'py>(py: Python<'py>, run: &str, corrected: &Corrected) -> Arrays<'py> {
    let n = corrected.poses.len();
    let poses = Array2::from_shape_fn((n, 3), |(row, column)| {
        let pose = &corrected.poses[row];
        [pose.x, pose.y, pose.heading][column]
    });
    let covariances = corrected.spread.as_ref().map(|spread| {
        Array3::from_shape_fn((n, 3, 3), |(row, i, j)| {
            let [xx, xy, yy, x_heading, y_heading, heading] = spread[row].numbers();
            [[xx, xy, x_heading], [xy, yy, y_heading], [x_heading, y_heading, heading]][i][j]
        })
    });
    (
        run.to_owned(),
        PyArray1::from_slice(py, &corrected.time),
        PyArray2::from_owned_array(py, poses),
        covariances.map(|covariances| PyArray3::from_owned_array(py, covariances)),
    )
}
