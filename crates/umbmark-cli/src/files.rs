//! Files that the command writes: whole or not at all, and none is replaced unless the user says so.

use std::io::{self, Write};
use std::path::Path;

use anyhow::Context;
use umbmark_io::Existing;
use umbmark_io::whole_file::{FileError, WholeFile};

/// A file that appears under its name only when it is whole.
#[derive(Debug)]
pub struct Pending {
    file: WholeFile,
    failed: String,
}

impl Pending {
    /// Begins a file; refuses one that exists unless `force`.
    pub fn create(path: &Path, force: bool) -> anyhow::Result<Pending> {
        let file = WholeFile::create(path, existing(force)).map_err(with_remedy)?;
        Ok(Pending { file, failed: format!("cannot write {}", path.display()) })
    }

    /// What to say when writing fails.
    pub fn failed(&self) -> String {
        self.failed.clone()
    }

    /// Gives the file its name.
    pub fn finish(self) -> anyhow::Result<()> {
        Ok(self.file.finish()?)
    }

    /// Writes a whole file at once.
    pub fn write_whole(path: &Path, force: bool, text: &str) -> anyhow::Result<()> {
        let mut file = Pending::create(path, force)?;
        file.write_all(text.as_bytes()).with_context(|| file.failed())?;
        file.finish()
    }
}

/// Whether `--force` replaces files that exist.
pub fn existing(force: bool) -> Existing {
    if force { Existing::Replace } else { Existing::Keep }
}

/// What to do about a file that exists.
pub fn with_remedy(error: FileError) -> anyhow::Error {
    match error {
        FileError::Exists(_) => anyhow::anyhow!("{error}; --force replaces it"),
        error => error.into(),
    }
}

impl Write for Pending {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
