//! What can be read only once: standard input and named pipes, copied into a file while it is read.

use super::error::DatasetError;
use super::file_names::ROBOT;
use super::layout::ending_of_messages;
use super::source::unreadable;
use super::unfinished::Unfinished;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// More than the bytes with which files of messages begin.
const HEAD: u64 = 32;

/// A copy of what came through a pipe.
pub(super) struct Spooled {
    /// Holds the copy, and is deleted with it.
    folder: tempfile::TempDir,
    /// Of the folder.
    _unfinished: Unfinished,
    /// The copy.
    pub path: PathBuf,
    /// What messages call it.
    name: String,
}

impl Spooled {
    /// Copies what can be read only once, with the `robot.toml` of its folder or the current one beside it; `None` for files and folders.
    pub fn of(path: &Path) -> Result<Option<Spooled>, DatasetError> {
        let is_stdin = path == Path::new("-");
        if !is_stdin && std::fs::metadata(path).map_or(true, |found| found.is_file() || found.is_dir()) {
            return Ok(None);
        }
        let name = if is_stdin { "standard input".to_owned() } else { path.display().to_string() };
        let failed = |error: std::io::Error| unreadable(Path::new(&name), &error);
        let mut input: Box<dyn Read> =
            if is_stdin { Box::new(std::io::stdin().lock()) } else { Box::new(File::open(path).map_err(failed)?) };
        let made = || tempfile::Builder::new().prefix("umbmark-").tempdir();
        let (folder, _unfinished) = Unfinished::begin(made, |folder| folder.path()).map_err(failed)?;
        let mut head = Vec::new();
        input.by_ref().take(HEAD).read_to_end(&mut head).map_err(failed)?;
        let copy = folder.path().join(format!("log.{}", ending_of_messages(&head).unwrap_or("csv")));
        let mut file = File::create(&copy).map_err(failed)?;
        file.write_all(&head).and_then(|()| std::io::copy(&mut input, &mut file)).map_err(failed)?;
        let beside = [path.with_file_name(ROBOT), PathBuf::from(ROBOT)];
        if let Some(robot) = beside.iter().find(|robot| robot.is_file()) {
            std::fs::copy(robot, folder.path().join(ROBOT)).map_err(|error| unreadable(robot, &error))?;
        }
        Ok(Some(Spooled { folder, _unfinished, path: copy, name }))
    }

    /// A message in which the copy has the name of the pipe.
    pub fn told(&self, message: &str) -> String {
        let copy = self.path.display().to_string();
        let robot = self.folder.path().join(ROBOT).display().to_string();
        message.replace(&copy, &self.name).replace(&robot, ROBOT)
    }

    /// An error that names the pipe.
    pub fn error(&self, error: DatasetError) -> DatasetError {
        let folder = self.folder.path().display().to_string();
        if !error.to_string().contains(&folder) {
            return error;
        }
        DatasetError::InPipe { message: self.told(&error.to_string()) }
    }
}
