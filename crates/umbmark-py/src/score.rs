//! `score`.

use pyo3::prelude::*;
use umbmark_core::document;
use umbmark_core::score::{self as core, Convention, Returns, ScoreError};

use crate::arrays::return_errors;
use crate::dataset::Dataset;
use crate::work::detached;
use crate::{choice, refused};

const CONVENTIONS: [(&str, Convention); 2] = [("mean", Convention::Mean), ("sum", Convention::Sum)];

/// The score of return errors in arrays.
#[pyfunction]
pub fn score_arrays(
    cw: &Bound<'_, PyAny>,
    ccw: &Bound<'_, PyAny>,
    bumps_cw: Option<&Bound<'_, PyAny>>,
    bumps_ccw: Option<&Bound<'_, PyAny>>,
    level: f64,
    convention: &str,
) -> PyResult<String> {
    let convention = choice("convention", convention, &CONVENTIONS)?;
    let mut returns = Returns::default();
    for (name, array, errors) in [
        ("cw", Some(cw), &mut returns.cw),
        ("ccw", Some(ccw), &mut returns.ccw),
        ("bumps_cw", bumps_cw, &mut returns.bumps_cw),
        ("bumps_ccw", bumps_ccw, &mut returns.bumps_ccw),
    ] {
        if let Some(array) = array {
            *errors = return_errors(name, array)?;
        }
    }
    let score = detached(cw.py(), || {
        all_finite(&returns)?;
        core::score_returns(&returns, level)
    })?;
    Ok(document::score(&score.map_err(refused)?, convention).to_string())
}

/// The score of a dataset.
#[pyfunction]
pub fn score_dataset(py: Python<'_>, data: &Dataset, level: f64, convention: &str) -> PyResult<String> {
    let convention = choice("convention", convention, &CONVENTIONS)?;
    let mut score = detached(py, || core::score(&data.0.runs, level))?.map_err(refused)?;
    score.warnings.splice(0..0, data.0.warnings.iter().cloned());
    Ok(document::score(&score, convention).to_string())
}

/// Refuses a return error that is no number, its run named as Python would index it.
fn all_finite(returns: &Returns) -> Result<(), ScoreError> {
    for (name, errors) in
        [("cw", &returns.cw), ("ccw", &returns.ccw), ("bumps_cw", &returns.bumps_cw), ("bumps_ccw", &returns.bumps_ccw)]
    {
        let finite = |e: &umbmark_core::dataset::ReturnError| {
            e.x.is_finite() && e.y.is_finite() && e.heading.is_none_or(f64::is_finite)
        };
        if let Some(row) = errors.iter().position(|error| !finite(error)) {
            let error = errors[row];
            let run = format!("{name}[{row}]");
            return Err(ScoreError::NotFinite { run, x: error.x, y: error.y, heading: error.heading });
        }
    }
    Ok(())
}
