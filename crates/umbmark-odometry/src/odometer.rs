//! One reading of the counters after the other, and the pose after each.

use crate::context::{Here, Place, Progress};
use crate::gearing::{Gearing, roll_over};
use crate::geometry::{Displacement2, Pose2};
use crate::law::Acts;
use crate::pace::{HALF_WINDOW, Reading, between, speeds, window};
use crate::spread::Spread;
use crate::table::Table;
use crate::travel::WheelTravel;
use core::fmt;

/// Counts beyond this are not whole numbers any more.
const MOST_COUNTS: f64 = 9_007_199_254_740_992.0;

/// Where the robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time of the reading that the pose belongs to \[s\].
    pub time: f64,
    /// The pose.
    pub pose: Pose2,
    /// How sure it is, START taken to be exact; `None` where the noise is not known.
    pub spread: Option<Spread>,
}

/// Why a reading gives no pose. The next one may be given: nothing is lost, as counters count on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UpdateError {
    /// A time that is not finite, or not later than the one before. The reading is left out.
    Time,
    /// A count that is not finite, beyond 2^53, or not whole although the counter rolls over. The reading is left out.
    Count,
    /// More readings within 0.1 s than there is room for. The reading stands in place of the one before it.
    TooFast,
    /// The pose is not finite: counts or numbers of the model are out of all range. Begin anew.
    Lost,
}

impl fmt::Display for UpdateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            UpdateError::Time => "the time of a reading must be finite and later than that of the one before",
            UpdateError::Count => "a count must be finite, within 2^53, and whole where counters roll over",
            UpdateError::TooFast => "there is no room for so many readings within 0.1 s; read more slowly or make room",
            UpdateError::Lost => "the pose is not finite; are the counts those of this robot?",
        })
    }
}

impl core::error::Error for UpdateError {}

/// Corrected odometry, reading by reading.
///
/// Where no law [reads speeds](crate::law::Law::reads_speed), [`update`](Odometer::update) gives the pose of the reading that it gets.
/// A speed is taken over 0.05 s before and after a moment, as in the fits that found the law. So where some law reads speeds, `update`
/// gives the pose of the last reading that is 0.05 s old, and [`ahead`](Odometer::ahead) that of the newest reading, with the part of
/// the window that is there.
///
/// The poses of `update` are those of `umbmark apply` on the whole log, to the last bit; that of `ahead` is the last of `umbmark apply` on
/// the log up to now.
///
/// `READINGS` is the room for readings: all within 0.1 s and three more, where speeds are read, and 2 where none are.
#[derive(Clone, Debug)]
pub struct Odometer<'t, const READINGS: usize> {
    counters: Option<Counters>,
    log: Log<'t, READINGS>,
    settled: Settled,
}

/// The model, and the last readings.
#[derive(Clone, Debug)]
struct Log<'t, const READINGS: usize> {
    table: Table<'t>,
    reads_speed: bool,
    readings: [Reading; READINGS],
    /// Number of readings so far; the last ones stand in `readings`.
    count: u64,
    /// Time of the first reading \[s\].
    first: f64,
}

/// The two counters as they were read last, and the ticks of the axle's wheels that follow.
#[derive(Clone, Copy, Debug)]
struct Counters {
    origin: [f64; 2],
    raw: [f64; 2],
    total: [f64; 2],
    wired: [f64; 2],
    ticks: [f64; 2],
}

/// The state after the last reading whose pose is final.
#[derive(Clone, Debug)]
struct Settled {
    /// Number of readings until then.
    count: u64,
    /// The last readings before the beginning and the end of the window of the last speed.
    cursors: [u64; 2],
    /// The last speeds of the wheels \[m/s\].
    speeds: [f64; 2],
    progress: Progress,
    pose: Pose2,
    spread: Spread,
}

impl<'t, const READINGS: usize> Odometer<'t, READINGS> {
    /// A run that begins at the START of the table with its first reading.
    pub fn begin(table: &Table<'t>) -> Self {
        Self::begin_at(table, table.start, &Place::default())
    }

    /// A run that begins elsewhere, or has others before it in its session.
    pub fn begin_at(table: &Table<'t>, start: Pose2, place: &Place) -> Self {
        const { assert!(READINGS >= 2, "a step has two readings") };
        let readings = [Reading::default(); READINGS];
        Odometer {
            counters: None,
            log: Log { table: *table, reads_speed: table.reads_speed(), readings, count: 0, first: 0.0 },
            settled: Settled {
                count: 0,
                cursors: [0; 2],
                speeds: [0.0; 2],
                progress: Progress::new(&table.nominal, place, true),
                pose: start,
                spread: Spread::default(),
            },
        }
    }

    /// How much later than the newest reading a pose of [`update`](Odometer::update) is known at least \[s\].
    pub fn delay(&self) -> f64 {
        if self.log.reads_speed { HALF_WINDOW } else { 0.0 }
    }

    /// Takes a reading of both counters, and gives the pose of the last reading for which it is final.
    ///
    /// Counts are cumulative, and the first reading is START. Where counters roll over they are what the counter shows. `time` \[s\] may
    /// begin anywhere.
    ///
    /// # Errors
    /// See [`UpdateError`].
    pub fn update(&mut self, time: f64, counts: [f64; 2]) -> Result<Estimate, UpdateError> {
        let log = &mut self.log;
        if !time.is_finite() || log.count > 0 && time <= log.reading(log.count - 1).time {
            return Err(UpdateError::Time);
        }
        let rolls = log.table.counter_bits.is_some();
        let is_count = |count: &f64| count.abs() <= MOST_COUNTS && (!rolls || (*count as i64) as f64 == *count);
        if !counts.iter().all(is_count) {
            return Err(UpdateError::Count);
        }
        let needed = self.settled.cursors[0].min(self.settled.count.saturating_sub(1));
        let too_fast = log.count - needed >= READINGS as u64;
        if too_fast {
            // In place of the last reading: were this one left out, no time would pass and no room would come free.
            log.count -= 1;
        }
        let counters = log.table.counted(self.counters.as_ref(), counts);
        self.counters = Some(counters);
        log.push(Reading { time, ticks: counters.ticks });
        log.settle(&mut self.settled, false);
        if too_fast { Err(UpdateError::TooFast) } else { log.estimate(&self.settled) }
    }

    /// The pose of the newest reading, as it were if the run ended there.
    ///
    /// # Errors
    /// [`UpdateError::Lost`].
    pub fn ahead(&self) -> Result<Estimate, UpdateError> {
        let mut settled = self.settled.clone();
        self.log.settle(&mut settled, true);
        self.log.estimate(&settled)
    }

    /// Path length driven in the session until the last final pose \[m\], for the next run.
    pub fn session_distance(&self) -> f64 {
        self.settled.progress.session_distance()
    }
}

impl<const READINGS: usize> Log<'_, READINGS> {
    fn push(&mut self, reading: Reading) {
        if self.count == 0 {
            self.first = reading.time;
        }
        self.readings[(self.count % READINGS as u64) as usize] = reading;
        self.count += 1;
    }

    fn reading(&self, number: u64) -> &Reading {
        &self.readings[(number % READINGS as u64) as usize]
    }

    fn estimate(&self, at: &Settled) -> Result<Estimate, UpdateError> {
        let Pose2 { x, y, heading } = at.pose;
        if !(x + y + heading).is_finite() {
            return Err(UpdateError::Lost);
        }
        let time = if self.count > 0 { self.reading(at.count.saturating_sub(1)).time } else { 0.0 };
        Ok(Estimate { time, pose: at.pose, spread: self.table.growth.map(|_| at.spread) })
    }

    /// Goes on to the last reading for which the pose is final, or to the newest if the run ends there.
    fn settle(&self, at: &mut Settled, ended: bool) {
        let Some(newest) = self.count.checked_sub(1) else { return };
        let last = self.reading(newest).time;
        while at.count <= newest {
            let now = self.reading(at.count);
            if self.reads_speed && !ended && now.time + HALF_WINDOW > last {
                return;
            }
            let before = if at.count == 0 { Reading { ticks: [0.0; 2], ..*now } } else { *self.reading(at.count - 1) };
            let speeds = if self.reads_speed { self.speeds(at, now.time, last) } else { [0.0; 2] };
            let from = if at.count == 0 { speeds } else { at.speeds };
            let per_tick = &self.table.nominal.metres_per_tick;
            let travel = WheelTravel {
                left: (now.ticks[0] - before.ticks[0]) * per_tick.left,
                right: (now.ticks[1] - before.ticks[1]) * per_tick.right,
            };
            let piece = at.progress.piece(&travel, now.time - before.time, from, speeds);
            if piece.moves() {
                let from = at.pose;
                let motion = self.displacement(&piece.at_pose(&from), travel);
                at.pose.advance(&motion);
                if let Some(growth) = &self.table.growth {
                    at.spread = at.spread.after(&from, &motion, travel.rolled(), &at.pose, growth);
                }
            }
            at.speeds = speeds;
            at.count += 1;
            if !self.reads_speed {
                at.cursors = [at.count - 1; 2];
            }
        }
    }

    /// Speeds of the wheels at a time \[m/s\]; the cursors go on to the ends of its window.
    fn speeds(&self, at: &mut Settled, time: f64, last: f64) -> [f64; 2] {
        let newest = self.count - 1;
        let ends = window(time, self.first, last);
        let mut ticks = [[0.0; 2]; 2];
        for ((cursor, end), ticks) in at.cursors.iter_mut().zip(ends).zip(&mut ticks) {
            while *cursor < newest && self.reading(*cursor + 1).time <= end {
                *cursor += 1;
            }
            *ticks = between(self.reading(*cursor), self.reading((*cursor + 1).min(newest)), end);
        }
        speeds(ends, ticks[0], ticks[1], &self.table.nominal.metres_per_tick)
    }

    /// True motion of the body for a believed wheel travel.
    fn displacement(&self, at: &Here, believed: WheelTravel) -> Displacement2 {
        let mut travel = believed;
        for step in self.table.steps() {
            if let Acts::Wheels(change) = step.law.acts {
                change(step.values, at, &mut travel);
            }
        }
        let mut motion = travel.displacement(self.table.nominal.wheelbase);
        for step in self.table.steps() {
            if let Acts::Body(change) = step.law.acts {
                change(step.values, at, &mut motion);
            }
        }
        motion
    }
}

impl Table<'_> {
    /// The counters after another reading.
    fn counted(&self, known: Option<&Counters>, raw: [f64; 2]) -> Counters {
        let Table { gearing, columns, counter_bits, nominal, .. } = self;
        let before =
            known.copied().unwrap_or(Counters { origin: raw, raw, total: [0.0; 2], wired: [0.0; 2], ticks: [0.0; 2] });
        let angle = gearing.steers().then_some(usize::from(!columns.exchanged));
        let total = [0, 1].map(|column| match counter_bits {
            Some(bits) if angle == Some(column) => roll_over(0, raw[column] as i64, *bits) as f64,
            None if angle == Some(column) => raw[column],
            Some(bits) => before.total[column] + roll_over(before.raw[column] as i64, raw[column] as i64, *bits) as f64,
            None => raw[column] - before.origin[column],
        });
        let turned = [0, 1].map(|column| if columns.backward[column] { -total[column] } else { total[column] });
        let wired = if columns.exchanged { [turned[1], turned[0]] } else { turned };
        let ticks = match gearing {
            Gearing::Wheels(_) => wired,
            _ => {
                let from = if known.is_some() { before.wired } else { wired };
                let rolled = gearing.travel(nominal.wheelbase, from, wired);
                let per_tick = &nominal.metres_per_tick;
                [before.ticks[0] + rolled.left / per_tick.left, before.ticks[1] + rolled.right / per_tick.right]
            }
        };
        Counters { origin: before.origin, raw, total, wired, ticks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::TABLE;
    use core::f64::consts::PI;

    /// E_d = 1.002 and E_b = 0.99 as the paper defines them.
    #[test]
    fn a_leg_bends_and_a_turn_ends_as_wheels_and_wheelbase_say() {
        let table = Table::read(&TABLE).unwrap();
        let tick = PI * 0.15 / 2000.0;
        let mut odometer = Odometer::<2>::begin(&table);
        odometer.update(5.0, [100.0, -20.0]).unwrap();
        let leg = odometer.update(6.0, [4100.0, 3980.0]).unwrap();
        let [left, right] = [2.0 / 2.002, 2.004 / 2.002].map(|ratio| 4000.0 * tick * ratio);
        assert!((leg.pose.heading - (right - left) / (0.34 * 0.99)).abs() < 1e-12, "{leg:?}");
        let turn = odometer.update(7.0, [3100.0, 4980.0]).unwrap();
        let turned = 1000.0 * tick * 2.0 / (0.34 * 0.99);
        assert!((turn.pose.heading - leg.pose.heading - turned).abs() < 1e-12, "{turn:?}");
        assert_eq!((turn.time, odometer.ahead().unwrap()), (7.0, turn));
        // Noise of the heading: 0.0015 rad per root metre, 0.001 per root radian.
        let heading = leg.spread.unwrap().heading;
        assert!((heading - (2.25e-6 * (0.5 * (left + right)) + 1e-6 * leg.pose.heading)).abs() < 1e-15, "{heading:e}");
    }

    #[test]
    fn a_bad_reading_is_refused_and_nothing_is_lost() {
        let table = Table::read(&TABLE).unwrap();
        let [mut odometer, mut spared] = [0; 2].map(|_| Odometer::<2>::begin(&table));
        for k in 0..20 {
            let (time, counts) = (f64::from(k), [f64::from(30 * k), f64::from(31 * k)]);
            assert_eq!(odometer.update(time, counts), spared.update(time, counts));
            for (time, counts, error) in [
                (time, counts, UpdateError::Time),
                (time - 0.1, counts, UpdateError::Time),
                (f64::INFINITY, counts, UpdateError::Time),
                (time + 0.1, [f64::NAN, 0.0], UpdateError::Count),
                (time + 0.1, [0.0, 1e16], UpdateError::Count),
            ] {
                assert_eq!(odometer.update(time, counts), Err(error));
            }
        }
        let mut rolling = table;
        rolling.counter_bits = Some(16);
        assert_eq!(Odometer::<2>::begin(&rolling).update(0.0, [0.5, 0.0]), Err(UpdateError::Count));
    }

    #[test]
    fn numbers_that_lead_nowhere_lose_the_pose_and_say_so() {
        let mut bad = TABLE;
        // E_b = 0: no robot has it, and the table does not know.
        bad[29] = 0.0;
        let table = Table::read(&bad).unwrap();
        let mut odometer = Odometer::<2>::begin(&table);
        odometer.update(0.0, [0.0, 0.0]).unwrap();
        assert_eq!(odometer.update(1.0, [0.0, 100.0]), Err(UpdateError::Lost));
    }

    #[test]
    fn counters_that_roll_over_go_on() {
        let mut table = Table::read(&TABLE).unwrap();
        let plain = table;
        table.counter_bits = Some(8);
        let (mut rolling, mut odometer) = (Odometer::<2>::begin(&table), Odometer::<2>::begin(&plain));
        for k in 0..100 {
            let count = 40 * k - 700;
            let shown = f64::from(count & 255);
            let found = rolling.update(f64::from(k), [shown, shown]).unwrap();
            assert_eq!(found, odometer.update(f64::from(k), [f64::from(count); 2]).unwrap());
        }
    }
}
