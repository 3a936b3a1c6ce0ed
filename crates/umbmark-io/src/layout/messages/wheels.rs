//! How far the wheels turned, message by message: from counts, joint positions or odometry.

use super::clock::{Clock, Times};
use super::fields::{Fields, Number};
use super::joints::Joints;
use super::message_type::MessageType;
use super::odometer::Odometer;
use super::topics::shown;
use crate::error::quoted;
use crate::recording::Recording;
use std::f64::consts::TAU;
use umbmark_core::drive::Robot;
use umbmark_core::inspect::{WheelUnit, steps_per_turn};

/// Counts beyond it are no longer distinct in `f64`.
const LARGEST: f64 = 9e15;
/// Joint positions that are nearer to whole ticks than this came from counts \[ticks\].
const WHOLE: f64 = 1e-4;

/// What is read of each message.
enum Source {
    Counts,
    /// The place of the left and of the right count in a list.
    List([usize; 2]),
    Joints(Joints),
    Odometry(Odometer),
}

/// The wheels of a log, in the unit of their messages.
pub(in crate::layout) struct Wheels {
    source: Source,
    pub times: Vec<Times>,
    values: [Vec<f64>; 2],
}

impl Wheels {
    /// Wheels from messages of a type; `part` is what was said behind the topic's name.
    pub fn new(kind: &MessageType, part: Option<&str>) -> Result<Wheels, String> {
        let pair = part.map(|part| part.split_once(',').ok_or("LEFT,RIGHT must follow the colon".to_owned()));
        let pair = pair.transpose()?;
        let source = match (kind, pair) {
            (MessageType::Joints, pair) => Source::Joints(Joints::new(pair)),
            (MessageType::CountList, Some(("left", "right"))) => Source::List([0, 1]),
            (MessageType::CountList, Some(("right", "left"))) => Source::List([1, 0]),
            (MessageType::CountList, _) => return Err("its list does not say which count is the left one".to_owned()),
            (_, Some(_)) => return Err("its messages have no parts to choose from".to_owned()),
            (MessageType::Odometry, None) => Source::Odometry(Odometer::default()),
            _ => Source::Counts,
        };
        Ok(Wheels { source, times: Vec::new(), values: [Vec::new(), Vec::new()] })
    }

    /// Takes a message; says what is wrong with it.
    pub fn take(&mut self, logged: u64, fields: &Fields) -> Result<(), String> {
        let times = Times::new(logged, fields.stamp());
        let pair = match &mut self.source {
            Source::Counts => Some([fields.number(Number::Left), fields.number(Number::Right)]),
            Source::List(places) => {
                let [Some(left), Some(right)] = places.map(|place| fields.values.get(place).copied()) else {
                    return Err(format!("holds {} counts, where two are needed", fields.values.len()));
                };
                Some([left, right])
            }
            Source::Joints(joints) => joints.positions(fields)?,
            Source::Odometry(odometer) => Some(odometer.advance(&times, fields)?),
        };
        let Some(pair) = pair else { return Ok(()) };
        if let Some(value) = pair.into_iter().find(|value| !(value.abs() <= LARGEST)) {
            return Err(format!("holds {value:e}, where a finite number of at most {LARGEST:e} either way is allowed"));
        }
        self.times.push(times);
        for (values, value) in self.values.iter_mut().zip(pair) {
            values.push(value);
        }
        Ok(())
    }

    /// Whether the values are those of counters, which may roll over.
    pub fn are_counts(&self) -> bool {
        matches!(self.source, Source::Counts | Source::List(_))
    }

    /// Whether the robot must be known to make ticks of the values.
    pub fn need_robot(&self) -> bool {
        !self.are_counts()
    }

    /// What the readings are, and where among the messages; the steps per turn of positions that come in steps.
    pub fn found(&self) -> (WheelUnit, Option<String>, Option<f64>) {
        match &self.source {
            Source::Counts | Source::List(_) => (WheelUnit::Counts, None, None),
            Source::Odometry(_) => (WheelUnit::Odometry, None, None),
            Source::Joints(joints) => {
                let steps = self.values.clone().map(|mut positions| {
                    unwind(&mut positions);
                    steps_per_turn(&positions)
                });
                let same = steps[0].filter(|_| steps[0] == steps[1]);
                let names = joints.names().map(|name| shown(&name));
                (WheelUnit::Positions, Some(format!("joints {} and {}", names[0], names[1])), same)
            }
        }
    }

    /// Why there are no wheels among the joints, where there are joints and none of them could be used.
    pub fn missing_joints(&self) -> Option<String> {
        match &self.source {
            Source::Joints(joints) if self.times.is_empty() => Some(joints.missing()),
            _ => None,
        }
    }

    /// The log in ticks. Values that need a robot are taken as ticks without one.
    pub fn into_recording(
        mut self,
        file: &str,
        topic: &str,
        clock: &Clock,
        robot: Option<&Robot>,
        warnings: &mut Vec<String>,
    ) -> Recording {
        let mut names = ["left", "right"].map(str::to_owned);
        if let (Source::Joints(joints), Some(robot)) = (&self.source, robot) {
            names = joints.names();
            for (values, name) in self.values.iter_mut().zip(&names) {
                if unwind(values) {
                    warnings
                        .push(format!("{file}: positions of joint {} start anew at a full turn; undone", quoted(name)));
                }
                to_ticks(values, robot.encoder.ticks_per_revolution());
            }
        }
        if let (Source::Odometry(odometer), Some(robot)) = (&self.source, robot) {
            if let Some(twist) = odometer.twist_alone() {
                self.values = twist;
                warnings.push(format!("{file}: the poses of {topic} do not change; its speeds are taken instead"));
            }
            odometry_to_ticks(&mut self.values, robot);
        }
        Recording {
            file: file.to_owned(),
            columns: [clock.name().to_owned(), names[0].clone(), names[1].clone()]
                .map(|name| format!("{topic} {name}"))
                .to_vec(),
            lines: (1..=self.times.len()).collect(),
            time: self.times.iter().map(|times| clock.seconds(times)).collect(),
            counts: self.values.into(),
            ..Recording::default()
        }
    }
}

/// Undoes positions that start anew at a full turn; says whether there were any.
fn unwind(positions: &mut [f64]) -> bool {
    let within = |low: f64, high: f64| positions.iter().all(|p| (low - 1e-6..=high + 1e-6).contains(p));
    let one_turn = within(-TAU / 2.0, TAU / 2.0) || within(0.0, TAU);
    if !one_turn || !positions.windows(2).any(|pair| (pair[1] - pair[0]).abs() > TAU / 2.0) {
        return false;
    }
    let (mut turns, mut before) = (0.0, positions.first().copied().unwrap_or(0.0));
    for position in positions {
        let step = *position - before;
        before = *position;
        turns -= (step / TAU).round();
        *position += TAU * turns;
    }
    true
}

/// Radians to ticks; whole ones where all of them are whole but for rounding.
fn to_ticks(positions: &mut [f64], ticks_per_revolution: f64) {
    let scale = ticks_per_revolution / TAU;
    let whole = positions.iter().all(|p| (p * scale - (p * scale).round()).abs() < WHOLE);
    for position in positions {
        *position *= scale;
        if whole {
            *position = position.round();
        }
    }
}

/// Distance \[m\] and turn \[rad\] of the body to ticks of the wheels, by the nominal kinematics.
fn odometry_to_ticks(values: &mut [Vec<f64>; 2], robot: &Robot) {
    let per_tick = robot.metres_per_tick();
    let half = 0.5 * robot.drive.wheelbase();
    let [first, second] = values;
    for (a, b) in first.iter_mut().zip(second) {
        let (distance, turn) = (*a, *b);
        *a = (distance - half * turn) / per_tick.left;
        *b = (distance + half * turn) / per_tick.right;
    }
}
