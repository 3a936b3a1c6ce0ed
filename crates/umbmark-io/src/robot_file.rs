//! `robot.toml`: the nominal robot, its encoders and its path, and how the measured poses are counted.

use super::document::{Entry, Source, Table};
use super::error::{DatasetError, did_you_mean};
use super::source::read_text;
use umbmark_core::dataset::ReferenceFrame;
use umbmark_core::drive::{DifferentialDrive, Drive, DriveError, Encoder, Kind, MAX_COUNTER_BITS, Robot, Wiring};
use umbmark_core::parameter::{DefaultValue, Parameter};
use umbmark_core::path::{Path, PathError, SHAPES, Shape, SpeedProfile, WAYPOINTS};

const WHEELBASE: Parameter =
    Parameter::of_robot("wheelbase_m", "m", 0.340, (1e-3, 100.0), "distance of the two wheels' contact points");
const DIAMETER: Parameter =
    Parameter::of_robot("wheel_diameter_m", "m", 0.150, (1e-3, 10.0), "diameter of both wheels");
const RADIUS: Parameter = Parameter::of_robot("wheel_radius_m", "m", 0.075, (5e-4, 5.0), "radius of both wheels");
const DIAMETER_LEFT: Parameter = Parameter { name: "wheel_diameter_left_m", ..DIAMETER };
const DIAMETER_RIGHT: Parameter = Parameter { name: "wheel_diameter_right_m", ..DIAMETER };
const TICKS: Parameter = Parameter::of_robot(
    "ticks_per_revolution",
    "",
    2000.0,
    (1.0, 1e9),
    "counts per wheel revolution, after gearing and quadrature",
);
const RATE: Parameter =
    Parameter::of_robot("encoder_rate_hz", "Hz", 100.0, (1e-3, 1e6), "how often the counts are read");
const BITS: Parameter =
    Parameter::of_robot("counter_bits", "", 16.0, (1.0, MAX_COUNTER_BITS as f64), "width of a counter that rolls over");
const WHEELBASE_NAMES: [&str; 3] = [WHEELBASE.name, "wheel_separation_m", "track_width_m"];
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
        root.only(&["robot", "path", "reference"])?;
        let robot =
            root.need("robot", "a table [robot] with wheelbase_m, wheel_diameter_m and ticks_per_revolution")?;
        let robot = read_robot_table(&robot.table("[robot]".into())?)?;
        let path = root.get("path").map(|path| read_path_table(&path.table("[path]".into())?)).transpose()?;
        let reference = root.get("reference").map(|entry| read_reference(&entry.table("[reference]".into())?));
        Ok(RobotFile { robot, path, reference: reference.transpose()?.unwrap_or_default() })
    }
}

/// The table of a robot.
pub(super) fn read_robot_table(table: &Table) -> Result<Robot, DatasetError> {
    let kind = table.get("drive").map_or(Ok(Kind::Differential), |drive| read_kind(&drive))?;
    let backward = kind.counters().map(|counter| format!("{counter}_counts_backward"));
    let mut keys = vec!["name", "drive", EXCHANGED, &backward[0], &backward[1]];
    if kind == Kind::Differential {
        keys.extend(WHEELBASE_NAMES);
        keys.extend([DIAMETER, DIAMETER_LEFT, DIAMETER_RIGHT, RADIUS].map(|p| p.name));
    } else {
        keys.extend(kind.parameters().iter().map(|p| p.name));
    }
    keys.extend([TICKS, RATE, BITS].map(|p| p.name));
    table.only(&keys)?;
    let name = table.get("name").map(|entry| entry.word("text")).transpose()?.unwrap_or("robot");
    let drive = match kind {
        Kind::Differential => read_differential(table)?,
        _ => Drive::from_values(kind, &read_numbers(table, kind.parameters())?),
    };
    let flag = |key: &str| table.get(key).map_or(Ok(false), |entry| entry.flag());
    let wiring = Wiring { exchanged: flag(EXCHANGED)?, backward: [flag(&backward[0])?, flag(&backward[1])?] };
    let encoder = Encoder::new(table.number(&TICKS)?, read_rate(table)?, read_bits(table)?);
    match (drive, encoder) {
        (Ok(drive), Ok(encoder)) => Ok(Robot { name: name.to_owned(), drive, encoder: encoder.wired(wiring) }),
        (Err(error), _) | (_, Err(error)) => Err(table.missing("possible values", &error.to_string())),
    }
}

fn read_differential(table: &Table) -> Result<Result<Drive, DriveError>, DatasetError> {
    let wheelbase =
        table.one_of(&WHEELBASE_NAMES)?.ok_or_else(|| table.missing(WHEELBASE.name, "e.g. wheelbase_m = 0.340"))?;
    let wheelbase = wheelbase.number(&WHEELBASE)?;
    let (left, right) = read_wheels(table)?;
    Ok(DifferentialDrive::new(wheelbase, left, right).map(Drive::from))
}

fn read_kind(drive: &Entry) -> Result<Kind, DatasetError> {
    let names: Vec<&str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
    let allowed = format!("one of {}", names.join(", "));
    let word = drive.word(&allowed)?;
    let kind = Kind::ALL.iter().copied().find(|kind| kind.name() == word);
    kind.ok_or_else(|| drive.wrong(&allowed, &did_you_mean(word, names)))
}

/// The numbers of a drive; those that do nothing at 0 may be left out.
fn read_numbers(table: &Table, parameters: &[Parameter]) -> Result<Vec<f64>, DatasetError> {
    let read = |p: &Parameter| match (table.get(p.name), p.default) {
        (None, DefaultValue::Value(0.0)) => Ok(0.0),
        _ => table.number(p),
    };
    parameters.iter().map(read).collect()
}

/// Left and right diameter \[m\].
fn read_wheels(table: &Table) -> Result<(f64, f64), DatasetError> {
    let both = table.one_of(&[DIAMETER.name, RADIUS.name])?;
    let single = table.get(DIAMETER_LEFT.name).or_else(|| table.get(DIAMETER_RIGHT.name));
    match (both, single) {
        (Some(both), Some(single)) => Err(both.again(&single)),
        (Some(radius), None) if radius.key == RADIUS.name => {
            let diameter = 2.0 * radius.number(&RADIUS)?;
            Ok((diameter, diameter))
        }
        (Some(diameter), None) => {
            let diameter = diameter.number(&DIAMETER)?;
            Ok((diameter, diameter))
        }
        (None, Some(_)) => Ok((table.number(&DIAMETER_LEFT)?, table.number(&DIAMETER_RIGHT)?)),
        (None, None) => Err(table.missing(
            DIAMETER.name,
            "e.g. wheel_diameter_m = 0.150 (or wheel_diameter_left_m and wheel_diameter_right_m, or wheel_radius_m)",
        )),
    }
}

fn read_rate(table: &Table) -> Result<Option<f64>, DatasetError> {
    let Some(entry) = table.get(RATE.name) else { return Ok(None) };
    if entry.any_number().is_none() {
        let allowed = format!("{}, or \"{EVERY_TICK}\"", RATE.allowed());
        return match entry.word(&allowed) {
            Ok(EVERY_TICK) => Ok(None),
            _ => Err(entry.wrong(&allowed, "")),
        };
    }
    entry.number(&RATE).map(Some)
}

fn read_bits(table: &Table) -> Result<Option<u32>, DatasetError> {
    let Some(entry) = table.get(BITS.name) else { return Ok(None) };
    let bits = entry.number(&BITS)?;
    if bits.fract() != 0.0 {
        return Err(entry.wrong(&format!("a whole number {}", BITS.allowed()), ""));
    }
    Ok(Some(bits as u32))
}

fn read_path_table(table: &Table) -> Result<Path, DatasetError> {
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
    Path::new(shape, &values, speed).map_err(|error| match (&error, table.get(POINTS)) {
        (PathError::Waypoint { index, .. }, Some(points)) => points.wrong(
            "two or more points of at most 1e6 m either way, each another than the one before",
            &format!("look at point {index}"),
        ),
        (_, Some(points)) => points.wrong(&error.to_string(), ""),
        (_, None) => entry.wrong(&error.to_string(), ""),
    })
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
    let [y_mirrored, heading_clockwise, heading_backward] =
        keys.map(|key| table.get(key).map_or(Ok(false), |entry| entry.flag()));
    Ok(ReferenceFrame {
        y_mirrored: y_mirrored?,
        heading_clockwise: heading_clockwise?,
        heading_backward: heading_backward?,
    })
}
