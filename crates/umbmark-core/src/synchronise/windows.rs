//! Displacements over short windows, by the track and by the ticks, as a least-squares problem.
//!
//! In a window the tracked body moves by u (in its own frame at the window's start) and turns by α. The ticks say d and β. With
//! lever arm l and yaw δ of the body on the robot, scale c, turning gain g and drift k of the nominal robot:
//!
//! ```text
//! u = R(-δ) (c d + (R(α) - 1) l),    α = g β + k d_x
//! ```
//!
//! Without measured headings only |u| is compared, and the lever arm is taken to lie ahead.

use super::coarse::Guess;
use super::motion::Motion;
use crate::fit::Problem;
use crate::geometry::Pose2;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::ops::Range;

/// Places of the clock among the parameters.
pub(super) const OFFSET: usize = 0;
pub(super) const RATE: usize = 1;
/// The others, before those that the data cannot show are left out.
const SCALE: usize = 2;
const GAIN: usize = 3;
const DRIFT: usize = 4;
const AHEAD: usize = 5;
const LEFT: usize = 6;
const YAW: usize = 7;
const ALL: usize = 8;

/// Length of a window \[s\], where both are sampled faster.
const LENGTH: f64 = 0.4;
/// Windows begin so many times in their length.
const OVERLAP: f64 = 4.0;
/// More windows tell nothing more.
const MAX_WINDOWS: usize = 4000;
/// Less turning \[rad\] and driving \[m\] in all do not show lever arm and yaw.
const LEAST_TURN: f64 = 1.0;
const LEAST_WAY: f64 = 0.2;

/// The windows of a run.
pub(super) struct Windows<'m> {
    ticks: &'m Motion,
    has_heading: bool,
    arm: f64,
    /// Start and end by the track's clock, and what the track says of the motion between.
    seen: Vec<(f64, f64, Pose2)>,
    /// Which of all the parameters are fitted.
    active: Vec<usize>,
}

impl<'m> Windows<'m> {
    pub fn new(ticks: &'m Motion, track: &Motion, guess: &Guess, arm: f64) -> Windows<'m> {
        let length = LENGTH.max(2.0 * track.period).max(2.0 * ticks.period);
        let span = track.last() - track.first();
        let step = (length / OVERLAP).max(span / MAX_WINDOWS as f64);
        let middle = 0.5 * (ticks.first() + ticks.last());
        let tick_time = |time: f64| middle + (time - guess.offset) / guess.rate;
        let mut seen = Vec::new();
        let mut next = track.first();
        for (i, from) in track.time.iter().copied().enumerate() {
            if from < next {
                continue;
            }
            next = (next + step).max(from);
            let j = track.time.partition_point(|t| *t < from + length - 0.5 * track.period);
            let Some(to) = track.time.get(j).copied().filter(|to| *to < from + 1.5 * length) else { continue };
            let (begin, end) = (tick_time(from) - length, tick_time(to) + length);
            let known = end > ticks.first() && begin < ticks.last() && !ticks.has_gap(begin, end);
            if known {
                seen.push((from, to, track.poses[i].between(&track.poses[j])));
            }
        }
        let active = active(ticks, track.has_heading);
        Windows { ticks, has_heading: track.has_heading, arm, seen, active }
    }

    pub fn len(&self) -> usize {
        self.seen.len()
    }

    pub fn middle(&self) -> f64 {
        0.5 * (self.ticks.first() + self.ticks.last())
    }

    pub fn half_span(&self) -> f64 {
        0.5 * (self.ticks.last() - self.ticks.first())
    }

    /// Where lever arm (ahead, left) and yaw stand among the fitted parameters.
    pub fn places(&self) -> [Option<usize>; 3] {
        [AHEAD, LEFT, YAW].map(|parameter| self.active.iter().position(|a| *a == parameter))
    }

    /// Way and turning by the track over those by the ticks.
    pub fn scales(&self, parameters: &[f64]) -> [f64; 2] {
        let all = self.full(parameters);
        [all[SCALE], all[GAIN]]
    }

    /// Start values: the guess, a perfect robot, no lever arm, and the best of 24 yaws.
    pub fn start(&self, guess: &Guess) -> Vec<f64> {
        let mut all = [guess.offset, guess.rate, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        let fitted = |all: &[f64; ALL]| self.active.iter().map(|a| all[*a]).collect::<Vec<f64>>();
        if !self.active.contains(&YAW) {
            return fitted(&all);
        }
        let cost = |yaw: f64| {
            let mut tried = all;
            tried[YAW] = yaw;
            self.residuals(&fitted(&tried)).norm_squared()
        };
        let yaws = (-12..12).map(|i| f64::from(i) * PI / 12.0);
        all[YAW] = yaws.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(0.0);
        fitted(&all)
    }

    /// Drops the windows whose residuals are `times` the median one.
    pub fn leave_out(&mut self, residuals: &DVector<f64>, times: f64) {
        let rows = self.rows();
        let size: Vec<f64> = (0..self.len()).map(|i| residuals.rows(i * rows, rows).norm()).collect();
        let mut sorted = size.clone();
        let middle = sorted.len() / 2;
        let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
        let mut size = size.into_iter();
        self.seen.retain(|_| size.next().is_none_or(|size| size <= times * median.max(1e-6)));
    }

    /// Residuals of each of `count` stretches of about the same number of windows.
    pub fn blocks(&self, count: usize) -> Vec<Range<usize>> {
        let edge = |i: usize| self.rows() * (i * self.len() / count);
        (0..count).map(|i| edge(i)..edge(i + 1)).collect()
    }

    /// Residuals of a window.
    fn rows(&self) -> usize {
        if self.has_heading { 3 } else { 1 }
    }

    fn full(&self, parameters: &[f64]) -> [f64; ALL] {
        let mut all = [0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        for (place, value) in self.active.iter().zip(parameters) {
            all[*place] = *value;
        }
        all
    }

    /// What the ticks say that the track should see.
    fn predicted(&self, p: &[f64; ALL], from: f64, to: f64) -> Pose2 {
        let [from, to] = [from, to].map(|time| self.ticks.at(self.middle() + (time - p[OFFSET]) / p[RATE]));
        let moved = from.between(&to);
        let turn = p[GAIN] * moved.heading + p[DRIFT] * moved.x;
        let (sine, cosine) = (libm::sin(turn), libm::cos(turn));
        let x = p[SCALE] * moved.x + (cosine - 1.0) * p[AHEAD] - sine * p[LEFT];
        let y = p[SCALE] * moved.y + sine * p[AHEAD] + (cosine - 1.0) * p[LEFT];
        Pose2::new(0.0, 0.0, p[YAW]).between(&Pose2::new(x, y, turn + p[YAW]))
    }
}

impl Problem for Windows<'_> {
    fn residuals(&self, parameters: &[f64]) -> DVector<f64> {
        let p = self.full(parameters);
        let each = self.seen.iter().flat_map(|(from, to, seen)| {
            let expected = self.predicted(&p, *from, *to);
            let residuals = if self.has_heading {
                [seen.x - expected.x, seen.y - expected.y, self.arm * (seen.heading - expected.heading)]
            } else {
                [libm::hypot(seen.x, seen.y) - libm::hypot(expected.x, expected.y), 0.0, 0.0]
            };
            residuals.into_iter().take(self.rows())
        });
        DVector::from_iterator(self.rows() * self.len(), each)
    }

    /// By central differences, for the clock over half a tick's period: interpolated motion has corners at the samples.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let step = |place: usize| match self.active[place] {
            OFFSET => 0.5 * self.ticks.period,
            RATE => 0.5 * self.ticks.period / self.half_span(),
            _ => 1e-6,
        };
        let columns: Vec<DVector<f64>> = (0..parameters.len())
            .map(|place| {
                let at = |sign: f64| {
                    let mut moved = parameters.to_vec();
                    moved[place] += sign * step(place);
                    self.residuals(&moved)
                };
                (at(1.0) - at(-1.0)) / (2.0 * step(place))
            })
            .collect();
        DMatrix::from_columns(&columns)
    }
}

/// The parameters that the motion can show.
fn active(ticks: &Motion, has_heading: bool) -> Vec<usize> {
    let pairs = || ticks.poses.windows(2).map(|pair| pair[0].between(&pair[1]));
    let turn: f64 = pairs().map(|moved| moved.heading.abs()).sum();
    let way: f64 = pairs().map(|moved| libm::hypot(moved.x, moved.y)).sum();
    let (turns, drives) = (turn > LEAST_TURN, way > LEAST_WAY);
    let shown = |parameter: &usize| match *parameter {
        SCALE => drives,
        GAIN => turns && has_heading,
        DRIFT | YAW => drives && has_heading,
        AHEAD => turns,
        LEFT => turns && has_heading,
        _ => true,
    };
    (0..ALL).filter(shown).collect()
}
