//! A run compared with its prediction by a model: both poses, and the error that each step between two measurements adds.

use crate::effect::{Chain, Context};
use crate::geometry::Pose2;
use crate::likelihood::{Observed, ObservedRun};
use crate::path::Direction;
use crate::replay::Track;
use crate::setup::PoseNoise;
use std::ops::Range;

/// Steps longer than this \[m, rad\] do not show how the robot drove within them.
const LONGEST: (f64, f64) = (0.2, 0.35);

/// A step is straight if the wheels differ by less than this share; single ticks cause smaller differences.
const STRAIGHT: f64 = 0.05;

/// A run followed from measurement to measurement.
pub(super) struct Followed<'a> {
    pub observed: &'a ObservedRun,
    pub direction: Option<Direction>,
    /// Poses predicted and measured, first those at START: both in the frame in which the robot stands there.
    pub places: Vec<MeasuredBlock>,
    /// From each place to the next, if that is near enough.
    pub steps: Vec<ErrorIncrement>,
    pub with_heading: bool,
}

/// A block of measurements: predicted and measured pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredBlock {
    pub predicted: Pose2,
    pub measured: Pose2,
    /// Number of pieces of the track until then, and mean travel of the wheels \[m\].
    pub made: usize,
    pub rolled: f64,
    /// Whether START was fitted here, so that its error is zero.
    pub starts: bool,
}

/// The step between two neighbouring places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErrorIncrement {
    /// Error that it adds, in the robot's frame: forward, to the left \[m\], rotation \[rad\].
    pub own: [f64; 3],
    /// Predicted motion: forward \[m\], rotation \[rad\].
    pub motion: [f64; 2],
    /// Whether the robot turns about a point within a wheelbase of its axle's centre.
    pub turning: bool,
    pub at: Conditions,
    /// Its time \[s\].
    pub seconds: f64,
    /// Index of the place where it ends.
    pub ends: usize,
}

/// How the robot drives in a step: rates are means over its time, other values are those at its middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Conditions {
    /// \[m/s, rad/s\]
    pub speed: f64,
    pub turn_rate: f64,
    /// Rate of change of the size of the speed, and of the turn rate \[m/s², rad/s²\].
    pub acceleration: f64,
    pub turn_acceleration: f64,
    /// \[rad\]
    pub wheel_angle: [f64; 2],
    pub heading: f64,
    /// Share of the run's way, time \[s\], way since the last turn \[m\].
    pub place: f64,
    pub time: f64,
    pub since_turn: f64,
    /// +1 left, -1 right, 0 none yet; +1 ccw, -1 cw, 0 neither; from 0.
    pub last_turn: f64,
    pub direction: f64,
    pub run: f64,
}

impl<'a> Followed<'a> {
    fn new(observed: &'a ObservedRun, chain: &Chain<f64>, noise: PoseNoise) -> Followed<'a> {
        let places = places(observed, chain, noise);
        let short = |step: &ErrorIncrement| step.motion[0].abs() <= LONGEST.0 && step.motion[1].abs() <= LONGEST.1;
        let steps = (1..places.len()).filter_map(|ends| step(&observed.track, &places, ends)).filter(short).collect();
        let with_heading = observed.blocks.iter().any(|block| block.headings > 0);
        Followed { observed, direction: observed.direction, places, steps, with_heading }
    }
}

/// All runs, followed along a model; `observed` must lie along it.
pub(super) fn all<'a>(observed: &'a Observed, chain: &Chain<f64>) -> Vec<Followed<'a>> {
    observed.runs.iter().map(|run| Followed::new(run, chain, observed.setup.noise)).collect()
}

/// Measured poses are moved so that they agree with the model at START, which is fitted to the first of them where it was measured, and
/// anew where the track jumps; else START is trusted. A heading that was not measured gets the error of the last measured one.
fn places(run: &ObservedRun, chain: &Chain<f64>, noise: PoseNoise) -> Vec<MeasuredBlock> {
    let rolled = run.track.rolled();
    let residuals = run.residuals(chain);
    let mut places = Vec::with_capacity(run.blocks.len() + 1);
    if !run.start_seen {
        let start = run.track.start(chain);
        places.push(MeasuredBlock { predicted: start, measured: start, made: 0, rolled: 0.0, starts: true });
    }
    for stretch in run.stretches([noise.position, noise.heading]) {
        let mut turned = 0.0;
        let left = stretch.less_start(run, &residuals);
        for (index, [dx, dy, turn]) in stretch.blocks.clone().zip(left) {
            let block = &run.blocks[index];
            if block.headings > 0 {
                turned = turn;
            }
            let (made, predicted) = (run.made_at(block).round() as usize, block.place);
            let starts = !stretch.told().contains(&index);
            let off = if starts { [0.0; 3] } else { [dx, dy, turned] };
            let measured = Pose2::new(predicted.x + off[0], predicted.y + off[1], predicted.heading + off[2]);
            places.push(MeasuredBlock { predicted, measured, made, rolled: rolled[made], starts });
        }
    }
    places
}

/// The step to the place that `ends` it, from that before.
fn step(track: &Track, places: &[MeasuredBlock], ends: usize) -> Option<ErrorIncrement> {
    let (a, b) = (&places[ends - 1], &places[ends]);
    // Steps across a jump do not count.
    if b.starts {
        return None;
    }
    let predicted = a.predicted.between(&b.predicted);
    let own = predicted.between(&a.measured.between(&b.measured));
    let forward = predicted.log().forward;
    let (at, turning, seconds) = conditions(track, a.made..b.made, 0.5 * (a.predicted.heading + b.predicted.heading))?;
    Some(ErrorIncrement {
        own: [own.x, own.y, own.heading],
        motion: [forward, predicted.heading],
        turning,
        at,
        seconds,
        ends,
    })
}

/// Driving conditions of some pieces, whether most of their wheel travel is turning, and their time \[s\]; `None` if nothing moves.
fn conditions(track: &Track, pieces: Range<usize>, heading: f64) -> Option<(Conditions, bool, f64)> {
    let own: Vec<&Context> = track.contexts()[pieces.clone()].iter().filter(|at| !at.stands()).collect();
    let middle = own.get(own.len() / 2)?;
    let seconds: f64 = own.iter().map(|at| at.duration).sum();
    let mean = |of: &dyn Fn(&Context) -> f64| {
        let sum: f64 = own.iter().map(|at| of(at) * at.duration).sum();
        if seconds > 0.0 { sum / seconds } else { of(middle) }
    };
    let rise = |of: &dyn Fn(&Context) -> f64| {
        let sum: f64 = own.iter().map(|at| of(at)).sum();
        if seconds > 0.0 { sum / seconds } else { 0.0 }
    };
    let travel = &track.travel()[pieces];
    let (left, right) = travel.iter().fold((0.0, 0.0), |(l, r), t| (l + t.left, r + t.right));
    let (apart, way) = (f64::abs(right - left), 0.5 * f64::abs(left + right));
    let speed = mean(&|at| at.speed);
    let turn_rate = if apart < STRAIGHT * way { 0.0 } else { mean(&|at| at.turn_rate) };
    let change = |at: &Context| [at.speed_change[0] + at.speed_change[1], at.speed_change[1] - at.speed_change[0]];
    let wheels = |at: &Context| at.wheel_speed[1] - at.wheel_speed[0];
    let wheelbase = own.iter().find(|at| at.turn_rate != 0.0).map_or(1.0, |at| wheels(at) / at.turn_rate);
    let at = Conditions {
        speed,
        turn_rate,
        acceleration: speed.signum() * rise(&|at| 0.5 * change(at)[0]),
        turn_acceleration: turn_rate.signum() * rise(&|at| change(at)[1] / wheelbase),
        wheel_angle: middle.wheel_angle,
        heading,
        place: middle.distance / track.length().max(f64::MIN_POSITIVE),
        time: middle.time,
        since_turn: middle.since_turn,
        last_turn: middle.last_turn,
        direction: middle.direction,
        run: middle.run,
    };
    Some((at, apart > way, seconds))
}
