//! `export`: a model as the file of another program.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_core::geometry::Pose2;
use umbmark_io::RobotFile;
use umbmark_io::export::{Export, ExportError, TARGETS, UrdfFile, Usual};

use crate::arguments::model;
use crate::model::Model;
use crate::path::Path;
use crate::{WORDS, choice, refused};

/// A model as text for a target, and what the text does not hold.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn export(
    #[pyo3(from_py_with = model)] model: Model,
    to: &str,
    path: Option<&Path>,
    controller: Option<String>,
    urdf: Option<(String, Option<[String; 2]>)>,
    usual: [f64; 3],
    start: [f64; 3],
    force: bool,
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
    let doubt = model.doubt.as_ref().filter(|doubt| !(doubt.alone && target.holds_all));
    if let Some(doubt) = doubt.filter(|_| !force) {
        let because = &doubt.because;
        return Err(PyValueError::new_err(format!(
            "the model is in doubt; force=True gives it all the same. {because}"
        )));
    }
    let written = target.write(&export).map_err(in_words)?;
    let doubt = doubt.map(|doubt| doubt.because.clone());
    Ok((written.text, doubt.into_iter().chain(written.notes).collect()))
}

/// Why a file cannot be written, in Python's words.
fn in_words(error: ExportError) -> PyErr {
    PyValueError::new_err(error.worded(&WORDS))
}
