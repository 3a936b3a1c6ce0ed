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
        let usual = usual_step(readings);
        let mut total = 0.0;
        let mut ticks = vec![0.0; readings.len()];
        for (i, pair) in readings.windows(2).enumerate() {
            let plain = pair[1] - pair[0];
            let step = bits.map_or(plain, |bits| roll_over(pair[0] as i64, pair[1] as i64, bits) as f64);
            *rolled += u32::from(step != plain);
            self.check_step(wheel, i, step, robot, bits, usual)?;
            // Sums of whole numbers are exact; of others, the difference from the first reading is.
            total = if bits.is_some() { total + step } else { pair[1] - readings[0] };
            ticks[i + 1] = total;
        }
        Ok(ticks)
    }

    fn check_step(
        &self,
        wheel: usize,
        at: usize,
        step: f64,
        robot: Option<&Robot>,
        bits: Option<u32>,
        usual: f64,
    ) -> Result<(), DatasetError> {
        let size = step.abs();
        let seconds = self.time[at + 1] - self.time[at];
        let (file, line, column) = (self.file.clone(), self.lines[at + 1], self.columns[wheel + 1].clone());
        let (before, after) = (self.counts[wheel][at], self.counts[wheel][at + 1]);
        let near = |bits: &u32| (size - f64::from(*bits).exp2()).abs() <= 4.0 * usual && size > 10.0 * usual;
        if let (None, Some(bits)) = (bits, USUAL_BITS.into_iter().find(near)) {
            return Err(DatasetError::RolledOver { file, line, column, before, after, bits });
        }
        let Some(robot) = robot else { return Ok(()) };
        let per_tick = robot.metres_per_tick();
        let speed = size * [per_tick.left, per_tick.right][wheel] / seconds;
        if speed <= FASTEST {
            return Ok(());
        }
        let remedy: String = match bits {
            Some(bits) => format!("look whether the counter has {bits} bits, was set back, or rows are missing"),
            None => "look whether the counter was set back, rolled over (say counter_bits in robot.toml), or rows are missing".into(),
        };
        let speed = speed.round();
        Err(DatasetError::Jump {
            file,
            line,
            column,
            before,
            after,
            seconds,
            speed,
            limit: FASTEST,
            remedy: remedy.into(),
        })
    }
}

/// The size of step that all but one in a hundred stay below, at least one tick.
fn usual_step(readings: &[f64]) -> f64 {
    let mut steps: Vec<f64> = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    if steps.is_empty() {
        return 1.0;
    }
    let place = (steps.len() - 1) * 99 / 100;
    let (_, usual, _) = steps.select_nth_unstable_by(place, f64::total_cmp);
    usual.max(1.0)
}
