//! `robot.toml`: the nominal robot, its encoders and its path, how the measured poses are counted, and what columns are called.

use super::column_names::{COLUMNS, ColumnNames};
use super::document::{Entry, Source, Table};
use super::error::{DatasetError, did_you_mean};
use super::source::read_text;
use umbmark_core::dataset::ReferenceFrame;
use umbmark_core::drive::{Drive, DriveKind, Encoder, Robot, Spelling, Wiring};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::{Path, PathError, SHAPES, Shape, SpeedProfile, WAYPOINTS};

const EVERY_TICK: &str = "every tick";
const POINTS: &str = "points_m";
pub(super) const EXCHANGED: &str = "wheels_exchanged";

/// What a `robot.toml` says.
#[derive(Clone, Debug)]
pub struct RobotFile {
    /// The nominal robot.
    pub robot: Robot,
    /// What it was told to drive, where the file says it.
    pub path: Option<Path>,
    /// How the measured poses of its logs are counted.
    pub reference: ReferenceFrame,
    /// Names that columns have in its tables in place of the usual ones.
    pub columns: ColumnNames,
}

impl RobotFile {
    /// Reads a `robot.toml`.
    pub fn read(file: impl AsRef<std::path::Path>) -> Result<RobotFile, DatasetError> {
        let file = file.as_ref();
        RobotFile::parse(&file.display().to_string(), &read_text(file)?)
    }

    /// The same from text; `file` is what messages call it.
    pub fn parse(file: &str, text: &str) -> Result<RobotFile, DatasetError> {
        let source = Source { file, text };
        let root = source.parse()?;
        let root = Table::root(&source, &root);
        root.only(&["robot", "path", "reference", COLUMNS])?;
        let robot =
            root.need("robot", "a table [robot] with wheelbase_m, wheel_diameter_m and ticks_per_revolution")?;
        let robot = read_robot_table(&robot.table("[robot]".into())?)?;
        let path = root.get("path").map(|path| read_path_table(&path.table("[path]".into())?, &robot)).transpose()?;
        let reference = root.get("reference").map(|entry| read_reference(&entry.table("[reference]".into())?));
        let columns = root.get(COLUMNS).map(|entry| ColumnNames::read(file, &entry.table(format!("[{COLUMNS}]"))?));
        let (reference, columns) =
            (reference.transpose()?.unwrap_or_default(), columns.transpose()?.unwrap_or_default());
        Ok(RobotFile { robot, path, reference, columns })
    }

    /// The keys that `[robot]` may have for a kind of drive.
    pub fn keys(kind: DriveKind) -> Vec<String> {
        let of_wiring =
            if kind.moves_sideways() { vec![] } else { [&[EXCHANGED.to_owned()], &backward_keys(kind)[..]].concat() };
        let of_drive = kind.parameters().iter().chain(kind.spellings().iter().map(|spelling| &spelling.parameter));
        let numbers = of_drive.chain([&Encoder::TICKS, &Encoder::RATE, &Encoder::BITS]).map(|p| p.name.to_owned());
        ["name", "drive"].map(str::to_owned).into_iter().chain(of_wiring).chain(numbers).collect()
    }
}

/// Keys that say of each counter whether it counts backward.
fn backward_keys(kind: DriveKind) -> [String; 2] {
    kind.counters().map(|counter| format!("{counter}_counts_backward"))
}

/// The table of a robot.
pub(super) fn read_robot_table(table: &Table) -> Result<Robot, DatasetError> {
    let kind = table.get("drive").map_or_else(|| Ok(DriveKind::default()), |drive| read_kind(&drive))?;
    let keys = RobotFile::keys(kind);
    table.only(&keys.iter().map(String::as_str).collect::<Vec<_>>())?;
    let name = table.get("name").map(|entry| entry.word("text")).transpose()?.unwrap_or("robot");
    let values = kind.parameters().iter().map(|p| read_number(table, kind, p)).collect::<Result<Vec<f64>, _>>()?;
    let drive = Drive::from_values(kind, &values);
    let flag = |key: &str| table.get(key).map_or(Ok(false), |entry| entry.flag());
    let [left, right] = backward_keys(kind);
    let wiring = Wiring { exchanged: flag(EXCHANGED)?, backward: [flag(&left)?, flag(&right)?] };
    let encoder = Encoder::new(table.number(&Encoder::TICKS)?, read_rate(table)?, read_bits(table)?);
    match (drive, encoder) {
        (Ok(drive), Ok(encoder)) => Ok(Robot { name: name.to_owned(), drive, encoder: encoder.wired(wiring) }),
        (Err(error), _) | (_, Err(error)) => Err(table.missing("possible values", &error.to_string())),
    }
}

fn read_kind(drive: &Entry) -> Result<DriveKind, DatasetError> {
    let names: Vec<&str> = DriveKind::ALL.iter().map(|kind| kind.name()).collect();
    let allowed = format!("one of {}", names.join(", "));
    let word = drive.word(&allowed)?;
    let kind = DriveKind::ALL.iter().copied().find(|kind| kind.name() == word);
    kind.ok_or_else(|| drive.wrong(&allowed, &did_you_mean(word, names)))
}

/// A number of a drive, by whichever of its keys is there; one that may do nothing may be left out.
fn read_number(table: &Table, kind: DriveKind, parameter: &Parameter) -> Result<f64, DatasetError> {
    let spellings: Vec<&Spelling> = kind.spellings().iter().filter(|s| s.of.contains(&parameter.name)).collect();
    let names: Vec<&str> = spellings.iter().map(|s| s.parameter.name).collect();
    let own = [parameter.name];
    let Some(entry) = table.one_of(&[&own, &names[..]].concat())? else {
        return match parameter.nothing() {
            Some(nothing) => Ok(nothing),
            None => Err(missing(table, parameter, &spellings)),
        };
    };
    match spellings.iter().find(|s| s.parameter.name == entry.key) {
        Some(spelling) => Ok(spelling.factor * entry.number(&spelling.parameter)?),
        None => entry.number(parameter),
    }
}

/// The error of a number that is not there: by a key for several, where the others are not there either.
fn missing(table: &Table, parameter: &Parameter, spellings: &[&Spelling]) -> DatasetError {
    let example = |p: &Parameter| format!("e.g. {} = {:?}", p.name, p.typical);
    let of_several = |s: &&&Spelling| s.of.len() > 1 && s.of.iter().all(|name| table.get(name).is_none());
    let mut all: Vec<&&Spelling> = spellings.iter().filter(of_several).collect();
    if all.is_empty() {
        return table.missing(parameter.name, &example(parameter));
    }
    let first = all.remove(0);
    let others: String = all.iter().map(|s| format!(", or {}", s.parameter.name)).collect();
    let example = format!("{} (or {}{others})", example(&first.parameter), first.of.join(" and "));
    table.missing(first.parameter.name, &example)
}

fn read_rate(table: &Table) -> Result<Option<f64>, DatasetError> {
    let Some(entry) = table.get(Encoder::RATE.name) else { return Ok(None) };
    if entry.any_number().is_none() {
        let allowed = format!("{}, or \"{EVERY_TICK}\"", Encoder::RATE.allowed());
        return match entry.word(&allowed) {
            Ok(EVERY_TICK) => Ok(None),
            _ => Err(entry.wrong(&allowed, "")),
        };
    }
    entry.number(&Encoder::RATE).map(Some)
}

fn read_bits(table: &Table) -> Result<Option<u32>, DatasetError> {
    let Some(entry) = table.get(Encoder::BITS.name) else { return Ok(None) };
    let bits = entry.number(&Encoder::BITS)?;
    if bits.fract() != 0.0 {
        return Err(entry.wrong(&format!("a whole number {}", Encoder::BITS.allowed()), ""));
    }
    Ok(Some(bits as u32))
}

fn read_path_table(table: &Table, robot: &Robot) -> Result<Path, DatasetError> {
    let allowed = format!("one of {}", SHAPES.iter().map(|shape| shape.name).collect::<Vec<_>>().join(", "));
    let entry = table.need("shape", "e.g. shape = \"square\"")?;
    let word = entry.word(&allowed)?;
    let shape = *SHAPES
        .iter()
        .find(|shape| shape.name == word)
        .ok_or_else(|| entry.wrong(&allowed, &did_you_mean(word, SHAPES.iter().map(|shape| shape.name))))?;
    let mut keys = vec!["shape"];
    keys.extend(shape.parameters.iter().map(|p| p.name));
    if is_waypoints(shape) {
        keys.push(POINTS);
    }
    keys.extend(SpeedProfile::PARAMETERS.iter().map(|p| p.name));
    table.only(&keys)?;
    let values = if is_waypoints(shape) {
        read_points(table)?
    } else {
        shape.parameters.iter().map(|p| table.number(p)).collect::<Result<Vec<_>, _>>()?
    };
    let speed = read_speed(table)?;
    let path = Path::new(shape, &values, speed).map_err(|error| match (&error, table.get(POINTS)) {
        (PathError::Waypoint { index, .. }, Some(points)) => points.wrong(
            "two or more points of at most 1e6 m either way, each another than the one before",
            &format!("look at point {index}"),
        ),
        (_, Some(points)) => points.wrong(&error.to_string(), ""),
        (_, None) => entry.wrong(&error.to_string(), ""),
    })?;
    let drive = robot.drive.kind();
    if path.slides() && !drive.moves_sideways() {
        let others = SHAPES.iter().filter(|shape| !shape.usual().slides()).map(|shape| shape.name);
        let allowed =
            format!("one of {} for a robot with drive = \"{}\"", others.collect::<Vec<_>>().join(", "), drive.name());
        return Err(entry.wrong(&allowed, "it does not move sideways"));
    }
    Ok(path)
}

fn read_speed(table: &Table) -> Result<SpeedProfile, DatasetError> {
    let mut values = SpeedProfile::default().values();
    for (value, parameter) in values.iter_mut().zip(&SpeedProfile::PARAMETERS) {
        if let Some(entry) = table.get(parameter.name) {
            *value = entry.number(parameter)?;
        }
    }
    SpeedProfile::new(values[0], values[1], values[2])
        .map_err(|error| table.missing("possible speed", &error.to_string()))
}

fn read_points(table: &Table) -> Result<Vec<f64>, DatasetError> {
    const ALLOWED: &str = "a list of points [x, y], in m";
    let entry = table.need(POINTS, "e.g. points_m = [[4.0, 0.0], [4.0, 4.0], [0.0, 0.0]]")?;
    let mut values = Vec::new();
    for point in entry.list(ALLOWED)? {
        let pair = point.list(ALLOWED)?;
        if pair.len() != 2 {
            return Err(point.wrong(ALLOWED, "each point has two numbers"));
        }
        for coordinate in pair {
            values.push(coordinate.any_number().ok_or_else(|| coordinate.wrong(ALLOWED, ""))?);
        }
    }
    Ok(values)
}

pub(super) fn is_waypoints(shape: &Shape) -> bool {
    shape.name == WAYPOINTS.name
}

fn read_reference(table: &Table) -> Result<ReferenceFrame, DatasetError> {
    let keys = ReferenceFrame::default().keys().map(|(key, ..)| key);
    table.only(&keys)?;
    let [y_mirrored, heading_clockwise, heading_backward, drifting] =
        keys.map(|key| table.get(key).map_or(Ok(false), |entry| entry.flag()));
    Ok(ReferenceFrame {
        y_mirrored: y_mirrored?,
        heading_clockwise: heading_clockwise?,
        heading_backward: heading_backward?,
        drifting: drifting?,
    })
}
