//! `paper`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::paper::{self as core, Bench, PaperError};
use umbmark_core::result::Paper;

use crate::arguments::{seed, threads};
use crate::work::{Watch, watched};
use crate::{choice, json, refused};

/// Adds what an experiment found.
type Experiment = fn(&Bench, &mut Paper) -> Result<(), PaperError>;

const EXPERIMENTS: [(&str, Experiment); 7] = [
    ("table_1", |bench, all| core::table_one(bench).map(|found| all.table_1 = Some(found))),
    ("table_2", |bench, all| core::table_two(bench).map(|found| all.table_2 = Some(found))),
    ("figure_2", |_, all| core::masking().map(|found| all.figure_2 = Some(found))),
    ("figure_5", |bench, all| core::clusters(bench.seed).map(|found| all.figure_5 = Some(found))),
    ("figure_6", |_, all| core::bump_places().map(|found| all.figure_6 = Some(found))),
    ("figure_eight", |_, all| core::figure_eight().map(|found| all.figure_eight = Some(found))),
    ("rectangle", |_, all| core::rectangle().map(|found| all.rectangle = Some(found))),
];

/// Tests of each robot that a table may be made of.
const TRIALS: std::ops::RangeInclusive<u64> = 10..=10_000_000;

/// Experiments of the paper, as one document and in words; all of them where none is named.
#[pyfunction]
pub fn paper(
    py: Python<'_>,
    names: Vec<String>,
    trials: u64,
    #[pyo3(from_py_with = seed)] seed: u64,
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    if !TRIALS.contains(&trials) {
        let (least, most) = (TRIALS.start(), TRIALS.end());
        return Err(PyValueError::new_err(format!("n must be between {least} and {most}, got {trials}")));
    }
    for name in &names {
        choice("experiment", name, &EXPERIMENTS)?;
    }
    let found = watched(py, threads, progress, move |told: &Watch| {
        let wanted = |name: &str| names.is_empty() || names.iter().any(|known| known == name);
        let mut found = Paper::new(seed);
        for (_, experiment) in EXPERIMENTS.iter().filter(|(name, _)| wanted(name)) {
            told.work(|watch| experiment(&Bench { trials, seed, watch }, &mut found))?;
        }
        Ok::<_, PaperError>(found)
    })?;
    let found = found.map_err(refused)?;
    Ok((json(&found)?, told::paper(&found)))
}
