//! `reference/*.csv`: poses with a clock of their own.

use super::tick_log::ReferenceColumns;
use crate::columns::{Columns, Quantity};
use crate::error::DatasetError;
use crate::sheet::Sheet;
use crate::source::Source;
use crate::track_rows::TrackRows;

const HEADER: &str = "t_s,x_ref_m,y_ref_m,theta_ref_rad";

pub(super) fn is_track(first_row: &str) -> bool {
    first_row.contains("x_ref")
}

/// Rows without a pose are gaps.
pub(super) fn parse_columns(source: Source, warnings: &mut Vec<String>) -> Result<TrackRows, DatasetError> {
    let sheet = Sheet::open(source, HEADER)?;
    let mut columns = Columns::of(&sheet);
    let needs = "a track needs t_s, x_ref_m and y_ref_m";
    let time = columns.need("t", Quantity::Time, needs)?;
    let Some(reference) = ReferenceColumns::find(&mut columns)? else {
        return Err(columns.missing("x_ref", Quantity::Length, needs));
    };
    if reference.is_headings_only() {
        return Err(columns.missing("x_ref", Quantity::Length, needs));
    }
    columns.finish(warnings)?;
    let mut rows = TrackRows { file: sheet.file().to_owned(), column: time.name.clone(), ..TrackRows::default() };
    sheet.for_each(|row| {
        match reference.read(row)? {
            Some(pose) => rows.push(row.line, row.number(&time)?, pose),
            None => rows.lost += 1,
        }
        Ok(())
    })?;
    if rows.time.is_empty() {
        let remedy = "fill in the poses".into();
        return Err(DatasetError::NoRows { file: rows.file, found: "none of the rows has a pose", remedy });
    }
    Ok(rows)
}
