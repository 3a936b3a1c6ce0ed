//! Rows that show the counts of an earlier reading.
//!
//! A driver that asks its counters 10 times a second and writes 50 rows a second repeats each reading, and then shows the way of all five rows at once.
//! Taken as counts of their own time, such rows are late by up to a period of the readings, and poses beside them are misjudged by the way in
//! it. Between readings nothing is known of the counts, so these rows are no rows of the counters.

use super::Recording;
use umbmark_core::prose::counted;

/// Where a wheel goes so many ticks from reading to reading, it does not stand between them by the resolution of its counter.
const LEAST_STEP: f64 = 4.0;
/// A robot may stand for longer \[s\].
const LONGEST: f64 = 0.3;
/// The rates before and after a row that was held differ by no more than this factor; where a wheel starts or stops they do.
const ALIKE: f64 = 2.0;
/// Rows that are no farther before a reading, as a share of the usual time between two readings, repeat the reading before.
const WITHIN: f64 = 0.95;
/// Least share of held readings among those of wheels that roll.
const LEAST_SHARE: f64 = 0.1;

/// Takes rows that show the counts of an earlier reading out of the counters; their poses get rows of their own.
pub(super) fn set_apart(recording: &mut Recording, warnings: &mut Vec<String>) {
    if recording.per_cycle {
        return;
    }
    let held = held_rows(recording);
    let rows = held.iter().filter(|held| **held).count();
    if rows == 0 {
        return;
    }
    let mut poses = std::mem::take(&mut recording.reference);
    let apart = &mut recording.apart;
    for pose in poses.iter().filter(|pose| held[pose.sample]) {
        apart.push(recording.lines.of(pose.sample), recording.time[pose.sample], (pose.x, pose.y, pose.heading));
    }
    poses.retain(|pose| !held[pose.sample]);
    // Where each row goes.
    let place: Vec<usize> = held
        .iter()
        .scan(0, |kept, held| {
            *kept += usize::from(!held);
            Some(kept.saturating_sub(1))
        })
        .collect();
    poses.iter_mut().for_each(|pose| pose.sample = place[pose.sample]);
    recording.reference = poses;
    recording.marked.iter_mut().for_each(|(sample, _)| *sample = place[*sample]);
    let is_kept = |row: &usize| !held[*row];
    let rows_kept: Vec<usize> = (0..held.len()).filter(is_kept).collect();
    let pick = |values: &[f64]| rows_kept.iter().map(|row| values[*row]).collect::<Vec<f64>>();
    recording.counts = recording.counts.iter().map(|counts| pick(counts)).collect();
    recording.lines = rows_kept.iter().map(|row| recording.lines.of(*row)).collect();
    recording.time = pick(&recording.time);
    warnings.push(format!(
        "{}: the counters are read less often than rows are written: {} that repeat the counts before them while the wheels roll were left out, and \
         their poses kept",
        recording.file,
        counted(rows, "row")
    ));
}

/// Which rows are held; none where too few are.
fn held_rows(recording: &Recording) -> Vec<bool> {
    let (time, rows) = (&recording.time, recording.time.len());
    let step = |row: usize| {
        let steps = recording.counts.iter().map(|counts| (counts[row] - counts[row - 1]).abs());
        steps.fold(0.0, f64::max)
    };
    let read: Vec<usize> = (1..rows).filter(|row| step(*row) > 0.0).collect();
    let mut held = vec![false; rows];
    let (mut rolling, mut periods) = (0, Vec::new());
    for (place, pair) in read.windows(2).enumerate() {
        let [at, next] = [pair[0], pair[1]];
        let before = place.checked_sub(1).map_or(f64::NEG_INFINITY, |place| time[read[place]]);
        let (seconds, seconds_before) = (time[next] - time[at], time[at] - before);
        let (rate, rate_before) = (step(next) / seconds, step(at) / seconds_before);
        // The first reading of a wheel that begins to roll has no rate before it.
        let alike = seconds_before > LONGEST || rate <= ALIKE * rate_before && rate_before <= ALIKE * rate;
        if step(at).min(step(next)) < LEAST_STEP || seconds > LONGEST || !alike {
            continue;
        }
        rolling += 1;
        if next > at + 1 {
            periods.push(seconds);
            held[at + 1..next].fill(true);
        }
    }
    periods.sort_by(f64::total_cmp);
    let usual = periods.get(periods.len() / 2).filter(|_| periods.len() as f64 >= LEAST_SHARE * f64::from(rolling));
    let Some(period) = usual else { return vec![false; rows] };
    // What is read so seldom is so where wheels start, turn back and stop as well.
    for next in read {
        let mut row = next - 1;
        while row > 0 && step(row) == 0.0 && time[next] - time[row] < WITHIN * period {
            held[row] = true;
            row -= 1;
        }
    }
    for (marked, _) in &recording.marked {
        held[*marked] = false;
    }
    held
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::dataset::ReferencePose;

    /// Wheels that start, roll and stop, read every so many rows; poses in every row.
    fn recording(every: usize, ticks: f64) -> Recording {
        let way = |row: usize| ticks * (row as f64 - 42.0).clamp(0.0, 100.0);
        let shown = |row: usize| way(row / every * every).floor();
        let rows = 200;
        let pose = |sample: usize| ReferencePose { sample, x: way(sample), y: 0.0, heading: None };
        Recording {
            time: (0..rows).map(|row| 0.02 * row as f64).collect(),
            counts: vec![(0..rows).map(shown).collect(), (0..rows).map(|row| 0.5 * shown(row)).collect()],
            lines: (2..rows + 2).collect(),
            reference: (0..rows).map(pose).collect(),
            ..Recording::default()
        }
    }

    #[test]
    fn rows_between_readings_are_taken_out_and_their_poses_kept() {
        let (whole, mut read) = (recording(1, 6.0), recording(5, 6.0));
        let mut warnings = Vec::new();
        set_apart(&mut read, &mut warnings);
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert_eq!(read.reference.len() + read.apart.poses.len(), 200);
        assert!((78..90).contains(&read.apart.poses.len()), "{}", read.apart.poses.len());
        for (time, counts) in read.time.iter().zip(&read.counts[0]) {
            let row = (time / 0.02).round() as usize;
            assert!(*counts == whole.counts[0][row], "{row}: {counts}");
        }
        for pose in &read.reference {
            assert_eq!(pose.x, whole.reference[(read.time[pose.sample] / 0.02).round() as usize].x);
        }
    }

    #[test]
    fn counters_that_are_read_in_every_row_and_coarse_ones_keep_their_rows() {
        // A counter of one tick in five rows stands between them by itself.
        for (every, ticks) in [(1, 6.0), (1, 0.2), (1, 3.3), (5, 0.04)] {
            let mut read = recording(every, ticks);
            let before = read.clone();
            set_apart(&mut read, &mut Vec::new());
            assert_eq!(read, before, "{every} {ticks}");
        }
        let mut read = Recording { per_cycle: true, ..recording(5, 6.0) };
        set_apart(&mut read, &mut Vec::new());
        assert_eq!(read.time.len(), 200);
    }
}
