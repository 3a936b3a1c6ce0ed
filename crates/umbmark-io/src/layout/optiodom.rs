//! A set as the OptiOdom project has it: a pose with heading in every row, and the ticks since the row before.

use super::super::csv_text::CsvText;
use super::super::error::DatasetError;
use super::super::save::{Existing, put};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use umbmark_core::dataset::{Dataset, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_core::path::{Path as DrivenPath, SQUARE};

pub(super) fn write(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let robot = data.nominal_robot()?;
    let kind = robot.drive.kind();
    if !kind.has_axle_wheels() {
        let reason = format!("a robot with drive = \"{}\" is not written as a set of OptiOdom", kind.name());
        return Err(DatasetError::Unwritable { file: folder.display().to_string(), reason });
    }
    let set = set_name(&robot.name, folder);
    let (numbers, renumbered) = numbers(data);
    let mut files = BTreeMap::new();
    let mut lost = Lost::default();
    for ((_, log), number) in super::logs(data).zip(numbers) {
        if let Some(text) = run_text(log, &mut lost) {
            files.insert(PathBuf::from(format!("{set}_run-{number:02}.csv")), text);
        }
    }
    if files.is_empty() {
        let reason = "no log has measured poses with headings, and OptiOdom has one in every row".into();
        return Err(DatasetError::Unwritable { file: folder.display().to_string(), reason });
    }
    let runs = files.len();
    files.insert(PathBuf::from(format!("{set}_metadata.csv")), metadata_text(robot, data.path.as_ref(), runs));
    put(folder, &files, existing, |written| {
        let unreadable = |reason: String| DatasetError::Unwritable { file: folder.display().to_string(), reason };
        let read = crate::load(written).map_err(|error| unreadable(format!("it would not be read back: {error}")))?;
        let whole = read.runs.len() == runs;
        whole.then_some(()).ok_or_else(|| unreadable("it would be read back with other runs".into()))
    })?;
    lost.renumbered = renumbered;
    lost.left_out = data.runs.len() - runs;
    Ok(lost.sentences(data))
}

/// What the layout could not hold.
#[derive(Default)]
struct Lost {
    left_out: usize,
    renumbered: bool,
    /// Rows without a pose, whose ticks went into the next row with one.
    merged: usize,
    /// Ticks after the last pose.
    trailing: f64,
}

impl Lost {
    fn sentences(&self, data: &Dataset) -> Vec<String> {
        let mut said = Vec::new();
        let mut say = |is: bool, text: String| said.extend(is.then_some(text));
        say(self.left_out > 0, format!("{} runs without measured poses with headings", self.left_out));
        say(self.merged > 0, format!("{} rows without a pose: their ticks are in the next row with one", self.merged));
        say(self.trailing > 0.0, format!("{} ticks after the last poses", self.trailing));
        say(self.renumbered, "the numbers of the runs: they are counted through both directions".into());
        let other_path = data.path.as_ref().is_some_and(|path| path.shape().name != SQUARE.name);
        say(other_path, "the path: only the side of a square has a place".into());
        let bumps = data.runs.iter().any(|run| run.test == TestKind::Bumps);
        say(bumps, "which runs are of the test with bumps".into());
        let encoder = data.robot.as_ref().map(|robot| &robot.encoder);
        let more = encoder.is_some_and(|encoder| encoder.rate().is_some() || encoder.counter_bits().is_some());
        say(more, "encoder rate and counter width".into());
        said.push("return errors: they follow from the last row of each log".into());
        said
    }
}

/// The rows of a run, where there are any.
fn run_text(log: &TickLog, lost: &mut Lost) -> Option<Vec<u8>> {
    let mut text = CsvText::behind("");
    let (mut left, mut right, mut rows) = (0.0, 0.0, 0);
    for pose in &log.reference {
        let Some(heading) = pose.heading else { continue };
        let (time, l, r) = (log.time[pose.sample], log.left[pose.sample], log.right[pose.sample]);
        [time, pose.x, pose.y, heading].into_iter().for_each(|value| text.decimal(value));
        text.cell(r - right);
        text.cell(l - left);
        text.end();
        (left, right, rows) = (l, r, rows + 1);
    }
    if rows == 0 {
        return None;
    }
    lost.merged += log.time.len().saturating_sub(rows);
    let rest = |ticks: &[f64], at: f64| ticks.last().map_or(0.0, |last| (last - at).abs());
    lost.trailing += rest(&log.left, left) + rest(&log.right, right);
    Some(text.finish())
}

fn metadata_text(robot: &Robot, path: Option<&DrivenPath>, runs: usize) -> Vec<u8> {
    let side = path.filter(|path| path.shape().name == SQUARE.name).map(|path| path.values()[0].to_string());
    let side = side.unwrap_or_default();
    let (drive, ticks) = (&robot.drive, robot.encoder.ticks_per_revolution());
    let (right, left) = (drive.wheel_diameter_right(), drive.wheel_diameter_left());
    let [ticks, wheelbase, right, left] = [ticks, drive.wheelbase(), right, left].map(|value| value.to_string());
    let runs = runs.to_string();
    let mut text = CsvText::behind("");
    text.row(["type", "diff"]);
    text.row(["ngear", "1"]);
    text.row(["encRes", &ticks]);
    text.row(["Li", &wheelbase]);
    text.row(["Di", &right, &left]);
    text.row(["Thi", ""]);
    text.row(["N", &runs]);
    text.row(["L", &side]);
    text.finish()
}

/// One number for each run with a log; whether they are not the runs' own, because these are not unique.
fn numbers(data: &Dataset) -> (Vec<u32>, bool) {
    let own: Vec<u32> = super::logs(data).map(|(run, _)| run.number).collect();
    let unique = own.iter().collect::<BTreeSet<_>>().len() == own.len() && own.iter().all(|number| *number < 100);
    if unique { (own, false) } else { ((1..=own.len() as u32).collect(), true) }
}

/// The set's own name where the robot still has it, else that of the folder.
fn set_name(robot: &str, folder: &Path) -> String {
    let folder = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let name = robot.strip_prefix("OptiOdom ").unwrap_or(&folder);
    let clean: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    if clean.is_empty() { "set".into() } else { clean }
}
