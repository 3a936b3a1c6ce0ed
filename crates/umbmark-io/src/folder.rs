//! Files and folders recognised by what is in them.

use super::assembly::{Assembly, Tracked};
use super::error::DatasetError;
use super::label::{self, Named};
use super::mcap::{Survey, Topics};
use super::optiodom;
use super::reference_file::parse_reference;
use super::returns::parse_returns;
use super::robot_file::RobotFile;
use super::source::{Source, unreadable};
use super::tick_log::parse_tick_log;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::Dataset;
use umbmark_core::run::dead_reckoning::EndPose;

pub(super) const ROBOT: &str = "robot.toml";
pub(super) const RETURNS: &str = "returns.csv";
pub(super) const RUNS: &str = "runs";
pub(super) const REFERENCE: &str = "reference";
/// Endings of files with poses that have a clock of their own.
const TRACKS: [&str; 4] = ["csv", "tum", "txt", "tsv"];
const EXPECTED: &str =
    "a dataset has robot.toml with returns.csv, runs/*.csv or runs/*.mcap (`umbmark init FOLDER` writes a start)";

/// A dataset from a folder, or from one file of it.
pub(super) fn load(path: &Path, topics: &Topics) -> Result<Dataset, DatasetError> {
    let kind = std::fs::metadata(path).map_err(|error| unreadable(path, &error))?;
    if kind.is_dir() { load_folder(path, topics) } else { load_file(path, topics) }
}

fn load_folder(folder: &Path, topics: &Topics) -> Result<Dataset, DatasetError> {
    let names = names_in(folder)?;
    let has = |name: &str| names.iter().any(|n| n == name);
    let sheets = || names.iter().filter(|name| name.strip_suffix(".gz").unwrap_or(name) == RETURNS);
    if !has(ROBOT) {
        let sets: Vec<&str> = names.iter().filter_map(|name| optiodom::set_of_metadata(name)).collect();
        return match sets[..] {
            [set] => load_optiodom(folder, set, &names),
            [] if sheets().count() > 0 || has(RUNS) => Err(not_a_dataset(folder, "it has no robot.toml".into())),
            [] => Err(not_a_dataset(folder, "it has neither robot.toml, nor returns.csv, nor runs".into())),
            _ => Err(DatasetError::NotADataset {
                file: folder.display().to_string(),
                found: format!("it has {} OptiOdom sets ({})", sets.len(), sets.join(", ")),
                remedy: "give the metadata file of one of them",
            }),
        };
    }
    let mut assembly = Assembly::new(Some(RobotFile::read(folder.join(ROBOT))?));
    for sheet in sheets() {
        add_returns(&mut assembly, &folder.join(sheet))?;
    }
    let mut logs = 0;
    if has(RUNS) {
        logs = add_logs(&mut assembly, &folder.join(RUNS), topics)?;
    }
    if logs == 0 && sheets().count() == 0 {
        return Err(not_a_dataset(folder, "it has a robot and no measurement".into()));
    }
    let named_alike = names.iter().map(|name| folder.join(name)).filter(|file| stem(file).to_lowercase() == "returns");
    for file in named_alike.filter(|file| sheets().all(|sheet| *sheet != name_of(file))) {
        assembly.warnings.push(format!("{}: is no return sheet ({RETURNS}) and was not read", file.display()));
    }
    Ok(assembly.finish())
}

fn not_a_dataset(file: &Path, found: String) -> DatasetError {
    DatasetError::NotADataset { file: file.display().to_string(), found, remedy: EXPECTED }
}

/// The names of what a folder holds, sorted, without hidden ones.
fn names_in(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        let entry = entry.map_err(|error| unreadable(folder, &error))?;
        names.push(entry.file_name().to_string_lossy().into_owned());
    }
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    Ok(names)
}

fn add_returns(assembly: &mut Assembly, file: &Path) -> Result<(), DatasetError> {
    let name = file.display().to_string();
    let rows = parse_returns(Source::open(file)?, &mut assembly.warnings)?;
    assembly.add_returns(&name, &rows)
}

/// Adds every log of a folder, with its track where there is one beside it, and says how many.
fn add_logs(assembly: &mut Assembly, folder: &Path, topics: &Topics) -> Result<usize, DatasetError> {
    let mut tracks = tracks_beside(folder, &mut assembly.warnings)?;
    let mut logs = 0;
    for name in names_in(folder)? {
        let file = folder.join(&name);
        match extension(&file).as_str() {
            "csv" => {
                add_log(assembly, &file, tracks.remove(&stem(&file)))?;
                logs += 1;
            }
            "mcap" => {
                add_mcap(assembly, Survey::open(&file)?, &file, topics)?;
                logs += 1;
            }
            _ => assembly.warnings.push(format!("{}: is no log (.csv, .mcap) and was not read", file.display())),
        }
    }
    for track in tracks.values() {
        assembly.warnings.push(format!("{}: belongs to no log of its name (.csv) and was not read", track.display()));
    }
    Ok(logs)
}

/// The tracks of logs in `runs`, by the name of the log: files of the folder `reference` beside it.
fn tracks_beside(runs: &Path, warnings: &mut Vec<String>) -> Result<BTreeMap<String, PathBuf>, DatasetError> {
    let folder = runs.parent().unwrap_or(Path::new(".")).join(REFERENCE);
    let mut tracks = BTreeMap::new();
    if !folder.is_dir() {
        return Ok(tracks);
    }
    for file in names_in(&folder)?.into_iter().map(|name| folder.join(name)) {
        let name = file.display().to_string();
        if !TRACKS.contains(&extension(&file).as_str()) {
            warnings.push(format!("{name}: is no track (.{}) and was not read", TRACKS.join(", .")));
        } else if let Some(first) = tracks.insert(stem(&file), file) {
            return Err(DatasetError::TwoTracks { file: name, first: first.display().to_string() });
        }
    }
    Ok(tracks)
}

fn add_log(assembly: &mut Assembly, file: &Path, track: Option<PathBuf>) -> Result<(), DatasetError> {
    let recording = parse_tick_log(Source::open(file)?, assembly.kind(), &mut assembly.warnings)?;
    let tracked = track.map(|track| read_track(&track, &mut assembly.warnings)).transpose()?;
    let stem = stem(file);
    assembly.add_recording(recording, tracked, &stem, label::parse(&stem), EndPose::Standing)
}

fn read_track(file: &Path, warnings: &mut Vec<String>) -> Result<Tracked, DatasetError> {
    Ok(Tracked { track: parse_reference(Source::open(file)?, warnings)?, file: file.display().to_string() })
}

fn add_mcap(assembly: &mut Assembly, survey: Survey, file: &Path, topics: &Topics) -> Result<(), DatasetError> {
    let mut warnings = Vec::new();
    let reading = survey.read(topics, assembly.robot(), &mut warnings)?;
    let stem = stem(file);
    assembly.topics.push(reading.topics(&stem));
    let log = reading.into_log(assembly.robot(), &mut warnings)?;
    assembly.warnings.append(&mut warnings);
    assembly.add_log(file.display().to_string(), log, None, &stem, label::parse(&stem), EndPose::Standing)
}

/// One MCAP log, with the robot that stands beside it, or with the one that it brings along.
fn load_mcap(file: &Path, topics: &Topics) -> Result<Dataset, DatasetError> {
    let survey = Survey::open(file)?;
    let robot_file = match (robot_beside(folder_of(file)), &survey.robot) {
        (Some(robot), _) => Some(RobotFile::read(robot)?),
        (None, Some(text)) => Some(RobotFile::parse(&format!("{} (its robot.toml)", file.display()), text)?),
        (None, None) => None,
    };
    let mut assembly = Assembly::new(robot_file);
    add_mcap(&mut assembly, survey, file, topics)?;
    Ok(assembly.finish())
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn load_optiodom(folder: &Path, set: &str, names: &[String]) -> Result<Dataset, DatasetError> {
    let mut assembly = optiodom_assembly(folder, set)?;
    let runs = optiodom::runs(names, set);
    if runs.is_empty() {
        let found = format!("it has OptiOdom metadata and neither {set}_run-01.csv nor {set}_run-01_odo.csv");
        return Err(not_a_dataset(folder, found));
    }
    for run in runs {
        add_optiodom_run(&mut assembly, folder, &run)?;
    }
    Ok(assembly.finish())
}

fn optiodom_assembly(folder: &Path, set: &str) -> Result<Assembly, DatasetError> {
    let metadata = folder.join(format!("{set}_metadata.csv"));
    let (robot, path) = optiodom::parse_metadata(set, Source::open(&metadata)?)?;
    Ok(Assembly::new(Some(RobotFile::new(robot, path))))
}

fn add_optiodom_run(assembly: &mut Assembly, folder: &Path, run: &optiodom::RunFiles) -> Result<(), DatasetError> {
    let file = folder.join(&run.ticks);
    let source = Source::open(&file)?;
    let named = Named { number: Some(run.number), ..Named::default() };
    let tricycle = assembly.robot().filter(|robot| robot.drive.kind().steers());
    let Some(track) = &run.track else {
        let recording = match tricycle {
            Some(robot) => optiodom::parse_tricycle_run(source, robot)?,
            None => optiodom::parse_run(source)?,
        };
        return assembly.add_recording(recording, None, &stem(&file), named, EndPose::Last);
    };
    if tricycle.is_some() {
        let (key, value) = ("type".into(), "\"tricyc\"".into());
        let remedy = "of tricycles, runs are read whose two clocks were brought together (*_run-NN.csv)".into();
        return Err(DatasetError::NotYet { file: source.file, line: 1, key, value, remedy });
    }
    let recording = optiodom::parse_odometry(source)?;
    let tracked = read_track(&folder.join(track), &mut assembly.warnings)?;
    assembly.add_recording(recording, Some(tracked), &stem(&file), named, EndPose::Last)
}

/// One file, with the robot that stands beside it where there is one.
fn load_file(file: &Path, topics: &Topics) -> Result<Dataset, DatasetError> {
    match extension(file).as_str() {
        "toml" => {
            let (file, found) = (file.display().to_string(), "it describes one".into());
            return Err(DatasetError::NotADataset { file, found, remedy: "give the folder it is in, or returns.csv" });
        }
        "mcap" => return load_mcap(file, topics),
        _ => {}
    }
    let folder = folder_of(file);
    if let Some(set) =
        optiodom::set_of(&name_of(file)).filter(|set| folder.join(format!("{set}_metadata.csv")).is_file())
    {
        return load_optiodom_file(file, folder, set);
    }
    let mut assembly = Assembly::new(robot_beside(folder).map(RobotFile::read).transpose()?);
    let is_log = Source::open(file)?.first_row().to_lowercase().contains("ticks");
    if is_log {
        let in_runs = folder.file_name().is_some_and(|name| name == RUNS);
        let track = if in_runs { tracks_beside(folder, &mut Vec::new())?.remove(&stem(file)) } else { None };
        add_log(&mut assembly, file, track)?
    } else {
        add_returns(&mut assembly, file)?
    }
    Ok(assembly.finish())
}

/// A set of OptiOdom by its metadata, or one run of it.
fn load_optiodom_file(file: &Path, folder: &Path, set: &str) -> Result<Dataset, DatasetError> {
    let names = names_in(folder)?;
    let name = name_of(file);
    if optiodom::set_of_metadata(&name).is_some() {
        return load_optiodom(folder, set, &names);
    }
    let mut assembly = optiodom_assembly(folder, set)?;
    match optiodom::runs(&names, set).iter().find(|run| run.ticks == name || run.track.as_ref() == Some(&name)) {
        Some(run) => add_optiodom_run(&mut assembly, folder, run)?,
        None => return Err(not_a_dataset(file, "it is no run of the OptiOdom set beside it".into())),
    }
    Ok(assembly.finish())
}

/// The robot.toml of a file in `folder`: in it, or above it where it is called runs.
fn robot_beside(folder: &Path) -> Option<PathBuf> {
    let in_runs = folder.file_name().is_some_and(|name| name == RUNS);
    let above = in_runs.then(|| folder.join("..").join(ROBOT));
    [Some(folder.join(ROBOT)), above].into_iter().flatten().find(|robot| robot.is_file())
}

fn name_of(file: &Path) -> String {
    file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The ending of a file, in lower case; that of what is packed in it where it is packed.
fn extension(file: &Path) -> String {
    let name = name_of(file).to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map_or(String::new(), |(_, extension)| extension.to_owned())
}

/// The name of a file without its endings.
fn stem(file: &Path) -> String {
    let name = name_of(file);
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
}
