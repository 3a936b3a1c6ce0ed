//! `paper`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Map, Value, json};
use umbmark_core::paper::{self as core, Bench, PaperError};

use crate::work::{Watch, watched};
use crate::{choice, refused};

type Experiment = fn(&Bench) -> Result<Value, PaperError>;

const EXPERIMENTS: [(&str, Experiment); 7] = [
    ("table_1", |bench| Ok(json!(core::table_one(bench)?))),
    ("table_2", |bench| Ok(json!(core::table_two(bench)?))),
    ("figure_2", |_| Ok(json!(core::masking()?))),
    ("figure_5", |bench| Ok(json!(core::clusters(bench.seed)?))),
    ("figure_6", |_| Ok(json!(core::bump_places()?))),
    ("figure_eight", |_| Ok(json!(core::figure_eight()?))),
    ("rectangle", |_| Ok(json!(core::rectangle()?))),
];

/// Tests of each robot that a table may be made of.
const TRIALS: std::ops::RangeInclusive<u64> = 10..=10_000_000;

/// Experiments of the paper, as one document; all of them where none is named.
#[pyfunction]
pub fn paper(
    py: Python<'_>,
    names: Vec<String>,
    trials: u64,
    seed: u64,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    if !TRIALS.contains(&trials) {
        let (least, most) = (TRIALS.start(), TRIALS.end());
        return Err(PyValueError::new_err(format!("n must be between {least} and {most}, got {trials}")));
    }
    for name in &names {
        choice("experiment", name, &EXPERIMENTS)?;
    }
    let found = watched(py, threads, progress, move |told: &Watch| {
        let wanted = |name: &str| names.is_empty() || names.iter().any(|known| known == name);
        let mut document = Map::new();
        for (name, experiment) in EXPERIMENTS.iter().filter(|(name, _)| wanted(name)) {
            let found = told.work(|watch| experiment(&Bench { trials, seed, watch }))?;
            document.insert((*name).to_owned(), found);
        }
        document.insert("seed".to_owned(), json!(seed));
        document.insert("version".to_owned(), json!(umbmark_core::VERSION));
        Ok::<_, PaperError>(Value::Object(document).to_string())
    })?;
    found.map_err(refused)
}
