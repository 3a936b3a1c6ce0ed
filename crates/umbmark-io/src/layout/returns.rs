//! The return sheet alone.

use super::Layout;
use super::csv::returns_text;
use crate::error::DatasetError;
use crate::file_names::RETURNS;
use crate::save::{Existing, put};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::Dataset;
use umbmark_core::prose::counted;

pub(super) const LAYOUT: Layout = Layout::new("returns", "the return sheet alone: returns.csv").writes(write);

fn write(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let text = returns_text(&data.runs).ok_or_else(|| DatasetError::Unwritable {
        file: folder.display().to_string(),
        reason: "no run has a return error".into(),
    })?;
    put(folder, &BTreeMap::from([(PathBuf::from(RETURNS), text)]), existing, |_| Ok(()))?;
    let mut lost = Vec::new();
    let (logs, unknown) = (super::logs(data).count(), data.runs.iter().filter(|run| run.returned.is_none()).count());
    if logs > 0 {
        lost.push(format!("{}: a return sheet holds end poses only", counted(logs, "log")));
    }
    if unknown > 0 {
        lost.push(format!("{} without a return error", counted(unknown, "run")));
    }
    if !data.conditions.is_empty() {
        lost.push("the conditions of the runs: a return sheet holds end poses only".into());
    }
    if data.robot.is_some() {
        lost.push("robot and path: copy robot.toml beside the sheet".into());
    }
    Ok(lost)
}
