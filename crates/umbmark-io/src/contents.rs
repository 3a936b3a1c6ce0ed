//! Logs found in a place, and what they hold before anything is known of their robot.

use super::conditions::CONDITIONS;
use super::error::{DatasetError, LineProblem};
use super::file_names::{RETURNS, RUNS, robot_beside};
use super::layout::messages::Topics;
use super::layout::{is_foreign, is_log, look};
use super::probe::{Probe, names_in, stem};
use super::recording::Recording;
use super::remedy::Words;
use std::path::{Path, PathBuf};
use umbmark_core::inspect::LogContents;

/// A log in a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FoundLog {
    pub path: PathBuf,
    /// What its run is called: the name of the file, or of the folder of a bag.
    pub name: String,
}

/// The logs of a place: the place itself where it is one, else those in a folder, in its `runs` where it has that.
pub(super) fn logs_in(place: &Path) -> Result<Vec<FoundLog>, DatasetError> {
    let probe = Probe::of(place)?;
    if is_log(place) {
        let whole = place.canonicalize().unwrap_or_else(|_| place.to_owned());
        return Ok(vec![FoundLog { path: place.to_owned(), name: stem(&whole) }]);
    }
    match (probe.is_folder, probe.has(RUNS)) {
        (false, _) => Ok(Vec::new()),
        (true, true) => in_folder(&place.join(RUNS)),
        (true, false) => in_folder(place),
    }
}

fn in_folder(folder: &Path) -> Result<Vec<FoundLog>, DatasetError> {
    let paths = names_in(folder)?.into_iter().map(|name| folder.join(name));
    let no_logs = [RETURNS, CONDITIONS].map(|name| stem(Path::new(name)));
    let logs = paths.filter(|path| is_log(path) && !no_logs.contains(&stem(path).to_lowercase()));
    Ok(logs.map(|path| FoundLog { name: stem(&path), path }).collect())
}

/// What the logs of a place hold: a file, a folder of logs, a folder with `runs`, or a bag of ROS 2. Empty where no robot is
/// missing (a `robot.toml` stands there, or the layout brings its own), and where there are no logs. `words` names arguments as
/// an edge does.
///
/// # Errors
///
/// Where a log cannot be opened, or is none.
pub fn contents(place: impl AsRef<Path>, topics: &Topics, words: &Words) -> Result<Vec<LogContents>, DatasetError> {
    let place = place.as_ref();
    let probe = Probe::of(place)?;
    if probe.is_folder && is_foreign(&probe) || robot_beside(&probe.folder).is_some() {
        return Ok(Vec::new());
    }
    logs_in(place)?.iter().filter_map(|log| look(&log.path, topics, words)).collect()
}

/// Whether the folder of a dataset has logs in its `runs`.
pub fn has_logs(folder: impl AsRef<Path>) -> bool {
    let runs = folder.as_ref().join(RUNS);
    runs.is_dir() && in_folder(&runs).is_ok_and(|logs| !logs.is_empty())
}

/// The width of counters that are seen to roll over; the reason, where the recording cannot be used.
pub(super) fn rolls_over(recording: Recording, words: &Words) -> Result<Option<u32>, String> {
    match recording.into_log(None, None, &mut Vec::new()) {
        Ok(_) => Ok(None),
        Err(DatasetError::Line { problem: LineProblem::RolledOver { bits, .. }, .. }) => Ok(Some(bits)),
        Err(error) => Err(error.worded(words)),
    }
}
