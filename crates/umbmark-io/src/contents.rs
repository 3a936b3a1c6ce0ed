//! Logs found in a place, and what they hold before anything is known of their robot.

use super::error::{DatasetError, LineProblem};
use super::layout::csv::{RETURNS, RUNS, robot_beside};
use super::layout::mcap::Topics;
use super::layout::{is_foreign, is_log, look};
use super::probe::{Probe, names_in, stem};
use super::recording::Recording;
use super::remedy::Words;
use std::path::{Path, PathBuf};
use umbmark_core::inspect::LogContents;

/// What `metadata.yaml` is to a bag of ROS 2: the mark of a folder that is one recording.
const BAG: &str = "metadata.yaml";

/// A log in a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FoundLog {
    pub path: PathBuf,
    /// What its run is called: the name of the file, or of the folder of a bag with one file.
    pub name: String,
}

/// The logs of a place: the file itself, or those in a folder, in its `runs` where it has that, and in the bags of ROS 2 in it.
pub(super) fn logs_in(place: &Path) -> Result<Vec<FoundLog>, DatasetError> {
    let probe = Probe::of(place)?;
    if !probe.is_folder {
        let log = FoundLog { path: place.to_owned(), name: stem(place) };
        return Ok(if is_log(place) { vec![log] } else { Vec::new() });
    }
    if probe.has(RUNS) {
        return in_folder(&place.join(RUNS));
    }
    in_folder(place)
}

fn in_folder(folder: &Path) -> Result<Vec<FoundLog>, DatasetError> {
    let names = names_in(folder)?;
    let mut logs = Vec::new();
    for path in names.iter().map(|name| folder.join(name)) {
        if path.is_dir() {
            if path.join(BAG).is_file() {
                logs.extend(bag(&path)?);
            }
        } else if is_log(&path) && stem(&path).to_lowercase() != stem(Path::new(RETURNS)) {
            logs.push(FoundLog { name: stem(&path), path });
        }
    }
    if names.iter().any(|name| name == BAG) {
        logs = bag(folder)?;
    }
    Ok(logs)
}

/// The files of a bag. One that was split has several, each a run of its own.
fn bag(folder: &Path) -> Result<Vec<FoundLog>, DatasetError> {
    let files = names_in(folder)?.into_iter().map(|name| folder.join(name)).filter(|file| is_log(file));
    let mut logs: Vec<FoundLog> = files.map(|path| FoundLog { name: stem(&path), path }).collect();
    if let ([log], Some(name)) = (&mut logs[..], folder.file_name()) {
        log.name = name.to_string_lossy().into_owned();
    }
    Ok(logs)
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
