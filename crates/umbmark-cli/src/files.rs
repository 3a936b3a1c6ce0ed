//! Files written beside and renamed, so that nobody ever sees half of one.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use tempfile::TempPath;

/// A file that appears under its name only when it is whole.
#[derive(Debug)]
pub struct Pending {
    path: PathBuf,
    file: BufWriter<File>,
    beside: TempPath,
    force: bool,
}

impl Pending {
    /// Begins a file; refuses one that exists unless `force`.
    pub fn create(path: &Path, force: bool) -> anyhow::Result<Pending> {
        if !force && path.exists() {
            anyhow::bail!("{} exists already; --force replaces it", path.display());
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let (file, beside) = builder
            .tempfile_in(folder)
            .with_context(|| format!("cannot write into the folder {}", folder.display()))?
            .into_parts();
        Ok(Pending { path: path.to_owned(), file: BufWriter::new(file), beside, force })
    }

    /// What to say when writing fails.
    pub fn failed(&self) -> String {
        format!("cannot write {}", self.path.display())
    }

    /// Gives the file its name.
    pub fn finish(self) -> anyhow::Result<()> {
        let failed = self.failed();
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error).with_context(|| failed.clone())?;
        file.sync_all().with_context(|| failed.clone())?;
        drop(file);
        let named =
            if self.force { self.beside.persist(&self.path) } else { self.beside.persist_noclobber(&self.path) };
        named.map_err(|error| error.error).with_context(|| failed)?;
        Ok(())
    }

    /// Writes a whole file at once.
    pub fn write_whole(path: &Path, force: bool, text: &str) -> anyhow::Result<()> {
        let mut file = Pending::create(path, force)?;
        file.write_all(text.as_bytes()).with_context(|| file.failed())?;
        file.finish()
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
