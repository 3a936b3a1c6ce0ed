//! A run saved as one MCAP file, beside its place, read back, and renamed.

use super::super::error::DatasetError;
use super::super::save::{Existing, unwritable};
use super::super::{Dataset, TickLog};
use super::write::{nanoseconds, write};
use crate::geometry::wrap;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Times are kept to the nanosecond, half of one at most being lost \[s\].
const TIME: f64 = 0.51e-9;
/// Headings go through a quaternion \[rad\].
const HEADING: f64 = 4e-15;
/// Counts that are not whole go through radians \[ticks, as a share of the count\].
const COUNT: f64 = 4e-15;

impl Dataset {
    /// Writes the one run of this dataset as an MCAP file of ROS 2 messages, with its nominal robot.
    ///
    /// It reads back as the same log: whole counts and positions to the last bit, times to the nanosecond, headings to
    /// 4e-15 rad. That is checked before the file gets its name.
    pub fn save_mcap(&self, file: impl AsRef<Path>, existing: Existing) -> Result<(), DatasetError> {
        let file = file.as_ref();
        let robot = self.nominal_robot()?;
        let refuse = |reason: String| DatasetError::Unwritable { file: file.display().to_string(), reason };
        let [run] = &self.runs[..] else {
            return Err(refuse(format!("there are {} runs, and an MCAP file holds one", self.runs.len())));
        };
        let log = run.log.as_ref().ok_or_else(|| refuse(format!("{} has no ticks", run.name)))?;
        let in_range = |time: &f64| (0.0..f64::from(i32::MAX)).contains(time);
        if let Some(time) = log.time.iter().find(|time| !in_range(time)) {
            return Err(refuse(format!("time {time} s cannot be written; stamps go from 0 to {} s", i32::MAX)));
        }
        if existing == Existing::Keep && file.exists() {
            let (file, remedy) = (file.display().to_string(), "choose another name, or say --force to replace it");
            return Err(DatasetError::AlreadyThere { file, remedy });
        }
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".umbmark-").suffix(".mcap");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut beside = builder.tempfile_in(folder).map_err(|error| unwritable(file, &error))?;
        write(BufWriter::new(&mut beside), robot, self.path.as_ref(), log)
            .map_err(|error| refuse(error.to_string()))?;
        beside.flush().and_then(|()| beside.as_file().sync_all()).map_err(|error| unwritable(file, &error))?;
        let read = super::Survey::open(beside.path()).and_then(|survey| {
            let reading = survey.read(&super::Topics::default(), Some(robot), &mut Vec::new())?;
            reading.into_log(Some(robot), &mut Vec::new())
        });
        match read {
            Ok(read) if same(log, &read) => {}
            Ok(_) => return Err(refuse("its log would not be read back as it is".into())),
            Err(error) => {
                let place = beside.path().display().to_string();
                return Err(refuse(format!("it could not be read back: {}", error.to_string().replace(&place, "…"))));
            }
        }
        let named = match existing {
            Existing::Keep => beside.persist_noclobber(file),
            Existing::Replace => beside.persist(file),
        };
        named.map(|_| ()).map_err(|error| unwritable(file, &error.error))
    }
}

/// Whether a log was read back as it was, but for what the messages cannot hold.
fn same(log: &TickLog, read: &TickLog) -> bool {
    let near = |a: f64, b: f64| a == b || a.fract() != 0.0 && (a - b).abs() <= COUNT * a.abs();
    let counts = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(*a, *b));
    let times = log.time.len() == read.time.len()
        && log.time.iter().zip(&read.time).all(|(a, b)| (a - b).abs() <= TIME && nanoseconds(*a) == nanoseconds(*b));
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
