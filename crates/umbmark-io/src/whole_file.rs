//! Files written beside and renamed, so that nobody ever sees half of one.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::Existing;

/// A file that appears under its name only when it is whole.
#[derive(Debug)]
pub struct WholeFile {
    path: PathBuf,
    file: BufWriter<File>,
    beside: TempPath,
    existing: Existing,
}

/// Why a file is not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// It is there, and was to be kept.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// Nothing can be written where it should stand.
    #[error("cannot write into the folder {}: {}", folder.display(), in_words(error, "there is no such folder; make it first"))]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// It cannot be written.
    #[error("cannot write {}: {error}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// Why.
        error: io::Error,
    },
}

/// What the system says, without its numbers; this where there is nothing.
pub(crate) fn in_words(error: &io::Error, nothing: &str) -> String {
    if error.kind() == io::ErrorKind::NotFound { nothing.to_owned() } else { error.kind().to_string() }
}

impl WholeFile {
    /// Begins a file; refuses one that exists where that is to be kept.
    pub fn create(path: &Path, existing: Existing) -> Result<WholeFile, FileError> {
        if existing == Existing::Keep && path.exists() {
            return Err(FileError::Exists(path.to_owned()));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let beside = builder.tempfile_in(folder);
        let (file, beside) =
            beside.map_err(|error| FileError::Folder { folder: folder.to_owned(), error })?.into_parts();
        Ok(WholeFile { path: path.to_owned(), file: BufWriter::new(file), beside, existing })
    }

    /// Gives the file its name.
    pub fn finish(self) -> Result<(), FileError> {
        let WholeFile { path, file, beside, existing } = self;
        let named = file.into_inner().map_err(io::IntoInnerError::into_error).and_then(|file| {
            file.sync_all()?;
            drop(file);
            let named = match existing {
                Existing::Keep => beside.persist_noclobber(&path),
                Existing::Replace => beside.persist(&path),
            };
            named.map_err(|error| error.error)
        });
        named.map_err(|error| FileError::Write { file: path, error })
    }

    /// Writes a whole file at once.
    pub fn write(path: &Path, existing: Existing, bytes: &[u8]) -> Result<(), FileError> {
        let mut file = WholeFile::create(path, existing)?;
        file.write_all(bytes).map_err(|error| FileError::Write { file: path.to_owned(), error })?;
        file.finish()
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_when_it_is_whole_and_what_is_there_is_kept_unless_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let mut file = WholeFile::create(&path, Existing::Keep).unwrap();
        file.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(file);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        WholeFile::write(&path, Existing::Keep, b"one").unwrap();
        let told = WholeFile::write(&path, Existing::Keep, b"two").unwrap_err();
        assert!(told.to_string().ends_with("a.txt exists already"));
        assert_eq!(std::fs::read(&path).unwrap(), b"one");
        WholeFile::write(&path, Existing::Replace, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        let nowhere = folder.path().join("no/where.txt");
        let told = WholeFile::write(&nowhere, Existing::Keep, b"").unwrap_err();
        assert!(told.to_string().ends_with("/no: there is no such folder; make it first"), "{told}");
    }
}
