//! Raw counts as a reader found them, and how they become a [`TickLog`].

use super::error::DatasetError;
use super::{ReferencePose, TickLog};
use crate::drive::{Robot, roll_over};

/// No wheel of a robot rolls faster \[m/s\].
const FASTEST: f64 = 100.0;
/// Counters that are looked for where a count jumps.
const USUAL_BITS: [u32; 5] = [8, 12, 16, 24, 32];

/// The rows of one log, before anything is mended.
#[derive(Clone, Debug, Default)]
pub(super) struct Recording {
    pub file: String,
    /// Names of the time, left and right columns.
    pub columns: [String; 3],
    /// Line of each row.
    pub lines: Vec<usize>,
    /// \[s\]
    pub time: Vec<f64>,
    /// Readings of the left and the right counter.
    pub counts: [Vec<f64>; 2],
    pub reference: Vec<ReferencePose>,
}

impl Recording {
    /// Checks time and counts, undoes roll-overs of a counter of `bits` bits, and counts from START.
    pub fn into_log(
        self,
        robot: Option<&Robot>,
        bits: Option<u32>,
        warnings: &mut Vec<String>,
    ) -> Result<TickLog, DatasetError> {
        self.check_time()?;
        let mut rolled = 0;
        let [left, right] = [0, 1].map(|wheel| self.unroll(wheel, robot, bits, &mut rolled));
        let (left, right) = (left?, right?);
        if let (Some(bits), 1..) = (bits, rolled) {
            warnings.push(format!("{}: {rolled} roll-overs of the {bits}-bit counters undone", self.file));
        }
        Ok(TickLog { time: self.time, left, right, reference: self.reference })
    }

    fn check_time(&self) -> Result<(), DatasetError> {
        let Some(at) = self.time.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
        Err(DatasetError::Time {
            file: self.file.clone(),
            line: self.lines[at + 1],
            column: self.columns[0].clone(),
            before: self.time[at],
            after: self.time[at + 1],
        })
    }

    /// Cumulative ticks of a wheel from its first reading.
    fn unroll(
        &self,
        wheel: usize,
        robot: Option<&Robot>,
        bits: Option<u32>,
        rolled: &mut u32,
    ) -> Result<Vec<f64>, DatasetError> {
        let readings = &self.counts[wheel];
        if let Some(at) = bits.and(readings.iter().position(|reading| reading.fract() != 0.0)) {
            return Err(DatasetError::Cell {
                file: self.file.clone(),
                line: self.lines[at],
                column: self.columns[wheel + 1].clone(),
                value: readings[at].to_string(),
                allowed: "a whole number of ticks where the robot has counter_bits".into(),
                remedy: "".into(),
            });
        }
        let usual = self.usual_rate(wheel);
        let fastest = robot.map_or(f64::INFINITY, |robot| FASTEST / metres_per_tick(robot, wheel));
        let mut total = 0.0;
        let mut ticks = vec![0.0; readings.len()];
        for (i, pair) in readings.windows(2).enumerate() {
            let plain = pair[1] - pair[0];
            let step = bits.map_or(plain, |bits| roll_over(pair[0] as i64, pair[1] as i64, bits) as f64);
            *rolled += u32::from(step != plain);
            let seconds = self.time[i + 1] - self.time[i];
            if let (None, Some(bits)) = (bits, rolled_bits(step.abs(), (usual * seconds).max(1.0))) {
                return Err(self.rolled_over(wheel, i, bits));
            }
            if let Some(robot) = robot.filter(|_| step.abs() > fastest * seconds) {
                return Err(self.jump(wheel, i, step.abs() * metres_per_tick(robot, wheel) / seconds, bits));
            }
            // Sums of whole numbers are exact; of others, the difference from the first reading is.
            total = if bits.is_some() { total + step } else { pair[1] - readings[0] };
            ticks[i + 1] = total;
        }
        Ok(ticks)
    }

    /// The rate of a wheel that all but one step in a hundred stay below \[ticks/s\].
    fn usual_rate(&self, wheel: usize) -> f64 {
        let steps = self.counts[wheel].windows(2).zip(self.time.windows(2));
        let mut rates: Vec<f64> =
            steps.map(|(count, time)| (count[1] - count[0]).abs() / (time[1] - time[0])).collect();
        if rates.is_empty() {
            return 0.0;
        }
        let place = (rates.len() - 1) * 99 / 100;
        *rates.select_nth_unstable_by(place, f64::total_cmp).1
    }

    fn rolled_over(&self, wheel: usize, at: usize, bits: u32) -> DatasetError {
        DatasetError::RolledOver {
            file: self.file.clone(),
            line: self.lines[at + 1],
            column: self.columns[wheel + 1].clone(),
            before: self.counts[wheel][at],
            after: self.counts[wheel][at + 1],
            bits,
        }
    }

    fn jump(&self, wheel: usize, at: usize, speed: f64, bits: Option<u32>) -> DatasetError {
        let cause = bits.map_or("rolled over (say counter_bits in robot.toml)".to_owned(), |bits| {
            format!("has another width than {bits} bits")
        });
        DatasetError::Jump {
            file: self.file.clone(),
            line: self.lines[at + 1],
            column: self.columns[wheel + 1].clone(),
            before: self.counts[wheel][at],
            after: self.counts[wheel][at + 1],
            seconds: ((self.time[at + 1] - self.time[at]) * 1e9).round() / 1e9,
            speed: speed.round(),
            limit: FASTEST,
            remedy: format!("look whether the counter was set back or {cause}, or rows are missing").into(),
        }
    }
}

/// The counter that rolled over where a wheel went `size` ticks and about `expected` are usual.
fn rolled_bits(size: f64, expected: f64) -> Option<u32> {
    let near = |bits: &u32| (size - f64::from(*bits).exp2()).abs() <= 4.0 * expected;
    USUAL_BITS.into_iter().find(near).filter(|_| size > 10.0 * expected)
}

fn metres_per_tick(robot: &Robot, wheel: usize) -> f64 {
    let per_tick = robot.metres_per_tick();
    [per_tick.left, per_tick.right][wheel]
}
