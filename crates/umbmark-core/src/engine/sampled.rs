//! Odometry from counters read at given instants.

use blocks::Blocks;
use directions::Directions;
pub use profile::Profile;
use ramp::Ramps;

use super::oracle::CompensatedSum;
use super::{Instructions, Motion, TickGeometry, WheelLine};
use crate::geometry::{Pose2, Real};

mod blocks;
mod carries;
mod constant_rate;
mod directions;
mod profile;
mod ramp;

/// How the pose is advanced by one change of the counters, of distance d and rotation θ at heading φ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Update {
    /// Along the circular arc: d sinc(θ/2) in direction φ + θ/2. Exact if both wheels kept their speed.
    #[default]
    Arc,
    /// Along the chord's direction with the arc's length: d in direction φ + θ/2, the second-order Runge-Kutta rule.
    Midpoint,
    /// Straight ahead, then turn: d in direction φ.
    Euler,
}

impl Update {
    /// Length \[m\] of the straight step and its direction \[rad\] from the old heading.
    #[inline]
    fn step(self, distance: f64, rotation: f64) -> (f64, f64) {
        let half = 0.5 * rotation;
        match self {
            Update::Arc => (distance * half.sinc_cos().0, half),
            Update::Midpoint => (distance, half),
            Update::Euler => (distance, 0.0),
        }
    }
}

/// Odometry whose counters are read at given instants, as real controllers do.
///
/// Between two readings only the changes of the counts are known; [`Update`] says how the pose follows them. The heading
/// is that of the counts, whatever the update.
///
/// Cloning gives every thread its own scratch memory; results do not depend on what was computed before.
#[derive(Clone, Debug)]
pub struct SampledOdometry {
    geometry: TickGeometry,
    update: Update,
    instructions: Instructions,
    directions: Directions,
    blocks: Blocks,
    ramps: Ramps,
}

impl SampledOdometry {
    /// Odometry with these tick lengths, this wheelbase and this update.
    pub fn new(geometry: TickGeometry, update: Update) -> SampledOdometry {
        SampledOdometry {
            geometry,
            update,
            instructions: Instructions::best(),
            directions: Directions::default(),
            blocks: Blocks::default(),
            ramps: Ramps::default(),
        }
    }

    /// The same odometry, with registers no wider than these: the same bits, maybe slower.
    pub fn limited_to(self, instructions: Instructions) -> SampledOdometry {
        SampledOdometry { instructions: self.instructions.min(instructions), ..self }
    }

    /// What a tick is worth.
    pub fn geometry(&self) -> &TickGeometry {
        &self.geometry
    }

    /// How the pose follows the counts.
    pub fn update(&self) -> Update {
        self.update
    }

    /// A pose at the origin, waiting for the first reading; for readings that go on across segments.
    pub fn track(&self) -> CounterTrack {
        CounterTrack {
            geometry: self.geometry,
            update: self.update,
            counts: [0; 2],
            x: CompensatedSum::default(),
            y: CompensatedSum::default(),
        }
    }

    /// The motion reported by successive readings of the (left, right) counters, which start at \[0, 0\].
    pub fn from_counts(&self, readings: impl IntoIterator<Item = [i64; 2]>) -> Motion {
        let mut track = self.track();
        readings.into_iter().for_each(|counts| track.read(counts));
        track.motion()
    }

    /// The motion reported along `line` when the counters are read where the given fractions of its travel are done.
    ///
    /// This is how acceleration enters; what fractions mean is said at [`Profile::new`].
    ///
    /// ```
    /// use umbmark_core::engine::{SampledOdometry, TickGeometry, Update, WheelLine};
    /// let odometry = SampledOdometry::new(TickGeometry::new(1e-3, 1e-3, 0.34)?, Update::Arc);
    /// let line = WheelLine::from_ticks([0.0, 0.0], [500.0, 520.0])?;
    /// // From rest to rest in 50 readings, the speed a triangle.
    /// let ramp = (1..=50).map(|k| f64::from(k) / 50.0).map(|t| if t < 0.5 { 2.0 * t * t } else { 1.0 - 2.0 * (1.0 - t) * (1.0 - t) });
    /// let motion = odometry.with_profile(&line, ramp);
    /// assert!((motion.pose.heading - 0.02 / 0.34).abs() < 1e-15);
    /// # Ok::<(), umbmark_core::engine::EngineError>(())
    /// ```
    pub fn with_profile(&self, line: &WheelLine, fractions: impl IntoIterator<Item = f64>) -> Motion {
        self.from_counts(Profile::new(fractions).counts(line))
    }
}

/// A pose that follows the readings of two counters.
#[derive(Clone, Debug)]
pub struct CounterTrack {
    geometry: TickGeometry,
    update: Update,
    counts: [i64; 2],
    x: CompensatedSum,
    y: CompensatedSum,
}

impl CounterTrack {
    /// Takes the next reading of the cumulative (left, right) counts.
    #[inline]
    pub fn read(&mut self, counts: [i64; 2]) {
        let change = [0, 1].map(|i| counts[i] - self.counts[i]);
        let (length, turned) = self.update.step(self.geometry.distance(change), self.geometry.heading(change));
        let (sine, cosine) = (self.geometry.heading(self.counts) + turned).sine_cosine();
        self.x.add(length * cosine);
        self.y.add(length * sine);
        self.counts = counts;
    }

    /// The last reading.
    pub fn counts(&self) -> [i64; 2] {
        self.counts
    }

    /// The pose after the last reading, as seen from where the track began.
    pub fn pose(&self) -> Pose2 {
        self.motion().pose
    }

    /// The motion from where the track began to the last reading.
    pub fn motion(&self) -> Motion {
        Motion::with_counts(self.x.value(), self.y.value(), self.counts, &self.geometry)
    }
}

#[cfg(test)]
mod tests;
