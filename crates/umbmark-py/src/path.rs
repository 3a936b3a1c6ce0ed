//! `umbmark.Path`.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use toml::{Table, Value};
use umbmark_core::path::{Direction, SHAPES};
use umbmark_core::{drive, path, result};
use umbmark_io::RobotFile;

use crate::{as_python, choice, hash_of, keys};

/// The two directions of driving, by name.
pub const DIRECTIONS: [(&str, Direction); 2] = [("cw", Direction::Cw), ("ccw", Direction::Ccw)];

/// A path to be driven in either direction, from START along its heading.
///
/// Parameters
/// ----------
/// shape : str, default "square"
///     One of `Path.shapes()`.
/// **keys
///     The other keys of ``[path]`` in a robot.toml: the sizes of the shape (``side_m`` of a square, ``points_m`` of
///     waypoints, shape (n, 2)) in m, and ``speed_m_s``, ``acceleration_m_s2`` and ``pause_s``.
///
/// Raises
/// ------
/// ValueError
///     If a key is missing, unknown or out of its range, in the words of the file's reader.
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> umbmark.Path(side_m=4.0).length_m
/// 16.0
#[pyclass(frozen, eq, module = "umbmark", from_py_object)]
#[derive(Clone)]
pub struct Path(pub path::Path);

impl PartialEq for Path {
    fn eq(&self, other: &Path) -> bool {
        let described = |p: &Path| (p.0.shape().name, p.0.values().to_vec(), p.0.speed);
        described(self) == described(other)
    }
}

impl Path {
    /// A robot.toml with this path.
    fn file(&self) -> String {
        RobotFile::new(any_robot(), Some(self.0.clone())).text()
    }
}

/// A robot that can drive every path: a file has one, and which does not matter to the path.
fn any_robot() -> drive::Robot {
    drive::Robot { drive: drive::DriveKind::Mecanum.usual(), ..drive::Robot::labmate() }
}

#[pymethods]
impl Path {
    #[new]
    #[pyo3(signature = (shape="square", **keys))]
    fn new(shape: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Path> {
        let mut path = Table::from_iter([("shape".to_owned(), Value::String(shape.to_owned()))]);
        path.extend(keys::table(keys)?);
        let robot = RobotFile::new(any_robot(), None).text();
        let file = format!("{}\n{robot}", Table::from_iter([("path".to_owned(), Value::Table(path))]));
        let file = RobotFile::parse("Path", &file).map_err(|error| keys::refused(&error))?;
        Ok(Path(file.path.unwrap_or_else(path::Path::umbmark)))
    }

    /// The paper's 4 x 4 m square at 0.2 m/s.
    #[staticmethod]
    fn umbmark() -> Path {
        Path(path::Path::umbmark())
    }

    /// A square with sides of this length in m; the other keys as of ``Path``.
    #[staticmethod]
    #[pyo3(signature = (side_m, **keys))]
    fn square(py: Python<'_>, side_m: &Bound<'_, PyAny>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Path> {
        let keys = keys.map_or_else(|| Ok(PyDict::new(py)), |keys| keys.copy())?;
        keys.set_item("side_m", side_m)?;
        Path::new("square", Some(&keys))
    }

    /// Give the names of all shapes, each with what it is.
    #[staticmethod]
    fn shapes(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        SHAPES.iter().map(|shape| (shape.name, shape.about)).into_py_dict(py)
    }

    /// Give shape, sizes in m and length in m, as results have them.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &result::PathFacts::from(&self.0))
    }

    /// Name of its shape.
    #[getter]
    fn shape(&self) -> &'static str {
        self.0.shape().name
    }

    /// Length travelled by the centre of the axle in m.
    #[getter]
    fn length_m(&self) -> f64 {
        self.0.length()
    }

    /// Where a robot without errors ends, (x, y, heading) in m and rad, seen from START, driven "cw" or "ccw".
    fn end(&self, direction: &str) -> PyResult<(f64, f64, f64)> {
        let end = self.0.end(choice("direction", direction, &DIRECTIONS)?);
        Ok((end.x, end.y, end.heading))
    }

    fn __hash__(&self) -> u64 {
        hash_of(&self.file())
    }

    fn __repr__(&self) -> String {
        let file = self.file();
        format!("Path({})", keys::written(file.split_once("[path]\n").map_or("", |(_, path)| path)))
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (String,))> {
        Ok((slf.getattr("_from_toml")?.unbind(), (slf.get().file(),)))
    }

    #[staticmethod]
    fn _from_toml(text: &str) -> PyResult<Path> {
        let file = RobotFile::parse("robot.toml", text).map_err(crate::refused)?;
        Ok(Path(file.path.unwrap_or_else(path::Path::umbmark)))
    }
}
