//! A trial: tracks of `time; x; y; heading`.

use super::Layout;
use crate::error::DatasetError;
use crate::sheet::Rows;
use crate::source::Source;
use crate::track_rows::TrackRows;

pub(super) const LAYOUT: Layout = Layout::new("trail", "tracks of time; x; y; heading").reads_tracks((
    &["trail"],
    |first_row| first_row.contains(';'),
    read,
));

fn read(source: Source, _: &mut Vec<String>) -> Result<TrackRows, DatasetError> {
    let mut rows = TrackRows { file: source.file.clone(), column: "time".into(), ..TrackRows::default() };
    let mut lines = Rows::separated_by(b';', source);
    while let Some(row) = lines.next()? {
        let number = |place: usize, name: &str| row.own_number(name, row.cell(place));
        rows.lines.push(row.line);
        rows.time.push(number(0, "time")?);
        rows.poses.push((number(1, "x")?, number(2, "y")?, Some(number(3, "heading")?)));
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_is_recognised_and_read() {
        let source = Source::of("a.trail", &b"# a body\n0; 1; 2; 0.1\n0.5; 1.5; 2; 0.2\n"[..]).unwrap();
        let track = super::super::parse_track(source, &mut Vec::new()).unwrap();
        assert_eq!((track.time, track.x), (vec![0.0, 0.5], vec![1.0, 1.5]));
    }
}
