//! What a tick log holds, and what of it would be read, before anything is known of its robot.

use super::tick_log::parse_tick_log;
use crate::contents::rolls_over;
use crate::error::{DatasetError, LineProblem};
use crate::layout::messages::Topics;
use crate::recording::Recording;
use crate::remedy::Words;
use crate::sheet::Sheet;
use crate::source::Source;
use std::path::Path;
use umbmark_core::drive::DriveKind;
use umbmark_core::inspect::{LogContents, LogPart, ReferenceFound, WheelUnit, WheelsFound, usual_rate};

const EXPECTED: &str = super::tick_log::HEADER;

/// The cells of a column.
#[derive(Default)]
struct Cells {
    filled: u64,
    /// The least and the largest number, while all cells are numbers.
    range: Option<[f64; 2]>,
    has_text: bool,
}

impl Cells {
    fn take(&mut self, cell: &str) {
        if cell.is_empty() {
            return;
        }
        self.filled += 1;
        match cell.parse::<f64>() {
            Ok(value) => {
                let [low, high] = self.range.unwrap_or([value; 2]);
                self.range = Some([low.min(value), high.max(value)]);
            }
            Err(_) => self.has_text = true,
        }
    }

    fn kind(&self) -> String {
        match self.range {
            _ if self.has_text => "text".to_owned(),
            Some([low, high]) if low == high => format!("always {}", short(low)),
            Some([low, high]) => format!("{} to {}", short(low), short(high)),
            None => "empty".to_owned(),
        }
    }
}

/// A number to six digits at the most, but whole ones to the last.
fn short(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return format!("{}", value + 0.0);
    }
    let decimals = (5.0 - libm::floor(libm::log10(value.abs()))).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Looks through a file of columns.
///
/// # Errors
///
/// Where it is no table. That it lacks the columns of a log is told in the contents.
pub(super) fn look(file: &Path, _: &Topics, words: &Words) -> Result<LogContents, DatasetError> {
    let sheet = Sheet::open(Source::open(file)?, EXPECTED)?;
    let header = sheet.header.clone();
    let mut cells: Vec<Cells> = header.iter().map(|_| Cells::default()).collect();
    sheet.for_each(|row| {
        cells.iter_mut().enumerate().for_each(|(place, cells)| cells.take(row.cell(place)));
        Ok(())
    })?;
    let has = |name: &str| header.iter().any(|column| column == name);
    let named = |kind: &&DriveKind| kind.has_tick_logs() && kind.columns().iter().all(|of| has(&format!("ticks_{of}")));
    let drive = DriveKind::ALL.iter().find(named).copied().unwrap_or_default();
    let mut notes = Vec::new();
    let recording = match parse_tick_log(Source::open(file)?, drive, &mut notes) {
        Ok(recording) => Ok(recording),
        // Its columns are not those of a log.
        Err(DatasetError::Line { problem, .. }) if is_of_header(&problem) => Err(problem.to_string()),
        Err(error) => return Err(error),
    };
    let time = recording.as_ref().map_or(&[][..], |recording| &recording.time);
    let duration = time.last().zip(time.first()).map(|(last, first)| last - first).filter(|seconds| *seconds > 0.0);
    let part = |(name, cells): (&String, &Cells)| LogPart {
        name: name.clone(),
        kind: cells.kind(),
        count: Some(cells.filled),
        rate: duration.filter(|_| cells.filled > 1).map(|seconds| (cells.filled - 1) as f64 / seconds),
        used: recording.as_ref().ok().and_then(|recording| role(recording, name)),
    };
    let parts = header.iter().zip(&cells).map(part).collect();
    let reference = recording.as_ref().ok().and_then(reference);
    let wheels = recording.and_then(|recording| wheels(recording, drive, words));
    let (file, layout) = (file.display().to_string(), super::LAYOUT.name);
    let (reference, notes) = (Ok(reference), Vec::new());
    Ok(LogContents { file, layout, duration, parts, wheels, reference, notes, robot: None, urdf: None })
}

fn is_of_header(problem: &LineProblem) -> bool {
    matches!(problem, LineProblem::MissingColumn { .. } | LineProblem::UnknownColumn { .. } | LineProblem::Unit { .. })
}

/// What a column is used for.
fn role(recording: &Recording, name: &str) -> Option<&'static str> {
    let [time, wheels @ ..] = &recording.columns[..] else { return None };
    if name == time {
        return Some("time");
    }
    if wheels.iter().any(|wheel| wheel == name) {
        return Some("wheels");
    }
    let is_pose = ["x_ref_", "y_ref_", "theta_ref_", "gyro_"].iter().any(|base| name.starts_with(base));
    (is_pose && has_poses(recording)).then_some("reference")
}

fn has_poses(recording: &Recording) -> bool {
    !recording.reference.is_empty() || !recording.apart.poses.is_empty()
}

fn reference(recording: &Recording) -> Option<ReferenceFound> {
    let (beside, apart) = (&recording.reference, &recording.apart);
    let times = beside.iter().filter_map(|pose| recording.time.get(pose.sample));
    let mut times: Vec<f64> = times.chain(&apart.time).copied().collect();
    times.sort_by(f64::total_cmp);
    let headings = beside.iter().map(|pose| pose.heading).chain(apart.poses.iter().map(|pose| pose.2));
    has_poses(recording).then(|| ReferenceFound {
        source: if apart.poses.is_empty() { "columns of its rows" } else { "rows of their own" }.to_owned(),
        poses: times.len(),
        headings: headings.flatten().count(),
        rate: usual_rate(&times),
    })
}

fn wheels(recording: Recording, drive: DriveKind, words: &Words) -> Result<WheelsFound, String> {
    let wheels = recording.columns.get(1..).unwrap_or_default();
    let (source, readings) = (wheels.join(", "), recording.time.len());
    let rate = usual_rate(&recording.time).ok_or("there are fewer than two rows with a time of their own")?;
    let counter_bits = rolls_over(recording, words)?;
    let (unit, ticks_per_revolution) = (WheelUnit::Counts, None);
    Ok(WheelsFound { source, unit, drive, readings, rate, ticks_per_revolution, counter_bits })
}
