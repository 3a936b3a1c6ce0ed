//! Readings at equal fractions of the travel: a wheel's count changes by one of two neighbouring whole numbers.

use super::blocks::Blocks;
use super::{SampledOdometry, Update};
use crate::engine::{Motion, TickGeometry, WheelLine};
use crate::geometry::Real;

/// A line cut into equal pieces, both wheels mirrored forward.
///
/// The phase of a wheel before reading i is start + i rate in units of 2^-64 tick, where the rate is the travel divided
/// by the number of readings and rounded up. The rounding adds up to less than 2^-32 tick over all readings, so that the
/// counts at the end are those of the line; up to 2^16 readings every count on the way is that of the exact quotient too.
#[derive(Clone, Copy, Debug)]
pub(super) struct EqualPieces {
    /// Phases within a tick, units of 2^-64.
    pub phase: [u64; 2],
    /// Whole ticks per reading.
    pub whole: [i64; 2],
    /// What is left of the rate, units of 2^-64 tick: a reading counts one tick more when this carries.
    pub rest: [u64; 2],
    /// 1 forward, -1 backward.
    pub sign: [i64; 2],
    pub readings: u32,
}

impl EqualPieces {
    /// `readings` must not be 0.
    pub fn new(line: &WheelLine, readings: u32) -> EqualPieces {
        let forward = line.mirrored_forward();
        let rate = forward.travel().map(|travel| {
            // travel 2^32 / readings, in two divisions of 64 bits.
            let (travel, readings) = (travel as u64, u64::from(readings));
            let rest = (travel % readings) << 32;
            (u128::from(travel / readings) << 32 | u128::from(rest / readings)) + u128::from(rest % readings != 0)
        });
        EqualPieces {
            phase: forward.start().map(|start| (start as u64) << 32),
            whole: rate.map(|rate| (rate >> 64) as i64),
            rest: rate.map(|rate| rate as u64),
            sign: line.backward().map(|backward| if backward { -1 } else { 1 }),
            readings,
        }
    }

    /// What the four kinds of readings do, by left carry + 2 right carry.
    pub fn steps(&self, geometry: &TickGeometry, update: Update) -> [PoseIncrement; 4] {
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|carries| {
            let change = [0, 1].map(|i| self.sign[i] * (self.whole[i] + carries[i]));
            PoseIncrement::new(geometry, update, change)
        })
    }
}

/// What one reading does to the pose: a step in the old frame, then a rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseIncrement {
    pub x: f64,
    pub y: f64,
    pub cosine: f64,
    pub sine: f64,
}

impl PoseIncrement {
    pub const IDENTITY: PoseIncrement = PoseIncrement { x: 0.0, y: 0.0, cosine: 1.0, sine: 0.0 };

    pub fn new(geometry: &TickGeometry, update: Update, change: [i64; 2]) -> PoseIncrement {
        let rotation = geometry.heading(change);
        let (length, turned) = update.step(geometry.distance(change), rotation);
        let (side, ahead) = turned.sine_cosine();
        let (sine, cosine) = rotation.sine_cosine();
        PoseIncrement { x: length * ahead, y: length * side, cosine, sine }
    }

    /// This step, then `next`.
    #[inline(always)]
    pub fn then(&self, next: &PoseIncrement) -> PoseIncrement {
        let PoseIncrement { x, y, cosine, sine } = *self;
        PoseIncrement {
            x: x + (cosine * next.x - sine * next.y),
            y: y + (sine * next.x + cosine * next.y),
            cosine: cosine * next.cosine - sine * next.sine,
            sine: sine * next.cosine + cosine * next.sine,
        }
    }
}

impl SampledOdometry {
    /// The motion reported along `line` when the counters are read `readings` times at equal fractions of its travel, the
    /// last time at its end. Without any reading nothing is reported.
    ///
    /// ```
    /// use umbmark_core::engine::{SampledOdometry, TickGeometry, Update, WheelLine};
    /// let mut odometry = SampledOdometry::new(TickGeometry::new(1e-3, 1e-3, 0.34)?, Update::Arc);
    /// let line = WheelLine::from_ticks([0.0, 0.0], [4000.0, 4000.0])?;
    /// assert_eq!(odometry.at_constant_rate(&line, 2000).pose.y, 0.0);
    /// # Ok::<(), umbmark_core::engine::EngineError>(())
    /// ```
    pub fn at_constant_rate(&mut self, line: &WheelLine, readings: u32) -> Motion {
        if readings == 0 {
            return Motion::IDENTITY;
        }
        let (pieces, counts) = (EqualPieces::new(line, readings), line.counts());
        if !Blocks::suit(&self.geometry, &pieces, counts) {
            return self.one_by_one(line, readings);
        }
        self.directions.reach_to(counts, &self.geometry);
        let (x, y) = self.blocks.end(&self.geometry, self.update, self.instructions, &self.directions, &pieces);
        Motion::with_counts(x, y, counts, &self.geometry)
    }

    /// The same, always reading by reading; equal to within rounding.
    pub fn one_by_one(&self, line: &WheelLine, readings: u32) -> Motion {
        if readings == 0 {
            return Motion::IDENTITY;
        }
        let pieces = EqualPieces::new(line, readings);
        let (x, y) = one_by_one(&self.geometry, self.update, &pieces);
        Motion::with_counts(x, y, line.counts(), &self.geometry)
    }
}

/// Four steps worked out beforehand, chosen by the two carries; the direction is a rotating unit vector.
fn one_by_one(geometry: &TickGeometry, update: Update, pieces: &EqualPieces) -> (f64, f64) {
    let steps = pieces.steps(geometry, update);
    let ([mut left, mut right], [left_rest, right_rest]) = (pieces.phase, pieces.rest);
    let mut motion = PoseIncrement::IDENTITY;
    for _ in 0..pieces.readings {
        let (left_carry, right_carry);
        (left, left_carry) = left.overflowing_add(left_rest);
        (right, right_carry) = right.overflowing_add(right_rest);
        motion = motion.then(&steps[usize::from(left_carry) + 2 * usize::from(right_carry)]);
    }
    (motion.x, motion.y)
}
