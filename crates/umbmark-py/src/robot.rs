//! `umbmark.Robot`.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use toml::{Table, Value};
use umbmark_core::{drive, result};
use umbmark_io::RobotFile;

use crate::{as_python, hash_of, keys, refused};

/// A nominal robot: what its odometry believes of itself.
///
/// Parameters
/// ----------
/// **keys
///     The keys of ``[robot]`` in a robot.toml: ``wheelbase_m``, ``wheel_diameter_m`` (or ``wheel_diameter_left_m`` and
///     ``wheel_diameter_right_m``, or ``wheel_radius_m``) in m, ``ticks_per_revolution``, and where they are known
///     ``name``, ``drive``, ``encoder_rate_hz`` in Hz and ``counter_bits``. A ``drive`` other than "differential", one of
///     `Robot.drives()`, has lengths of its own.
///
/// Raises
/// ------
/// ValueError
///     If a key is missing, unknown or out of its range, in the words of the file's reader.
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> robot = umbmark.Robot(wheelbase_m=0.34, wheel_diameter_m=0.15, ticks_per_revolution=2000)
/// >>> robot.wheelbase_m
/// 0.34
/// >>> umbmark.Robot(wheelbase_m=-0.34, wheel_diameter_m=0.15, ticks_per_revolution=2000)
/// Traceback (most recent call last):
/// ...
/// ValueError: Robot: wheelbase_m must be between 0.001 and 100 m, got -0.34
#[pyclass(frozen, eq, module = "umbmark", from_py_object)]
#[derive(Clone, PartialEq)]
pub struct Robot(pub drive::Robot);

#[pymethods]
impl Robot {
    #[new]
    #[pyo3(signature = (**keys))]
    fn new(keys: Option<&Bound<'_, PyDict>>) -> PyResult<Robot> {
        let file = Table::from_iter([("robot".to_owned(), Value::Table(keys::table(keys)?))]);
        let file = RobotFile::parse("Robot", &file.to_string()).map_err(|error| keys::refused(&error))?;
        Ok(Robot(file.robot))
    }

    /// The TRC LabMate of the paper: wheelbase 0.340 m; wheels of 0.150 m and 2000 ticks per revolution are assumed.
    #[staticmethod]
    fn labmate() -> Robot {
        Robot(drive::Robot::labmate())
    }

    /// Give the names of all drives, each with what it is.
    #[staticmethod]
    fn drives(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        drive::DriveKind::ALL.iter().map(|kind| (kind.name(), kind.about())).into_py_dict(py)
    }

    /// Read the robot of a robot.toml.
    #[staticmethod]
    fn read(file: std::path::PathBuf) -> PyResult<Robot> {
        RobotFile::read(file).map(|file| Robot(file.robot)).map_err(refused)
    }

    /// Read the robot of the text of a robot.toml.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Robot> {
        RobotFile::parse("robot.toml", text).map(|file| Robot(file.robot)).map_err(refused)
    }

    /// Write it as the text of a robot.toml, which reads back to the last bit.
    fn to_toml(&self) -> String {
        RobotFile::new(self.0.clone(), None).text()
    }

    /// Give its keys and values, as results have them.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &result::RobotFacts::from(&self.0))
    }

    /// What people call it.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Nominal wheelbase b in m: the distance between the wheels' contact points.
    #[getter]
    fn wheelbase_m(&self) -> f64 {
        self.0.drive.wheelbase()
    }

    /// Nominal diameter of the left wheel in m.
    #[getter]
    fn wheel_diameter_left_m(&self) -> f64 {
        self.0.drive.wheel_diameter_left()
    }

    /// Nominal diameter of the right wheel in m.
    #[getter]
    fn wheel_diameter_right_m(&self) -> f64 {
        self.0.drive.wheel_diameter_right()
    }

    /// Encoder ticks per wheel revolution, after gearing and quadrature.
    #[getter]
    fn ticks_per_revolution(&self) -> f64 {
        self.0.encoder.ticks_per_revolution()
    }

    /// How often the counters are read in Hz; None for every tick.
    #[getter]
    fn encoder_rate_hz(&self) -> Option<f64> {
        self.0.encoder.rate()
    }

    fn __hash__(&self) -> u64 {
        hash_of(&self.to_toml())
    }

    fn __repr__(&self) -> String {
        format!("Robot({})", keys::written(&self.to_toml()))
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (String,))> {
        Ok((slf.getattr("from_toml")?.unbind(), (slf.get().to_toml(),)))
    }
}
