//! Trajectories as the TUM benchmarks write them: `t tx ty tz qx qy qz qw`, cells separated by spaces, comments behind #.
//!
//! Source: Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems", file formats. z is up; of the
//! orientation only the heading is used.

use super::Layout;
use crate::error::{At, DatasetError, LineProblem};
use crate::label::label;
use crate::save::{Existing, put};
use crate::sheet::Rows;
use crate::source::Source;
use crate::track_rows::TrackRows;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use umbmark_core::apply::Corrected;
use umbmark_core::dataset::{Dataset, ReferencePose};
use umbmark_core::run::dead_reckoning::computed_poses;

pub(super) const LAYOUT: Layout = Layout::new("tum", "TUM trajectories: *_reference.tum and *_odometry.tum")
    .reads_tracks((&["tum", "txt", "tsv"], is_tum, parse_tum))
    .writes(write);

const NAMES: [&str; 8] =
    ["t (1st)", "tx (2nd)", "ty (3rd)", "tz (4th)", "qx (5th)", "qy (6th)", "qz (7th)", "qw (8th)"];
/// A quaternion shorter or longer than this is none.
const UNIT: std::ops::RangeInclusive<f64> = 0.9..=1.1;

fn is_tum(first_row: &str) -> bool {
    !first_row.contains(',') && first_row.split_whitespace().next().is_some_and(|cell| cell.parse::<f64>().is_ok())
}

/// The poses of a file.
pub(crate) fn parse_tum(source: Source, _: &mut Vec<String>) -> Result<TrackRows, DatasetError> {
    let mut lines = Rows::separated_by(b' ', source);
    let file = lines.file().to_owned();
    let mut rows = TrackRows { file, column: NAMES[0].to_owned(), ..TrackRows::default() };
    while let Some(row) = lines.next()? {
        let (file, line) = (row.file, row.line);
        let cells: Vec<&str> = row.cells().flat_map(str::split_whitespace).collect();
        if cells.len() != NAMES.len() {
            let remedy = "a TUM trajectory has t tx ty tz qx qy qz qw, separated by spaces";
            return Err(At::new(file, line).refuse(LineProblem::Ragged { got: cells.len(), expected: 8, remedy }));
        }
        let mut numbers = [0.0; 8];
        for (i, cell) in cells.iter().enumerate() {
            numbers[i] = row.own_number(NAMES[i], cell)?;
        }
        let [time, x, y, _, qx, qy, qz, qw] = numbers;
        let length = (qx * qx + qy * qy + qz * qz + qw * qw).sqrt();
        if !UNIT.contains(&length) {
            return Err(At::new(file, line).refuse(LineProblem::Cell {
                column: "qx qy qz qw".into(),
                value: format!("{length:.3}"),
                allowed: "a quaternion of length 1".into(),
                remedy: "".into(),
            }));
        }
        rows.lines.push(line);
        rows.time.push(time);
        rows.poses.push((x, y, Some(yaw(qx, qy, qz, qw))));
    }
    if rows.time.is_empty() {
        let remedy = "a TUM trajectory has one pose a line: t tx ty tz qx qy qz qw".into();
        return Err(DatasetError::NoRows { file: rows.file, found: "there are no poses", remedy });
    }
    Ok(rows)
}

/// Heading of a rotation \[rad\].
fn yaw(qx: f64, qy: f64, qz: f64, qw: f64) -> f64 {
    libm::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
}

/// A trajectory of times, positions and headings.
fn tum_text(what: &str, poses: impl Iterator<Item = (f64, f64, f64, f64)>) -> String {
    timed_text(what, poses.map(|(time, x, y, heading)| (format!("{time:?}"), x, y, heading)))
}

fn timed_text(what: &str, poses: impl Iterator<Item = (String, f64, f64, f64)>) -> String {
    let mut text = format!("# {what}\n# t tx ty tz qx qy qz qw\n");
    for (time, x, y, heading) in poses {
        let (qz, qw) = (libm::sin(0.5 * heading), libm::cos(0.5 * heading));
        let _ = writeln!(text, "{time} {x:?} {y:?} 0 0 0 {qz:?} {qw:?}");
    }
    text
}

/// Corrected odometry as a trajectory.
pub(crate) fn corrected(corrected: &Corrected) -> String {
    let poses = corrected.poses.iter().enumerate();
    timed_text(
        "poses corrected by a model",
        poses.map(|(sample, p)| (crate::corrected::time_text(corrected, sample), p.x, p.y, p.heading)),
    )
}

/// Measured and computed poses of each run, for tools that compare trajectories.
fn write(data: &Dataset, folder: &Path, existing: Existing) -> Result<Vec<String>, DatasetError> {
    let robot = data.nominal_robot()?;
    let mut files = BTreeMap::new();
    let (mut poses, mut without_heading) = (0, 0);
    for (run, log) in super::logs(data) {
        let name = label(run.test, run.direction, run.number);
        let computed = log.time.iter().zip(computed_poses(log, robot));
        let text = tum_text("poses computed from the wheel counts", computed.map(|(t, p)| (*t, p.x, p.y, p.heading)));
        files.insert(PathBuf::from(format!("{name}_odometry.tum")), text);
        let headed = |pose: &ReferencePose| Some((log.time[pose.sample], pose.x, pose.y, pose.heading?));
        let measured: Vec<_> = log.reference.iter().filter_map(headed).collect();
        poses += measured.len();
        without_heading += log.reference.len() - measured.len();
        if !measured.is_empty() {
            let text = tum_text("measured poses", measured.into_iter());
            files.insert(PathBuf::from(format!("{name}_reference.tum")), text);
        }
    }
    if files.is_empty() {
        let reason = "no run has a log, and trajectories are made of logs".into();
        return Err(DatasetError::Unwritable { file: folder.display().to_string(), reason });
    }
    put(folder, &files, existing, |_| Ok(()))?;
    let mut lost = vec!["counts, robot and path: trajectories hold poses only".to_owned()];
    if without_heading > 0 {
        lost.push(format!("{without_heading} measured poses without a heading, of {}", poses + without_heading));
    }
    if data.runs.iter().any(|run| run.returned.is_some()) {
        lost.push("return errors: they are the difference of the last poses".into());
    }
    if poses > 0 {
        lost.push("full turns of headings".into());
    }
    Ok(lost)
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::geometry::wrap;

    #[test]
    fn what_is_written_is_read_back() {
        let poses: Vec<(f64, f64, f64, f64)> =
            (-8..=8).map(f64::from).map(|i| (i + 20.0, 0.1 * i, -0.3 * i, 0.4 * i)).collect();
        let rows =
            parse_tum(Source::of("f", tum_text("poses", poses.iter().copied()).as_bytes()).unwrap(), &mut Vec::new())
                .unwrap();
        assert_eq!(rows.time.len(), poses.len());
        for ((time, pose), (t, x, y, heading)) in rows.time.iter().zip(&rows.poses).zip(poses) {
            assert_eq!((*time, pose.0, pose.1), (t, x, y));
            assert!(wrap(pose.2.unwrap() - heading).abs() < 1e-15, "{heading}");
        }
    }

    #[test]
    fn a_tilted_body_has_the_heading_of_its_forward_axis() {
        // Turned by 1.1 rad to the left, then pitched by 30 degrees: forward still points 1.1 rad to the left of x.
        let (s, c) = (libm::sin(0.55), libm::cos(0.55));
        let (sp, cp) = (15f64.to_radians().sin(), 15f64.to_radians().cos());
        let turned = yaw(-s * sp, c * sp, s * cp, c * cp);
        assert!((turned - 1.1).abs() < 1e-15, "{turned}");
    }
}
