//! Runs saved as MCAP: one as a file, read back and renamed; or each as a file of a folder.

use super::super::csv::{LogFormat, save_with};
use super::super::messages::{Survey, Topics, is_calendar};
use super::write::{nanoseconds, write};
use crate::RobotFile;
use crate::error::DatasetError;
use crate::remedy::Remedy;
use crate::save::{Existing, unwritable};
use crate::unfinished::Unfinished;
use crate::whole_file::{Place, WholeFile};
use std::io::{Cursor, Write};
use std::path::Path;
use umbmark_core::dataset::{Dataset, Run, TickLog};
use umbmark_core::geometry::wrap;

/// Times are kept to the nanosecond, one at most being lost \[s\].
const TIME: f64 = 1.01e-9;
/// Headings go through a quaternion \[rad\].
const HEADING: f64 = 4e-15;
/// Counts go through radians where some of them are not whole \[ticks, as a share of the count\].
const COUNT: f64 = 4e-15;

/// `runs/*.mcap`.
const MCAP: LogFormat = LogFormat { ending: "mcap", bytes, same };

/// Writes a dataset as MCAP, ROS 2 messages with the nominal robot in each file: its one run where `place` ends in
/// `.mcap`, else a folder of `robot.toml`, `returns.csv` and `runs/*.mcap`. Says what is lost, one sentence each.
///
/// Logs read back as they are: whole counts and positions to the last bit, times to the nanosecond, headings to
/// 4e-15 rad. That is checked before anything gets its name.
pub fn save_mcap(data: &Dataset, place: impl AsRef<Path>, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let place = place.as_ref();
    let kind = data.nominal_robot()?.drive.kind();
    if !kind.has_axle_wheels() {
        let reason =
            format!("MCAP logs hold wheels, and a robot with drive = \"{}\" counts others; write CSV", kind.name());
        return Err(DatasetError::Unwritable { file: place.display().to_string(), reason });
    }
    if !place.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap")) {
        let read = save_with(data, place, existing, &MCAP)?;
        let read_log = |run: &Run| {
            let key = |run: &Run| (run.test, run.direction, run.number);
            read.runs.iter().find(|read| key(read) == key(run))?.log.as_ref()
        };
        return Ok(lost(data.runs.iter().filter_map(|run| Some((run.log.as_ref()?, read_log(run)?)))));
    }
    let refuse = |reason: String| DatasetError::Unwritable { file: place.display().to_string(), reason };
    let [run] = &data.runs[..] else {
        return Err(refuse(format!("there are {} runs, and an MCAP file holds one", data.runs.len())));
    };
    let log = run.log.as_ref().ok_or_else(|| refuse(format!("{} has no ticks", run.name)))?;
    let read = save_log(data, run, log, place, existing)?;
    let mut lost = lost(std::iter::once((log, &read)));
    lost.extend(run.returned.map(|_| "the return error: it follows from the log".to_owned()));
    Ok(lost)
}

fn save_log(
    data: &Dataset,
    run: &Run,
    log: &TickLog,
    file: &Path,
    existing: Existing,
) -> Result<TickLog, DatasetError> {
    let place = Place::of(file);
    if existing == Existing::Keep && matches!(&place, Place::Named(place) if place.exists()) {
        let (file, remedy) = (file.display().to_string(), Remedy::Replace { another: "name" });
        return Err(DatasetError::AlreadyThere { file, remedy });
    }
    let refuse = |reason: String| DatasetError::Unwritable { file: file.display().to_string(), reason };
    // Read back before it gets its name; what is written through has no place beside it.
    let elsewhere = std::env::temp_dir();
    let folder = match &place {
        Place::Named(place) => place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")),
        Place::Stdout | Place::Special => &elsewhere,
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".umbmark-").suffix(".mcap");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let beside = Unfinished::begin(|| builder.tempfile_in(folder), |beside| beside.path());
    let (mut beside, _unfinished) = beside.map_err(|error| unwritable(file, &error))?;
    let bytes = bytes(data, run, log)?;
    beside.write_all(&bytes).and_then(|()| beside.as_file().sync_all()).map_err(|error| unwritable(file, &error))?;
    let robot = data.robot.as_ref();
    let read = Survey::open(beside.path()).and_then(|survey| {
        let reading = survey.read(&Topics::default(), robot, &mut Vec::new())?;
        reading.into_log(robot, &mut Vec::new())
    });
    let read = read.map_err(|error| {
        let place = beside.path().display().to_string();
        refuse(format!("it could not be read back: {}", error.to_string().replace(&place, "…")))
    })?;
    if !same(log, &read) {
        return Err(refuse("its log would not be read back as it is".into()));
    }
    let named = match (place, existing) {
        (Place::Named(place), Existing::Keep) => beside.persist_noclobber(place).map(drop).map_err(|error| error.error),
        (Place::Named(place), Existing::Replace) => beside.persist(place).map(drop).map_err(|error| error.error),
        _ => WholeFile::write(file, existing, &bytes).map_err(std::io::Error::other),
    };
    named.map_err(|error| unwritable(file, &error))?;
    Ok(read)
}

/// A log as the bytes of an MCAP file.
fn bytes(data: &Dataset, run: &Run, log: &TickLog) -> Result<Vec<u8>, DatasetError> {
    let refuse = |reason: String| DatasetError::Unwritable { file: run.name.clone(), reason };
    if log.headings_only {
        return Err(refuse(
            "its reference tells headings only, which messages of poses cannot say; write it as CSV".into(),
        ));
    }
    let begin = log.time.first().copied().unwrap_or(0.0).min(0.0);
    if let Some(time) = log.time.iter().find(|time| **time - begin >= f64::from(i32::MAX)) {
        return Err(refuse(format!("time {time} s cannot be written; stamps go from 0 to {} s", i32::MAX)));
    }
    let mut file = Cursor::new(Vec::new());
    let mut robot_file = RobotFile::new(data.nominal_robot()?.clone(), data.path.clone());
    robot_file.reference.drifting = log.relative;
    write(&mut file, &robot_file, log, begin).map_err(|error| refuse(error.to_string()))?;
    Ok(file.into_inner())
}

/// The time that is zero when a log is read back \[s\].
fn origin(log: &TickLog) -> f64 {
    let (Some(first), Some(last)) = (log.time.first(), log.time.last()) else { return 0.0 };
    let is_moved = *first < 0.0 || is_calendar(nanoseconds(*last) as i64);
    if is_moved { *first } else { 0.0 }
}

/// Whether a log was read back as it was, but for what the messages cannot hold.
fn same(log: &TickLog, read: &TickLog) -> bool {
    let whole = log.left.iter().chain(&log.right).all(|count| count.fract() == 0.0);
    let near = |a: f64, b: f64| a == b || !whole && (a - b).abs() <= COUNT * a.abs();
    let counts = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(*a, *b));
    let origin = origin(log);
    let times = log.time.len() == read.time.len()
        && log.time.iter().zip(&read.time).all(|(a, b)| (a - origin - b).abs() <= TIME);
    let references = log.reference.len() == read.reference.len()
        && log.reference.iter().zip(&read.reference).all(|(a, b)| {
            let headings = match (a.heading, b.heading) {
                (Some(a), Some(b)) => wrap(a - b).abs() <= HEADING * (1.0 + a.abs()),
                (a, b) => a == b,
            };
            (a.sample, a.x, a.y) == (b.sample, b.x, b.y) && headings
        });
    times && references && counts(&log.left, &read.left) && counts(&log.right, &read.right)
}

/// What is not as it was in logs that were read back, one sentence each.
fn lost<'l>(logs: impl Iterator<Item = (&'l TickLog, &'l TickLog)>) -> Vec<String> {
    let (mut origins, mut times, mut counts, mut headings, mut turns) = (0, 0, 0, 0, 0);
    for (log, read) in logs {
        let origin = origin(log);
        origins += usize::from(origin != 0.0);
        let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).filter(|(a, b)| a != b).count();
        times += log.time.iter().zip(&read.time).filter(|(a, b)| *a - origin != **b).count();
        counts += differ(&log.left, &read.left) + differ(&log.right, &read.right);
        for (a, b) in log.reference.iter().zip(&read.reference) {
            let Some((a, b)) = a.heading.zip(b.heading) else { continue };
            headings += usize::from(a != b);
            turns += usize::from((a - b).abs() > 1.0);
        }
    }
    let sentences = [
        (origins, "logs keep no date: their times are counted from the first row"),
        (times, "times are rounded to the nanosecond"),
        (counts, "counts between readings are rounded in their last digits"),
        (headings, "headings are rounded in their last digits (4e-15 rad)"),
        (turns, "headings differ by full turns"),
    ];
    sentences.into_iter().filter(|(n, _)| *n > 0).map(|(n, text)| format!("{n} {text}")).collect()
}
