//! What a log holds, before anything is known of its robot.

use crate::drive::DriveKind;

/// The topics or columns of a log, and which of them would be read.
#[derive(Clone, Debug, PartialEq)]
pub struct LogContents {
    /// The file.
    pub file: String,
    /// Name of its layout: "csv", "mcap", "rosbag" or "rosbag2".
    pub layout: &'static str,
    /// Time from the first message or row to the last \[s\]; `None` where the file does not say it.
    pub duration: Option<f64>,
    /// Its topics or columns, in the order of the file; topics by name.
    pub parts: Vec<LogPart>,
    /// The wheels, or why there are none.
    pub wheels: Result<WheelsFound, String>,
    /// The absolute poses, where there are some, or why they cannot be read.
    pub reference: Result<Option<ReferenceFound>, String>,
    /// What was noticed in it, a sentence each.
    pub notes: Vec<String>,
    /// The robot.toml that it brings along, as logs of simulated robots do.
    pub robot: Option<String>,
    /// The URDF that it brings along, on the topic `robot_description`.
    pub urdf: Option<String>,
}

/// A topic or a column.
#[derive(Clone, Debug, PartialEq)]
pub struct LogPart {
    /// Its name.
    pub name: String,
    /// The type of its messages; of a column the range of its numbers, or "text".
    pub kind: String,
    /// Messages, or cells that hold something; `None` where the file does not say it.
    pub count: Option<u64>,
    /// Messages or cells per second \[Hz\]; `None` for fewer than two, or where the file does not say it.
    pub rate: Option<f64>,
    /// What it would be used for: "time", "wheels", "reference"; `None` for what is not used.
    pub used: Option<&'static str>,
}

/// What tells how the wheels turned.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelsFound {
    /// The topic and its fields, or the columns.
    pub source: String,
    /// What its numbers are.
    pub unit: WheelUnit,
    /// The drive whose counters have such names.
    pub drive: DriveKind,
    /// Readings.
    pub readings: usize,
    /// Readings per second, by the median of the time between them \[Hz\].
    pub rate: f64,
    /// Steps per turn of positions that come in steps; `None` for counts, and where no step shows.
    pub ticks_per_revolution: Option<f64>,
    /// Width of counters that are seen to roll over \[bit\].
    pub counter_bits: Option<u32>,
}

/// What readings of the wheels are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelUnit {
    /// Counts of an encoder.
    Counts,
    /// Positions of joints \[rad\].
    Positions,
    /// Odometry that the robot computed itself.
    Odometry,
}

impl WheelUnit {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            WheelUnit::Counts => "counts",
            WheelUnit::Positions => "joint positions",
            WheelUnit::Odometry => "odometry",
        }
    }
}

/// What tells where the robot was.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceFound {
    /// The topic, or the columns.
    pub source: String,
    /// Poses.
    pub poses: usize,
    /// How many of them have a heading.
    pub headings: usize,
    /// Poses per second, by the median of the time between them \[Hz\]; `None` for fewer than two.
    pub rate: Option<f64>,
}

/// How often something was recorded, by the median of the time between its records \[Hz\]; `None` for fewer than two
/// records, or where all have one time.
///
/// ```
/// use umbmark_core::inspect::usual_rate;
/// assert_eq!(usual_rate(&[0.0, 0.5, 1.0, 1.5, 9.0]), Some(2.0));
/// assert_eq!(usual_rate(&[3.0]), None);
/// ```
pub fn usual_rate(times: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    Some(1.0 / *median)
}

/// The steps per turn of wheel positions \[rad\] that come from a counter: all of their changes are multiples of one step,
/// 2π / ticks per revolution. `None` where they are not, where they are too few to say, or where every change is more than four steps, as in a
/// log of fast wheels that does not begin at rest.
///
/// The smallest change is the first guess of the step, or twice, thrice or four times the step. Larger changes, in their
/// order, make it sharper, so that the number of steps in the next one is certain.
///
/// ```
/// use umbmark_core::inspect::steps_per_turn;
/// let ticks = [0, 1, 3, 6, 10, 15, 21, 28, 36, 45, 55, 66, 78, 91];
/// let positions = ticks.map(|tick| f64::from(tick) * std::f64::consts::TAU / 1440.0);
/// assert_eq!(steps_per_turn(&positions), Some(1440.0));
/// ```
pub fn steps_per_turn(positions: &[f64]) -> Option<f64> {
    /// Changes that say whether there is a step.
    const LEAST_CHANGES: usize = 10;
    /// Smaller changes are rounding \[rad\].
    const ROUNDING: f64 = 1e-6;
    /// More steps than any encoder has.
    const MOST_STEPS: f64 = 4e6;
    /// How near to a whole number of steps a change is.
    const WHOLE: f64 = 0.1;
    let change = |pair: &[f64]| (pair[1] - pair[0]).abs();
    let mut changes: Vec<f64> = positions.windows(2).map(change).filter(|change| *change > ROUNDING).collect();
    changes.sort_by(f64::total_cmp);
    let smallest = *changes.first().filter(|_| changes.len() >= LEAST_CHANGES)?;
    if changes.last().is_some_and(|largest| *largest < 1.5 * smallest) {
        // One speed, and nothing to tell a step from it.
        return None;
    }
    let step = (1..=4).find_map(|parts| {
        let mut step = smallest / f64::from(parts);
        let (mut way, mut steps) = (0.0, 0.0);
        for change in &changes {
            let whole = (change / step).round();
            if (change / step - whole).abs() > WHOLE {
                return None;
            }
            (way, steps) = (way + change, steps + whole);
            step = way / steps;
        }
        Some(step)
    })?;
    let per_turn = std::f64::consts::TAU / step;
    let whole = per_turn.round();
    let is_whole = (per_turn - whole).abs() < 1e-3 || (per_turn - whole).abs() < 1e-6 * per_turn;
    (per_turn <= MOST_STEPS).then_some(if is_whole { whole } else { per_turn })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use std::f64::consts::TAU;

    /// Seeds 0 to 199, encoders of 12 to 400 000 steps per turn, written with all digits or as floats of 32 bits.
    #[test]
    fn the_steps_of_any_encoder_are_found_and_smooth_positions_have_none() {
        for seed in 0..200 {
            let mut stream = Stream::new(seed, 1, 0);
            let per_turn = (12.0 * (stream.uniform() * (400_000.0f64 / 12.0).ln()).exp()).round();
            // Steps that vary round an eighth of a radian per second, read at 50 Hz.
            let usual = (per_turn / TAU * 5.0 / 50.0).max(1.5);
            let mut tick = 0.0;
            // From rest, so that the first readings are a few steps apart.
            let ticks: Vec<f64> = (0..400)
                .map(|reading| {
                    let change = (stream.uniform() * 2.0 * usual).round();
                    tick += change.min(f64::from(reading + 1));
                    tick
                })
                .collect();
            let exact: Vec<f64> = ticks.iter().map(|tick| tick * TAU / per_turn).collect();
            assert_eq!(steps_per_turn(&exact), Some(per_turn), "seed {seed}");
            let backward: Vec<f64> = exact.iter().map(|position| 3.0 - position).collect();
            assert_eq!(steps_per_turn(&backward), Some(per_turn), "seed {seed}, backward");
            if per_turn < 4000.0 {
                let single: Vec<f64> = exact.iter().map(|position| f64::from(*position as f32)).collect();
                let found = steps_per_turn(&single).unwrap();
                assert!((found / per_turn - 1.0).abs() < 1e-4, "seed {seed}: {found} of {per_turn}");
            }
            let smooth: Vec<f64> = (0..400)
                .scan(0.0, |sum, _| {
                    *sum += stream.uniform() * 0.1;
                    Some(*sum)
                })
                .collect();
            assert_eq!(steps_per_turn(&smooth), None, "seed {seed}");
        }
    }

    #[test]
    fn one_speed_all_the_way_shows_no_step() {
        let even: Vec<f64> = (0..100).map(|i| 0.037 * f64::from(i)).collect();
        assert_eq!(steps_per_turn(&even), None);
        assert_eq!(steps_per_turn(&[]), None);
        assert_eq!(usual_rate(&[1.0, 1.0]), None);
    }
}
