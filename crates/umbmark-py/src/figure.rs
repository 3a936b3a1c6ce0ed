//! `plot`.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use umbmark_io::whole_file::WholeFile;
use umbmark_plot::figure as core;
use umbmark_plot::kind::{all, find};
use umbmark_plot::render::file::{DOTS_PER_INCH, Format, WIDTHS_MM};
use umbmark_plot::render::plotly;
use umbmark_plot::study::{Options, Study};

use crate::arguments::threads;
use crate::dataset::Dataset;
use crate::diagnose::options_of;
use crate::model::Model;
use crate::work::{Watch, detached, watched};
use crate::{as_python, existing, refused, unwritten};

/// A dataset and a model of its robot, named; without a model, the one that the dataset teaches.
pub type Asked = (String, Py<Dataset>, Option<(String, Model)>);

/// Simulated tests that a figure may be made of.
const TRIALS: std::ops::RangeFrom<u64> = 100..;

/// How studies are made: size, draws and seed of tests, return poses alone, simulated tests.
pub fn options((tests, return_poses, trials): ((f64, usize, u64), bool, u64)) -> PyResult<Options> {
    if !TRIALS.contains(&trials) {
        return Err(PyValueError::new_err(format!("n must be {} or more, got {trials}", TRIALS.start)));
    }
    Ok(Options { diagnose: options_of(tests, return_poses)?, trials })
}

/// The study that was asked for.
pub fn study(py: Python<'_>, (name, data, model): Asked, options: Options) -> PyResult<Study> {
    let data = Arc::clone(&data.get().0);
    if model.is_some() {
        data.nominal_robot().map_err(refused)?;
    }
    let model = model.map(|(name, model)| Ok::<_, PyErr>((name, model.of_data(py, &data)?))).transpose()?;
    Ok(Study::new(name, data, model, options))
}

/// A figure of a report: numbers, axes and three sentences, drawn as SVG, PNG, PDF or by Plotly. Frozen.
///
/// ``umbmark.plot`` makes one. Notebooks show it as SVG.
#[pyclass(frozen, eq, module = "umbmark")]
#[derive(PartialEq)]
pub struct Figure(core::Figure);

#[pymethods]
impl Figure {
    /// Its kind.
    #[getter]
    fn kind(&self) -> &str {
        self.0.kind
    }

    /// A few words.
    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    /// What it shows, in a sentence or two.
    #[getter]
    fn shows(&self) -> &str {
        &self.0.told.shows
    }

    /// What would be good.
    #[getter]
    fn good(&self) -> &str {
        &self.0.told.good
    }

    /// What this one says.
    #[getter]
    fn says(&self) -> &str {
        &self.0.told.says
    }

    /// Give the numbers behind it as words, one dict a row.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let core::Table { header, rows } = &self.0.table;
        let row = |cells: &Vec<String>| {
            let row = PyDict::new(py);
            header.iter().zip(cells).try_for_each(|(key, cell)| row.set_item(key, cell)).map(|()| row)
        };
        rows.iter().map(row).collect()
    }

    /// Draw it as SVG, ``width_mm`` wide (88 mm: a column of a journal).
    #[pyo3(signature = (*, width_mm=88.0))]
    fn to_svg(&self, py: Python<'_>, width_mm: f64) -> PyResult<String> {
        let bytes = self.bytes(py, Format::Svg, width_mm, 300)?;
        String::from_utf8(bytes).map_err(refused)
    }

    /// Draw it as PNG.
    #[pyo3(signature = (*, width_mm=88.0, dpi=300))]
    fn to_png<'py>(&self, py: Python<'py>, width_mm: f64, dpi: u32) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.bytes(py, Format::Png, width_mm, dpi)?))
    }

    /// Draw it as PDF.
    #[pyo3(signature = (*, width_mm=88.0))]
    fn to_pdf<'py>(&self, py: Python<'py>, width_mm: f64) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.bytes(py, Format::Pdf, width_mm, 300)?))
    }

    /// Give it as ``plotly.graph_objects.Figure`` takes it: ``data`` and ``layout``.
    fn to_plotly<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_python(py, &plotly::figure(&self.0))
    }

    /// Write it as NAME.svg, NAME.png, NAME.pdf, or NAME.json for Plotly.
    ///
    /// Parameters
    /// ----------
    /// place : path-like
    ///     The file.
    /// width_mm : float, default 88
    ///     Width, from 40 to 400 mm.
    /// dpi : int, default 300
    ///     Dots per inch of a PNG, from 30 to 1200.
    /// replace : bool, default False
    ///     Whether a file that exists is replaced.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the ending is none of these, a number is out of range, or the file is there already.
    #[pyo3(signature = (place, *, width_mm=88.0, dpi=300, replace=false))]
    fn save(&self, py: Python<'_>, place: PathBuf, width_mm: f64, dpi: u32, replace: bool) -> PyResult<()> {
        let bytes = self.bytes(py, Format::of(&place).map_err(refused)?, width_mm, dpi)?;
        WholeFile::write(&place, existing(replace), &bytes).map_err(unwritten)
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        self.to_svg(py, 130.0)
    }

    fn __repr__(&self) -> String {
        format!("Figure({}: {})", self.0.kind, self.0.told.says)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = serde_json::to_string(&slf.get().0).map_err(refused)?;
        Ok((slf.getattr("_from_json")?, (text,)))
    }

    #[staticmethod]
    fn _from_json(text: &str) -> PyResult<Figure> {
        serde_json::from_str(text).map(Figure).map_err(refused)
    }
}

impl Figure {
    fn bytes(&self, py: Python<'_>, format: Format, width_mm: f64, dpi: u32) -> PyResult<Vec<u8>> {
        if !WIDTHS_MM.contains(&width_mm) {
            let (least, most) = (WIDTHS_MM.start(), WIDTHS_MM.end());
            return Err(PyValueError::new_err(format!("width_mm must be from {least} to {most}, got {width_mm}")));
        }
        if !DOTS_PER_INCH.contains(&dpi) {
            let (least, most) = (DOTS_PER_INCH.start(), DOTS_PER_INCH.end());
            return Err(PyValueError::new_err(format!("dpi must be from {least} to {most}, got {dpi}")));
        }
        detached(py, || format.bytes(&self.0, width_mm, dpi))?.map_err(refused)
    }
}

/// The kinds of figures, and what each shows.
#[pyfunction]
pub fn kinds(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let kinds = PyDict::new(py);
    all().try_for_each(|kind| kinds.set_item(kind.name, kind.about)).map(|()| kinds)
}

/// One figure of a dataset and a model.
#[pyfunction]
pub fn figure(
    py: Python<'_>,
    kind: &str,
    asked: Asked,
    how: ((f64, usize, u64), bool, u64),
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Figure> {
    let known = || all().map(|kind| kind.name).collect::<Vec<_>>().join(", ");
    let kind = find(kind)
        .ok_or_else(|| PyValueError::new_err(format!("there is no figure \"{kind}\"; there are {}", known())))?;
    let study = study(py, asked, options(how)?)?;
    let name = study.name.clone();
    let made = watched(py, threads, progress, move |told: &Watch| {
        let study = study.stopped_by(&told.stop);
        if study.given.is_none() {
            // Why nothing could be learnt, the figure says where it matters.
            let _ = told.work(|watch| study.learn(watch.progress).is_ok());
        }
        (kind.build)(&study)
    })?;
    let refuse = |why| PyValueError::new_err(format!("{} cannot be drawn from {name}: {why}", kind.name));
    made.map(Figure).map_err(refuse)
}
