//! `score`.

use std::sync::Arc;

use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::dataset::ReturnError;
use umbmark_core::result;
use umbmark_core::score::{self as core, Convention, ScoreError};

use crate::arguments::poses;
use crate::dataset::Dataset;
use crate::work::{detached, watched};
use crate::{choice, json, refused};

const CONVENTIONS: [(&str, Convention); 2] = [("mean", Convention::Mean), ("sum", Convention::Sum)];

/// The names of the arrays, as in the call.
pub const ARRAYS: [&str; 4] = ["cw", "ccw", "bumps_cw", "bumps_ccw"];

/// The score of return errors in arrays, as a document and in words.
#[pyfunction]
pub fn score_arrays(
    cw: &Bound<'_, PyAny>,
    ccw: &Bound<'_, PyAny>,
    bumps_cw: Option<&Bound<'_, PyAny>>,
    bumps_ccw: Option<&Bound<'_, PyAny>>,
    level: f64,
    convention: &str,
) -> PyResult<(String, String)> {
    let convention = choice("convention", convention, &CONVENTIONS)?;
    let given = ARRAYS.into_iter().zip([Some(cw), Some(ccw), bumps_cw, bumps_ccw]);
    let arrays: PyResult<Vec<_>> =
        given.map(|(name, array)| array.map(|array| poses(name, array)).transpose()).collect();
    let arrays = arrays?;
    let rows = |index: usize| -> PyResult<&[[f64; 3]]> {
        arrays[index].as_ref().map_or(Ok(&[][..]), |array| Ok(array.as_slice()?.as_chunks().0))
    };
    let all = [rows(0)?, rows(1)?, rows(2)?, rows(3)?];
    let score = detached(cw.py(), || {
        ARRAYS.into_iter().zip(all).try_for_each(|(name, rows)| all_finite(name, rows))?;
        let [cw, ccw, bumps_cw, bumps_ccw] = all;
        core::score_returns([cw, ccw], [bumps_cw, bumps_ccw], level)
    })?;
    let score = score.map_err(refused)?;
    Ok((json(&result::Score::new(&score, convention))?, told::score(None, &score, convention)))
}

/// The score of a dataset, as a document and in words.
#[pyfunction]
pub fn score_dataset(py: Python<'_>, data: &Dataset, level: f64, convention: &str) -> PyResult<(String, String)> {
    let convention = choice("convention", convention, &CONVENTIONS)?;
    let shared = Arc::clone(&data.0);
    let mut score = watched(py, 1, None, move |_| core::score_dataset(&shared, level))?.map_err(refused)?;
    let noticed = score.setup.notices().len();
    score.warnings.splice(noticed..noticed, data.0.warnings.iter().cloned());
    Ok((json(&result::Score::new(&score, convention))?, told::score(Some(&data.0), &score, convention)))
}

/// Refuses a return error that is no number, its run named as Python would index it.
pub fn all_finite(name: &str, rows: &[[f64; 3]]) -> Result<(), ScoreError> {
    let wrong = |[x, y, heading]: &[f64; 3]| !x.is_finite() || !y.is_finite() || heading.is_infinite();
    let Some(row) = rows.iter().position(wrong) else { return Ok(()) };
    let ReturnError { x, y, heading } = rows[row].into();
    Err(ScoreError::NotFinite { run: format!("{name}[{row}]"), x, y, heading })
}
