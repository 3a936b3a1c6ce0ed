//! What a place shows of itself before anything in it is read.

use super::error::DatasetError;
use super::file_names::robot_beside;
use super::robot_file::RobotFile;
use super::source::{Source, unreadable};
use std::path::{Path, PathBuf};

/// A folder, or a file among its neighbours.
pub(super) struct Probe {
    /// The place.
    pub path: PathBuf,
    pub is_folder: bool,
    /// The folder, or that of the file.
    pub folder: PathBuf,
    /// What stands in that folder, sorted, without what is hidden.
    pub names: Vec<String>,
    /// The robot of logs beside which there is none.
    pub robot: Option<RobotFile>,
}

impl Probe {
    pub fn of(path: &Path) -> Result<Probe, DatasetError> {
        let is_folder = std::fs::metadata(path).map_err(|error| unreadable(path, &error))?.is_dir();
        let folder = if is_folder { path } else { folder_of(path) }.to_owned();
        let names = if is_folder { names_in(&folder)? } else { names_in(&folder).unwrap_or_default() };
        Ok(Probe { path: path.to_owned(), is_folder, folder, names, robot: None })
    }

    /// The robot that stands beside the logs, or else the one that was named.
    pub fn robot_file(&self) -> Result<Option<RobotFile>, DatasetError> {
        match robot_beside(&self.folder) {
            Some(robot) => RobotFile::read(robot).map(Some),
            None => Ok(self.robot.clone()),
        }
    }

    /// Whether something of this name stands in the folder.
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }

    /// The first row of a file that is text.
    pub fn first_row(&self) -> Result<String, DatasetError> {
        Ok(Source::open(&self.path)?.first_row())
    }

    /// The ending of a file; that of a folder is nothing.
    pub fn extension(&self) -> String {
        if self.is_folder { String::new() } else { extension(&self.path) }
    }
}

/// The names of what a folder holds, sorted, without hidden ones.
pub(super) fn names_in(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        let entry = entry.map_err(|error| unreadable(folder, &error))?;
        names.push(entry.file_name().into_string().map_err(|name| DatasetError::Unreadable {
            file: folder.join(&name).display().to_string(),
            reason: "its name is not UTF-8; rename it".to_owned(),
        })?);
    }
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    Ok(names)
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

pub(super) fn name_of(file: &Path) -> String {
    file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The ending of a file, in lower case; that of what is packed in it where it is packed.
pub(super) fn extension(file: &Path) -> String {
    let name = name_of(file).to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map_or(String::new(), |(_, extension)| extension.to_owned())
}

/// The name of a file without its endings, as its run is called: without characters that move the cursor of a terminal.
pub(super) fn stem(file: &Path) -> String {
    let name = name_of(file).replace(char::is_control, "?");
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
}
