//! Where a page comes from, so that it can be made again.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest, Sha256};

/// What made a page.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Provenance {
    /// The version of the program.
    pub version: String,
    /// The seed of all random numbers.
    pub seed: u64,
    /// The command, as it was given.
    pub command: String,
    /// The files that were read.
    pub files: Vec<Origin>,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Its name, as it was given.
    pub name: String,
    /// Its length \[bytes\].
    pub bytes: u64,
    /// SHA-256 of what stands in it.
    pub sha256: String,
}

impl Origin {
    /// Reads a file.
    pub fn of(file: &Path) -> io::Result<Origin> {
        let mut reader = std::fs::File::open(file)?;
        let mut hash = Sha256::new();
        let mut piece = vec![0; 1 << 16];
        let mut bytes = 0;
        loop {
            let read = reader.read(&mut piece)?;
            if read == 0 {
                break;
            }
            bytes += read as u64;
            hash.update(&piece[..read]);
        }
        let sha256 = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Origin { name: file.display().to_string(), bytes, sha256 })
    }

    /// Reads all files of a dataset: a file with the `robot.toml` beside it, or a folder with its `runs`, in the order of
    /// their names.
    pub fn of_dataset(place: &Path) -> io::Result<Vec<Origin>> {
        let mut files = if place.is_dir() {
            let mut files = inside(place)?;
            let runs = place.join("runs");
            if runs.is_dir() {
                files.extend(inside(&runs)?);
            }
            files
        } else {
            let beside = place.with_file_name("robot.toml");
            let mut files = vec![place.to_owned()];
            files.extend(Some(beside).filter(|robot| robot.is_file() && robot != place));
            files
        };
        files.sort();
        files.iter().map(|file| Origin::of(file)).collect()
    }
}

fn inside(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_file() && !hidden {
            files.push(path);
        }
    }
    Ok(files)
}
