//! `returns.csv`: what a tape measure and the robot's own display say at the end of each run.

use crate::columns::{Column, Columns, Quantity};
use crate::csv_text::CsvText;
use crate::error::{At, DatasetError, LineProblem};
use crate::label::{DIRECTIONS, TESTS};
use crate::sheet::{Row, Sheet};
use crate::source::Source;
use Quantity::{Angle, Bare, Length};
use umbmark_core::dataset::{RETURNS_COLUMNS, ReturnError, Run};
use umbmark_core::effect::TestKind;
use umbmark_core::geometry::{Pose2, wrap};
use umbmark_core::path::Direction;
use umbmark_core::run::PoseRow;

/// A row of the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReturnRow {
    pub line: usize,
    /// `None` where the file has no such column.
    pub test: Option<TestKind>,
    pub direction: Option<Direction>,
    pub number: u32,
    pub measured: Measured,
}

/// What a row tells of the return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Measured {
    /// Absolute minus computed end pose.
    Error(ReturnError),
    /// The absolute end pose, in the frame of START; the computed one follows from the run's log.
    Absolute(PoseRow),
}

struct PoseColumns {
    x: Column,
    y: Column,
    heading: Option<Column>,
}

/// Columns of absolute and computed end poses, and of START where it was measured.
struct EndPoses {
    absolute: PoseColumns,
    /// `None` where they follow from logs.
    computed: Option<PoseColumns>,
    start: Option<PoseColumns>,
}

enum Convention {
    Poses(Box<EndPoses>),
    Errors(PoseColumns),
}

/// The rows of a file, and what was noticed in it.
pub(crate) fn parse_returns(source: Source, warnings: &mut Vec<String>) -> Result<Vec<ReturnRow>, DatasetError> {
    let sheet = Sheet::open(source, RETURNS_COLUMNS)?;
    let mut columns = Columns::of(&sheet);
    let direction = columns.need("direction", Bare, "it says cw or ccw")?;
    let number = columns.need("run", Bare, "it numbers the runs of each direction from 1")?;
    let test = columns.find("test", Bare)?;
    let convention = Convention::find(&sheet, &mut columns)?;
    columns.finish(warnings)?;
    let (mut rows, mut on_start, file) = (Vec::new(), 0, sheet.file().to_owned());
    sheet.for_each(|row| {
        on_start += usize::from(convention.leaves_computed_empty(row));
        rows.push(ReturnRow {
            line: row.line,
            test: test.as_ref().map(|column| read_test(row, column)).transpose()?,
            direction: row.word(&direction, &DIRECTIONS)?,
            number: read_run_number(row, &number)?,
            measured: convention.read(row)?,
        });
        Ok(())
    })?;
    // Where all are empty, whoever wrote it means that the robot believes to stand on START.
    if on_start > 0 && on_start < rows.len() {
        warnings.push(format!(
            "{file}: {on_start} of {} rows leave a cell of the computed pose empty; it was taken as 0",
            rows.len()
        ));
    }
    Ok(rows)
}

fn read_test(row: &Row, column: &Column) -> Result<TestKind, DatasetError> {
    if row.text(column).is_empty() { Ok(TestKind::Systematic) } else { row.word(column, &TESTS) }
}

fn read_run_number(row: &Row, column: &Column) -> Result<u32, DatasetError> {
    row.text(column).parse().map_err(|_| row.wrong(column, "a whole number, counted from 1", ""))
}

impl PoseColumns {
    fn find(columns: &mut Columns, names: [&str; 3], remedy: &str) -> Result<PoseColumns, DatasetError> {
        let x = columns.need(names[0], Length, remedy)?;
        let y = columns.need(names[1], Length, remedy)?;
        Ok(PoseColumns { x, y, heading: columns.find(names[2], Angle)? })
    }

    fn read(&self, row: &Row) -> Result<(f64, f64, Option<f64>), DatasetError> {
        let heading = self.heading.as_ref().map(|column| row.number_or(column)).transpose()?.flatten();
        Ok((row.number(&self.x)?, row.number(&self.y)?, heading))
    }

    /// The same, where an empty cell means 0: a robot that drives by its odometry believes to stand on START at the end.
    fn read_or_zero(&self, row: &Row) -> Result<(f64, f64, Option<f64>), DatasetError> {
        let number = |column: &Column| Ok::<_, DatasetError>(row.number_or(column)?.unwrap_or(0.0));
        Ok((number(&self.x)?, number(&self.y)?, self.heading.as_ref().map(number).transpose()?))
    }
}

impl Convention {
    fn find(sheet: &Sheet, columns: &mut Columns) -> Result<Convention, DatasetError> {
        let errors = ["ex", "ey", "etheta"];
        let poses = ["x_abs", "y_abs", "theta_abs", "x_calc", "y_calc", "theta_calc"];
        let stands =
            |base: &&str| sheet.header.iter().find(|h| h.strip_prefix(*base).is_some_and(|r| r.starts_with('_')));
        match (poses.iter().find_map(stands), errors.iter().find_map(stands)) {
            (Some(poses), Some(errors)) => Err(At::new(sheet.file(), sheet.header_line)
                .refuse(LineProblem::BothConventions { poses: poses.clone(), errors: errors.clone() })),
            (None, Some(_)) => {
                let found = PoseColumns::find(columns, errors, "an error needs ex_m and ey_m (absolute - computed)")?;
                Ok(Convention::Errors(found))
            }
            _ => Ok(Convention::Poses(Box::new(EndPoses::find(columns)?))),
        }
    }

    /// Whether a row says nothing in a cell of the computed pose that it has to fill; a heading that was not measured needs none.
    fn leaves_computed_empty(&self, row: &Row) -> bool {
        let Convention::Poses(columns) = self else { return false };
        let EndPoses { absolute, computed, .. } = &**columns;
        let Some(computed) = computed else { return false };
        let empty = |column: &Column| row.text(column).is_empty();
        let measured = absolute.heading.as_ref().is_some_and(|column| !empty(column));
        empty(&computed.x) || empty(&computed.y) || measured && computed.heading.as_ref().is_some_and(empty)
    }

    fn read(&self, row: &Row) -> Result<Measured, DatasetError> {
        match self {
            Convention::Poses(columns) => columns.read(row),
            Convention::Errors(columns) => {
                let (x, y, heading) = columns.read(row)?;
                Ok(Measured::Error(ReturnError { x, y, heading: heading.map(wrap) }))
            }
        }
    }
}

impl EndPoses {
    fn find(columns: &mut Columns) -> Result<EndPoses, DatasetError> {
        let needs = "a return needs the end poses x_abs_m, y_abs_m, x_calc_m, y_calc_m, or the errors ex_m, ey_m";
        let absolute = PoseColumns::find(columns, ["x_abs", "y_abs", "theta_abs"], needs)?;
        let given = columns.given(&["x_calc", "y_calc", "theta_calc"]);
        let computed =
            given.then(|| PoseColumns::find(columns, ["x_calc", "y_calc", "theta_calc"], needs)).transpose()?;
        let computed_heading = computed.as_ref().and_then(|computed| computed.heading.as_ref());
        if let (Some(_), None) | (None, Some(_)) = (&absolute.heading, computed_heading)
            && computed.is_some()
        {
            let base = if absolute.heading.is_some() { "theta_calc" } else { "theta_abs" };
            return Err(columns.missing(base, Angle, "a heading error needs both theta_abs_rad and theta_calc_rad"));
        }
        let needs = "a START pose needs x_start_m, y_start_m and theta_start_rad";
        let names = ["x_start", "y_start", "theta_start"];
        let (x, y) = (columns.find(names[0], Length)?, columns.find(names[1], Length)?);
        let start = match (x, y, columns.find(names[2], Angle)?) {
            (None, None, None) => None,
            (Some(x), Some(y), Some(heading)) => Some(PoseColumns { x, y, heading: Some(heading) }),
            (None, _, _) => return Err(columns.missing(names[0], Length, needs)),
            (_, None, _) => return Err(columns.missing(names[1], Length, needs)),
            _ => return Err(columns.missing(names[2], Angle, needs)),
        };
        Ok(EndPoses { absolute, computed, start })
    }

    fn read(&self, row: &Row) -> Result<Measured, DatasetError> {
        let (mut x, mut y, mut heading) = self.absolute.read(row)?;
        if let Some(columns) = &self.start {
            let start = columns.read(row)?;
            let column = columns.heading.as_ref().unwrap_or(&columns.x);
            let turned = start.2.ok_or_else(|| row.wrong(column, "a finite number", "START needs its heading"))?;
            let seen = Pose2::new(start.0, start.1, turned).between(&Pose2::new(x, y, heading.unwrap_or(turned)));
            (x, y, heading) = (seen.x, seen.y, heading.map(|_| seen.heading));
        }
        let Some(computed) = &self.computed else { return Ok(Measured::Absolute((x, y, heading))) };
        let (x_calc, y_calc, calc) = computed.read_or_zero(row)?;
        let heading = match (heading, calc) {
            (Some(absolute), Some(calc)) => Some(wrap(absolute - calc)),
            _ => None,
        };
        Ok(Measured::Error(ReturnError { x: x - x_calc, y: y - y_calc, heading }))
    }
}

/// `returns.csv` of the runs whose return error is known; nothing if there is none.
pub(crate) fn returns_text(runs: &[Run]) -> Option<Vec<u8>> {
    let known: Vec<_> = runs.iter().filter_map(|run| Some((run, run.returned?))).collect();
    if known.is_empty() {
        return None;
    }
    let tests = known.iter().any(|(run, _)| run.test != TestKind::Systematic);
    let headings = known.iter().any(|(_, error)| error.heading.is_some());
    let mut text = CsvText::behind("# Return errors: absolute minus computed end pose, in the frame of START.\n");
    let optional = |is: bool, column: &'static str| is.then_some(column);
    let columns = ["direction", "run"].into_iter().chain(optional(tests, "test")).chain(["ex_m", "ey_m"]);
    text.row(columns.chain(optional(headings, "etheta_rad")));
    for (run, error) in known {
        text.cell(run.direction.map_or("none", Direction::name));
        text.cell(run.number);
        if tests {
            text.cell(run.test.name());
        }
        text.decimal(error.x);
        text.decimal(error.y);
        if headings {
            text.decimal(error.heading);
        }
        text.end();
    }
    Some(text.finish())
}
