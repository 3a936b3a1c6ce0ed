//! Files written to folders: all of them beside, looked at once more, and then renamed into place.

use super::error::DatasetError;
use super::file_names::{RETURNS, RUNS};
use super::remedy::Remedy;
use super::unfinished::Unfinished;
use super::whole_file::{Place, WholeFile};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What to do with files that are there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Leave them, and write nothing.
    Keep,
    /// Put the new ones in their place.
    Replace,
}

/// Writes files beside `folder`, has them checked, and renames them into it.
pub(super) fn put<Checked>(
    folder: &Path,
    files: &BTreeMap<PathBuf, impl AsRef<[u8]>>,
    existing: Existing,
    check: impl FnOnce(&Path) -> Result<Checked, DatasetError>,
) -> Result<Checked, DatasetError> {
    refuse_existing(folder, files, existing)?;
    refuse_other_logs(folder, files)?;
    lay(folder, files, check)
}

/// The same for files that belong to whatever logs the folder has.
pub(super) fn put_beside_logs(
    folder: &Path,
    files: &BTreeMap<PathBuf, impl AsRef<[u8]>>,
    existing: Existing,
) -> Result<(), DatasetError> {
    refuse_existing(folder, files, existing)?;
    lay(folder, files, |_| Ok(()))
}

/// Writes files beside `folder`, has them checked, and renames them into it, over those that are there.
fn lay<Checked>(
    folder: &Path,
    files: &BTreeMap<PathBuf, impl AsRef<[u8]>>,
    check: impl FnOnce(&Path) -> Result<Checked, DatasetError>,
) -> Result<Checked, DatasetError> {
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (beside, _unfinished) = temporary_folder(parent).map_err(|error| unwritable(parent, &error))?;
    for (name, bytes) in files {
        write_file(beside.path(), name, bytes.as_ref()).map_err(|error| unwritable(&folder.join(name), &error))?;
    }
    let checked = check(beside.path())?;
    if !folder.exists() {
        std::fs::rename(beside.path(), folder).map_err(|error| unwritable(folder, &error))?;
        let _ = beside.keep();
        return Ok(checked);
    }
    for name in files.keys() {
        let to = folder.join(name);
        let made = to.parent().map_or(Ok(()), std::fs::create_dir_all);
        made.and_then(|()| place(&beside.path().join(name), &to)).map_err(|error| unwritable(&to, &error))?;
    }
    Ok(checked)
}

/// Gives a whole file its name; what is no regular file stays, and is written through.
fn place(whole: &Path, to: &Path) -> std::io::Result<()> {
    match Place::of(to) {
        Place::Named(place) if place == to => std::fs::rename(whole, to),
        _ => WholeFile::write(to, Existing::Replace, &std::fs::read(whole)?).map_err(std::io::Error::other),
    }
}

/// A new folder with the rights that the user's folders have.
fn temporary_folder(parent: &Path) -> std::io::Result<(tempfile::TempDir, Unfinished)> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".umbmark-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o777));
    }
    Unfinished::begin(|| builder.tempdir_in(parent), |folder| folder.path())
}

/// Writes a file to a folder. A folder that was taken away stays away.
fn write_file(folder: &Path, name: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut place = folder.to_owned();
    for part in name.parent().into_iter().flat_map(Path::components) {
        place.push(part);
        match std::fs::create_dir(&place) {
            Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => return Err(error),
            _ => {}
        }
    }
    let mut handle = std::fs::File::create(folder.join(name))?;
    handle.write_all(bytes)?;
    handle.sync_all()
}

fn refuse_existing(
    folder: &Path,
    files: &BTreeMap<PathBuf, impl AsRef<[u8]>>,
    existing: Existing,
) -> Result<(), DatasetError> {
    let there = files.keys().map(|name| folder.join(name)).find(|file| file.exists());
    match (there, existing) {
        (Some(file), Existing::Keep) => Err(already_there(&file, Remedy::Replace { another: "folder" })),
        _ => Ok(()),
    }
}

fn already_there(file: &Path, remedy: Remedy) -> DatasetError {
    DatasetError::AlreadyThere { file: file.display().to_string(), remedy }
}

/// Refuses to mix a dataset with the logs of another one.
fn refuse_other_logs(folder: &Path, files: &BTreeMap<PathBuf, impl AsRef<[u8]>>) -> Result<(), DatasetError> {
    let logs = std::fs::read_dir(folder.join(RUNS)).into_iter().flatten().flatten();
    let mut others = logs.map(|entry| Path::new(RUNS).join(entry.file_name()));
    let of_dataset = files.keys().any(|name| name.starts_with(RUNS) || name.as_path() == Path::new(RETURNS));
    match others.find(|name| of_dataset && !files.contains_key(name)) {
        Some(other) => Err(already_there(
            &folder.join(other),
            "it is the log of another run: choose another folder, or delete it".into(),
        )),
        None => Ok(()),
    }
}

pub(super) fn unwritable(file: &Path, error: &std::io::Error) -> DatasetError {
    let reason = match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such folder".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    };
    DatasetError::Unwritable { file: file.display().to_string(), reason }
}
