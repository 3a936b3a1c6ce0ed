//! `report`.

use std::path::PathBuf;

use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::result::Report;
use umbmark_io::whole_file::WholeFile;
use umbmark_plot::page::{Origin, Provenance, change, page, said};
use umbmark_plot::study::Study;

use crate::arguments::threads;
use crate::figure::{Asked, options, study};
use crate::work::{Watch, watched};
use crate::{existing, json, refused, unwritten};

/// The page of one study or of two side by side, and its document. `call` is how Python asked, `places` what it read.
#[pyfunction]
pub fn report(
    py: Python<'_>,
    asked: Vec<Asked>,
    how: ((f64, usize, u64), bool, u64),
    call: String,
    places: Vec<PathBuf>,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    let options = options(how)?;
    let studies = asked.into_iter().map(|asked| study(py, asked, options)).collect::<PyResult<Vec<Study>>>()?;
    let files = places.iter().map(|place| Origin::of_dataset(place)).collect::<Result<Vec<_>, _>>();
    let files = files.map_err(refused)?.concat();
    let (version, seed) = (umbmark_core::VERSION.to_owned(), options.diagnose.seed);
    let provenance = Provenance { version, seed, command: call, files };
    let made = watched(py, threads, progress, move |told: &Watch| {
        let studies: Vec<Study> = studies.into_iter().map(|study| study.stopped_by(&told.stop)).collect();
        for study in studies.iter().filter(|study| study.given.is_none()) {
            // Why nothing could be learnt, the page says.
            let _ = told.work(|watch| study.learn(watch.progress).is_ok());
        }
        let html = page(&studies, &provenance, told::ACTIONS, |_| ())?;
        let report = Report {
            bytes: html.len(),
            studies: studies.iter().map(said).collect(),
            change: change(&studies),
            seed,
            version: umbmark_core::VERSION,
        };
        Ok::<_, umbmark_plot::page::PageError>((report, html))
    })?;
    let (report, html) = made.map_err(refused)?;
    Ok((json(&report)?, html))
}

/// Writes a file, whole or not at all.
#[pyfunction]
pub fn write(place: PathBuf, bytes: &[u8], replace: bool) -> PyResult<()> {
    WholeFile::write(&place, existing(replace), bytes).map_err(unwritten)
}
