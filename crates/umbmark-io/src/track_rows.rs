//! The rows of a track as a reader found them, and how they become a [`ReferenceTrack`].

use super::error::DatasetError;
use super::lines::Lines;
use super::recording::time_error;
use std::f64::consts::TAU;
use umbmark_core::prose::counted;
use umbmark_core::run::{PoseRow, ReferenceTrack, headings_of};

/// The rows of a track.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TrackRows {
    pub file: String,
    /// Name of the time column.
    pub column: String,
    pub lines: Lines,
    pub time: Vec<f64>,
    pub poses: Vec<PoseRow>,
    /// Rows where the body was not seen.
    pub lost: usize,
    /// Whether the headings are the rates of a gyro, and nothing else was measured.
    pub rates: bool,
}

/// More late rows than this share are no accident.
const MOST_LATE: f64 = 0.05;

impl TrackRows {
    pub fn push(&mut self, line: usize, time: f64, pose: PoseRow) {
        self.lines.push(line);
        self.time.push(time);
        self.poses.push(pose);
    }

    /// Puts late rows where they belong, leaves repeated time stamps out, and says so.
    pub fn put_in_order(&mut self, warnings: &mut Vec<String>) -> Result<(), DatasetError> {
        let mut order: Vec<usize> = (0..self.time.len()).collect();
        order.sort_by(|a, b| self.time[*a].total_cmp(&self.time[*b]));
        let mut latest = f64::NEG_INFINITY;
        let late: Vec<usize> = (0..self.time.len())
            .filter(|i| {
                let is_late = self.time[*i] < latest;
                latest = latest.max(self.time[*i]);
                is_late
            })
            .collect();
        if late.len() > 1 && late.len() as f64 > MOST_LATE * self.time.len() as f64 {
            let remedy = "too many rows are out of order for late arrivals; cut the track where its clock was set back";
            return Err(time_error(&self.file, &self.column, &self.lines, &self.time, late[0], remedy));
        }
        let rows = order.len();
        order.dedup_by(|b, a| self.time[*b] == self.time[*a]);
        let mut note = |n: usize, noun: &str, what: [&str; 2]| {
            if n > 0 {
                let what = what[usize::from(n > 1)];
                warnings.push(format!("{}: {} {what}", self.file, counted(n, noun)));
            }
        };
        let out_of_order = "out of order was put where its time stamp says";
        note(late.len(), "row", [out_of_order, "out of order were put where their time stamps say"]);
        let again = ["that repeats a time stamp was left out", "that repeat a time stamp were left out"];
        note(rows - order.len(), "row", again);
        let unseen =
            ["without a pose (the body was not seen) is a gap", "without a pose (the body was not seen) are gaps"];
        note(self.lost, "frame", unseen);
        self.lines = order.iter().map(|i| self.lines.of(*i)).collect();
        self.time = order.iter().map(|i| self.time[*i]).collect();
        self.poses = order.iter().map(|i| self.poses[*i]).collect();
        Ok(())
    }

    /// Counts full turns of the headings; adds up the rates of a gyro.
    pub fn count_turns(&mut self) {
        if self.rates {
            let rates: Vec<f64> = self.poses.iter().map(|pose| pose.2.unwrap_or(0.0)).collect();
            let headings = headings_of(&self.time, &rates);
            self.poses.iter_mut().zip(headings).for_each(|(pose, heading)| pose.2 = Some(heading));
            return;
        }
        count_turns(self.poses.iter_mut().filter_map(|pose| pose.2.as_mut()));
    }

    /// The rows in order, as a track.
    pub fn into_track(mut self, warnings: &mut Vec<String>) -> Result<ReferenceTrack, DatasetError> {
        self.put_in_order(warnings)?;
        self.count_turns();
        let heading: Option<Vec<f64>> = self.poses.iter().map(|pose| pose.2).collect();
        Ok(ReferenceTrack {
            time: self.time,
            x: self.poses.iter().map(|pose| pose.0).collect(),
            y: self.poses.iter().map(|pose| pose.1).collect(),
            heading,
        })
    }
}

/// Adds full turns, so that headings that follow each other differ by less than half a turn.
pub(super) fn count_turns<'h>(headings: impl Iterator<Item = &'h mut f64>) {
    let mut before = None;
    for heading in headings {
        *heading += TAU * ((before.unwrap_or(*heading) - *heading) / TAU).round();
        before = Some(*heading);
    }
}
