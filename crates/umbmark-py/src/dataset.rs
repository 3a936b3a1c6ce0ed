//! Measured (or simulated) robots.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2, ndarray::Array2};
use pyo3::exceptions::{PyIndexError, PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyIterator, PySlice, PyTuple};
use serde::{Deserialize, Serialize};
use umbmark_cli::told;
use umbmark_core::dataset::{self as core, RunClock, RunConditions, RunTopics};
use umbmark_core::result;
use umbmark_io::{Layout, Recorded, Topics, assemble};

use crate::arguments::{integer, poses};
use crate::path::{DIRECTIONS, Path};
use crate::robot::Robot;
use crate::run::{self, Run, TESTS};
use crate::score::{ARRAYS, all_finite};
use crate::stated;
use crate::work::{detached, watched};
use crate::{choice, existing, hash_of, json, refused, refused_data};

/// A robot and its runs, measured or simulated. Frozen; ``umbmark.load_dataset`` reads one.
///
/// It is a sequence of its runs: ``len(data)``, ``data[0]``, ``data["cw_01"]``, ``for run in data``; a slice is the dataset of
/// those runs. Datasets are equal if robot, path and runs are.
///
/// Parameters
/// ----------
/// robot : Robot, optional
///     The nominal robot; scores do without.
/// path : Path, optional
///     The path that it was told to drive.
/// runs : sequence of Run
///     Its runs; two of one direction and test have different numbers, and all have different names.
///
/// Raises
/// ------
/// ValueError
///     If two runs have the same number or name.
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> runs = [umbmark.Run("cw", 1, returned=(-0.21, -0.19, -0.05))]
/// >>> data = umbmark.Dataset(umbmark.Robot.labmate(), umbmark.Path.umbmark(), runs)
/// >>> data.returns("cw")
/// array([[-0.21, -0.19, -0.05]])
#[pyclass(frozen, eq, sequence, module = "umbmark")]
pub struct Dataset(pub Arc<core::Dataset>);

impl PartialEq for Dataset {
    fn eq(&self, other: &Dataset) -> bool {
        let of = |data: &Dataset| (data.0.robot.clone(), data.path(), data.0.reference_frame);
        of(self) == of(other) && self.0.runs == other.0.runs && self.0.conditions == other.0.conditions
    }
}

impl From<core::Dataset> for Dataset {
    fn from(data: core::Dataset) -> Dataset {
        Dataset(Arc::new(data))
    }
}

/// What a pickled dataset holds beside robot and path.
#[derive(Default, Serialize, Deserialize)]
struct Rest {
    reference_frame: core::ReferenceFrame,
    #[serde(default)]
    columns: Vec<core::ColumnName>,
    runs: Vec<core::Run>,
    sessions: Vec<core::Session>,
    #[serde(default)]
    conditions: Vec<RunConditions>,
    clocks: Vec<RunClock>,
    topics: Vec<RunTopics>,
    warnings: Vec<String>,
}

#[pymethods]
impl Dataset {
    #[new]
    #[pyo3(signature = (robot=None, path=None, runs=Vec::new()))]
    fn new(robot: Option<&Robot>, path: Option<&Path>, runs: Vec<Py<Run>>) -> PyResult<Dataset> {
        let mut runs: Vec<core::Run> = runs.iter().map(|run| run.get().core().clone()).collect();
        all_differ(&runs)?;
        if let Some(robot) = robot {
            for log in runs.iter_mut().filter_map(|run| run.log.as_mut()) {
                log.place_headings(&robot.0);
            }
        }
        Ok(Rest { runs, ..Rest::default() }.with(robot, path))
    }

    /// Make a dataset of return errors in arrays, one row a run.
    ///
    /// Parameters
    /// ----------
    /// cw, ccw : array of numbers, shape (n, 3) or (n, 2), optional
    ///     Return errors of the clockwise and of the counter-clockwise runs: x in m, y in m, heading in rad, each absolute minus
    ///     computed (Eq. 1), in the frame of START; NaN, or no third column, for a heading that was not measured.
    /// robot : Robot, optional
    ///     The nominal robot; scores do without.
    /// path : Path, optional
    ///     The path that it was told to drive.
    /// bumps_cw, bumps_ccw : array of numbers, shape (n, 3) or (n, 2), optional
    ///     The same of the extended test, driven over bumps.
    ///
    /// Returns
    /// -------
    /// Dataset
    ///     The runs of each array are numbered from 1.
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     If an argument has no such numbers; it names the argument.
    ///
    /// Examples
    /// --------
    /// >>> import umbmark
    /// >>> cw, ccw = [[-0.21, -0.19, -0.05]], [[0.02, 0.01, 0.01], [0.01, -0.02, 0.02]]
    /// >>> robot, path = umbmark.Robot.labmate(), umbmark.Path.umbmark()
    /// >>> data = umbmark.Dataset.from_arrays(cw, ccw, robot=robot, path=path)
    /// >>> data
    /// Dataset(TRC LabMate, square of 16.000000 m: 1 cw + 2 ccw runs, 0 with ticks)
    #[staticmethod]
    #[pyo3(signature = (cw=None, ccw=None, *, robot=None, path=None, bumps_cw=None, bumps_ccw=None))]
    fn from_arrays(
        cw: Option<&Bound<'_, PyAny>>,
        ccw: Option<&Bound<'_, PyAny>>,
        robot: Option<&Robot>,
        path: Option<&Path>,
        bumps_cw: Option<&Bound<'_, PyAny>>,
        bumps_ccw: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Dataset> {
        let mut runs = Vec::new();
        for (index, (name, array)) in ARRAYS.into_iter().zip([cw, ccw, bumps_cw, bumps_ccw]).enumerate() {
            let Some(array) = array else { continue };
            let ((_, direction), (_, test)) = (DIRECTIONS[index % 2], TESTS[index / 2]);
            let rows = poses(name, array)?;
            let rows: &[[f64; 3]] = rows.as_slice()?.as_chunks().0;
            all_finite(name, rows).map_err(refused)?;
            for (number, row) in (1..).zip(rows) {
                let name = format!("{name}_{number:02}");
                let returned = Some(core::ReturnError::from(*row));
                runs.push(core::Run { name, number, direction: Some(direction), test, log: None, returned });
            }
        }
        Ok(Rest { runs, ..Rest::default() }.with(robot, path))
    }

    /// Make a dataset of logs in one frame, a row for each reading of the counters.
    ///
    /// Rows are read as those of ``runs/*.csv`` are: counters may roll over, poses may stand in a frame of their own, and START is
    /// found from them; ``warnings`` say what was mended.
    ///
    /// Parameters
    /// ----------
    /// frame : pandas, polars or Arrow table, xarray.Dataset, or dict of str to array
    ///     The columns, also of anything that hands over a stream of Arrow.
    /// robot : Robot, optional
    ///     The nominal robot.
    /// path : Path, optional
    ///     The path that it was told to drive.
    /// run : str or None, default "run"
    ///     The column that names the run of each row. A name such as "cw_01" or "ccw_03" tells direction and number; of other
    ///     names, the direction follows from the counts. None where all rows are one run.
    /// t : str, default "t_s"
    ///     The column of times in s, or of dates.
    /// ticks : tuple of str, default ("ticks_left", "ticks_right")
    ///     The columns of the two counters.
    /// pose : tuple of str or None, default ("x_ref_m", "y_ref_m", "theta_ref_rad")
    ///     The columns of the absolute poses: x in m, y in m and, where it was measured, heading in rad; NaN where there was no
    ///     measurement. None where there are no poses.
    ///
    /// Returns
    /// -------
    /// Dataset
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     If a column is missing or has no such numbers, or a file with these rows would be refused; it names the column.
    ///
    /// Examples
    /// --------
    /// >>> import umbmark
    /// >>> counts = [0, 100, 200]
    /// >>> frame = {"run": ["cw_01"] * 3, "t": [0, 1, 2], "left": counts, "right": counts}
    /// >>> umbmark.Dataset.from_frame(frame, t="t", ticks=("left", "right"), pose=None)
    /// Dataset(unknown robot, unknown path: 1 cw + 0 ccw runs, 1 with ticks)
    #[staticmethod]
    #[pyo3(
        signature = (frame, *, robot=None, path=None, run=Some("run".to_owned()), t="t_s".to_owned(), ticks=counters(), pose=Some(poses_of_files())),
        text_signature = "(frame, *, robot=None, path=None, run='run', t='t_s', ticks=('ticks_left', 'ticks_right'), \
                          pose=('x_ref_m', 'y_ref_m', 'theta_ref_rad'))"
    )]
    #[allow(clippy::too_many_arguments)]
    fn from_frame(
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        robot: Option<&Robot>,
        path: Option<&Path>,
        run: Option<String>,
        t: String,
        ticks: (String, String),
        pose: Option<Vec<String>>,
    ) -> PyResult<Dataset> {
        let columns = [t.clone(), ticks.0.clone(), ticks.1.clone()];
        let read = py.import("umbmark._frames")?.call_method1("logs", (frame, run, t, ticks, pose))?;
        let mut logs = Vec::new();
        for log in read.try_iter()? {
            let (name, time, left, right, samples, poses): Columns<'_> = log?.extract()?;
            let reference = run::references(&samples, &poses);
            let [time, left, right] = [time, left, right].map(|column| column.as_array().to_vec());
            logs.push(Recorded { name, columns: columns.clone(), time, counts: [left, right], reference });
        }
        let (robot, path) = (robot.map(|robot| robot.0.clone()), path.map(|path| path.0.clone()));
        detached(py, || assemble(robot, path, logs))?.map(Dataset::from).map_err(refused_data)
    }

    /// The nominal robot; None where a return sheet was given without one.
    #[getter]
    fn robot(&self) -> Option<Robot> {
        self.0.robot.clone().map(Robot)
    }

    /// The path that it was told to drive, where that is known.
    #[getter]
    fn path(&self) -> Option<Path> {
        self.0.path.clone().map(Path)
    }

    /// The runs.
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, (0..self.0.runs.len()).map(|index| Run::of(&self.0, index)))
    }

    fn __len__(&self) -> usize {
        self.0.runs.len()
    }

    /// Give a run by its place or its name, or the dataset of a slice of the runs.
    fn __getitem__<'py>(&self, py: Python<'py>, key: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        if let Ok(name) = key.extract::<&str>() {
            let named = self.0.runs.iter().position(|run| run.name == name);
            let index = named.ok_or_else(|| {
                let names: Vec<&str> = self.0.runs.iter().map(|run| run.name.as_str()).collect();
                PyKeyError::new_err(format!("there is no run \"{name}\"; there are {}", names.join(", ")))
            })?;
            return Ok(Run::of(&self.0, index).into_pyobject(py)?.into_any());
        }
        if let Ok(slice) = key.cast::<PySlice>() {
            let indices = slice.indices(self.0.runs.len() as isize)?;
            let place = |step: isize| (indices.start + step * indices.step) as usize;
            let steps = 0..indices.slicelength as isize;
            let runs: Vec<core::Run> = steps.map(|step| self.0.runs[place(step)].clone()).collect();
            let names: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
            let (clocks, topics) = (self.0.clocks.iter(), self.0.topics.iter());
            let part = core::Dataset {
                clocks: clocks.filter(|clock| names.contains(&clock.run)).cloned().collect(),
                topics: topics.filter(|topics| names.contains(&topics.run)).cloned().collect(),
                conditions: self.0.conditions.iter().filter(|stated| names.contains(&stated.run)).cloned().collect(),
                runs,
                ..(*self.0).clone()
            };
            return Ok(Dataset::from(part).into_pyobject(py)?.into_any());
        }
        let given = integer("index", key)?;
        let count = self.0.runs.len();
        let from_end = |index: isize| if index < 0 { index.checked_add_unsigned(count) } else { Some(index) };
        let place = given.extract().ok().and_then(from_end).and_then(|index| usize::try_from(index).ok());
        let Some(place) = place.filter(|place| *place < count) else {
            let words = match count.checked_sub(1) {
                Some(last) => format!("index must be between -{count} and {last}, got {given}"),
                None => "there are no runs".to_owned(),
            };
            return Err(PyIndexError::new_err(words));
        };
        Ok(Run::of(&self.0, place).into_pyobject(py)?.into_any())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.runs(py)?.try_iter()
    }

    fn __hash__(&self) -> u64 {
        let lengths = self.0.runs.iter().map(|run| (&run.name, run.log.as_ref().map(|log| log.time.len())));
        hash_of(&lengths.collect::<Vec<_>>())
    }

    /// What the reader noticed and mended, one sentence each.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.warnings)
    }

    /// What is stated of the conditions of its runs: each condition with its value of every run, a word or a number; None where it is not known.
    #[getter]
    fn conditions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        stated::told(py, &self.0)
    }

    /// Give the same dataset with the conditions of its runs; what was stated before is kept unless it is given anew.
    ///
    /// Parameters
    /// ----------
    /// **conditions : str, number, or sequence of them
    ///     Each condition by its name, which ends in the unit of a number: one value for all runs, or one for each run in the order of
    ///     ``runs``; None or NaN where it is not known. Words are levels; numbers are amounts on which the robot may depend by a slope.
    ///
    /// Returns
    /// -------
    /// Dataset
    ///
    /// Raises
    /// ------
    /// TypeError, ValueError
    ///     If a value is neither a word nor a finite number, or if there are not as many as runs; it names the condition.
    ///
    /// Examples
    /// --------
    /// >>> import umbmark
    /// >>> data = umbmark.Dataset.from_arrays([[0.1, 0.2, 0.0]] * 3, robot=umbmark.Robot.labmate())
    /// >>> data.with_conditions(floor=["tile", "tile", "carpet"], load_kg=2).conditions
    /// {'floor': ['tile', 'tile', 'carpet'], 'load_kg': [2.0, 2.0, 2.0]}
    #[pyo3(signature = (**conditions))]
    fn with_conditions(&self, conditions: Option<&Bound<'_, PyDict>>) -> PyResult<Dataset> {
        stated::with_conditions(&self.0, conditions).map(Dataset::from)
    }

    /// Give the known return errors of a direction.
    ///
    /// Parameters
    /// ----------
    /// direction : str
    ///     "cw" or "ccw".
    /// test : str, default "systematic"
    ///     "systematic", or "bumps" for the extended test.
    ///
    /// Returns
    /// -------
    /// ndarray of float64, shape (n, 3)
    ///     x in m, y in m and heading in rad, absolute minus computed (Eq. 1), in the frame of START; NaN for a heading that
    ///     was not measured.
    #[pyo3(signature = (direction, test="systematic"))]
    fn returns<'py>(&self, py: Python<'py>, direction: &str, test: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (direction, test) = (choice("direction", direction, &DIRECTIONS)?, choice("test", test, &TESTS)?);
        let rows: Vec<f64> =
            self.0.returns(test, direction).flat_map(|e| [e.x, e.y, e.heading.unwrap_or(f64::NAN)]).collect();
        let shape = (rows.len() / 3, 3);
        let array = Array2::from_shape_vec(shape, rows).map_err(refused)?;
        Ok(PyArray2::from_owned_array(py, array))
    }

    /// Write it in a layout.
    ///
    /// Parameters
    /// ----------
    /// place : path-like
    ///     Folder to write, or NAME.mcap for one run as a log of ROS 2.
    /// layout : str, optional
    ///     "csv", "mcap", "optiodom", "tum" or "returns"; "csv" where nothing is said, and "mcap" for NAME.mcap.
    /// replace : bool, default False
    ///     Whether files that exist are replaced.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     What the layout cannot hold, a sentence each.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If files are there already, or nothing can be written.
    #[pyo3(signature = (place, *, layout=None, replace=false))]
    fn save(&self, py: Python<'_>, place: PathBuf, layout: Option<&str>, replace: bool) -> PyResult<Vec<String>> {
        let named = |layout: &'static Layout| (layout.name, layout);
        let layout = match layout {
            Some(name) => choice("layout", name, &Layout::written().map(named).collect::<Vec<_>>())?,
            None => Layout::of_place(&place),
        };
        detached(py, || layout.write(&self.0, &place, existing(replace)))?.map_err(refused_data)
    }

    /// Draw the return errors, cw and ccw, or the tracks.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib axes, optional
    ///     Where to draw; a new figure where none is given.
    /// tracks : bool, default False
    ///     Whether to draw the measured tracks instead of the return errors.
    ///
    /// Returns
    /// -------
    /// matplotlib axes
    #[pyo3(signature = (ax=None, *, tracks=false))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<&Bound<'py, PyAny>>, tracks: bool) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("umbmark._plots")?.call_method1("dataset", (slf, ax, tracks))
    }

    fn __repr__(&self) -> String {
        let robot = self.0.robot.as_ref().map_or("unknown robot", |robot| robot.name.as_str());
        let path = self
            .0
            .path
            .as_ref()
            .map_or("unknown path".to_owned(), |p| format!("{} of {:.6} m", p.shape().name, p.length()));
        let count = |direction| self.0.runs.iter().filter(|run| run.direction == Some(direction)).count();
        let [(_, cw), (_, ccw)] = DIRECTIONS;
        let logs = self.0.runs.iter().filter(|run| run.log.is_some()).count();
        format!("Dataset({robot}, {path}: {} cw + {} ccw runs, {logs} with ticks)", count(cw), count(ccw))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Pickled<'py>)> {
        let data = &slf.get().0;
        let rest = Rest {
            reference_frame: data.reference_frame,
            columns: data.columns.clone(),
            runs: data.runs.clone(),
            sessions: data.sessions.clone(),
            conditions: data.conditions.clone(),
            clocks: data.clocks.clone(),
            topics: data.topics.clone(),
            warnings: data.warnings.clone(),
        };
        let rest = PyBytes::new(slf.py(), &serde_json::to_vec(&rest).map_err(refused)?);
        Ok((slf.getattr("_from_parts")?, (slf.get().robot(), slf.get().path(), rest)))
    }

    #[staticmethod]
    fn _from_parts(robot: Option<&Robot>, path: Option<&Path>, rest: &[u8]) -> PyResult<Dataset> {
        let rest: Rest = serde_json::from_slice(rest).map_err(refused)?;
        Ok(rest.with(robot, path))
    }
}

/// Columns of a log: name of the run, times, counts of the left and the right wheel, rows of poses, and poses.
type Columns<'py> = (
    String,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray2<'py, f64>,
);

/// The columns of counters in a file.
fn counters() -> (String, String) {
    ("ticks_left".to_owned(), "ticks_right".to_owned())
}

/// The columns of absolute poses in a file.
fn poses_of_files() -> Vec<String> {
    ["x_ref_m", "y_ref_m", "theta_ref_rad"].map(str::to_owned).into()
}

/// Refuses runs that have the same number or name.
fn all_differ(runs: &[core::Run]) -> PyResult<()> {
    let (mut names, mut numbers) = (HashMap::new(), HashMap::new());
    for (index, run) in runs.iter().enumerate() {
        let named = names.insert(&run.name, index);
        let numbered = numbers.insert((run.direction, run.test, run.number), index);
        if let Some(first) = named.or(numbered) {
            let (number, name) = (run.number, &run.name);
            let words = "must each have a number of their own within a direction and test, and a name of their own";
            return Err(PyValueError::new_err(format!(
                "runs {words}; runs[{first}] and runs[{index}] are both number {number} or \"{name}\""
            )));
        }
    }
    Ok(())
}

/// Arguments that make a dataset again.
type Pickled<'py> = (Option<Robot>, Option<Path>, Bound<'py, PyBytes>);

impl Rest {
    fn with(self, robot: Option<&Robot>, path: Option<&Path>) -> Dataset {
        let Rest { reference_frame, columns, runs, sessions, conditions, clocks, topics, warnings } = self;
        let (robot, path) = (robot.map(|robot| robot.0.clone()), path.map(|path| path.0.clone()));
        Dataset::from(core::Dataset {
            robot,
            path,
            reference_frame,
            columns,
            runs,
            sessions,
            conditions,
            clocks,
            topics,
            warnings,
        })
    }
}

/// One place, or several.
#[derive(FromPyObject)]
pub enum Places {
    One(PathBuf),
    Many(Vec<PathBuf>),
}

impl Places {
    fn of(given: &Bound<'_, PyAny>) -> PyResult<Places> {
        given.extract().map_err(|_| {
            let got = given.repr().and_then(|shown| Ok(format!("{shown} ({})", given.get_type().name()?)));
            PyTypeError::new_err(format!("place must be a path, or several, got {}", got.unwrap_or_default()))
        })
    }

    fn all(self) -> Vec<PathBuf> {
        match self {
            Places::One(place) => vec![place],
            Places::Many(places) => places,
        }
    }
}

/// Read a dataset: a folder, an OptiOdom folder, or one file of either.
///
/// Parameters
/// ----------
/// place : path-like or sequence of path-like
///     A folder with robot.toml and returns.csv, and logs in runs; a folder of OptiOdom; a return sheet; a log in CSV or MCAP;
///     a bag of ROS 1 (.bag) or ROS 2 (.db3, or its folder). Several of one robot are read as one; each is a session.
/// ticks : str, optional
///     Topic of the wheels in MCAP files and bags, where it is not found by type; ":LEFT,RIGHT" behind it names the joints,
///     ":left,right" or ":right,left" the order in a list of counts.
/// reference : str, optional
///     Topic of the absolute poses in MCAP files and bags; ":FRAME" behind it picks one of several transforms, "none" reads no poses.
///
/// Returns
/// -------
/// Dataset
///     Its ``warnings`` say what the reader noticed and mended.
///
/// Raises
/// ------
/// ValueError
///     If a file is missing or wrong: file, line, key, value, allowed range, and what to do.
#[pyfunction]
#[pyo3(signature = (place, *, ticks=None, reference=None))]
pub fn load_dataset(
    py: Python<'_>,
    #[pyo3(from_py_with = Places::of)] place: Places,
    ticks: Option<String>,
    reference: Option<String>,
) -> PyResult<Dataset> {
    let topics = Topics { ticks, reference };
    let places = place.all();
    let read = watched(py, 0, None, move |_| umbmark_io::load_together(&places, &topics))?;
    read.map(Dataset::from).map_err(refused_data)
}

/// What a dataset holds, whether it is any good, and what it can determine.
#[pyfunction]
pub fn inspect(py: Python<'_>, data: &Dataset, place: &str) -> PyResult<(String, String)> {
    if data.0.runs.is_empty() {
        return Err(PyValueError::new_err("there are no runs to inspect"));
    }
    let shared = Arc::clone(&data.0);
    let found = watched(py, 1, None, move |_| shared.inspect())?;
    let text = told::inspection(&data.0, &found);
    Ok((json(&result::Inspection::new(place, &data.0, &found, &[]))?, text))
}
