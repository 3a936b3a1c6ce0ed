//! Rows whose time stamps go back or repeat.
//!
//! A row that arrived late belongs where its time stamp says: there the counts run on smoothly. Where they do not, the clock
//! was set back, and nobody can say when the rows were measured. A time stamp that repeats with the same counts is a row that
//! was sent twice; with other counts, the clock's digits are coarser than the rate, and the last row stands for both.

use super::super::error::DatasetError;
use super::{Recording, time_error};
use umbmark_core::dataset::Mended;

/// More late rows than this share are no accident.
const MOST_LATE: f64 = 0.05;
const SET_BACK: &str = "its counts do not fit there: was the clock set back? cut the log at that row";
const TOO_MANY: &str = "too many rows are out of order for late arrivals; put them in the order of time";
const CLASH: &str = "the counts of the two rows are too far apart for one moment; keep one of the rows";

/// Sorts rows by time and leaves repeated ones out, where the counts allow it; says how many.
pub(super) fn put_in_order(
    recording: &mut Recording,
    mended: &mut Mended,
    warnings: &mut Vec<String>,
) -> Result<(), DatasetError> {
    if recording.time.windows(2).all(|pair| pair[0] < pair[1]) {
        return Ok(());
    }
    let late = late_rows(&recording.time);
    let order = sorted(recording, &late)?;
    let order = without_repeats(recording, order)?;
    let mut note = |n: usize, what: &str| {
        if n > 0 {
            warnings.push(format!("{}: {n} {what}", recording.file));
        }
    };
    (mended.late, mended.repeated) = (late.len(), recording.time.len() - order.len());
    note(mended.late, "rows out of order were put where their time stamps say");
    note(mended.repeated, "rows that repeat a time stamp were left out");
    rearrange(recording, &order);
    Ok(())
}

/// Rows that stand behind a later one.
fn late_rows(time: &[f64]) -> Vec<usize> {
    let mut latest = f64::NEG_INFINITY;
    let is_late = |i: &usize| {
        let late = time[*i] < latest;
        latest = latest.max(time[*i]);
        late
    };
    (0..time.len()).filter(is_late).collect()
}

/// The order of time, where the counts run more smoothly in it than in the file.
fn sorted(recording: &Recording, late: &[usize]) -> Result<Vec<usize>, DatasetError> {
    let time = &recording.time;
    let given: Vec<usize> = (0..time.len()).collect();
    let mut order = given.clone();
    order.sort_by(|a, b| time[*a].total_cmp(&time[*b]));
    let Some(first) = late.first() else { return Ok(order) };
    let refuse = |remedy| Err(refused(recording, *first, remedy));
    if !recording.per_cycle && way(recording, &order) > way(recording, &given) {
        return refuse(SET_BACK);
    }
    if late.len() > 1 && late.len() as f64 > MOST_LATE * time.len() as f64 {
        return refuse(TOO_MANY);
    }
    Ok(order)
}

/// What both counters go in all, forth and back, when the rows are taken in an order.
fn way(recording: &Recording, order: &[usize]) -> f64 {
    let counts = recording.counts.iter();
    counts.map(|counts| order.windows(2).map(|pair| (counts[pair[1]] - counts[pair[0]]).abs()).sum::<f64>()).sum()
}

/// One row for each time stamp: the last one with a pose, or the last one, so that counts and pose are of one moment.
fn without_repeats(recording: &Recording, order: Vec<usize>) -> Result<Vec<usize>, DatasetError> {
    let time = &recording.time;
    let apart = |a: usize, b: usize| {
        let between = recording.counts.iter().map(|counts| (counts[a] - counts[b]).abs());
        between.fold(0.0, f64::max)
    };
    let steps = order.windows(2).filter(|pair| time[pair[0]] < time[pair[1]]);
    let largest = steps.map(|pair| apart(pair[0], pair[1])).fold(0.0, f64::max);
    let mut seen = vec![false; time.len()];
    recording.reference.iter().for_each(|pose| seen[pose.sample] = true);
    let mut kept: Vec<usize> = Vec::with_capacity(order.len());
    for row in order {
        match kept.last_mut() {
            Some(last) if time[*last] == time[row] => {
                let limit = if recording.per_cycle { 0.0 } else { largest };
                if apart(*last, row) > limit {
                    return Err(refused(recording, row, CLASH));
                }
                if seen[row] || !seen[*last] {
                    *last = row;
                }
            }
            _ => kept.push(row),
        }
    }
    Ok(kept)
}

fn refused(recording: &Recording, at: usize, remedy: &str) -> DatasetError {
    time_error(&recording.file, &recording.columns[0], &recording.lines, &recording.time, at, remedy)
}

/// Keeps the rows of an order, in it, with the poses that belong to them or to a row of the same time.
fn rearrange(recording: &mut Recording, order: &[usize]) {
    let mut references: Vec<_> = std::mem::take(&mut recording.reference);
    let stamps: Vec<f64> = order.iter().map(|row| recording.time[*row]).collect();
    let place = |time: f64| stamps.partition_point(|stamp| *stamp < time);
    let own = |row: usize| order.get(place(recording.time[row])) == Some(&row);
    references.sort_by_key(|pose| !own(pose.sample));
    for pose in &mut references {
        pose.sample = place(recording.time[pose.sample]);
    }
    references.sort_by_key(|pose| pose.sample);
    references.dedup_by_key(|pose| pose.sample);
    recording.reference = references;
    for (sample, _) in &mut recording.marked {
        *sample = place(recording.time[*sample]);
    }
    recording.marked.sort_by_key(|(sample, _)| *sample);
    recording.marked.dedup_by_key(|(sample, _)| *sample);
    let pick = |values: &[f64]| order.iter().map(|row| values[*row]).collect::<Vec<f64>>();
    recording.counts = recording.counts.iter().map(|counts| pick(counts)).collect();
    recording.lines = order.iter().map(|row| recording.lines.of(*row)).collect();
    recording.time = pick(&recording.time);
}
