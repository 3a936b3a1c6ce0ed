//! Files written beside and renamed, so that nobody ever sees half of one.
//!
//! Only regular files are replaced. A symbolic link stays, and the file that it leads to is replaced; what goes to a device, a named pipe or
//! standard output (`-`, `/dev/stdout`) is written through it.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::Existing;
use crate::unfinished::Unfinished;

/// A file that appears under its name only when it is whole.
#[derive(Debug)]
pub struct WholeFile {
    /// As it was named.
    path: PathBuf,
    target: Target,
}

#[derive(Debug)]
enum Target {
    /// A regular file, or a new one: written beside `place` and renamed.
    Beside { place: PathBuf, file: BufWriter<File>, beside: TempPath, existing: Existing, unfinished: Unfinished },
    /// What keeps its identity, and has no half.
    Through(BufWriter<Sink>),
}

/// What is written through.
#[derive(Debug)]
enum Sink {
    Stdout(io::Stdout),
    Special(File),
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Sink::Stdout(out) => out.write(bytes),
            Sink::Special(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Sink::Stdout(out) => out.flush(),
            Sink::Special(file) => file.flush(),
        }
    }
}

/// Where the bytes of a file go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// To standard output.
    Stdout,
    /// Into what is no regular file.
    Special,
    /// Under this name, which is that of no symbolic link.
    Named(PathBuf),
}

/// Links that are followed before they are taken for a circle.
const LINKS: usize = 40;

impl Place {
    /// Follows symbolic links, also to what does not exist yet.
    pub(crate) fn of(path: &Path) -> Place {
        if is_standard_output(path) {
            return Place::Stdout;
        }
        if std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return Place::Special;
        }
        let mut place = path.to_owned();
        for _ in 0..LINKS {
            let Ok(next) = std::fs::read_link(&place) else { break };
            place = place.parent().map_or(next.clone(), |folder| folder.join(next));
        }
        Place::Named(place)
    }
}

/// Whether a name is that of standard output: `-`, or what the system calls it.
pub fn is_standard_output(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
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
    /// A folder stands there.
    #[error("{} is a folder; name a file", .0.display())]
    IsFolder(PathBuf),
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
    /// Begins a file; refuses a regular one that exists where that is to be kept.
    pub fn create(path: &Path, existing: Existing) -> Result<WholeFile, FileError> {
        let target = match Place::of(path) {
            Place::Stdout => Target::Through(BufWriter::new(Sink::Stdout(io::stdout()))),
            Place::Special => {
                let file = File::options().write(true).open(path);
                let failed = |error| FileError::Write { file: path.to_owned(), error };
                Target::Through(BufWriter::new(Sink::Special(file.map_err(failed)?)))
            }
            Place::Named(place) if place.is_dir() => return Err(FileError::IsFolder(path.to_owned())),
            Place::Named(place) if existing == Existing::Keep && place.exists() => {
                return Err(FileError::Exists(path.to_owned()));
            }
            Place::Named(place) => {
                let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
                let mut builder = tempfile::Builder::new();
                #[cfg(unix)]
                builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
                let beside = Unfinished::begin(|| builder.tempfile_in(folder), |beside| beside.path());
                let failed = |error| FileError::Folder { folder: folder.to_owned(), error };
                let (beside, unfinished) = beside.map_err(failed)?;
                let (file, beside) = beside.into_parts();
                Target::Beside { place, file: BufWriter::new(file), beside, existing, unfinished }
            }
        };
        Ok(WholeFile { path: path.to_owned(), target })
    }

    /// Has the disk hold what was written: several files can then be given their names at once.
    pub fn secure(&mut self) -> Result<(), FileError> {
        let secured = match &mut self.target {
            Target::Beside { file, .. } => file.flush().and_then(|()| file.get_ref().sync_all()),
            Target::Through(out) => out.flush(),
        };
        secured.map_err(|error| FileError::Write { file: self.path.clone(), error })
    }

    /// Gives the file its name.
    pub fn finish(self) -> Result<(), FileError> {
        let written = match self.target {
            Target::Through(mut out) => out.flush(),
            Target::Beside { place, file, beside, existing, unfinished } => {
                let written = file.into_inner().map_err(io::IntoInnerError::into_error).and_then(|file| {
                    file.sync_all()?;
                    drop(file);
                    let named = match existing {
                        Existing::Keep => beside.persist_noclobber(&place),
                        Existing::Replace => beside.persist(&place),
                    };
                    named.map_err(|error| error.error)
                });
                drop(unfinished);
                written
            }
        };
        written.map_err(|error| FileError::Write { file: self.path, error })
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
        match &mut self.target {
            Target::Beside { file, .. } => file.write(bytes),
            Target::Through(out) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Beside { file, .. } => file.flush(),
            Target::Through(out) => out.flush(),
        }
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
    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_the_file_that_it_leads_to_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let [real, link, hanging] = ["real.txt", "link.txt", "hanging.txt"].map(|name| folder.path().join(name));
        std::fs::write(&real, "one").unwrap();
        std::os::unix::fs::symlink("real.txt", &link).unwrap();
        std::os::unix::fs::symlink("new.txt", &hanging).unwrap();
        assert!(matches!(WholeFile::write(&link, Existing::Keep, b"two"), Err(FileError::Exists(_))));
        WholeFile::write(&link, Existing::Replace, b"two").unwrap();
        WholeFile::write(&hanging, Existing::Keep, b"new").unwrap();
        assert!(link.is_symlink() && hanging.is_symlink());
        assert_eq!(std::fs::read(&real).unwrap(), b"two");
        assert_eq!(std::fs::read(folder.path().join("new.txt")).unwrap(), b"new");
        assert!(matches!(WholeFile::write(folder.path(), Existing::Replace, b""), Err(FileError::IsFolder(_))));
    }

    #[cfg(unix)]
    #[test]
    fn a_device_and_a_named_pipe_are_written_through() {
        use std::os::unix::fs::FileTypeExt;
        WholeFile::write(Path::new("/dev/null"), Existing::Keep, b"gone").unwrap();
        WholeFile::write(Path::new("/dev/null"), Existing::Replace, b"gone").unwrap();
        assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || std::fs::read(pipe).unwrap()
        });
        WholeFile::write(&pipe, Existing::Replace, b"through").unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
    }
}
