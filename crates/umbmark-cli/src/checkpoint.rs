//! Studies written down: the file of `mc --checkpoint`, and of shards for `merge`.

use std::path::Path;

use anyhow::Context;
use serde::{Deserialize, Serialize};
use umbmark_core::monte_carlo::Ensemble;

use crate::ensemble_report::Description;
use crate::files::Pending;

/// A study, described, and what is known of it so far.
#[derive(Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    /// What it is.
    pub description: Description,
    /// What is done.
    pub ensemble: Ensemble,
}

impl Checkpoint {
    /// Reads a checkpoint.
    pub fn load(file: &Path) -> anyhow::Result<Checkpoint> {
        let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
        serde_json::from_str(&text).with_context(|| {
            format!("{} is no checkpoint of this version of umbmark; give a file of `mc --checkpoint`", file.display())
        })
    }

    /// Writes a checkpoint in the place of the last one, whole or not at all.
    pub fn save(file: &Path, description: &Description, ensemble: &Ensemble) -> anyhow::Result<()> {
        #[derive(Serialize)]
        struct Borrowed<'a> {
            description: &'a Description,
            ensemble: &'a Ensemble,
        }
        let text = serde_json::to_string(&Borrowed { description, ensemble })?;
        Pending::write_whole(file, true, &(text + "\n"))
    }
}
