//! Planar trajectories: `t x y theta`, cells separated by spaces.

use super::Layout;
use crate::error::{At, DatasetError, LineProblem};
use crate::sheet::Rows;
use crate::source::Source;
use crate::track_rows::TrackRows;

pub(super) const LAYOUT: Layout = Layout::new("planar", "planar trajectories: t x y theta").reads_tracks((
    &["xyt"],
    |first_row| first_row.split_whitespace().count() == 4,
    parse,
));

const NAMES: [&str; 4] = ["t (1st)", "x (2nd)", "y (3rd)", "theta (4th)"];

fn parse(source: Source, _: &mut Vec<String>) -> Result<TrackRows, DatasetError> {
    let mut lines = Rows::separated_by(b' ', source);
    let mut rows = TrackRows { file: lines.file().to_owned(), column: NAMES[0].to_owned(), ..TrackRows::default() };
    while let Some(row) = lines.next()? {
        let cells: Vec<&str> = row.cells().flat_map(str::split_whitespace).collect();
        if cells.len() != NAMES.len() {
            let remedy = "a planar trajectory has t x y theta, separated by spaces";
            let problem = LineProblem::Ragged { got: cells.len(), expected: NAMES.len(), remedy };
            return Err(At::new(row.file, row.line).refuse(problem));
        }
        let mut numbers = [0.0; 4];
        for (i, cell) in cells.iter().enumerate() {
            numbers[i] = row.own_number(NAMES[i], cell)?;
        }
        let [time, x, y, heading] = numbers;
        rows.lines.push(row.line);
        rows.time.push(time);
        rows.poses.push((x, y, Some(heading)));
    }
    Ok(rows)
}
