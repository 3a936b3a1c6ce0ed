//! The motion of a run cut into short windows, as the reference measured it and as the wheels rolled.

use super::low_pass::LowPass;
use crate::drive::{Robot, WheelTravel};
use crate::geometry::wrap;
use crate::run::TickLog;
use crate::run::resolution::hidden;

/// Length of a window \[s\], where both are sampled faster.
const LENGTH: f64 = 0.4;
/// Maximum length of a window \[s\]: the motion in it is treated as one arc.
const LONGEST: f64 = 2.5;
/// Windows overlap by half; maximum number per run.
const OVERLAP: f64 = 2.0;
const MAX_WINDOWS: usize = 600;

/// The motion that the reference measured between two of its poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Window {
    /// Time stamps of the two \[s\].
    pub from: f64,
    pub to: f64,
    /// How far the tracked point moved in the room \[m\].
    pub moved: [f64; 2],
    /// Heading at the beginning and rotation \[rad\]: as measured or, without headings, of the direction of motion.
    pub heading: f64,
    pub turned: f64,
    /// The rotation including full turns, as recorded.
    pub raw_turn: f64,
    /// Whether headings were measured; otherwise they follow from the direction of motion.
    pub with_heading: bool,
    /// Whether nothing but headings was measured.
    pub headings_only: bool,
}

impl Window {
    /// The same, if its headings are in another unit, which is so many radians.
    pub fn with_headings_times(&self, factor: f64) -> Window {
        Window { heading: factor * self.heading, turned: wrap(factor * self.raw_turn), ..*self }
    }
}

/// The windows of a run; empty if its poses are too few or too far apart.
pub(super) fn windows(log: &TickLog) -> Vec<Window> {
    let time: Vec<f64> = log.reference.iter().map(|pose| log.time[pose.sample]).collect();
    if time.len() < 4 {
        return Vec::new();
    }
    let with_heading = log.reference.iter().all(|pose| pose.heading.is_some());
    let length = LENGTH.max(2.0 * usual_step(&time)).max(2.0 * usual_step(&log.time));
    let step = (length / OVERLAP).max((time[time.len() - 1] - time[0]) / MAX_WINDOWS as f64);
    let (sine, cosine) = libm::sincos(log.start.heading);
    let (mut windows, mut next) = (Vec::new(), time[0]);
    for (i, from) in time.iter().enumerate() {
        if *from < next {
            continue;
        }
        next = (next + step).max(*from);
        let j = time.partition_point(|t| *t < from + length - 1e-9);
        let Some(to) = time.get(j).filter(|to| **to <= from + LONGEST.min(2.0 * length)) else { continue };
        let (a, b) = (&log.reference[i], &log.reference[j]);
        // In the frame of the file, because a fault of the headings there looks different in the frame of each START.
        let (x, y) = (b.x - a.x, b.y - a.y);
        let moved = [cosine * x - sine * y, sine * x + cosine * y];
        let (heading, raw_turn) = match (a.heading, b.heading) {
            (Some(from), Some(to)) if with_heading => (from + log.start.heading, to - from),
            _ => (0.0, 0.0),
        };
        let (turned, headings_only) = (wrap(raw_turn), log.headings_only);
        windows.push(Window { from: *from, to: *to, moved, heading, turned, raw_turn, with_heading, headings_only });
    }
    if with_heading { windows } else { by_course(windows) }
}

/// Windows with the direction of motion in place of a heading: that halfway between the previous and the next window. A window without
/// motion has none.
fn by_course(windows: Vec<Window>) -> Vec<Window> {
    let course = |w: &Window| libm::atan2(w.moved[1], w.moved[0]);
    let way = |w: &Window| libm::hypot(w.moved[0], w.moved[1]);
    let usual = crate::stats::robust::median(windows.iter().map(way));
    let around = |three: &[Window]| {
        let [before, own, after] = three else { return None };
        let turned = wrap(course(after) - course(before));
        let near = after.from - before.from < 2.0 * LONGEST;
        // Time from the middle of the previous window to that of the next one, in window lengths.
        let share = (own.to - own.from) / (after.from - before.from).max(f64::MIN_POSITIVE);
        let turned = turned * share;
        let driven = three.iter().all(|w| way(w) > 0.3 * usual) && turned.abs() < 1.0;
        (near && driven).then_some(Window { heading: course(own) - 0.5 * turned, turned, raw_turn: turned, ..*own })
    };
    windows.windows(3).filter_map(around).collect()
}

/// The median step \[s\].
pub(super) fn usual_step(time: &[f64]) -> f64 {
    crate::stats::robust::median(time.windows(2).map(|pair| pair[1] - pair[0]))
}

/// How the wheels rolled between two times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rolling {
    /// Travel of the left and the right wheel \[m\].
    pub travel: [f64; 2],
    /// Motion to the left \[m\], of a drive that moves sideways.
    pub aside: f64,
    /// ½ ∫ (r dl - l dr), l and r being the travel since the earlier time: 0 where both wheels roll in one proportion throughout, as on
    /// an arc, and positive where the robot turns left first and drives ahead afterwards \[m²\].
    pub area: f64,
}

/// Counters are coarse if a travel is uncertain by this \[m\].
const COARSE: f64 = 2.5e-4;
/// Their counts are averaged over this time before and after \[s\], or over two readings where these take longer.
const LONG: f64 = 0.1;

/// How far the wheels have rolled by any time, as the counts say.
pub(super) struct Rolled<'a> {
    times: &'a [f64],
    /// How far the left and the right wheel roll in one count \[m\]; 0 where readings are not whole counts.
    pub counts: [f64; 2],
    /// Travel of both wheels from the first sample to each \[m\]. That of coarse counters is smooth: the line between two readings is nearer
    /// to the wheels in its middle than at the readings, so a delay of half a reading would seem to agree best.
    travel: Vec<[f64; 2]>,
    /// Way to the left since START at each sample \[m\]; nothing of a drive that does not move sideways.
    asides: Vec<f64>,
    /// ½ ∫ (r dl - l dr) from the first sample to each \[m²\].
    areas: Vec<f64>,
    /// Samples a second, on average.
    rate: f64,
}

/// Travel of both wheels since the first sample \[m\], and the area up to there \[m²\].
type Rolls = ([f64; 2], f64);

impl<'a> Rolled<'a> {
    pub fn new(log: &'a TickLog, robot: &Robot) -> Rolled<'a> {
        let times = &log.time[..];
        let span = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
        let rate = if span > 0.0 { (times.len() - 1) as f64 / span } else { 0.0 };
        let WheelTravel { left, right } = robot.metres_per_tick();
        let counted = log.left.iter().zip(&log.right);
        let travel = counted.map(|(l, r)| [(l - log.left[0]) * left, (r - log.right[0]) * right]).collect();
        let (counts, areas) = (log.count_lengths(robot), vec![0.0; times.len()]);
        let asides = log.asides(robot).into_iter().map(|[way, _]| way).collect();
        let mut rolled = Rolled { times, counts, travel, asides, areas, rate };
        if rolled.uncertain(robot.drive.wheelbase()) > COARSE {
            let readings: Vec<f64> = (0..times.len()).filter(|k| !log.is_put_in(*k)).map(|k| times[k]).collect();
            rolled.travel = rolled.smooth(LONG.max(2.0 * usual_step(&readings)));
        }
        rolled.with_areas()
    }

    fn with_areas(mut self) -> Rolled<'a> {
        for sample in 1..self.times.len() {
            self.areas[sample] = self.areas[sample - 1] + swept(self.travel[sample - 1], self.travel[sample]);
        }
        self
    }

    /// The same behind a low-pass filter of a time constant \[s\].
    pub fn filtered(&self, time_constant: f64) -> Rolled<'a> {
        let mut travel = LowPass::<2>::new(time_constant);
        let mut aside = LowPass::<1>::new(time_constant);
        let areas = vec![0.0; self.times.len()];
        let travel = self.times.iter().zip(&self.travel).map(|(time, now)| travel.follow(*time, *now)).collect();
        let asides = self.times.iter().zip(&self.asides).map(|(time, now)| aside.follow(*time, [*now])[0]).collect();
        Rolled { travel, asides, areas, ..*self }.with_areas()
    }

    /// Standard deviation of a travel that whole counts at both ends make \[m\], of a coordinate of the robot.
    pub fn uncertain(&self, wheelbase: f64) -> f64 {
        hidden(self.counts, [2.0; 2], wheelbase)[0].sqrt()
    }

    /// The travel of each sample, averaged over this time before and after \[s\]; near the ends over less, but as long before as after.
    fn smooth(&self, half: f64) -> Vec<[f64; 2]> {
        // ∫ travel dt.
        let mut sums = vec![[0.0; 2]; self.times.len()];
        for (k, (travel, times)) in (1..).zip(self.travel.windows(2).zip(self.times.windows(2))) {
            let half = 0.5 * (times[1] - times[0]);
            sums[k] = [0, 1].map(|wheel| sums[k - 1][wheel] + half * (travel[0][wheel] + travel[1][wheel]));
        }
        let sum = |time: f64| {
            let (before, now) = self.on_the_line(time);
            let (since, from) = (time - self.times[before], self.travel[before]);
            [0, 1].map(|wheel| sums[before][wheel] + 0.5 * since * (from[wheel] + now[wheel]))
        };
        let of = |(time, own): (&f64, &[f64; 2])| {
            let half = half.min(time - self.times[0]).min(self.times[self.times.len() - 1] - time);
            if half <= 0.0 {
                return *own;
            }
            let (since, until) = (sum(time - half), sum(time + half));
            [0, 1].map(|wheel| (until[wheel] - since[wheel]) / (2.0 * half))
        };
        self.times.iter().zip(&self.travel).map(of).collect()
    }

    /// Number of samples up to a time; the search starts where uniform sampling would place it.
    fn after(&self, time: f64) -> usize {
        let times = self.times;
        let guess = ((time - times[0]) * self.rate) as usize + 1;
        let mut at = guess.min(times.len());
        while at < times.len() && times[at] <= time {
            at += 1;
        }
        while at > 0 && times[at - 1] > time {
            at -= 1;
        }
        at
    }

    /// The sample before a time, and the travel by then: linear between samples, and beyond the ends as in the next one.
    fn on_the_line(&self, time: f64) -> (usize, [f64; 2]) {
        let times = self.times;
        let after = self.after(time).clamp(1, times.len().max(2) - 1);
        let before = after - 1;
        let after = after.min(times.len() - 1);
        let span = times[after] - times[before];
        let share = if span > 0.0 { ((time - times[before]) / span).clamp(-50.0, 50.0) } else { 0.0 };
        let (from, to) = (self.travel[before], self.travel[after]);
        (before, [0, 1].map(|wheel| from[wheel] + share * (to[wheel] - from[wheel])))
    }

    /// By a time.
    fn at(&self, time: f64) -> Rolls {
        let (before, now) = self.on_the_line(time);
        (now, self.areas[before] + swept(self.travel[before], now))
    }

    /// Way to the left by a time, like [`Rolled::on_the_line`].
    fn aside_at(&self, time: f64) -> f64 {
        if self.asides.is_empty() {
            return 0.0;
        }
        let times = self.times;
        let after = self.after(time).clamp(1, times.len().max(2) - 1);
        let (before, after) = (after - 1, after.min(times.len() - 1));
        let span = times[after] - times[before];
        let share = if span > 0.0 { ((time - times[before]) / span).clamp(-50.0, 50.0) } else { 0.0 };
        self.asides[before] + share * (self.asides[after] - self.asides[before])
    }

    /// What lies between two times.
    pub fn between(&self, from: f64, to: f64) -> Rolling {
        let aside = self.aside_at(to) - self.aside_at(from);
        let ((from, before), (to, after)) = (self.at(from), self.at(to));
        Rolling { travel: way(from, to), aside, area: after - before - swept(from, to) }
    }
}

/// Travel of both wheels from one state to another \[m\].
fn way(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}

/// ½ (r Δl - l Δr) of a straight line of both travels \[m²\].
fn swept(from: [f64; 2], to: [f64; 2]) -> f64 {
    let [left, right] = way(from, to);
    0.5 * (from[1] * left - from[0] * right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::ReferencePose;

    /// A circle of radius 2 m, driven at 1 rad/s, seen every 50 ms.
    fn circle(with_heading: bool) -> TickLog {
        let seen = |sample: usize| {
            let angle = 0.05 * sample as f64;
            let (x, y) = (2.0 * libm::sin(angle), 2.0 - 2.0 * libm::cos(angle));
            ReferencePose { sample, x, y, heading: with_heading.then_some(wrap(angle)) }
        };
        let time: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
        let counts = |wheel: f64| time.iter().map(|t| wheel * t).collect();
        TickLog {
            left: counts(1.0),
            right: counts(2.0),
            reference: (0..200).map(seen).collect(),
            time,
            ..TickLog::default()
        }
    }

    #[test]
    fn windows_turn_as_the_course_does_with_measured_headings_and_without() {
        for with_heading in [true, false] {
            let found = windows(&circle(with_heading));
            assert!(found.len() > 40, "{}", found.len());
            for window in found {
                let expected = window.to - window.from;
                assert!((window.turned - expected).abs() < 0.02, "{with_heading} {window:?}");
                // Halfway, the robot heads as the chord does.
                let chord = libm::atan2(window.moved[1], window.moved[0]);
                assert!(wrap(window.heading + 0.5 * window.turned - chord).abs() < 0.02, "{window:?}");
            }
        }
    }

    #[test]
    fn rolled_is_linear_between_samples_and_goes_on_beyond_them() {
        let log = circle(true);
        let robot = Robot::labmate();
        let (rolled, per_tick) = (Rolled::new(&log, &robot), robot.metres_per_tick());
        for time in [-0.1, 0.0, 0.03, 4.999, 9.95, 10.2] {
            let ([left, right], _) = rolled.at(time);
            assert!((left - time * per_tick.left).abs() < 1e-12 && (right - 2.0 * time * per_tick.right).abs() < 1e-12);
        }
    }

    /// The left wheel rolls by l, and then the right one by r: the area is that of a triangle, ½ (0 - l r).
    #[test]
    fn the_area_is_that_between_the_way_of_the_wheels_and_the_straight_one() {
        let time: Vec<f64> = (0..=40).map(|k| 0.1 * f64::from(k)).collect();
        let left: Vec<f64> = time.iter().map(|t| 500.0 * t.min(2.0)).collect();
        let right = time.iter().map(|t| 300.0 * (t - 2.0).max(0.0)).collect();
        let log = TickLog { left, right, time, ..TickLog::default() };
        let robot = Robot::labmate();
        let (rolled, per_tick) = (Rolled::new(&log, &robot), robot.metres_per_tick());
        for (from, to) in [(0.0, 4.0), (1.5, 2.5), (0.73, 3.18)] {
            let Rolling { travel: [left, right], area, .. } = rolled.between(from, to);
            let expected = [500.0 * (2.0 - from) * per_tick.left, 300.0 * (to - 2.0) * per_tick.right];
            assert!((left - expected[0]).abs() < 1e-12 && (right - expected[1]).abs() < 1e-12);
            assert!((area + 0.5 * left * right).abs() < 1e-12, "{area}");
        }
        assert!(rolled.between(0.1, 1.93).area.abs() < 1e-12);
    }
}
