//! Raw counts as a reader found them, and how they become a [`TickLog`].

mod held;
mod order;

use super::error::{At, DatasetError, LineProblem};
use super::lines::Lines;
use super::track_rows::TrackRows;
use umbmark_core::dataset::{Mended, ReferencePose, TickLog};
use umbmark_core::drive::{DriveKind, Robot, roll_over};
use umbmark_core::prose::counted;
use umbmark_core::run::{headings_of, place};

/// Most robots' wheels roll no faster \[m/s\].
const PLAUSIBLE: f64 = 10.0;
/// No wheel of a robot rolls faster \[m/s\].
const FASTEST: f64 = 100.0;
/// Wheels that roll more slowly \[m/s\], in rows farther apart \[s\], of which there are so many or more, have another unit of time.
const SLOWEST: f64 = 3e-3;
const LONGEST: f64 = 1.0;
const FEWEST_ROWS: f64 = 10.0;
/// Counters that are looked for where a count jumps.
const USUAL_BITS: [u32; 5] = [8, 12, 16, 24, 32];
/// A counter that was set back shows no more than so many usual steps, after more than so many.
const AFTER_RESET: f64 = 2.0;
const BEFORE_RESET: f64 = 20.0;
/// The steps around a reset say what was turned between the two rows if these are no more than so many mean periods apart.
const SHORT: f64 = 5.0;
/// Clocks that differ by more than this share are told, and where they differ is looked for.
pub(crate) const CLOCK_EXCESS: f64 = 0.03;

/// The rows of one log, before anything is mended.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Recording {
    pub file: String,
    /// Names of the column of the times and of those of the counters.
    pub columns: Vec<String>,
    /// Line of each row.
    pub lines: Lines,
    /// \[s\]
    pub time: Vec<f64>,
    /// Readings of the left and the right counter, or of each wheel with rollers.
    pub counts: Vec<Vec<f64>>,
    /// Whether a reading is what was counted since the row before, rather than in all.
    pub per_cycle: bool,
    /// Whether the angle of a row is that of all that was driven since the row before, rather than that at its time.
    pub angle_of_row: bool,
    pub reference: Vec<ReferencePose>,
    /// Poses in rows of their own, without counts.
    pub apart: TrackRows,
    /// Rows with neither counts nor a pose.
    pub empty: usize,
    /// Whether these poses are sums of the steps of a reference that tells motion only.
    pub relative: bool,
    /// Whether they tell headings only.
    pub headings_only: bool,
    /// Whether their headings are the rates of a gyro, not yet added up.
    pub rates: bool,
    /// By which share the run took longer by the reference's clock than by that of the rows.
    pub clock_excess: f64,
    /// Rows at which the robot stood on a mark, and its name.
    pub marked: Vec<(usize, String)>,
}

impl Default for Recording {
    /// Without rows, for two counters.
    fn default() -> Recording {
        Recording {
            file: String::new(),
            columns: vec![String::new(); 3],
            lines: Lines::default(),
            time: Vec::new(),
            counts: vec![Vec::new(); 2],
            per_cycle: false,
            angle_of_row: false,
            reference: Vec::new(),
            apart: TrackRows::default(),
            empty: 0,
            relative: false,
            headings_only: false,
            rates: false,
            clock_excess: 0.0,
            marked: Vec::new(),
        }
    }
}

impl Recording {
    /// Puts rows in order, undoes roll-overs of a counter of `bits` bits and resets, and counts from START. With the samples at which the
    /// robot stood on a mark.
    pub fn into_log(
        mut self,
        robot: Option<&Robot>,
        bits: Option<u32>,
        warnings: &mut Vec<String>,
    ) -> Result<(TickLog, Vec<(usize, String)>), DatasetError> {
        if let Some(kind) =
            robot.map(|robot| robot.drive.kind()).filter(|kind| kind.columns().len() != self.counts.len())
        {
            return Err(self.other_counters(kind));
        }
        let mut mended = Mended::default();
        order::put_in_order(&mut self, &mut mended, warnings)?;
        held::set_apart(&mut self, warnings);
        let apart = self.poses_apart(warnings)?;
        if self.empty > 0 {
            let rows = counted(self.empty, "row");
            warnings.push(format!("{}: {rows} with neither counts nor a pose: left out", self.file));
        }
        self.add_up_rates();
        if self.per_cycle {
            self.add_up();
        }
        let (mut reset_rows, wheels) = (Vec::new(), self.counts.len());
        let mut unroll = |wheel| self.unroll(wheel, robot, bits, &mut mended.roll_overs, &mut reset_rows);
        let mut unrolled = Vec::new();
        for wheel in 0..wheels {
            unrolled.push(unroll(wheel)?);
        }
        if let (Some(bits), 1..) = (bits, mended.roll_overs) {
            warnings.push(format!("{}: {} roll-overs of the {bits}-bit counters undone", self.file, mended.roll_overs));
        }
        reset_rows.sort_unstable();
        reset_rows.dedup();
        mended.resets = reset_rows.len();
        if let [first, ..] = reset_rows[..] {
            warnings.push(format!(
                "{}:{}: {}: counted on; what the wheels turned between the rows around each is taken from the steps before and \
                 after",
                self.file,
                self.lines.of(first),
                counted(mended.resets, "counter reset")
            ));
        }
        let of_rollers = robot.and_then(|robot| robot.axle_ticks_of_rollers(&unrolled));
        let ([left, right], rollers) = if let Some(ticks) = of_rollers {
            (ticks, unrolled)
        } else {
            let mut two = unrolled.into_iter();
            let ticks = [two.next().unwrap_or_default(), two.next().unwrap_or_default()];
            let ticks = match robot {
                Some(robot) if self.angle_of_row => robot.axle_ticks_by_rows(robot.encoder.wiring().counters(ticks)),
                Some(robot) => robot.axle_ticks(robot.encoder.wiring().counters(ticks)),
                None => ticks,
            };
            (ticks, Vec::new())
        };
        let (time, reference, relative, headings_only) = (self.time, self.reference, self.relative, self.headings_only);
        let clock_excess = self.clock_excess;
        let counts = TickLog { left, right, rollers, clock_excess, mended, ..TickLog::default() };
        let mut log = TickLog { time, reference, relative, headings_only, ..counts };
        if let Some(robot) = robot.filter(|_| log.clock_excess.abs() > CLOCK_EXCESS) {
            log.find_lost_time(robot);
        }
        warnings.extend(robot.and_then(|robot| slow_clock(&log, robot)).map(|told| format!("{}: {told}", self.file)));
        if let Some(apart) = apart {
            let outside = place(&mut log, &apart.time, &apart.poses);
            if outside > 0 {
                let poses = counted(outside, "pose");
                let file = &self.file;
                warnings.push(format!("{file}: {poses} in a gap of the counts, or outside of them: left out"));
            }
        }
        Ok((log, self.marked))
    }

    /// All poses of a log in which some have rows of their own, in the order of time. Those are no rows of the counters then.
    fn poses_apart(&mut self, warnings: &mut Vec<String>) -> Result<Option<TrackRows>, DatasetError> {
        if self.apart.time.is_empty() {
            return Ok(None);
        }
        let mut apart = std::mem::take(&mut self.apart);
        // A pose beside counts stands first, and stays where another has its time.
        let own = std::mem::take(&mut self.reference);
        apart.put_in_order(warnings)?;
        let mut all = TrackRows { rates: apart.rates, ..TrackRows::default() };
        let mut own = own.iter().peekable();
        for (row, time) in apart.time.iter().enumerate() {
            while let Some(pose) = own.next_if(|pose| self.time[pose.sample] <= *time) {
                all.push(self.lines.of(pose.sample), self.time[pose.sample], (pose.x, pose.y, pose.heading));
            }
            if all.time.last() != Some(time) {
                all.push(apart.lines.of(row), *time, apart.poses[row]);
            }
        }
        for pose in own {
            all.push(self.lines.of(pose.sample), self.time[pose.sample], (pose.x, pose.y, pose.heading));
        }
        if all.rates {
            all.count_turns();
        }
        Ok(Some(all))
    }

    /// Makes headings of the rates of a gyro.
    fn add_up_rates(&mut self) {
        if self.rates {
            let time: Vec<f64> = self.reference.iter().map(|pose| self.time[pose.sample]).collect();
            let rates: Vec<f64> = self.reference.iter().map(|pose| pose.heading.unwrap_or(0.0)).collect();
            let headings = headings_of(&time, &rates);
            self.reference.iter_mut().zip(headings).for_each(|(pose, heading)| pose.heading = Some(heading));
        }
    }

    fn add_up(&mut self) {
        for counts in &mut self.counts {
            let mut total = 0.0;
            for count in counts {
                total += *count;
                *count = total;
            }
        }
    }

    /// Takes the readings of a wheel and makes cumulative ticks of them, from the first on; counts roll-overs and lists the
    /// rows before which it was reset.
    fn unroll(
        &mut self,
        wheel: usize,
        robot: Option<&Robot>,
        bits: Option<u32>,
        roll_overs: &mut usize,
        reset_rows: &mut Vec<usize>,
    ) -> Result<Vec<f64>, DatasetError> {
        let usual = self.usual_rate(wheel);
        let mut readings = std::mem::take(&mut self.counts[wheel]);
        if wheel == 1 && robot.is_some_and(|robot| robot.drive.kind().steers()) {
            // An angle, and no sum of steps.
            let signed = |reading: f64| bits.map_or(reading, |bits| roll_over(0, reading as i64, bits) as f64);
            return Ok(readings.into_iter().map(signed).collect());
        }
        if bits.is_some()
            && let Some(at) = readings.iter().position(|reading| reading.fract() != 0.0)
        {
            return Err(self.fractional(wheel, at, readings[at]));
        }
        // A steering counter has no speed over ground.
        let of_wheel = |robot: &&Robot| robot.drive.kind().has_axle_wheels() || robot.drive.kind().moves_sideways();
        let robot = robot.filter(|robot| wheel == 0 || of_wheel(robot));
        let fastest = robot.map_or(f64::INFINITY, |robot| FASTEST / metres_per_tick(robot, wheel));
        let mut before = readings.first().copied().unwrap_or(0.0);
        let widths = widths_of(&readings);
        let period = self.period();
        let (mut total, mut before_reset, mut origin) = (0.0, 0.0, before);
        for at in 0..readings.len() {
            let after = readings[at];
            let seconds = self.time[at] - self.time[at.saturating_sub(1)];
            let expected = (usual * seconds).max(1.0);
            let plain = after - before;
            let mut step = bits.map_or(plain, |bits| roll_over(before as i64, after as i64, bits) as f64);
            if was_reset(before, after, expected, bits, &widths) {
                reset_rows.push(at);
                let hidden = if seconds <= SHORT * period { self.around(&readings, at, total) } else { after };
                (before_reset, origin, step) = (total + hidden, after, hidden);
            } else {
                *roll_overs += usize::from(step != plain);
            }
            if let (None, Some(bits)) = (bits, rolled_bits(step.abs(), expected, &widths)) {
                return Err(self.rolled_over(wheel, at, [before, after], bits));
            }
            // Rows that are read from a buffer at once bear stamps that nearly agree.
            let seconds = seconds.max(period);
            if let Some(robot) = robot.filter(|_| step.abs() > fastest * seconds) {
                let speed = step.abs() * metres_per_tick(robot, wheel) / seconds;
                return Err(self.jump(wheel, at, [before, after], speed, bits));
            }
            // Sums of whole numbers are exact; of others, the difference from the first reading is.
            total = if bits.is_some() { total + step } else { before_reset + (after - origin) };
            (readings[at], before) = (total, after);
        }
        Ok(readings)
    }

    /// The mean time from row to row \[s\].
    fn period(&self) -> f64 {
        let whole = self.time.last().zip(self.time.first()).map_or(0.0, |(last, first)| last - first);
        whole / self.time.len().saturating_sub(1).max(1) as f64
    }

    /// What a wheel turned before a row, by the steps before and after it; the readings of rows before it are sums already, the last of them
    /// `total`.
    fn around(&self, readings: &[f64], at: usize, total: f64) -> f64 {
        let before = at.checked_sub(2).map(|two| (total - readings[two]) / (self.time[at - 1] - self.time[two]));
        let after = readings.get(at + 1).map(|next| (next - readings[at]) / (self.time[at + 1] - self.time[at]));
        let rates = [before, after].into_iter().flatten();
        let seconds = self.time[at] - self.time[at - 1];
        let turned = seconds * rates.clone().sum::<f64>() / rates.count().max(1) as f64;
        if readings[at].fract() == 0.0 { turned.round() } else { turned }
    }

    /// The rate of a wheel that all but one step in a hundred stay below \[ticks/s\]: the least of the largest hundredth, and
    /// no more than twice as many rates are kept at a time.
    fn usual_rate(&self, wheel: usize) -> f64 {
        let Some(last) = self.counts[wheel].len().checked_sub(2) else { return 0.0 };
        let hundredth = last + 1 - last * 99 / 100;
        let cut = |rates: &mut Vec<f64>| {
            let least = *rates.select_nth_unstable_by(hundredth - 1, |a, b| b.total_cmp(a)).1;
            rates.truncate(hundredth);
            least
        };
        // A small counter of a fast wheel rolls over in more than one step in a hundred.
        let range = widths_of(&self.counts[wheel]).first().map_or(f64::INFINITY, |bits| f64::from(*bits).exp2());
        let rolled = |step: f64| step.min((range - step).abs());
        let (mut largest, mut least) = (Vec::with_capacity(2 * hundredth), f64::NEG_INFINITY);
        for (count, time) in self.counts[wheel].windows(2).zip(self.time.windows(2)) {
            let rate = rolled((count[1] - count[0]).abs()) / (time[1] - time[0]);
            if !(rate <= least) {
                largest.push(rate);
                if largest.len() == 2 * hundredth {
                    least = cut(&mut largest);
                }
            }
        }
        cut(&mut largest)
    }

    /// The error of a log with other counters than the drive has.
    fn other_counters(&self, kind: DriveKind) -> DatasetError {
        let (key, value) = ("drive".into(), format!("\"{}\"", kind.name()));
        let columns: Vec<String> = kind.columns().iter().map(|counter| format!("ticks_{counter}")).collect();
        let remedy = format!("of this drive, only CSV with a counter for each wheel is read ({})", columns.join(", "));
        At::new(self.file.clone(), 1).refuse(LineProblem::NotYet { key, value, remedy })
    }

    fn fractional(&self, wheel: usize, at: usize, reading: f64) -> DatasetError {
        At::new(self.file.clone(), self.lines.of(at)).refuse(LineProblem::Cell {
            column: self.columns[wheel + 1].clone(),
            value: reading.to_string(),
            allowed: "a whole number of ticks where the robot has counter_bits".into(),
            remedy: "".into(),
        })
    }

    fn rolled_over(&self, wheel: usize, at: usize, [before, after]: [f64; 2], bits: u32) -> DatasetError {
        At::new(self.file.clone(), self.lines.of(at)).refuse(LineProblem::RolledOver {
            column: self.columns[wheel + 1].clone(),
            before,
            after,
            bits,
        })
    }

    /// The advice for times that are seconds by the speed of a wheel \[m/s\], in a column that is called otherwise.
    fn in_seconds(&self, speed: f64) -> String {
        let time = &self.columns[0];
        let per_second = [("_ms", 1e3), ("_us", 1e6), ("_ns", 1e9)].into_iter().find(|(unit, _)| time.ends_with(unit));
        match per_second {
            Some((_, factor)) if speed / factor <= PLAUSIBLE => {
                format!("if column \"{time}\" holds seconds, call it t_s; else ")
            }
            _ => String::new(),
        }
    }

    fn jump(&self, wheel: usize, at: usize, [before, after]: [f64; 2], speed: f64, bits: Option<u32>) -> DatasetError {
        let cause = bits.map_or("rolled over (say counter_bits in robot.toml)".to_owned(), |bits| {
            format!("has another width than {bits} bits")
        });
        At::new(self.file.clone(), self.lines.of(at)).refuse(LineProblem::Jump {
            column: self.columns[wheel + 1].clone(),
            before,
            after,
            seconds: ((self.time[at] - self.time[at - 1]) * 1e9).round() / 1e9,
            speed: speed.round(),
            limit: FASTEST,
            remedy: format!(
                "{}look whether the counter was set back or {cause}, or rows are missing",
                self.in_seconds(speed)
            )
            .into(),
        })
    }
}

/// Whether a counter was set back to zero: it showed many steps and shows next to none, and it did not roll over, after
/// which it would show next to none as well, but before which it would have been full.
fn was_reset(before: f64, after: f64, expected: f64, bits: Option<u32>, widths: &[u32]) -> bool {
    let fell = after.abs() <= AFTER_RESET * expected && before.abs() > BEFORE_RESET * expected;
    let full = |bits: u32| (f64::from(bits).exp2() - before).abs() <= 4.0 * expected;
    fell && !match bits {
        Some(bits) => full(bits),
        None => widths.iter().copied().any(full),
    }
}

/// The usual widths of a counter that can show all of some readings, unsigned or signed.
fn widths_of(readings: &[f64]) -> Vec<u32> {
    let (least, most) = readings.iter().fold((0.0_f64, 0.0_f64), |(l, m), reading| (l.min(*reading), m.max(*reading)));
    let fits = |bits: &u32| {
        let range = f64::from(*bits).exp2();
        (least >= 0.0 && most < range) || (least >= -0.5 * range && most < 0.5 * range)
    };
    USUAL_BITS.into_iter().filter(fits).collect()
}

/// The width of the counter that rolled over where a wheel went `size` ticks and about `expected` are usual, among the widths that
/// can show all of its readings.
fn rolled_bits(size: f64, expected: f64, widths: &[u32]) -> Option<u32> {
    let near = |bits: &u32| (size - f64::from(*bits).exp2()).abs() <= 4.0 * expected;
    if size > 10.0 * expected { widths.iter().copied().find(near) } else { None }
}

/// What is said of wheels that roll at no robot's speed, in rows that no logger writes: times in ms under the name of s.
fn slow_clock(log: &TickLog, robot: &Robot) -> Option<String> {
    let per_tick = robot.metres_per_tick();
    let (mut way, mut seconds, mut rows) = (0.0, 0.0, 0.0);
    for at in 1..log.time.len() {
        let of_wheel = |counts: &[f64], metres: f64| (metres * (counts[at] - counts[at - 1])).abs();
        let rolled = of_wheel(&log.left, per_tick.left).max(of_wheel(&log.right, per_tick.right));
        if rolled > 0.0 {
            (way, seconds, rows) = (way + rolled, seconds + log.time[at] - log.time[at - 1], rows + 1.0);
        }
    }
    let (speed, period) = (way / seconds, seconds / rows);
    (rows >= FEWEST_ROWS && speed < SLOWEST && period > LONGEST).then(|| {
        format!(
            "the wheels roll at {:.2} mm/s, by rows that are {period:.0} s apart: if the times are in milliseconds, call their column t_ms",
            1e3 * speed
        )
    })
}

/// The error of time that goes back, or stands still, at row `at`.
pub(super) fn time_error(
    file: &str,
    column: &str,
    lines: &Lines,
    time: &[f64],
    at: usize,
    remedy: &str,
) -> DatasetError {
    At::new(file, lines.of(at)).refuse(LineProblem::Time {
        column: column.to_owned(),
        before: time[at.saturating_sub(1)],
        after: time[at],
        remedy: remedy.into(),
    })
}

fn metres_per_tick(robot: &Robot, wheel: usize) -> f64 {
    let per_tick = robot.metres_per_tick();
    [per_tick.left, per_tick.right][wheel.min(1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::random::Stream;

    #[test]
    fn a_width_is_named_only_where_all_readings_fit_it() {
        // Readings from 1251429 down by about 4096 at once: no counter of 12 bits shows such numbers.
        let large = [1_251_429.0, 1_251_430.0, 1_247_334.0];
        assert_eq!(rolled_bits(4096.0, 1.0, &widths_of(&large)), None);
        assert!(USUAL_BITS.contains(&12) && USUAL_BITS.contains(&16));
        for (readings, bits) in [
            (vec![4090.0, 4095.0, 2.0], Some(12)),
            (vec![2040.0, 2047.0, -2046.0], Some(12)),
            (vec![4090.0, 4096.0, 2.0], None),
            (vec![2040.0, 2049.0, -2046.0], None),
        ] {
            assert_eq!(rolled_bits(4094.0, 1.0, &widths_of(&readings)), bits, "{readings:?}");
        }
    }

    /// A wheel of 2600 ticks a row rolls a counter of 16 bits over in four rows of a hundred.
    #[test]
    fn a_counter_that_rolls_over_every_few_rows_is_named() {
        let count = |row: i32| f64::from((2600 * row) % 65_536);
        let counts: Vec<f64> = (0..400).map(count).collect();
        let time: Vec<f64> = (0..400).map(|row| 0.05 * f64::from(row)).collect();
        let columns = ["t_s", "ticks_left", "ticks_right"].map(str::to_owned);
        let counts = [counts.clone(), counts];
        let recording = Recording {
            time,
            counts: counts.to_vec(),
            columns: columns.to_vec(),
            lines: (2..402).collect(),
            ..Recording::default()
        };
        assert!((recording.usual_rate(0) / 52_000.0 - 1.0).abs() < 1e-6);
        let refused = recording.into_log(None, None, &mut Vec::new()).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains("a counter of 16 bits"), "{refused}");
    }

    #[test]
    fn the_usual_rate_is_the_one_that_a_sorted_list_has_at_ninety_nine_per_cent() {
        let mut stream = Stream::new(5, 1, 0);
        for rows in [0, 1, 2, 3, 100, 101, 102, 103, 202, 5000] {
            let counts: Vec<f64> = (0..rows).map(|_| (stream.uniform() * 50.0).floor()).collect();
            let time = (0..rows).map(f64::from).collect();
            let mut rates: Vec<f64> = counts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
            rates.sort_by(f64::total_cmp);
            let expected = if rates.is_empty() { 0.0 } else { rates[(rates.len() - 1) * 99 / 100] };
            let recording = Recording { time, counts: vec![counts, Vec::new()], ..Recording::default() };
            assert_eq!(recording.usual_rate(0), expected, "{rows}");
        }
    }
}
