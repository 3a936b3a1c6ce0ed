//! The project's own layout: `robot.toml`, `returns.csv`, `runs/*.csv` and `reference/*.csv`.

mod contents;
mod marks;
mod returns;
mod tick_log;
mod track;

use super::messages::Topics;
use super::{Layout, ReadLogs, Tracks};
use crate::RobotFile;
use crate::assembly::Assembly;
use crate::conditions::{CONDITIONS, conditions_text, of_runs};
use crate::error::DatasetError;
use crate::file_names::{RETURNS, ROBOT, RUNS};
use crate::foreign::Foreign;
use crate::label;
use crate::probe::{Probe, extension, name_of, names_in, stem};
use crate::remedy::Remedy;
use crate::save::{Existing, put};
use crate::source::Source;
pub(crate) use returns::{Measured, ReturnRow, parse_returns, returns_text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
pub(crate) use tick_log::{parse_tick_log, tick_log_text};
use umbmark_core::action::Action;
use umbmark_core::dataset::{Dataset, Run, TickLog};
use umbmark_core::run::dead_reckoning::EndPose;

pub(crate) const LAYOUT: Layout = Layout::new("csv", "robot.toml, returns.csv and runs/*.csv: holds everything")
    .reads_data((is_data, read))
    .reads_logs(ReadLogs { ending: "csv", add: add_log, look: contents::look })
    .reads_tracks((&["csv"], track::is_track, track::parse_columns))
    .writes(write);

const MARKS: &str = "marks.csv";
pub(crate) const REFERENCE: &str = "reference";
const EXPECTED: Remedy = Remedy::Then {
    words: "a dataset has robot.toml with returns.csv, runs/*.csv or runs/*.mcap",
    action: Action::Begin,
};

fn is_data(probe: &Probe) -> bool {
    probe.is_folder && probe.has(ROBOT)
}

fn read(probe: &Probe, topics: &Topics) -> Result<Dataset, DatasetError> {
    if probe.is_folder { read_folder(probe, topics) } else { read_file(probe, topics) }
}

/// Robot, returns and runs of a folder.
fn read_folder(probe: &Probe, topics: &Topics) -> Result<Dataset, DatasetError> {
    let folder = &probe.folder;
    let sheets = || probe.names.iter().filter(|name| name.strip_suffix(".gz").unwrap_or(name) == RETURNS);
    if !probe.has(ROBOT) {
        return Err(match sheets().count() > 0 || probe.has(RUNS) {
            true => not_a_dataset(folder, "it has no robot.toml".into()),
            false => not_a_dataset(folder, "it has neither robot.toml, nor returns.csv, nor runs".into()),
        });
    }
    let mut assembly = Assembly::new(Some(RobotFile::read(folder.join(ROBOT))?));
    // A sheet that nobody has filled in yet says nothing beside logs; without logs there is nothing else to read.
    let mut unfilled = None;
    for sheet in sheets() {
        match add_returns(&mut assembly, &folder.join(sheet)) {
            Err(empty @ DatasetError::NoRows { .. }) => unfilled = Some(empty),
            added => added?,
        }
    }
    if probe.has(MARKS) {
        assembly.marks =
            marks::parse(Source::open(&folder.join(MARKS))?.with(&assembly.columns), &mut assembly.warnings)?;
    }
    let mut logs = 0;
    if probe.has(RUNS) {
        logs = add_logs(&mut assembly, &folder.join(RUNS), topics)?;
    }
    if let Some(empty) = unfilled.filter(|_| logs == 0) {
        return Err(empty);
    }
    if logs == 0 && sheets().count() == 0 {
        return Err(not_a_dataset(folder, "it has a robot and no measurement".into()));
    }
    let named_alike =
        probe.names.iter().map(|name| folder.join(name)).filter(|file| stem(file).to_lowercase() == "returns");
    for file in named_alike.filter(|file| sheets().all(|sheet| *sheet != name_of(file))) {
        assembly.warnings.push(format!("{}: is no return sheet ({RETURNS}) and was not read", file.display()));
    }
    assembly.columns.check()?;
    assembly.finish()
}

pub(super) fn not_a_dataset(file: &Path, found: String) -> DatasetError {
    DatasetError::NotADataset { file: file.display().to_string(), found, remedy: EXPECTED }
}

fn add_returns(assembly: &mut Assembly, file: &Path) -> Result<(), DatasetError> {
    let name = file.display().to_string();
    let rows = parse_returns(Source::open(file)?.with(&assembly.columns), &mut assembly.warnings)?;
    assembly.add_returns(&name, &rows)
}

/// Adds every log of a folder, with its track where there is one beside it, and says how many.
fn add_logs(assembly: &mut Assembly, folder: &Path, topics: &Topics) -> Result<usize, DatasetError> {
    let mut tracks = tracks_beside(folder, &mut assembly.warnings)?;
    let mut logs = 0;
    for name in names_in(folder)? {
        let file = folder.join(&name);
        match super::add_log(assembly, &file, &mut tracks, topics) {
            Some(added) => {
                added?;
                logs += 1;
            }
            None => {
                let endings = super::log_endings().join(", .");
                let what = Foreign::of_file(&file).map_or(String::new(), |foreign| format!(": {}", foreign.told()));
                assembly.warnings.push(format!("{}: is no log (.{endings}) and was not read{what}", file.display()));
            }
        }
    }
    for track in tracks.values() {
        assembly.warnings.push(format!("{}: belongs to no log of its name (.csv) and was not read", track.display()));
    }
    Ok(logs)
}

/// The tracks of logs in `runs`, by the name of the log: files of the folder `reference` beside it.
fn tracks_beside(runs: &Path, warnings: &mut Vec<String>) -> Result<Tracks, DatasetError> {
    let folder = runs.parent().unwrap_or(Path::new(".")).join(REFERENCE);
    let mut tracks = Tracks::new();
    if !folder.is_dir() {
        return Ok(tracks);
    }
    let endings = super::track_endings();
    for file in names_in(&folder)?.into_iter().map(|name| folder.join(name)) {
        let name = file.display().to_string();
        if !endings.contains(&extension(&file).as_str()) {
            warnings.push(format!("{name}: is no track (.{}) and was not read", endings.join(", .")));
        } else if let Some(first) = tracks.insert(stem(&file), file) {
            return Err(DatasetError::TwoTracks { file: name, first: first.display().to_string() });
        }
    }
    Ok(tracks)
}

/// Adds a log, with the track that stands beside it.
fn add_log(assembly: &mut Assembly, file: &Path, tracks: &mut Tracks, _: &Topics) -> Result<(), DatasetError> {
    let recording =
        parse_tick_log(Source::open(file)?.with(&assembly.columns), assembly.kind(), &mut assembly.warnings)?;
    let tracked = tracks
        .remove(&stem(file))
        .map(|track| super::read_track(&track, &assembly.columns, &mut assembly.warnings))
        .transpose()?;
    let stem = stem(file);
    assembly.add_recording(recording, tracked, &stem, label::parse(&stem), EndPose::Standing)
}

/// One file, with the robot that stands beside it where there is one.
fn read_file(probe: &Probe, topics: &Topics) -> Result<Dataset, DatasetError> {
    let (file, folder) = (&probe.path, &probe.folder);
    if probe.extension() == "toml" {
        let (file, found) = (file.display().to_string(), "it describes one".into());
        return Err(DatasetError::NotADataset {
            file,
            found,
            remedy: "give the folder it is in, or returns.csv".into(),
        });
    }
    let mut assembly = Assembly::new(probe.robot_file()?);
    let mut header: Vec<String> =
        probe.first_row()?.to_lowercase().split(',').map(|name| name.trim_matches([' ', '"']).to_owned()).collect();
    assembly.columns.rename(&mut header);
    if header.iter().any(|name| name.contains("ticks")) {
        let in_runs = folder.file_name().is_some_and(|name| name == RUNS);
        let mut tracks = if in_runs { tracks_beside(folder, &mut Vec::new())? } else { Tracks::new() };
        add_log(&mut assembly, file, &mut tracks, topics)?;
    } else {
        add_returns(&mut assembly, file)?;
    }
    assembly.finish()
}

/// The project's own layout. Counts between two readings, which a track put there, are no counts of a counter that rolls over:
/// then they are written as they are, unrolled.
fn write(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let between = |log: &TickLog| log.left.iter().chain(&log.right).any(|ticks| ticks.fract() != 0.0);
    let robot = data.nominal_robot()?;
    let mut lost = Vec::new();
    let timed = super::logs(data).filter(|(_, log)| log.clock_excess != 0.0).count();
    if timed > 0 {
        lost.push(format!("{timed} durations by the reference's clock: lost_cycles cannot be told from the copy"));
    }
    let encoder = &robot.encoder;
    if encoder.counter_bits().is_none() || !super::logs(data).any(|(_, log)| between(log)) {
        return save(data, folder, existing).map(|()| lost);
    }
    let mut unrolled = data.clone();
    let mut robot = robot.clone();
    robot.encoder = encoder.without_roll_over();
    unrolled.robot = Some(robot);
    save(&unrolled, folder, existing)?;
    lost.push("counter_bits: counts were put between readings, so all are written with their roll-overs undone".into());
    Ok(lost)
}

/// How the logs of a dataset are written.
pub(crate) struct LogFormat {
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
    let sense = |log: &TickLog| (log.relative, log.headings_only);
    let counts = |log: &TickLog| (log.left.clone(), log.right.clone(), log.rollers.clone());
    (&a.time, counts(a), &a.reference, sense(a)) == (&b.time, counts(b), &b.reference, sense(b))
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
pub(crate) fn save_with(
    data: &Dataset,
    folder: &Path,
    existing: Existing,
    format: &LogFormat,
) -> Result<Dataset, DatasetError> {
    let robot = data.nominal_robot()?;
    let mut files = BTreeMap::new();
    // The poses are written as they are meant to be.
    let mut robot_file = RobotFile::new(robot.clone(), data.path.clone());
    robot_file.reference.drifting = super::logs(data).any(|(_, log)| log.relative);
    files.insert(PathBuf::from(ROBOT), robot_file.text().into_bytes());
    files.extend(returns_text(&data.runs).map(|text| (PathBuf::from(RETURNS), text)));
    files.extend(conditions_text(data).map(|text| (PathBuf::from(CONDITIONS), text)));
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
    let read = crate::load(written).map_err(|error| {
        let place = written.display().to_string();
        refuse(format!("it could not be read back: {}", error.to_string().replace(&place, "…")))
    })?;
    let mut runs: Vec<&Run> = data.runs.iter().collect();
    runs.sort_by_key(|run| (run.test, run.direction, run.number));
    if (&read.robot, &read.path) != (&data.robot, &data.path) {
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
    let stated =
        |data| of_runs(data).into_iter().map(|(run, stated)| (run.test, run.direction, run.number, stated.clone()));
    if !stated(data).eq(stated(&read)) {
        return Err(refuse(
            "its conditions would not be read back as they are: a number stands where a word is meant".into(),
        ));
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
