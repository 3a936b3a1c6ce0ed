//! `runs/*.csv`: one tick log per run, with the absolute poses that were measured on the way.

use crate::columns::{Column, Columns, Quantity};
use crate::csv_text::CsvText;
use crate::error::{At, DatasetError, LineProblem, quoted};
use crate::recording::Recording;
use crate::sheet::{Row, Sheet};
use crate::source::Source;
use crate::track_rows::TrackRows;
use Quantity::{Angle, Bare, Length, Time, TurnRate};
use umbmark_core::dataset::{ReferencePose, TickLog};
use umbmark_core::drive::{DriveKind, Robot};
use umbmark_core::geometry::Pose2;
use umbmark_core::run::PoseRow;

/// The mark that the column `closed` means.
const START: &str = "START";

/// The columns of the absolute poses.
const REFERENCE: [&str; 3] = ["x_ref_m", "y_ref_m", "theta_ref_rad"];
/// The header of messages.
pub(crate) const HEADER: &str = "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad";

pub(crate) enum ReferenceColumns {
    /// Positions, with headings or without.
    Poses { x: Column, y: Column, heading: Option<Column> },
    /// Headings alone.
    Headings(Column),
}

/// The columns of a log.
struct LogColumns {
    time: Column,
    counts: Vec<Column>,
    reference: Option<ReferenceColumns>,
    steps: Option<[Column; 3]>,
    gyro: Option<Column>,
    mark: Option<Column>,
    closed: Option<Column>,
}

/// The rows of a log.
pub(crate) fn parse_tick_log(
    source: Source,
    kind: DriveKind,
    warnings: &mut Vec<String>,
) -> Result<Recording, DatasetError> {
    if !kind.has_tick_logs() {
        let (file, value) = (source.file, format!("\"{}\"", kind.name()));
        let remedy = "logs of its two trucks are not read; give its returns in returns.csv".into();
        return Err(At::new(file, 1).refuse(LineProblem::NotYet { key: "drive".into(), value, remedy }));
    }
    let sheet = Sheet::open(source, HEADER)?;
    let columns = LogColumns::find(&sheet, kind, warnings)?;
    let mut recording = columns.recording(sheet.file());
    sheet.for_each(|row| columns.read(row, &mut recording))?;
    Ok(recording)
}

impl LogColumns {
    fn find(sheet: &Sheet, kind: DriveKind, warnings: &mut Vec<String>) -> Result<LogColumns, DatasetError> {
        let mut columns = Columns::of(sheet);
        let counters: Vec<String> = kind.columns().iter().map(|counter| format!("ticks_{counter}")).collect();
        let of = if kind == DriveKind::default() {
            String::new()
        } else {
            format!(" of a robot with drive = \"{}\"", kind.name())
        };
        let (last, others) = counters.split_last().map_or(("", &[][..]), |(last, others)| (last.as_str(), others));
        let needs = format!(
            "a tick log{of} needs t_s, {} and {last}, or lines in [columns] of robot.toml that say what these are called",
            others.join(", ")
        );
        let time = columns.need("t", Time, &needs)?;
        let counts =
            counters.iter().map(|counter| columns.need(counter, Bare, &needs)).collect::<Result<Vec<_>, _>>()?;
        let reference = ReferenceColumns::find(&mut columns)?;
        // Beside a range, it names a mark that was sighted and not one that the robot stands on.
        let mark = if columns.given(&["range"]) { None } else { columns.find("mark", Bare)? };
        let closed = columns.find("closed", Bare)?;
        let steps = find_steps(&mut columns)?;
        let gyro = columns.find("gyro", TurnRate)?;
        if let Some(gyro) = gyro.as_ref().filter(|_| reference.is_some() || steps.is_some()) {
            let name = quoted(&gyro.name);
            warnings.push(format!("{}: column {name} is not used beside another reference", sheet.file()));
        }
        let gyro = gyro.filter(|_| reference.is_none() && steps.is_none());
        if let (Some(steps), Some(poses)) = (&steps, &reference) {
            let (first, second) = (poses.first().name.clone(), steps[0].name.clone());
            return Err(At::new(sheet.file(), sheet.header_line).refuse(LineProblem::BothReferences { first, second }));
        }
        columns.finish(warnings)?;
        Ok(LogColumns { time, counts, reference, steps, gyro, mark, closed })
    }

    /// The recording of a file, before its first row.
    fn recording(&self, file: &str) -> Recording {
        let columns: Vec<String> =
            [&self.time].into_iter().chain(&self.counts).map(|column| column.name.clone()).collect();
        let counts = vec![Vec::new(); self.counts.len()];
        let rates = self.gyro.is_some();
        let headings_only = rates || matches!(self.reference, Some(ReferenceColumns::Headings(_)));
        let relative = rates || self.steps.is_some();
        let apart = TrackRows { file: file.to_owned(), column: self.time.name.clone(), rates, ..TrackRows::default() };
        Recording {
            file: file.to_owned(),
            columns,
            counts,
            apart,
            relative,
            headings_only,
            rates,
            ..Recording::default()
        }
    }

    fn read(&self, row: &Row, recording: &mut Recording) -> Result<(), DatasetError> {
        let told = self.told(row, recording)?;
        if self.counts.iter().all(|column| row.text(column).is_empty()) {
            match told {
                Some(pose) => recording.apart.push(row.line, row.number(&self.time)?, pose),
                None => recording.empty += 1,
            }
            return Ok(());
        }
        recording.lines.push(row.line);
        recording.time.push(row.number(&self.time)?);
        for (counts, column) in recording.counts.iter_mut().zip(&self.counts) {
            counts.push(row.number(column)?);
        }
        let sample = recording.time.len() - 1;
        if let Some((x, y, heading)) = told {
            let is_first = recording.reference.is_empty() && recording.apart.time.is_empty();
            if self.steps.is_some() && is_first && sample > 0 {
                // The first step begins at the first row.
                recording.reference.push(ReferencePose { sample: 0, x: 0.0, y: 0.0, heading: Some(0.0) });
            }
            recording.reference.push(ReferencePose { sample, x, y, heading });
        }
        let closed = self.closed.as_ref().map(|column| is_closed(column, row)).transpose()?.unwrap_or(false);
        let named = self.mark.as_ref().map(|column| row.text(column)).filter(|mark| !mark.is_empty());
        if let Some(mark) = named.or(closed.then_some(START)) {
            recording.marked.push((sample, mark.to_owned()));
        }
        Ok(())
    }

    /// What the reference tells in a row; the rate of a gyro stands for its heading.
    fn told(&self, row: &Row, recording: &Recording) -> Result<Option<PoseRow>, DatasetError> {
        if let Some(columns) = &self.reference {
            return columns.read(row);
        }
        if let Some(gyro) = &self.gyro {
            return Ok(row.number_or(gyro)?.map(|rate| (0.0, 0.0, Some(rate))));
        }
        let Some(columns) = &self.steps else { return Ok(None) };
        let Some(step) = step(columns, row)? else { return Ok(None) };
        let at = last_pose(recording).compose(&step);
        Ok(Some((at.x, at.y, Some(at.heading))))
    }
}

/// The pose in the last row that has one.
fn last_pose(recording: &Recording) -> Pose2 {
    let beside =
        recording.reference.last().map(|pose| (recording.lines.of(pose.sample), (pose.x, pose.y, pose.heading)));
    let apart = &recording.apart;
    let apart = apart.poses.last().map(|pose| (apart.lines.of(apart.poses.len() - 1), *pose));
    let last = beside.into_iter().chain(apart).max_by_key(|(line, _)| *line);
    last.map_or(Pose2::IDENTITY, |(_, (x, y, heading))| Pose2::new(x, y, heading.unwrap_or(0.0)))
}

/// Whether the robot stands on its START mark.
fn is_closed(column: &Column, row: &Row) -> Result<bool, DatasetError> {
    match row.number_or(column)? {
        None => Ok(false),
        Some(closed) if closed == 0.0 || closed == 1.0 => Ok(closed == 1.0),
        Some(_) => Err(row.wrong(column, "1 on the START mark, and 0 or nothing elsewhere", "")),
    }
}

/// The columns of steps: how the sensor moved and turned since the last row that has them, as seen from where it was there.
fn find_steps(columns: &mut Columns) -> Result<Option<[Column; 3]>, DatasetError> {
    let names = ["dx_rel", "dy_rel", "dtheta_rel"];
    if !columns.given(&names) {
        return Ok(None);
    }
    let needs = "a step of the reference needs dx_rel_m, dy_rel_m and dtheta_rel_rad";
    let [x, y] = [names[0], names[1]].map(|name| columns.need(name, Length, needs));
    Ok(Some([x?, y?, columns.need(names[2], Angle, needs)?]))
}

/// The step of a row, if it has one.
fn step(columns: &[Column; 3], row: &Row) -> Result<Option<Pose2>, DatasetError> {
    let mut cells = [None; 3];
    for (cell, column) in cells.iter_mut().zip(columns) {
        *cell = row.number_or(column)?;
    }
    if let [Some(dx), Some(dy), Some(turned)] = cells {
        return Ok(Some(Pose2::new(dx, dy, turned)));
    }
    match columns.iter().zip(&cells).find(|(_, cell)| cell.is_none()) {
        Some((column, _)) if cells.iter().any(Option::is_some) => {
            Err(row.wrong(column, "a finite number", "fill in the step, or leave all its cells empty"))
        }
        _ => Ok(None),
    }
}

impl ReferenceColumns {
    pub fn find(columns: &mut Columns) -> Result<Option<ReferenceColumns>, DatasetError> {
        let x = columns.find("x_ref", Length)?;
        let y = columns.find("y_ref", Length)?;
        let heading = columns.find("theta_ref", Angle)?;
        let needs = "a reference needs both x_ref_m and y_ref_m";
        match (x, y) {
            (Some(x), Some(y)) => Ok(Some(ReferenceColumns::Poses { x, y, heading })),
            (None, None) => Ok(heading.map(ReferenceColumns::Headings)),
            (None, _) => Err(columns.missing("x_ref", Length, needs)),
            (_, None) => Err(columns.missing("y_ref", Length, needs)),
        }
    }

    /// The first of them.
    fn first(&self) -> &Column {
        match self {
            ReferenceColumns::Poses { x, .. } => x,
            ReferenceColumns::Headings(heading) => heading,
        }
    }

    /// Whether they tell headings only.
    pub fn is_headings_only(&self) -> bool {
        matches!(self, ReferenceColumns::Headings(_))
    }

    /// The pose of a row, if one was measured there.
    #[inline]
    pub fn read(&self, row: &Row) -> Result<Option<PoseRow>, DatasetError> {
        let (x, y, heading) = match self {
            ReferenceColumns::Poses { x, y, heading } => (x, y, heading),
            ReferenceColumns::Headings(column) => {
                return Ok(row.number_or(column)?.map(|heading| (0.0, 0.0, Some(heading))));
            }
        };
        let heading = heading.as_ref().map(|column| row.number_or(column)).transpose()?.flatten();
        match (row.number_or(x)?, row.number_or(y)?) {
            (Some(x), Some(y)) => Ok(Some((x, y, heading))),
            (None, None) if heading.is_none() => Ok(None),
            (None, _) => Err(row.wrong(x, "a finite number", "fill in the pose, or leave all its cells empty")),
            (_, None) => Err(row.wrong(y, "a finite number", "fill in the pose, or leave all its cells empty")),
        }
    }
}

/// `runs/*.csv` of a log whose references belong to different samples, in their order; counts as the encoder's counter
/// shows them, rolled over where it does.
pub(crate) fn tick_log_text(log: &TickLog, robot: &Robot) -> Vec<u8> {
    let (encoder, kind) = (&robot.encoder, robot.drive.kind());
    let ticks = [&log.left[..], &log.right[..]];
    let counted = match (kind.moves_sideways(), log.rollers.is_empty()) {
        (true, true) => robot.counters_of_rollers(ticks),
        (true, false) => log.rollers.clone(),
        (false, _) => encoder.wiring().columns(robot.counters(ticks)).to_vec(),
    };
    // Only a counter of some bits cuts the whole counts off, and rounds what is between two of them.
    let shown = |ticks: f64| match encoder.counter_bits() {
        Some(_) => encoder.reading(ticks.floor() as i64) as f64 + (ticks - ticks.floor()),
        None => ticks,
    };
    let referenced = !log.reference.is_empty();
    let counters: Vec<String> = kind.columns().iter().map(|counter| format!("ticks_{counter}")).collect();
    let mut text = CsvText::behind("");
    let columns = ["t_s"].into_iter().chain(counters.iter().map(String::as_str));
    let told = if log.headings_only { &REFERENCE[2..] } else { &REFERENCE[..] };
    text.row(columns.chain(told.iter().copied().filter(|_| referenced)));
    let mut references = log.reference.iter().peekable();
    for (sample, time) in log.time.iter().enumerate() {
        text.decimal(*time);
        counted.iter().for_each(|counts| text.cell(shown(counts[sample])));
        if referenced {
            let pose = references.next_if(|pose| pose.sample == sample);
            if !log.headings_only {
                text.decimal(pose.map(|pose| pose.x));
                text.decimal(pose.map(|pose| pose.y));
            }
            text.decimal(pose.and_then(|pose| pose.heading));
        }
        text.end();
    }
    text.finish()
}
