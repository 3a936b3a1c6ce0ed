//! One drive round a path.

use std::sync::Arc;

use numpy::ndarray::{Array2, ArrayView1};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_core::dataset::{self as core, Dataset, ReferencePose, ReturnError, TickLog};
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

use crate::arguments::{self, column, indices, whole};
use crate::path::DIRECTIONS;
use crate::{choice, hash_of, refused};

/// The two tests, by name.
pub const TESTS: [(&str, TestKind); 2] = [("systematic", TestKind::Systematic), ("bumps", TestKind::Bumps)];

/// One drive round the path: what the encoders showed, where the robot really was, and how it returned. Frozen.
///
/// Parameters
/// ----------
/// direction : str or None
///     "cw" or "ccw"; None for paths that have no sense of driving.
/// number : int
///     Its number, unique within its direction and test.
/// name : str, optional
///     Its name.
/// test : str, default "systematic"
///     "systematic", or "bumps" for the extended test.
/// returned : tuple of float, optional
///     Return error (x, y) in m or (x, y, heading) in m and rad, absolute minus computed (Eq. 1), in the frame of START.
/// time_s, ticks_left, ticks_right : array of numbers, shape (n,), optional
///     Times of the samples in s, and the wheels' cumulative counts.
/// reference_sample : array of whole numbers, shape (m,), optional
///     For each absolute pose, the sample that it belongs to.
/// reference_pose : array of numbers, shape (m, 3) or (m, 2), optional
///     The absolute poses: x in m, y in m, heading in rad (NaN, or no third column, where it was not measured), in the frame of
///     START. NaN for all x and y of a reference that tells headings only, such as a compass.
/// relative : bool, default False
///     Whether each pose tells only how the robot moved since the one before, as poses of visual odometry do, and headings that a
///     gyro added up.
///
/// An array is whatever has numbers: a sequence, a NumPy array of any real type, a column of pandas, polars or Arrow.
///
/// Raises
/// ------
/// TypeError
///     If an argument has no numbers.
/// ValueError
///     If arrays do not belong together, a number is not finite, or times do not increase.
#[pyclass(frozen, eq, module = "umbmark")]
pub struct Run {
    data: Arc<Dataset>,
    index: usize,
}

impl PartialEq for Run {
    fn eq(&self, other: &Run) -> bool {
        self.core() == other.core()
    }
}

#[pymethods]
impl Run {
    #[new]
    #[pyo3(signature = (direction, number, *, name=None, test="systematic", returned=None, time_s=None, ticks_left=None,
        ticks_right=None, reference_sample=None, reference_pose=None, relative=false))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        direction: Option<&str>,
        #[pyo3(from_py_with = number)] number: u32,
        name: Option<String>,
        test: &str,
        returned: Option<Vec<f64>>,
        time_s: Option<&Bound<'_, PyAny>>,
        ticks_left: Option<&Bound<'_, PyAny>>,
        ticks_right: Option<&Bound<'_, PyAny>>,
        reference_sample: Option<&Bound<'_, PyAny>>,
        reference_pose: Option<&Bound<'_, PyAny>>,
        relative: bool,
    ) -> PyResult<Run> {
        let direction = direction.map(|word| choice("direction", word, &DIRECTIONS)).transpose()?;
        let log = match (time_s, ticks_left, ticks_right) {
            (Some(time), Some(left), Some(right)) => {
                let read = |name, array| column(name, array).map(|array| array.as_array().to_vec());
                let time = read("time_s", time)?;
                let (left, right) = (read("ticks_left", left)?, read("ticks_right", right)?);
                let mut reference = match (reference_sample, reference_pose) {
                    (None, None) => Vec::new(),
                    (Some(samples), Some(poses)) => given_references(samples, poses)?,
                    _ => return Err(PyValueError::new_err("reference_sample and reference_pose go together")),
                };
                let headings_only = !reference.is_empty()
                    && reference.iter().all(|pose| pose.x.is_nan() && pose.y.is_nan() && pose.heading.is_some());
                if headings_only {
                    reference.iter_mut().for_each(|pose| (pose.x, pose.y) = (0.0, 0.0));
                }
                Some(checked(TickLog { time, left, right, reference, relative, headings_only, ..TickLog::default() })?)
            }
            (None, None, None) => None,
            _ => return Err(PyValueError::new_err("time_s, ticks_left and ticks_right go together")),
        };
        let named = || format!("{}_{number:02}", direction.map_or("run", Direction::name));
        let run = core::Run {
            name: name.unwrap_or_else(named),
            number,
            direction,
            test: choice("test", test, &TESTS)?,
            log,
            returned: returned.map(|error| return_error(&error)).transpose()?,
        };
        Ok(Run::alone(run))
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.core().name
    }

    /// Its number, unique within its direction and test.
    #[getter]
    fn number(&self) -> u32 {
        self.core().number
    }

    /// "cw" or "ccw"; None for paths that have no sense of driving.
    #[getter]
    fn direction(&self) -> Option<&'static str> {
        self.core().direction.map(Direction::name)
    }

    /// "systematic", or "bumps" for the extended test.
    #[getter]
    fn test(&self) -> &'static str {
        self.core().test.name()
    }

    /// Return error (x, y, heading) in m and rad, heading None where it was not measured; None without a return.
    #[getter]
    fn returned(&self) -> Option<(f64, f64, Option<f64>)> {
        self.core().returned.map(|error| (error.x, error.y, error.heading))
    }

    /// Times of the samples in s, shape (n,); None without ticks.
    #[getter]
    fn time_s<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.column(py, |log| &log.time)
    }

    /// Cumulative counts of the left wheel, roll-overs undone, shape (n,); None without ticks.
    #[getter]
    fn ticks_left<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.column(py, |log| &log.left)
    }

    /// Cumulative counts of the right wheel, roll-overs undone, shape (n,); None without ticks.
    #[getter]
    fn ticks_right<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.column(py, |log| &log.right)
    }

    /// For each absolute pose the sample that it belongs to, shape (m,); None without ticks.
    #[getter]
    fn reference_sample<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<i64>>> {
        let log = self.core().log.as_ref()?;
        Some(PyArray1::from_iter(py, log.reference.iter().map(|pose| pose.sample as i64)))
    }

    /// The absolute poses x, y in m and heading in rad, NaN for what was not measured, shape (m, 3); None without ticks.
    #[getter]
    fn reference_pose<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(log) = &self.core().log else { return Ok(None) };
        let place = |of: f64| if log.headings_only { f64::NAN } else { of };
        let poses =
            log.reference.iter().flat_map(|p| [place(p.x), place(p.y), p.heading.unwrap_or(f64::NAN)]).collect();
        let array = Array2::from_shape_vec((log.reference.len(), 3), poses).map_err(refused)?;
        Ok(Some(PyArray2::from_owned_array(py, array)))
    }

    /// Whether each pose tells only how the robot moved since the one before; None without ticks.
    #[getter]
    fn relative(&self) -> Option<bool> {
        self.core().log.as_ref().map(|log| log.relative)
    }

    fn __hash__(&self) -> u64 {
        let run = self.core();
        hash_of(&(&run.name, run.number, run.log.as_ref().map(|log| log.time.len())))
    }

    fn __repr__(&self) -> String {
        let run = self.core();
        let returned = run.returned.map(|e| format!(", returned=({:.4}, {:.4}) m", e.x, e.y)).unwrap_or_default();
        let log = run.log.as_ref();
        let log = log.map(|log| format!(", {} samples, {} poses", log.time.len(), log.reference.len()));
        format!("Run({}{returned}{})", run.name, log.unwrap_or_default())
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (String,))> {
        let text = serde_json::to_string(slf.get().core()).map_err(refused)?;
        Ok((slf.getattr("_from_json")?.unbind(), (text,)))
    }

    #[staticmethod]
    fn _from_json(text: &str) -> PyResult<Run> {
        serde_json::from_str(text).map(Run::alone).map_err(refused)
    }
}

impl Run {
    /// A run of a dataset.
    pub fn of(data: &Arc<Dataset>, index: usize) -> Run {
        Run { data: Arc::clone(data), index }
    }

    /// The run itself.
    pub fn core(&self) -> &core::Run {
        &self.data.runs[self.index]
    }

    fn alone(run: core::Run) -> Run {
        Run { data: Arc::new(Dataset { runs: vec![run], ..Dataset::default() }), index: 0 }
    }

    fn column<'py>(&self, py: Python<'py>, of: fn(&TickLog) -> &Vec<f64>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.core().log.as_ref().map(|log| PyArray1::from_slice(py, of(log)))
    }
}

/// A number of a run.
fn number(given: &Bound<'_, PyAny>) -> PyResult<u32> {
    Ok(whole("number", given, 0, u32::MAX.into())? as u32)
}

fn return_error(error: &[f64]) -> PyResult<ReturnError> {
    let given = |x: f64, y: f64, heading: Option<f64>| ReturnError { x, y, heading: heading.filter(|h| !h.is_nan()) };
    match *error {
        [x, y] => Ok(given(x, y, None)),
        [x, y, heading] => Ok(given(x, y, Some(heading))),
        _ => Err(PyValueError::new_err(format!(
            "returned must be (x, y) or (x, y, heading), got {} numbers",
            error.len()
        ))),
    }
}

/// The absolute poses of a call.
fn given_references(samples: &Bound<'_, PyAny>, poses: &Bound<'_, PyAny>) -> PyResult<Vec<ReferencePose>> {
    let (samples, poses) = (indices("reference_sample", samples)?, arguments::poses("reference_pose", poses)?);
    let (count, rows) = (samples.as_array().len(), poses.as_array().nrows());
    if count != rows {
        return Err(PyValueError::new_err(format!("reference_pose must have shape ({count}, 3), got [{rows}, 3]")));
    }
    Ok(references(&samples, &poses))
}

/// Absolute poses, each with its sample.
pub fn references(samples: &PyReadonlyArray1<'_, i64>, poses: &PyReadonlyArray2<'_, f64>) -> Vec<ReferencePose> {
    let (samples, poses) = (samples.as_array(), poses.as_array());
    let pose = |(sample, pose): (&i64, ArrayView1<'_, f64>)| ReferencePose {
        sample: usize::try_from(*sample).unwrap_or(usize::MAX),
        x: pose[0],
        y: pose[1],
        heading: Some(pose[2]).filter(|heading| !heading.is_nan()),
    };
    samples.iter().zip(poses.rows()).map(pose).collect()
}

/// Refuses a log that could not have been recorded.
fn checked(log: TickLog) -> PyResult<TickLog> {
    let refuse = |words: String| Err(PyValueError::new_err(words));
    let (time, left, right) = (log.time.len(), log.left.len(), log.right.len());
    if time != left || left != right {
        return refuse(format!(
            "time_s, ticks_left and ticks_right must be alike, got {time}, {left} and {right} samples"
        ));
    }
    let all = [("time_s", &log.time), ("ticks_left", &log.left), ("ticks_right", &log.right)];
    for (name, column) in all {
        if let Some(sample) = column.iter().position(|value| !value.is_finite()) {
            return refuse(format!("{name}[{sample}] must be finite, got {}", column[sample]));
        }
    }
    if let Some(sample) = log.time.windows(2).position(|pair| pair[1] <= pair[0]) {
        let (first, second) = (log.time[sample], log.time[sample + 1]);
        return refuse(format!(
            "time_s must increase, got {first} and {second} s at samples {sample} and {}",
            sample + 1
        ));
    }
    let mut before = 0;
    for (index, pose) in log.reference.iter().enumerate() {
        let (sample, last) = (pose.sample, time.saturating_sub(1));
        if sample < before || sample > last {
            return refuse(format!(
                "reference_sample[{index}] must be between {before} and {last}, got {}",
                sample as i64
            ));
        }
        if !(pose.x.is_finite() && pose.y.is_finite() && pose.heading.is_none_or(f64::is_finite)) {
            return refuse(format!("reference_pose[{index}] must be finite, got ({}, {})", pose.x, pose.y));
        }
        before = sample;
    }
    Ok(log)
}
