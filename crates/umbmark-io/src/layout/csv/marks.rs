//! `marks.csv`: the measured places of marks that robots are driven onto.

use crate::closures::Marks;
use crate::columns::{Columns, Quantity};
use crate::error::{At, DatasetError, LineProblem};
use crate::sheet::Sheet;
use crate::source::Source;

const HEADER: &str = "mark,x_m,y_m,theta_rad";

/// The marks of a file, each once.
pub(super) fn parse(source: Source, warnings: &mut Vec<String>) -> Result<Marks, DatasetError> {
    let sheet = Sheet::open(source, HEADER)?;
    let file = sheet.file().to_owned();
    let mut columns = Columns::of(&sheet);
    let needs = "marks.csv needs mark, x_m and y_m";
    let name = columns.need("mark", Quantity::Bare, "it names the marks as the column mark of the logs does")?;
    let (x, y) = (columns.need("x", Quantity::Length, needs)?, columns.need("y", Quantity::Length, needs)?);
    let heading = columns.find("theta", Quantity::Angle)?;
    columns.finish(warnings)?;
    let mut marks = Marks::new();
    sheet.for_each(|row| {
        let heading = heading.as_ref().map(|column| row.number_or(column)).transpose()?.flatten();
        let mark = row.text(&name).to_owned();
        if mark.is_empty() {
            return Err(row.wrong(&name, "the name of a mark", ""));
        }
        if marks.insert(mark, (row.number(&x)?, row.number(&y)?, heading)).is_some() {
            let (value, allowed) = (crate::error::quoted(row.text(&name)), "each mark once".into());
            let (column, remedy) = (name.name.clone(), "keep one of its rows".into());
            return Err(At::new(file.clone(), row.line).refuse(LineProblem::Cell { column, value, allowed, remedy }));
        }
        Ok(())
    })?;
    Ok(marks)
}
