//! `export`: a model as the file of another program.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_core::geometry::Pose2;
use umbmark_io::RobotFile;
use umbmark_io::export::{Export, ExportError, TARGETS, UrdfFile, Usual};

use crate::model::Model;
use crate::path::Path;
use crate::{WORDS, choice, refused};

/// A model as text for a target, and what the text does not hold.
#[pyfunction]
pub fn export(
    model: &Model,
    to: &str,
    path: Option<&Path>,
    controller: Option<String>,
    urdf: Option<(String, Option<[String; 2]>)>,
    usual: [f64; 3],
    start: [f64; 3],
) -> PyResult<(String, Vec<String>)> {
    let targets: Vec<_> = TARGETS.iter().map(|target| (target.name, *target)).collect();
    let target = choice("to", to, &targets)?;
    for (parameter, value) in Usual::PARAMETERS.iter().zip(usual) {
        parameter.check(value).map_err(refused)?;
    }
    let [speed, turn_rate, rate] = usual;
    if start.iter().any(|number| !number.is_finite()) {
        return Err(PyValueError::new_err(format!("start must be three finite numbers, got {start:?}")));
    }
    let [x, y, heading] = start;
    let robot = model.model.robot();
    let export = Export {
        noise: model.noise,
        controller,
        beside: path.map(|path| RobotFile::new(robot.clone(), Some(path.0.clone()))),
        urdf: urdf.map(|(file, joints)| UrdfFile::read(file, joints)).transpose().map_err(in_words)?,
        usual: Usual { speed, turn_rate, rate },
        start: Pose2::new(x, y, heading),
        ..Export::of(&model.model)
    };
    let written = target.write(&export).map_err(in_words)?;
    Ok((written.text, written.notes))
}

/// Why a file cannot be written, in Python's words.
fn in_words(error: ExportError) -> PyErr {
    PyValueError::new_err(error.worded(&WORDS))
}
