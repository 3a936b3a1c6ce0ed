//! The wheel motion of whole UMBmark tests, segment by segment: what every program of `peers/` integrates.

use crate::{LEG_READINGS, TURN_READINGS};
use rand::Rng;
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::engine::{Segment, TickGeometry, WheelLine};
use umbmark_core::path::{Direction, Path};
use umbmark_core::random::Stream;
use umbmark_core::simulate::{Course, Odometry, Phase, Simulator};

/// Runs in each direction.
pub const RUNS: usize = 5;

/// Moves of a run: four legs and four turns.
pub const MOVES: usize = 8;

/// Segments of a trial.
pub const SEGMENTS: usize = 2 * RUNS * MOVES;

/// Purpose of the stream that `umbmark_core::simulate` draws encoder phases from.
const ENCODER_PHASE: u64 = 1;

/// Tests of a TRC LabMate on the 4 x 4 m square, as `umbmark_core::simulate` commands them: from rest to rest, each wheel
/// anywhere within a tick.
#[derive(Debug)]
pub struct PlainTrials {
    courses: [Course; 2],
    /// What odometry believes of the robot.
    pub geometry: TickGeometry,
}

impl Default for PlainTrials {
    fn default() -> PlainTrials {
        let (robot, path) = (Robot::labmate(), Path::umbmark());
        let per_tick = robot.metres_per_tick();
        let simulator = Simulator::new(Model::new(&robot).robot(), &path, Odometry::EveryTick, Phase::Random)
            .expect("the paper's test can be driven");
        PlainTrials {
            courses: Direction::BOTH.map(|direction| simulator.course(direction).clone()),
            geometry: TickGeometry::new(per_tick.left, per_tick.right, robot.drive.wheelbase())
                .expect("positive lengths"),
        }
    }
}

impl PlainTrials {
    /// The segments of one trial: five runs clockwise, five counter-clockwise, eight moves each; readings as a controller
    /// takes them at 100 Hz and 0.2 m/s without ramps.
    pub fn segments(&self, seed: u64, trial: u64) -> [Segment; SEGMENTS] {
        let mut phases = Stream::new(seed, ENCODER_PHASE, trial);
        let mut phase = || {
            let word = phases.next_u64();
            [i64::from(word as u32), i64::from((word >> 32) as u32)]
        };
        let mut segments = [Segment::default(); SEGMENTS];
        for (run, moves) in segments.chunks_exact_mut(MOVES).enumerate() {
            let (mut stood, mut start) = ([0; 2], phase());
            for (index, (segment, leg)) in moves.iter_mut().zip(&self.courses[run / RUNS].legs).enumerate() {
                let end = phase();
                let travel = [0, 1].map(|wheel| ((leg.stop[wheel] - stood[wheel]) << 32) + end[wheel] - start[wheel]);
                let line = WheelLine::new(start, travel).expect("a leg of the paper's square is short");
                *segment = Segment::sampled(line, if index % 2 == 0 { LEG_READINGS } else { TURN_READINGS });
                (stood, start) = (leg.stop, end);
            }
        }
        segments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::dataset::ReturnError;
    use umbmark_core::effect::TestKind;
    use umbmark_core::engine::{Motion, TickOdometry, UNITS_PER_TICK};
    use umbmark_core::simulate::Truth;

    #[test]
    fn the_segments_are_those_that_the_simulator_drives() {
        let (robot, trials) = (Robot::labmate(), PlainTrials::default());
        let mut simulator = Simulator::new(&robot, &Path::umbmark(), Odometry::EveryTick, Phase::Random).unwrap();
        let mut truth = Truth::new(&Model::new(&robot));
        simulator.open(&mut truth, 4, 17);
        let mut returned = [[ReturnError::default(); RUNS]; 2];
        simulator.test(&mut truth, TestKind::Systematic, returned.each_mut().map(|r| r.as_mut_slice()));
        let odometry = TickOdometry::new(trials.geometry);
        for (moves, expected) in trials.segments(4, 17).chunks(MOVES).zip(returned.as_flattened()) {
            let (mut computed, mut driven) = (Motion::IDENTITY, Motion::IDENTITY);
            for segment in moves {
                computed = computed.then(&odometry.motion(&segment.line));
                let ticks = segment.line.travel().map(|units| units as f64 / UNITS_PER_TICK as f64);
                let [left, right] = ticks.map(|ticks| ticks * trials.geometry.left());
                driven = driven
                    .then(&Motion::exp(&robot.drive.displacement(&umbmark_core::drive::WheelTravel { left, right })));
            }
            let gap = [driven.pose.x - computed.pose.x - expected.x, driven.pose.y - computed.pose.y - expected.y];
            assert!(gap.iter().all(|gap| gap.abs() < 1e-12), "{gap:?}");
            assert!(expected.x.abs() > 1e-6, "{expected:?}");
        }
    }
}
