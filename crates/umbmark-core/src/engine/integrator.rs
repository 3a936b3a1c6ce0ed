//! A common interface to all kinds of odometry.

use super::{Instructions, Motion, SampledOdometry, TickGeometry, TickOdometry, Update, WheelLine, oracle};

/// When the counters are read, and by which algorithm the motion is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// At every tick, by the product over the word: [`TickOdometry`].
    EveryTick,
    /// At every tick, one after the other: the [`oracle`], thousands of times slower, to check the above.
    EveryTickOneByOne,
    /// At the readings of each segment: [`SampledOdometry`].
    Sampled(Update),
    /// At the readings of each segment, one after the other, to check the above.
    SampledOneByOne(Update),
}

/// A straight piece of wheel motion and how often the counters are read along it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Segment {
    /// The motion of the wheels.
    pub line: WheelLine,
    /// Readings at equal fractions of the travel, the last one at the end; ignored by tick-exact odometry.
    pub readings: u32,
}

impl Segment {
    /// A segment for odometry that is updated at every tick.
    pub fn every_tick(line: WheelLine) -> Segment {
        Segment { line, readings: 0 }
    }

    /// A segment whose counters are read this many times.
    pub fn sampled(line: WheelLine, readings: u32) -> Segment {
        Segment { line, readings }
    }
}

impl AsRef<WheelLine> for Segment {
    fn as_ref(&self) -> &WheelLine {
        &self.line
    }
}

/// Odometry: segments of wheel motion in, motions of the robot as its counters report them out.
///
/// Clone it for every thread. Results depend on the segment alone: not on what was computed before, in which order, on
/// which thread or on which processor.
#[derive(Clone, Debug)]
pub struct Integrator {
    kind: Engine,
}

#[derive(Clone, Debug)]
enum Engine {
    EveryTick(TickOdometry),
    EveryTickOneByOne(TickGeometry),
    Sampled(SampledOdometry),
    SampledOneByOne(SampledOdometry),
}

impl Integrator {
    /// An integrator with these tick lengths and this wheelbase.
    pub fn new(geometry: TickGeometry, method: Method) -> Integrator {
        let kind = match method {
            Method::EveryTick => Engine::EveryTick(TickOdometry::new(geometry)),
            Method::EveryTickOneByOne => Engine::EveryTickOneByOne(geometry),
            Method::Sampled(update) => Engine::Sampled(SampledOdometry::new(geometry, update)),
            Method::SampledOneByOne(update) => Engine::SampledOneByOne(SampledOdometry::new(geometry, update)),
        };
        Integrator { kind }
    }

    /// The same integrator, with registers no wider than these: the same bits, maybe slower.
    pub fn limited_to(self, instructions: Instructions) -> Integrator {
        let kind = match self.kind {
            Engine::EveryTick(odometry) => Engine::EveryTick(odometry.limited_to(instructions)),
            Engine::Sampled(odometry) => Engine::Sampled(odometry.limited_to(instructions)),
            one_by_one => one_by_one,
        };
        Integrator { kind }
    }

    /// What a tick is worth.
    pub fn geometry(&self) -> &TickGeometry {
        match &self.kind {
            Engine::EveryTick(odometry) => odometry.geometry(),
            Engine::EveryTickOneByOne(geometry) => geometry,
            Engine::Sampled(odometry) | Engine::SampledOneByOne(odometry) => odometry.geometry(),
        }
    }

    /// The motion that the counters report for `segment`.
    #[inline]
    pub fn motion(&mut self, segment: &Segment) -> Motion {
        match &mut self.kind {
            Engine::EveryTick(odometry) => odometry.motion(&segment.line),
            Engine::EveryTickOneByOne(geometry) => oracle::motion(geometry, &segment.line),
            Engine::Sampled(odometry) => odometry.at_constant_rate(&segment.line, segment.readings),
            Engine::SampledOneByOne(odometry) => odometry.one_by_one(&segment.line, segment.readings),
        }
    }

    /// The motions that the counters report for `segments`, into the `motions` of the same places.
    ///
    /// The same bits as one by one, faster where the machine has lanes. Only as many are computed as the shorter of the
    /// two slices has.
    pub fn motions(&mut self, segments: &[Segment], motions: &mut [Motion]) {
        match &mut self.kind {
            Engine::EveryTick(odometry) => odometry.motions(segments, motions),
            _ => segments.iter().zip(motions).for_each(|(segment, motion)| *motion = self.motion(segment)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::random_lines::{Source, cases};

    fn segments(source: &mut Source) -> Vec<Segment> {
        let count = cases(1_000);
        (0..count).map(|_| Segment::sampled(source.line(5_000), source.below(400) as u32)).collect()
    }

    #[test]
    fn each_fast_method_agrees_with_its_slow_one() {
        let geometry = TickGeometry::new(2.356e-4, 2.356e-4, 0.34).unwrap();
        let pairs = [
            [Method::EveryTick, Method::EveryTickOneByOne],
            [Method::Sampled(Update::Arc), Method::SampledOneByOne(Update::Arc)],
            [Method::Sampled(Update::Midpoint), Method::SampledOneByOne(Update::Midpoint)],
            [Method::Sampled(Update::Euler), Method::SampledOneByOne(Update::Euler)],
        ];
        for pair in pairs {
            let [mut fast, mut slow] = pair.map(|method| Integrator::new(geometry, method));
            for segment in segments(&mut Source(31)) {
                let (fast, slow) = (fast.motion(&segment), slow.motion(&segment));
                let error = (fast.pose.x - slow.pose.x).abs().max((fast.pose.y - slow.pose.y).abs());
                assert!(error < 1e-12 && fast.pose.heading == slow.pose.heading, "{pair:?} {segment:?}: {error:e}");
            }
        }
    }

    #[test]
    fn many_segments_are_the_same_bits_as_each_for_every_method_and_instruction_set() {
        let geometry = TickGeometry::new(2.356e-4, 2.356e-4, 0.34).unwrap();
        let segments = segments(&mut Source(32));
        for method in [Method::EveryTick, Method::EveryTickOneByOne, Method::Sampled(Update::Arc)] {
            let mut one = Integrator::new(geometry, method);
            let alone: Vec<Motion> = segments.iter().map(|segment| one.motion(segment)).collect();
            for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
                let mut motions = vec![Motion::IDENTITY; segments.len()];
                Integrator::new(geometry, method).limited_to(instructions).motions(&segments, &mut motions);
                assert_eq!(motions, alone, "{method:?} {instructions:?}");
            }
        }
    }
}
