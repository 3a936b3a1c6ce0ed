//! Files that one process writes again and again: a second process is told so.

use crate::unfinished::Unfinished;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

/// A file that this process alone may write, until this is dropped. A process that is killed holds nothing.
///
/// The lock is on a file beside it, whose name ends in `.lock`: the file itself is replaced with every write.
#[derive(Debug)]
pub struct Lock {
    file: File,
    path: PathBuf,
    _unfinished: Unfinished,
}

/// Another process has the lock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// Its number, if it has said it.
    pub process: Option<u32>,
}

/// Why a lock is not taken.
enum Refused {
    /// The folder takes no file.
    Unopened,
    /// Another process has it.
    Held(File),
    /// The file system knows no locks.
    Unknown,
}

impl Lock {
    /// The lock of a file; none of a device or a pipe, and none where the folder takes no file, which writing it says better.
    pub fn of(file: &Path) -> Result<Option<Lock>, Held> {
        if std::fs::metadata(file).is_ok_and(|there| !there.is_file()) {
            return Ok(None);
        }
        let mut path = file.as_os_str().to_owned();
        path.push(".lock");
        let path = PathBuf::from(path);
        // A process that ends takes its file away: what was locked may be gone from the folder by then.
        for _ in 0..100 {
            // A process that is told to end meanwhile waits for this, and takes the file away.
            let taken = || {
                let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
                let file = opened.map_err(|_| Refused::Unopened)?;
                match file.try_lock() {
                    Ok(()) => Ok((file, &path)),
                    Err(TryLockError::WouldBlock) => Err(Refused::Held(file)),
                    Err(TryLockError::Error(_)) => Err(Refused::Unknown),
                }
            };
            match Unfinished::begin(taken, |(_, path)| path) {
                Ok(((mut file, path), _unfinished)) if is_at(&file, path) => {
                    let said = file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id()));
                    // Who holds it is a courtesy.
                    drop(said);
                    return Ok(Some(Lock { file, path: path.clone(), _unfinished }));
                }
                Ok(_) => {}
                Err(Refused::Held(mut file)) => {
                    let mut text = String::new();
                    let read = file.rewind().and_then(|()| file.read_to_string(&mut text));
                    return Err(Held { process: read.ok().and_then(|_| text.trim().parse().ok()) });
                }
                Err(Refused::Unopened | Refused::Unknown) => return Ok(None),
            }
        }
        Ok(None)
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same = |one: std::fs::Metadata, other: std::fs::Metadata| (one.dev(), one.ino()) == (other.dev(), other.ino());
    file.metadata().is_ok_and(|one| std::fs::metadata(path).is_ok_and(|other| same(one, other)))
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Taken away while it is held, so that nobody takes away the lock of another.
        let _ = std::fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_one_writer_at_a_time_and_nothing_is_left_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("study.json");
        let one = Lock::of(&file).unwrap().unwrap();
        assert_eq!(Lock::of(&file).unwrap_err(), Held { process: Some(std::process::id()) });
        assert!(Lock::of(&folder.path().join("other.json")).unwrap().is_some());
        drop(one);
        // One that a killed process left behind holds nothing.
        std::fs::write(folder.path().join("study.json.lock"), "4294967294\n").unwrap();
        let again = Lock::of(&file).unwrap().unwrap();
        assert_eq!(Lock::of(&file).unwrap_err(), Held { process: Some(std::process::id()) });
        drop(again);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(Lock::of(&folder.path().join("missing").join("study.json")).unwrap().is_none());
        assert!(Lock::of(folder.path()).unwrap().is_none(), "a folder is no file");
    }
}
