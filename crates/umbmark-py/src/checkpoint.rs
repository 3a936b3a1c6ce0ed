//! `mc --checkpoint` and `merge`.

use std::path::PathBuf;
use std::time::Duration;

use pyo3::prelude::*;
use umbmark_io::checkpoint::{Checkpoint, CheckpointError, Found, Written};
use umbmark_io::whole_file::WholeFile;

use crate::exception::DataError;
use crate::monte_carlo::{Ensemble, document};
use crate::work::watched;
use crate::{existing, refused, unwritten};

/// Time between two writes \[s\].
const EVERY: Duration = Duration::from_secs(2);

/// Where a study is written down, as Python says it.
pub struct CheckpointOptions {
    /// The file.
    pub file: PathBuf,
    /// Whether to go on with it.
    pub resume: bool,
    /// Whether to begin anew where it is there.
    pub replace: bool,
}

impl CheckpointOptions {
    /// The same for the core.
    pub fn checkpoint(self) -> Checkpoint {
        let found = match (self.resume, self.replace) {
            (true, _) => Found::Resume,
            (false, true) => Found::Replace,
            (false, false) => Found::Refuse,
        };
        Checkpoint { file: self.file, every: EVERY, found }
    }
}

/// What to do about a checkpoint that is there.
pub fn unusable(error: CheckpointError) -> PyErr {
    match error {
        CheckpointError::Exists(_) => {
            DataError::new_err(format!("{error}; resume=True goes on with it, replace=True begins anew"))
        }
        error => refused(error),
    }
}

/// Shards or checkpoints of one study: the document of what they know together, its words, and the ensemble.
#[pyfunction]
pub fn merge(
    py: Python<'_>,
    files: Vec<PathBuf>,
    output: Option<PathBuf>,
    replace: bool,
) -> PyResult<(String, String, Ensemble)> {
    let merged = watched(py, 1, None, move |_| Written::merged(&files))?.map_err(unusable)?;
    if let Some(file) = output {
        let text = merged.text().map_err(refused)?;
        WholeFile::write(&file, existing(replace), text.as_bytes()).map_err(unwritten)?;
    }
    let Written { seed, study, ensemble } = merged;
    let partial = !ensemble.missing().is_empty();
    let (document, text) = document(&ensemble, seed, partial, None, &study)?;
    Ok((document, text, Ensemble(ensemble)))
}
