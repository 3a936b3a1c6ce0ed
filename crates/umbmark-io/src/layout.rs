//! Layouts: how files are recognised, read and written. One file each, listed by a word.
//!
//! A layout holds what it can hold; what it cannot is said in words, never left out silently.

use self::messages::{OpenMessages, Opened, Topics};
use super::assembly::{Assembly, Tracked};
use super::column_names::Renaming;
use super::conditions::read_conditions;
use super::error::DatasetError;
use super::probe::Probe;
use super::remedy::Words;
use super::robot_file::RobotFile;
use super::save::Existing;
use super::source::Source;
use super::spool::Spooled;
use super::track_rows::TrackRows;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::{Dataset, Run, TickLog};
use umbmark_core::inspect::LogContents;
use umbmark_core::run::ReferenceTrack;

pub(super) mod messages;

macro_rules! layouts {
    ($($name:ident),+ $(,)?) => {
        $(pub(super) mod $name;)+

        /// All of them. The first takes data sets and tracks that no other recognises.
        static LAYOUTS: &[Layout] = &[$($name::LAYOUT),+];
    };
}

layouts! { csv, mcap, rosbag2, rosbag, optiodom, tum, returns, motive }

/// How some files are recognised, read and written. A layout does what its file says that it does.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    data: Option<ReadData>,
    logs: Option<ReadLogs>,
    tracks: Option<ReadTracks>,
    messages: Option<OpenMessages>,
    folder: Option<OpenFolder>,
    write: Option<Write>,
}

/// Whole data sets: whether a place is one, and what is in it.
type ReadData = (fn(&Probe) -> bool, fn(&Probe, &Topics) -> Result<Dataset, DatasetError>);

/// Files in `runs`.
#[derive(Clone, Copy, Debug)]
struct ReadLogs {
    /// Their ending.
    ending: &'static str,
    /// How one is added, with its track where it takes one.
    add: fn(&mut Assembly, &Path, &mut Tracks, &Topics) -> Result<(), DatasetError>,
    /// What one holds, before its robot is known.
    look: fn(&Path, &Topics, &Words) -> Result<LogContents, DatasetError>,
}

/// Files in `reference`: their endings, whether a first row begins one, and its rows.
type ReadTracks =
    (&'static [&'static str], fn(&str) -> bool, fn(Source, &mut Vec<String>) -> Result<TrackRows, DatasetError>);

/// The file that makes a folder one log of messages, and how that is opened.
type OpenFolder = (&'static str, Open);
type Open = fn(&Path) -> Opened;

/// Writes a data set into a folder and says what is lost.
type Write = fn(&Dataset, &Path, Existing) -> Result<Vec<String>, DatasetError>;

/// Files of tracks, by the name of the log that they belong to.
type Tracks = BTreeMap<String, PathBuf>;

impl Layout {
    const fn new(name: &'static str, about: &'static str) -> Layout {
        Layout { name, about, data: None, logs: None, tracks: None, messages: None, folder: None, write: None }
    }

    const fn reads_data(self, read: ReadData) -> Layout {
        Layout { data: Some(read), ..self }
    }

    const fn reads_logs(self, read: ReadLogs) -> Layout {
        Layout { logs: Some(read), ..self }
    }

    const fn reads_tracks(self, read: ReadTracks) -> Layout {
        Layout { tracks: Some(read), ..self }
    }

    const fn reads_messages(self, messages: OpenMessages) -> Layout {
        Layout { messages: Some(messages), ..self }
    }

    const fn reads_folders(self, folder: OpenFolder) -> Layout {
        Layout { folder: Some(folder), ..self }
    }

    const fn writes(self, write: Write) -> Layout {
        Layout { write: Some(write), ..self }
    }

    /// Those that data sets are written in.
    pub fn written() -> impl Iterator<Item = &'static Layout> {
        LAYOUTS.iter().filter(|layout| layout.write.is_some())
    }

    /// The layout of a name that data sets are written in.
    pub fn named(name: &str) -> Option<&'static Layout> {
        Layout::written().find(|layout| layout.name == name)
    }

    /// The layout that the name of a place asks for: that whose logs end like it, else `csv`.
    pub fn of_place(place: impl AsRef<Path>) -> &'static Layout {
        let ending = super::probe::extension(place.as_ref());
        let is_its = |layout: &&Layout| layout.logs.is_some_and(|logs| logs.ending == ending);
        LAYOUTS.iter().find(is_its).unwrap_or(&LAYOUTS[0])
    }

    /// Writes a dataset into a folder, and says what this layout cannot hold, one sentence each.
    ///
    /// # Errors
    ///
    /// Where files are there already and are to be kept, where the layout can hold nothing of the dataset, and where the
    /// system does not let us write.
    pub fn write(
        &self,
        data: &Dataset,
        folder: impl AsRef<Path>,
        existing: Existing,
    ) -> Result<Vec<String>, DatasetError> {
        let file = || folder.as_ref().display().to_string();
        let write = self.write.ok_or_else(|| DatasetError::Unwritable {
            file: file(),
            reason: format!("files of the layout {} are read and not written; write NAME.mcap or a folder", self.name),
        })?;
        let mut lost = write(data, folder.as_ref(), existing)?;
        if !data.sessions.is_empty() {
            lost.push("which runs are of which session: read back, they are of one".into());
        }
        Ok(lost)
    }
}

/// The reader of the first layout that recognises a thing; else the first reader of such things.
fn choose<Read: Copy>(of: impl Fn(&Layout) -> Option<Read>, recognises: impl Fn(&Read) -> bool) -> Option<Read> {
    let readers = || LAYOUTS.iter().filter_map(&of);
    readers().find(recognises).or_else(|| readers().next())
}

/// A dataset from a folder, from one file of it, or from what comes through standard input (`-`) or a named pipe.
pub(super) fn load(path: &Path, topics: &Topics, robot: Option<&RobotFile>) -> Result<Dataset, DatasetError> {
    let Some(spooled) = Spooled::of(path)? else { return load_place(path, topics, robot) };
    let mut data = load_place(&spooled.path, topics, robot).map_err(|error| spooled.error(error))?;
    data.warnings.iter_mut().for_each(|warning| *warning = spooled.told(warning));
    Ok(data)
}

fn load_place(path: &Path, topics: &Topics, robot: Option<&RobotFile>) -> Result<Dataset, DatasetError> {
    let probe = Probe { robot: robot.cloned(), ..Probe::of(path)? };
    match choose(|layout| layout.data, |(recognises, _)| recognises(&probe)) {
        Some((_, read)) => {
            let mut data = read(&probe, topics)?;
            read_conditions(&probe, &mut data)?;
            Ok(data)
        }
        None => Ok(Dataset::default()),
    }
}

/// The endings of logs.
pub(super) fn log_endings() -> Vec<&'static str> {
    LAYOUTS.iter().filter_map(|layout| Some(layout.logs?.ending)).collect()
}

/// Adds a log, where a layout knows its ending.
fn add_log(
    assembly: &mut Assembly,
    file: &Path,
    tracks: &mut Tracks,
    topics: &Topics,
) -> Option<Result<(), DatasetError>> {
    Some((logs_of(file)?.add)(assembly, file, tracks, topics))
}

/// The layout of a folder that is one log, and how it is opened.
fn folder_of_messages(path: &Path) -> Option<(&'static Layout, Open)> {
    LAYOUTS.iter().find_map(|layout| {
        let (_, open) = layout.folder.filter(|(marker, _)| path.join(marker).is_file())?;
        Some((layout, open))
    })
}

/// How files of this ending, or folders that are one log, are read.
fn logs_of(file: &Path) -> Option<ReadLogs> {
    if let Some((layout, _)) = folder_of_messages(file) {
        return layout.logs;
    }
    let ending = super::probe::extension(file);
    LAYOUTS.iter().filter_map(|layout| layout.logs).find(|logs| logs.ending == ending)
}

/// Whether files of this ending are logs.
pub(super) fn is_log(file: &Path) -> bool {
    logs_of(file).is_some()
}

/// What a log holds, where a layout knows its ending.
pub(super) fn look(file: &Path, topics: &Topics, words: &Words) -> Option<Result<LogContents, DatasetError>> {
    Some((logs_of(file)?.look)(file, topics, words))
}

/// Whether a layout other than the own one recognises a place as a whole dataset, and not as a log.
pub(super) fn is_foreign(probe: &Probe) -> bool {
    let others = LAYOUTS[1..].iter().filter(|layout| layout.messages.is_none());
    others.filter_map(|layout| layout.data).any(|(recognises, _)| recognises(probe))
}

/// How a file of messages ends that begins with these bytes.
pub(super) fn ending_of_messages(start: &[u8]) -> Option<&'static str> {
    let of_magic = |layout: &&Layout| layout.messages.is_some_and(|messages| start.starts_with(messages.magic));
    LAYOUTS.iter().find(of_magic).and_then(|layout| Some(layout.logs?.ending))
}

/// The endings of tracks.
fn track_endings() -> Vec<&'static str> {
    LAYOUTS.iter().filter_map(|layout| layout.tracks).flat_map(|(endings, ..)| endings).copied().collect()
}

/// The poses of a file that have a clock of their own.
fn read_track(file: &Path, columns: &Renaming, warnings: &mut Vec<String>) -> Result<Tracked, DatasetError> {
    let track = parse_track(Source::open(file)?.with(columns), warnings)?;
    Ok(Tracked { track, file: file.display().to_string() })
}

/// The same of a text.
pub(super) fn parse_track(source: Source, warnings: &mut Vec<String>) -> Result<ReferenceTrack, DatasetError> {
    let first = source.first_row();
    match choose(|layout| layout.tracks, |(_, recognises, _)| recognises(&first)) {
        Some((.., read)) => read(source, warnings)?.into_track(warnings),
        None => Ok(ReferenceTrack::default()),
    }
}

/// The runs that have logs.
fn logs(data: &Dataset) -> impl Iterator<Item = (&Run, &TickLog)> {
    data.runs.iter().filter_map(|run| Some((run, run.log.as_ref()?)))
}

#[cfg(test)]
mod tests;
