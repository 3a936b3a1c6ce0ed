//! Files with poses that have a clock of their own: recognised by what is in them.

use super::columns::{Columns, Quantity};
use super::error::DatasetError;
use super::motive::{is_motive, parse_motive};
use super::sheet::Sheet;
use super::source::Source;
use super::tick_log::ReferenceColumns;
use super::track_rows::TrackRows;
use super::tum::parse_tum;
use umbmark_core::run::ReferenceTrack;

const HEADER: &str = "t_s,x_ref_m,y_ref_m,theta_ref_rad";

/// The track of a file: an export of Motive, a TUM trajectory, or `t_s,x_ref_m,y_ref_m,theta_ref_rad`.
pub(super) fn parse_reference(source: Source, warnings: &mut Vec<String>) -> Result<ReferenceTrack, DatasetError> {
    let first = source.first_row();
    let rows = if is_motive(&first) {
        parse_motive(source, warnings)?
    } else if first.contains(',') || first.is_empty() || first.contains("x_ref") {
        parse_columns(source, warnings)?
    } else {
        parse_tum(source)?
    };
    rows.into_track(warnings)
}

/// Rows without a pose are gaps.
fn parse_columns(source: Source, warnings: &mut Vec<String>) -> Result<TrackRows, DatasetError> {
    let sheet = Sheet::open(source, HEADER)?;
    let mut columns = Columns::of(&sheet);
    let needs = "a track needs t_s, x_ref_m and y_ref_m";
    let time = columns.need("t", Quantity::Time, needs)?;
    let Some(reference) = ReferenceColumns::find(&mut columns)? else {
        return Err(columns.missing("x_ref", Quantity::Length, needs));
    };
    columns.finish(warnings)?;
    let mut rows = TrackRows { file: sheet.file().to_owned(), column: time.name.clone(), ..TrackRows::default() };
    sheet.for_each(|row| {
        match reference.read(row, 0)? {
            Some(pose) => {
                rows.lines.push(row.line);
                rows.time.push(row.number(&time)?);
                rows.poses.push((pose.x, pose.y, pose.heading));
            }
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
