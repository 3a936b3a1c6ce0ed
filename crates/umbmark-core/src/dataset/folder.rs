//! Files and folders recognised by what is in them.

use super::Dataset;
use super::assembly::Assembly;
use super::dead_reckoning::EndPose;
use super::error::DatasetError;
use super::label::{self, Named};
use super::mcap::{Survey, Topics};
use super::optiodom;
use super::returns::parse_returns;
use super::robot_file::{parse_robot, read_robot};
use super::sheet::Rows;
use super::text::{read_text, unreadable};
use super::tick_log::parse_tick_log;
use std::path::{Path, PathBuf};

pub(super) const ROBOT: &str = "robot.toml";
pub(super) const RETURNS: &str = "returns.csv";
pub(super) const RUNS: &str = "runs";
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
    if !has(ROBOT) {
        let sets: Vec<&str> = names.iter().filter_map(|name| optiodom::set_of_metadata(name)).collect();
        return match sets[..] {
            [set] => load_optiodom(folder, set, &names),
            [] if has(RETURNS) || has(RUNS) => Err(not_a_dataset(folder, "it has no robot.toml".into())),
            [] => Err(not_a_dataset(folder, "it has neither robot.toml, nor returns.csv, nor runs".into())),
            _ => Err(not_a_dataset(folder, format!("it has {} OptiOdom sets", sets.len()))),
        };
    }
    let (robot, driven) = read_robot(folder.join(ROBOT))?;
    let mut assembly = Assembly::new(Some(robot), driven);
    if has(RETURNS) {
        add_returns(&mut assembly, &folder.join(RETURNS))?;
    }
    let mut logs = 0;
    if has(RUNS) {
        logs = add_logs(&mut assembly, &folder.join(RUNS), topics)?;
    }
    if logs == 0 && !has(RETURNS) {
        return Err(not_a_dataset(folder, "it has a robot and no measurement".into()));
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
    let rows = parse_returns(&name, &read_text(file)?, &mut assembly.warnings)?;
    assembly.add_returns(&name, &rows)
}

/// Adds every log of a folder, and says how many.
fn add_logs(assembly: &mut Assembly, folder: &Path, topics: &Topics) -> Result<usize, DatasetError> {
    let mut logs = 0;
    for name in names_in(folder)? {
        let file = folder.join(&name);
        match extension(&file).as_str() {
            "csv" => {
                add_log(assembly, &file)?;
                logs += 1;
            }
            "mcap" => {
                add_mcap(assembly, Survey::open(&file)?, &file, topics)?;
                logs += 1;
            }
            _ => assembly.warnings.push(format!("{}: is no log (.csv, .mcap) and was not read", file.display())),
        }
    }
    Ok(logs)
}

fn add_log(assembly: &mut Assembly, file: &Path) -> Result<(), DatasetError> {
    let name = file.display().to_string();
    let recording = parse_tick_log(&name, &read_text(file)?, &mut assembly.warnings)?;
    let stem = stem(file);
    assembly.add_log(recording, &stem, label::parse(&stem), EndPose::Standing)
}

fn add_mcap(assembly: &mut Assembly, survey: Survey, file: &Path, topics: &Topics) -> Result<(), DatasetError> {
    let mut warnings = Vec::new();
    let reading = survey.read(topics, assembly.robot(), &mut warnings)?;
    let log = reading.into_log(assembly.robot(), &mut warnings)?;
    assembly.warnings.append(&mut warnings);
    let stem = stem(file);
    assembly.add_ticks(file.display().to_string(), log, &stem, label::parse(&stem), EndPose::Standing)
}

/// One MCAP log, with the robot that stands beside it, or with the one that it brings along.
fn load_mcap(file: &Path, topics: &Topics) -> Result<Dataset, DatasetError> {
    let survey = Survey::open(file)?;
    let (robot, path) = match (robot_beside(folder_of(file)), &survey.robot) {
        (Some(robot), _) => read_robot(robot).map(|(robot, path)| (Some(robot), path))?,
        (None, Some(text)) => {
            let place = format!("{} (its robot.toml)", file.display());
            parse_robot(&place, text).map(|(robot, path)| (Some(robot), path))?
        }
        (None, None) => (None, None),
    };
    let mut assembly = Assembly::new(robot, path);
    add_mcap(&mut assembly, survey, file, topics)?;
    Ok(assembly.finish())
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn load_optiodom(folder: &Path, set: &str, names: &[String]) -> Result<Dataset, DatasetError> {
    let mut assembly = optiodom_assembly(folder, set)?;
    let runs: Vec<&String> = names.iter().filter(|name| optiodom::run_number(name, set).is_some()).collect();
    if runs.is_empty() {
        return Err(not_a_dataset(folder, format!("it has OptiOdom metadata and no {set}_run-01.csv")));
    }
    for name in runs {
        add_optiodom_run(&mut assembly, &folder.join(name), set)?;
    }
    Ok(assembly.finish())
}

fn optiodom_assembly(folder: &Path, set: &str) -> Result<Assembly, DatasetError> {
    let metadata = folder.join(format!("{set}_metadata.csv"));
    let (robot, path) = optiodom::parse_metadata(&metadata.display().to_string(), set, &read_text(&metadata)?)?;
    Ok(Assembly::new(Some(robot), path))
}

fn add_optiodom_run(assembly: &mut Assembly, file: &Path, set: &str) -> Result<(), DatasetError> {
    let recording = optiodom::parse_run(&file.display().to_string(), &read_text(file)?)?;
    let number = file.file_name().and_then(|name| optiodom::run_number(&name.to_string_lossy(), set));
    assembly.add_log(recording, &stem(file), Named { number, ..Named::default() }, EndPose::Last)
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
    let stem = stem(file);
    if let Some((set, _)) =
        stem.rsplit_once("_run-").filter(|(set, _)| folder.join(format!("{set}_metadata.csv")).is_file())
    {
        let mut assembly = optiodom_assembly(folder, set)?;
        add_optiodom_run(&mut assembly, file, set)?;
        return Ok(assembly.finish());
    }
    let (robot, path) = match robot_beside(folder) {
        Some(robot) => read_robot(robot).map(|(robot, path)| (Some(robot), path))?,
        None => (None, None),
    };
    let mut assembly = Assembly::new(robot, path);
    let text = read_text(file)?;
    let is_log = Rows::of(&text).next().is_some_and(|(_, header)| header.to_lowercase().contains("ticks"));
    if is_log {
        add_log(&mut assembly, file)?
    } else {
        add_returns(&mut assembly, file)?
    }
    Ok(assembly.finish())
}

/// The robot.toml of a file in `folder`: in it, or above it where it is called runs.
fn robot_beside(folder: &Path) -> Option<PathBuf> {
    let in_runs = folder.file_name().is_some_and(|name| name == RUNS);
    let above = in_runs.then(|| folder.join("..").join(ROBOT));
    [Some(folder.join(ROBOT)), above].into_iter().flatten().find(|robot| robot.is_file())
}

fn extension(file: &Path) -> String {
    file.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

fn stem(file: &Path) -> String {
    file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
