//! Datasets written to folders: all of it beside, looked at once more, and then renamed into place.

use super::RobotFile;
use super::error::DatasetError;
use super::folder::{RETURNS, ROBOT, RUNS};
use super::sheets::{returns_text, tick_log_text};
use super::{label, load};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::{Dataset, Run, TickLog};

/// What to do with files that are there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Leave them, and write nothing.
    Keep,
    /// Put the new ones in their place.
    Replace,
}

/// How the logs of a dataset are written.
pub(super) struct LogFormat {
    /// Ending of the files.
    pub ending: &'static str,
    /// The bytes of a file.
    pub bytes: fn(&Dataset, &Run, &TickLog) -> Result<Vec<u8>, DatasetError>,
    /// Whether the first log was read back as the second.
    pub same: fn(&TickLog, &TickLog) -> bool,
}

const CSV: LogFormat = LogFormat { ending: "csv", bytes: csv, same: same_record };

/// Whether two logs hold the same samples and poses, whatever had to be mended in either.
fn same_record(a: &TickLog, b: &TickLog) -> bool {
    (&a.time, &a.left, &a.right, &a.reference) == (&b.time, &b.left, &b.right, &b.reference)
}

fn csv(data: &Dataset, _: &Run, log: &TickLog) -> Result<Vec<u8>, DatasetError> {
    Ok(tick_log_text(log, data.nominal_robot()?))
}

/// Writes `robot.toml`, `returns.csv` and `runs/*.csv` into a folder, which is made where it is not there.
///
/// What is written reads back as this dataset to the last bit, but for the names of the runs and the warnings; that
/// is checked before anything is put in place, so a folder never holds half of a file. A folder that holds logs of
/// other runs is refused, lest the two datasets mix.
pub fn save(data: &Dataset, folder: impl AsRef<Path>, existing: Existing) -> Result<(), DatasetError> {
    save_with(data, folder.as_ref(), existing, &CSV).map(|_| ())
}

/// The same with logs of any format; returns what was read back.
pub(super) fn save_with(
    data: &Dataset,
    folder: &Path,
    existing: Existing,
    format: &LogFormat,
) -> Result<Dataset, DatasetError> {
    let robot = data.nominal_robot()?;
    let mut files = BTreeMap::new();
    // The poses are written as they are meant to be.
    let robot_file = RobotFile::new(robot.clone(), data.path.clone());
    files.insert(PathBuf::from(ROBOT), robot_file.text().into_bytes());
    files.extend(returns_text(&data.runs).map(|text| (PathBuf::from(RETURNS), text)));
    for run in &data.runs {
        let Some(log) = &run.log else { continue };
        let name = format!("{}.{}", label::label(run.test, run.direction, run.number), format.ending);
        files.insert(Path::new(RUNS).join(name), (format.bytes)(data, run, log)?);
    }
    put(folder, &files, existing, |written| check(data, folder, written, format))
}

/// Refuses what would be read back as something else.
fn check(data: &Dataset, folder: &Path, written: &Path, format: &LogFormat) -> Result<Dataset, DatasetError> {
    let refuse = |reason: String| DatasetError::Unwritable { file: folder.display().to_string(), reason };
    let read = load(written).map_err(|error| {
        let place = written.display().to_string();
        refuse(format!("it could not be read back: {}", error.to_string().replace(&place, "…")))
    })?;
    let mut runs: Vec<&Run> = data.runs.iter().collect();
    runs.sort_by_key(|run| (run.test, run.direction, run.number));
    let same_path = match (&data.path, &read.path) {
        (Some(a), Some(b)) => a.shape().name == b.shape().name && a.values() == b.values() && a.speed == b.speed,
        (a, b) => a.is_none() && b.is_none(),
    };
    if read.robot != data.robot || !same_path {
        return Err(refuse("robot or path would not be read back as they are".into()));
    }
    let same = |(a, b): (&&Run, &Run)| {
        (a.test, a.direction, a.number) == (b.test, b.direction, b.number)
            && match (&a.log, &b.log) {
                (Some(log), Some(read)) => (format.same)(log, read),
                (log, read) => log.is_none() && read.is_none(),
            }
            && (a.returned == b.returned || a.returned.is_none())
    };
    if runs.len() != read.runs.len() {
        return Err(refuse("a run has neither log nor return error".into()));
    }
    match runs.iter().zip(&read.runs).find(|pair| !same(*pair)) {
        Some((run, _)) => {
            let name = label::label(run.test, run.direction, run.number);
            // The last remark: roll-overs, which are undone as they were written, come before any reason.
            let why =
                read.warnings.iter().rev().find_map(|w| Some(w.split_once(&format!("{name}.{}: ", format.ending))?.1));
            let why = why.map(|why| format!("; the reader says: {why}")).unwrap_or_default();
            Err(refuse(format!("{name} would not be read back as it is{why}")))
        }
        None => Ok(read),
    }
}

/// Writes files beside `folder`, has them checked, and renames them into it.
pub(super) fn put<Checked>(
    folder: &Path,
    files: &BTreeMap<PathBuf, impl AsRef<[u8]>>,
    existing: Existing,
    check: impl FnOnce(&Path) -> Result<Checked, DatasetError>,
) -> Result<Checked, DatasetError> {
    refuse_existing(folder, files, existing)?;
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = temporary_folder(parent).map_err(|error| unwritable(parent, &error))?;
    for (name, bytes) in files {
        let file = beside.path().join(name);
        write_file(&file, bytes.as_ref()).map_err(|error| unwritable(&folder.join(name), &error))?;
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
        made.and_then(|()| std::fs::rename(beside.path().join(name), &to)).map_err(|error| unwritable(&to, &error))?;
    }
    Ok(checked)
}

/// A new folder with the rights that the user's folders have.
fn temporary_folder(parent: &Path) -> std::io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".umbmark-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o777));
    }
    builder.tempdir_in(parent)
}

fn write_file(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    file.parent().map_or(Ok(()), std::fs::create_dir_all)?;
    let mut handle = std::fs::File::create(file)?;
    handle.write_all(bytes)?;
    handle.sync_all()
}

fn refuse_existing(
    folder: &Path,
    files: &BTreeMap<PathBuf, impl AsRef<[u8]>>,
    existing: Existing,
) -> Result<(), DatasetError> {
    let refuse = |file: PathBuf, remedy| DatasetError::AlreadyThere { file: file.display().to_string(), remedy };
    let there = files.keys().map(|name| folder.join(name)).find(|file| file.exists());
    if let (Some(file), Existing::Keep) = (there, existing) {
        return Err(refuse(file, "choose another folder, or say --force to replace it"));
    }
    let logs = std::fs::read_dir(folder.join(RUNS)).into_iter().flatten().flatten();
    let mut others = logs.map(|entry| Path::new(RUNS).join(entry.file_name()));
    let of_dataset = files.keys().any(|name| name.starts_with(RUNS) || name.as_path() == Path::new(RETURNS));
    match others.find(|name| of_dataset && !files.contains_key(name)) {
        Some(other) => {
            Err(refuse(folder.join(other), "it is the log of another run: choose another folder, or delete it"))
        }
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
