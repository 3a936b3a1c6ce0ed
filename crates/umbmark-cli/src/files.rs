//! Files that the command writes: whole or not at all, and none is replaced unless the user says so.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use umbmark_io::Existing;
use umbmark_io::whole_file::{FileError, WholeFile, is_standard_output};

/// A file that appears under its name only when it is whole.
#[derive(Debug)]
pub struct Pending {
    file: WholeFile,
    failed: String,
}

impl Pending {
    /// Begins a file; refuses one that exists unless `force`.
    pub fn create(path: &Path, force: bool) -> anyhow::Result<Pending> {
        let file = begin(path, force).map_err(with_remedy)?;
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

/// Whether a file goes to standard output, so that everything else goes to standard error.
static ON_STDOUT: AtomicBool = AtomicBool::new(false);

/// Begins a whole file; refuses one that exists unless `force`. From then on, a file on standard output has it for itself.
pub fn begin(path: &Path, force: bool) -> Result<WholeFile, FileError> {
    if is_standard_output(path) {
        ON_STDOUT.store(true, Ordering::Relaxed);
    }
    WholeFile::create(path, existing(force))
}

/// Whether a file goes to standard output.
pub fn one_is_on_stdout() -> bool {
    ON_STDOUT.load(Ordering::Relaxed)
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
