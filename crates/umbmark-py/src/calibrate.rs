//! `calibrate`, and a calibration put to use.

use std::sync::Arc;

use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::calibrate::{self as core, Options, RadiusWheelbase};
use umbmark_core::{diagnose, effect, learn as learning, result, solve};

use crate::arguments::threads;
use crate::dataset::Dataset;
use crate::exception::DataError;
use crate::model::Model;
use crate::robot::Robot;
use crate::work::{Watch, watched};
use crate::{choice, json, probability, refused};

const WHEELBASES: [(&str, RadiusWheelbase); 2] =
    [("nominal", RadiusWheelbase::Nominal), ("corrected", RadiusWheelbase::Corrected)];

/// A doubt about numbers that no learnt model stands behind.
const NOT_LEARNT: &str = "Whether another effect spoils these numbers was not asked: learn=False was said.";

/// A calibration by every method that the data allows, that of the learnt model only where it is asked for, as a document and in words.
#[pyfunction]
pub fn calibrate(
    py: Python<'_>,
    data: &Dataset,
    level: f64,
    heading_arm_m: Option<f64>,
    radius_wheelbase: &str,
    learn: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<(String, String)> {
    probability("level", level)?;
    let options = Options {
        heading_arm: heading_arm_m,
        radius_wheelbase: choice("radius_wheelbase", radius_wheelbase, &WHEELBASES)?,
    };
    let kind = data.0.nominal_robot().map_err(refused)?.drive.kind();
    if !kind.has_axle_wheels() {
        let name = kind.name();
        let words = format!("this calibrates differential drives, got drive = \"{name}\"; use calibrate_gears");
        return Err(DataError::new_err(words));
    }
    let shared = Arc::clone(&data.0);
    let testing = diagnose::Options::default();
    let work = move |watch: &Watch| {
        let (mut calibration, answer) = match learn {
            true => watch.work(|watch| solve::calibrate_beside(&shared, &options, &testing, watch)),
            false => core::calibrate(&shared, &options).map(|found| (found, None)),
        }
        .map_err(refused)?;
        if calibration.estimates.is_empty() {
            let why = calibration.warnings.join("\n");
            return Err(DataError::new_err(format!("nothing can be calibrated from these runs\n{why}")));
        }
        if !learn {
            calibration.doubts.push(NOT_LEARNT.to_owned());
        }
        let noticed = calibration.setup.notices().len();
        calibration.warnings.splice(noticed..noticed, shared.warnings.iter().cloned());
        let robot = shared.nominal_robot().map_err(refused)?;
        let text = told::calibration(robot, &calibration, answer.as_ref(), level, testing.size);
        Ok((json(&result::Calibration::new(robot, &calibration, answer.as_ref(), level))?, text))
    };
    watched(py, threads, None, work)?
}

/// A calibration of any drive by its first effects: the document, the text, the model, and the corrected robot.
#[pyfunction]
pub fn calibrate_gears(
    py: Python<'_>,
    data: &Dataset,
    level: f64,
    learn: bool,
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<(String, String, Model, Robot)> {
    probability("level", level)?;
    let robot = data.0.nominal_robot().map_err(refused)?;
    let shared = Arc::clone(&data.0);
    let found = watched(py, threads, None, move |_| learning::calibrate_gears(&shared))?.map_err(refused)?;
    if found.estimates.is_empty() {
        return Err(DataError::new_err(
            "nothing can be calibrated from these runs: drive a closed path in both directions, or measure poses on the way",
        ));
    }
    let document = json(&result::GearCalibration::new(robot, &found, level, &data.0.warnings))?;
    let (shared, start) = (Arc::clone(&data.0), effect::Model::new(robot));
    let testing = diagnose::Options::default();
    let ask = move |watch: &Watch| learn.then(|| watch.work(|watch| solve::solve(&shared, &start, &testing, watch)));
    let answer = watched(py, threads, None, ask)?.transpose().map_err(refused)?;
    let text = told::gears(robot, &found, answer.as_ref(), level, testing.size);
    Ok((document, text, found.model.into(), Robot(found.corrected)))
}
