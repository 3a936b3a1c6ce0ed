//! A recorded run: the readings of the encoders, and the true poses.

use super::rolling::WheelsAtRest;
use super::{Leg, Rest, SimulateError, Simulator, Truth, return_error};
use crate::dataset::{ReferencePose, ReturnError, TickLog};
use crate::drive::{MOST_WHEELS, Robot, Wheel};
use crate::effect::{Sight, Stretch, TestKind};
use crate::engine::{RollerLine, SampledOdometry, TickGeometry, UNITS_PER_TICK, Update, WheelLine};
use crate::geometry::Pose2;
use crate::path::Direction;
use crate::run::dead_reckoning::computed_poses;

/// A simulated run with all its data.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Ticks and measured poses.
    pub log: TickLog,
    /// The true pose at every sample of the log.
    pub truth: Vec<Pose2>,
    /// The pose that the robot computed from its ticks, at every sample of the log.
    pub computed: Vec<Pose2>,
    /// Measured minus computed end pose.
    pub returned: ReturnError,
}

impl Recording {
    /// Turns readings of a drive's own counters into those of its axle's wheels, and computes the poses from these.
    fn reckon(&mut self, robot: &Robot) {
        let log = &mut self.log;
        [log.left, log.right] = match robot.axle_ticks_of_rollers(&log.rollers) {
            Some(ticks) => ticks,
            None => robot.axle_ticks([std::mem::take(&mut log.left), std::mem::take(&mut log.right)]),
        };
        self.computed = computed_poses(log, robot);
    }
}

/// Time that the robot rests before the first and after the last move \[s\].
const STANDING: f64 = 1.0;

impl Simulator {
    /// Drives once round the path, reading the counters `rate` times a second and measuring the absolute pose
    /// `reference_rate` times a second, both while standing before and after too.
    ///
    /// The wheel angles are those that [`Simulator::run`] with the same streams would make; the true motion is drawn from the same
    /// distribution, sample by sample. Effects get a [recorded](crate::effect::Context::recorded) run: errors that only the steps of the
    /// robot's own odometry cause are not in its ticks.
    pub fn record(
        &mut self,
        truth: &mut Truth,
        direction: Direction,
        test: TestKind,
        [rate, reference_rate]: [f64; 2],
    ) -> Result<Recording, SimulateError> {
        self.check_recordable([rate, reference_rate])?;
        truth.start(direction);
        truth.rest(STANDING);
        let per_tick = self.robot().metres_per_tick();
        let geometry = TickGeometry::new(per_tick.left, per_tick.right, self.robot().drive.wheelbase())?;
        let mut track = SampledOdometry::new(geometry, Update::Arc).track();
        let mut moves = Moves::new(self, direction, test);
        let samples = ((self.course(direction).duration() + 2.0 * STANDING) * rate).ceil() as usize;
        let mut recording = Recording {
            log: TickLog::default(),
            truth: Vec::with_capacity(samples + 1),
            computed: Vec::with_capacity(samples + 1),
            returned: ReturnError::default(),
        };
        let (mut next_reference, mut sights) = (0.0, Vec::new());
        for sample in 0..=samples {
            let time = sample as f64 / rate;
            let log = &mut recording.log;
            let at = self.drive_until(time - STANDING, &mut moves, truth, &mut log.bumps);
            let counts = at.map_or([0; 2], |(index, share)| moves.counts(index, share));
            track.read(counts);
            let held = moves.held(at, log.left.last() == Some(&(counts[0] as f64)));
            log.time.push(time);
            log.left.push(counts[0] as f64);
            log.right.push((counts[1] + held) as f64);
            if let Some(rolling) = &self.rolling {
                log.rollers.resize(rolling.wheels, Vec::new());
                let counts = at.map_or([0; MOST_WHEELS], |(index, share)| moves.wheel_counts(index, share));
                log.rollers.iter_mut().zip(counts).for_each(|(counter, count)| counter.push(count as f64));
            }
            recording.truth.push(truth.pose());
            recording.computed.push(track.pose());
            if time + 1e-9 >= next_reference || sample == samples {
                sights.push((sample, Sight { time, room: Some(Pose2::IDENTITY), ..Sight::default() }));
                next_reference += 1.0 / reference_rate;
            }
        }
        let shown = |time: f64| between(&recording.truth, time * rate);
        let measured = sights.into_iter().map(|(sample, sight)| {
            let Pose2 { x, y, heading } = truth.measure(&sight, shown);
            ReferencePose { sample, x, y, heading: Some(heading) }
        });
        recording.log.reference = measured.collect();
        if !self.robot().drive.kind().has_axle_wheels() {
            recording.reckon(self.robot());
        }
        let at_rest = Sight { time: samples as f64 / rate, ..Sight::default() };
        let measured = truth.measure(&at_rest, |time| between(&recording.truth, time * rate));
        recording.returned = return_error(&measured, &recording.computed.last().copied().unwrap_or_default());
        Ok(recording)
    }

    /// Refuses rates that are not positive, and robots that steer by trucks, whose counters are more than two.
    fn check_recordable(&self, [rate, reference_rate]: [f64; 2]) -> Result<(), SimulateError> {
        for (what, value) in [("sampling rate", rate), ("reference rate", reference_rate)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SimulateError::Rate { what, value });
            }
        }
        if self.convoys.is_some() {
            return Err(SimulateError::Unsupported {
                drive: self.robot().drive.kind().name(),
                what: "tick logs: each of its trucks has counters of its own; its returns are simulated",
            });
        }
        Ok(())
    }

    /// Drives until some time after START: the present move then, with the share of it that is done.
    fn drive_until(
        &self,
        driving: f64,
        moves: &mut Moves,
        truth: &mut Truth,
        bumps: &mut Vec<[f64; 2]>,
    ) -> Option<(usize, f64)> {
        // Every move that ended since the last sample is driven to its end, and the present one up to this sample.
        while let Some((stretch, leg)) = moves.next_due(self, driving) {
            self.advance(truth, 1.0, bumps);
            truth.begin(stretch, leg);
        }
        let (index, share) = moves.at(driving)?;
        self.advance(truth, share, bumps);
        if share >= 1.0 {
            truth.rest_until(driving);
        }
        Some((index, share))
    }

    /// Drives on, and notes where the wheels of the axle meet bumps: to a sample's way.
    fn advance(&self, truth: &mut Truth, share: f64, bumps: &mut Vec<[f64; 2]>) {
        let ahead = truth.ahead().to_vec();
        truth.advance(share);
        let (pose, half) = (truth.pose(), 0.5 * self.robot().drive.wheelbase());
        let pose = Pose2 { heading: pose.heading + truth.course(), ..pose };
        for bump in ahead[truth.ahead().len()..].iter().rev() {
            let left = if bump.wheel == Wheel::Left { half } else { -half };
            bumps.push([pose.x - left * libm::sin(pose.heading), pose.y + left * libm::cos(pose.heading)]);
        }
    }
}

/// The moves of a run, as far as they are begun.
struct Moves {
    direction: Direction,
    test: TestKind,
    legs: Vec<Leg>,
    /// Before the first move, and after each.
    rests: Vec<Rest>,
    /// The same of all wheels with rollers; none of a robot without such.
    wheels: Vec<WheelsAtRest>,
    begun: usize,
}

impl Moves {
    /// Those of a course, none begun; the phases at its rests are drawn.
    fn new(simulator: &mut Simulator, direction: Direction, test: TestKind) -> Moves {
        let legs = simulator.course(direction).legs.clone();
        let counts = std::iter::once([0; 2]).chain(legs.iter().map(|leg| leg.stop));
        let Some(rolling) = simulator.rolling.take() else {
            let rests = counts.map(|count| Rest { count, phase: simulator.draw_phase() }).collect();
            return Moves { direction, test, legs, rests, wheels: Vec::new(), begun: 0 };
        };
        // The axle of such a robot has no counters of its own.
        let rests = counts.map(|_| Rest { count: [0; 2], phase: [0; 2] }).collect();
        let begun = WheelsAtRest { phase: simulator.draw_phases(), ..WheelsAtRest::default() };
        let mut wheels = vec![begun];
        for index in 0..legs.len() {
            wheels.push(rolling.after(direction, index, &begun, || simulator.draw_phases()));
        }
        simulator.rolling = Some(rolling);
        Moves { direction, test, legs, rests, wheels, begun: 0 }
    }

    /// Begins the next move, where its time has come.
    fn next_due(&mut self, simulator: &Simulator, driving: f64) -> Option<(Stretch, &Leg)> {
        let index = self.begun;
        let leg = self.legs.get(index).filter(|leg| driving >= if index == 0 { 0.0 } else { leg.begins })?;
        self.begun += 1;
        if let Some(rolling) = &simulator.rolling {
            let believed = rolling.odometry.displacement(self.wheel_line(index).ticks());
            return Some((simulator.stretch(&believed, index, self.direction, self.test), leg));
        }
        let travel = simulator.believed(leg, &self.line(index));
        Some((Stretch { index, direction: self.direction, test: self.test, travel, left: leg.left }, leg))
    }

    /// The present move, and the share of it that is done.
    fn at(&self, driving: f64) -> Option<(usize, f64)> {
        let index = self.begun.checked_sub(1)?;
        let leg = &self.legs[index];
        Some((index, leg.profile.fraction(driving - leg.begins)))
    }

    /// What the wheels turn in a move.
    fn line(&self, index: usize) -> WheelLine {
        self.rests[index].line_to(&self.rests[index + 1])
    }

    /// What all wheels with rollers turn in a move.
    fn wheel_line(&self, index: usize) -> RollerLine {
        self.wheels[index].line_to(&self.wheels[index + 1])
    }

    /// The counts of all wheels with rollers where a share of a move is done.
    fn wheel_counts(&self, index: usize, share: f64) -> [i64; MOST_WHEELS] {
        let gained = self.wheel_line(index).counts_at(share);
        std::array::from_fn(|wheel| self.wheels[index].count[wheel] + gained[wheel])
    }

    /// The counts where a share of a move is done.
    fn counts(&self, index: usize, share: f64) -> [i64; 2] {
        let line = self.line(index);
        std::array::from_fn(|wheel| {
            let angle = line.start()[wheel] + (line.travel()[wheel] as f64 * share) as i64;
            self.rests[index].count[wheel] + angle.div_euclid(UNITS_PER_TICK)
        })
    }

    /// What the second counter holds beside its counts: once the robot stands after a move, it steers for the next one.
    fn held(&self, at: Option<(usize, f64)>, counts_stand: bool) -> i64 {
        let (index, share) = at.unwrap_or_default();
        let next = usize::from(share >= 1.0 && counts_stand);
        self.legs[(index + next).min(self.legs.len() - 1)].counting.held
    }
}

/// The pose at so many samples, with constant twist from one to the next; the robot rests before the first and after the last.
fn between(poses: &[Pose2], samples: f64) -> Pose2 {
    let samples = samples.clamp(0.0, poses.len().saturating_sub(1) as f64);
    let whole = (samples - samples.round()).abs() < 1e-9;
    let before = if whole { samples.round() } else { samples.floor() };
    let (share, before) = (if whole { 0.0 } else { samples - before }, before as usize);
    let Some(from) = poses.get(before) else { return Pose2::IDENTITY };
    poses.get(before + 1).map_or(*from, |to| from.toward(to, share))
}
