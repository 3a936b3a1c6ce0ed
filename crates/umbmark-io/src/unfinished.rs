//! Files and folders that are being written, that hold a copy of what came through a pipe, or that lock others: a process that ends at once
//! takes them away.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How often a folder is emptied to which files are added meanwhile.
const TRIES: usize = 100;

static ALL: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn all() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file or folder that is not yet, or never, to be seen under its name. Whoever holds this takes it away, or gives it its name, before
/// this is dropped.
#[derive(Debug)]
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Makes a file or folder. None is made while, or after, all of them are taken away.
    pub fn begin<T, E>(make: impl FnOnce() -> Result<T, E>, path: impl Fn(&T) -> &Path) -> Result<(T, Unfinished), E> {
        let mut all = all();
        let made = make()?;
        let path = path(&made).to_owned();
        all.insert(path.clone());
        Ok((made, Unfinished(path)))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        all().remove(&self.0);
    }
}

/// Takes away everything that is unfinished. The process must end after it: nothing can be begun any more.
pub fn take_away_unfinished() {
    let all = all();
    for path in all.iter() {
        // What cannot be taken away stays; there is nobody to tell. Another thread may add a file to a folder that is emptied.
        for _ in 0..TRIES {
            let gone = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
            if gone.is_ok() {
                break;
            }
        }
    }
    std::mem::forget(all);
}
