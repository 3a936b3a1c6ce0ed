//! The beginning of a dataset.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use umbmark_io::export::{ExportError, UrdfFile};
use umbmark_io::{KnownNumbers, Proposal, Topics, read_controller, write_template};

use crate::{WORDS, existing, refused_data};

/// Write a robot.toml and a returns.csv to fill in, or propose a robot.toml from logs.
///
/// Parameters
/// ----------
/// folder : path-like, default "."
///     Where to write; it is made where it is not there.
/// logs : path-like, optional
///     A log in CSV or MCAP, a bag of ROS 1 or 2, or a folder of these. A robot.toml is proposed from them, and they are put into
///     ``runs``. What they do not show is left to fill in, in lines marked FILL IN.
/// urdf : path-like, optional
///     Take wheelbase and wheel diameters from this URDF; with ``logs``.
/// controller_yaml : path-like, optional
///     Take them from the parameters of this ROS 2 controller; with ``logs``.
/// ticks, reference : str, optional
///     Topics of MCAP files and bags, as of ``load_dataset``.
/// replace : bool, default False
///     Whether files that exist are replaced.
///
/// Returns
/// -------
/// tuple of pathlib.Path
///     The files that were written: two to fill in, or the proposed robot.toml.
///
/// Raises
/// ------
/// ValueError
///     If files are there already, if nothing can be written, or if no log shows how the wheels turned.
#[pyfunction]
#[pyo3(signature = (
    folder=PathBuf::from("."), *, logs=None, urdf=None, controller_yaml=None, ticks=None, reference=None, replace=false
))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn init<'py>(
    py: Python<'py>,
    folder: PathBuf,
    logs: Option<PathBuf>,
    urdf: Option<PathBuf>,
    controller_yaml: Option<PathBuf>,
    ticks: Option<String>,
    reference: Option<String>,
    replace: bool,
) -> PyResult<Bound<'py, PyTuple>> {
    let Some(logs) = logs else {
        if urdf.is_some() || controller_yaml.is_some() || ticks.is_some() || reference.is_some() {
            return Err(PyValueError::new_err("urdf, controller_yaml, ticks and reference need logs"));
        }
        return PyTuple::new(py, write_template(&folder, existing(replace)).map_err(refused_data)?);
    };
    let mut known: Vec<KnownNumbers> = Vec::new();
    known.extend(controller_yaml.map(read_controller).transpose().map_err(refused_data)?);
    if let Some(urdf) = urdf {
        let in_words = |error: ExportError| PyValueError::new_err(error.worded(&WORDS));
        known.push(UrdfFile::read(urdf, None).and_then(|urdf| urdf.numbers()).map_err(in_words)?);
    }
    let topics = Topics { ticks, reference };
    let proposal = Proposal::of(&logs, &folder, &topics, &known, &WORDS).map_err(refused_data)?;
    PyTuple::new(py, [proposal.write(&folder, existing(replace)).map_err(refused_data)?])
}
