//! Where the robot was, message by message.

use super::clock::{Clock, Times};
use super::fields::{Fields, Number};
use super::message_type::MessageType;
use super::problem::{LogProblem, listed};
use super::topics::{Chosen, shown};
use crate::remedy::Argument;
use crate::track_rows::TrackRows;

/// More pairs of frames are not kept apart.
const MOST_FRAMES: usize = 256;
/// Positions farther away are none \[m\].
const FARTHEST: f64 = 1e7;
/// Nothing on wheels turns faster \[rad/s\].
const FASTEST: f64 = 1e4;

/// A pose in the plane, without its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::layout) struct PlanarPose {
    pub x: f64,
    pub y: f64,
    /// Missing where the orientation is all zeros.
    pub heading: Option<f64>,
}

/// The poses of one frame in another.
struct Frames {
    frame: String,
    child: String,
    rows: Vec<(Times, PlanarPose)>,
}

/// The poses of a topic.
pub(in crate::layout) struct Track {
    kind: MessageType,
    frames: Vec<Frames>,
}

impl Track {
    pub fn new(kind: &MessageType) -> Track {
        Track { kind: kind.clone(), frames: Vec::new() }
    }

    /// Whether its headings are the rates of a gyro.
    pub fn tells_rates(&self) -> bool {
        self.kind == MessageType::Imu
    }

    /// Takes a message; says what is wrong with it.
    pub fn take(&mut self, logged: u64, fields: &Fields) -> Result<(), String> {
        let place = if self.tells_rates() { turn_rate(fields)? } else { place(fields)? };
        let row = (Times::new(logged, fields.stamp()), place);
        let same = |frames: &&mut Frames| frames.frame == fields.frame && frames.child == fields.child;
        if let Some(frames) = self.frames.iter_mut().find(same) {
            frames.rows.push(row);
            return Ok(());
        }
        if self.frames.len() == MOST_FRAMES {
            return Err(format!("is in yet another frame, after {MOST_FRAMES} of them"));
        }
        self.frames.push(Frames { frame: fields.frame.clone(), child: fields.child.clone(), rows: vec![row] });
        Ok(())
    }

    /// The rows of the frames that are the reference; nothing, and the reason, if there are none.
    pub fn choose(
        mut self,
        chosen: &Chosen,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<(Times, PlanarPose)>, LogProblem> {
        if let Some(part) = &chosen.part {
            let names: Vec<String> = self.frames.iter().map(|frames| shown(&frames.child)).collect();
            self.frames.retain(|frames| bare(&frames.child) == bare(part) || bare(&frames.frame) == bare(part));
            if self.frames.is_empty() {
                let found = format!("it has no frame {}", crate::error::quoted(part));
                let remedy = format!("its frames are: {}", listed(names)).into();
                return Err(LogProblem::Topic { topic: shown(&chosen.topic), found, remedy });
            }
        } else if !chosen.named
            && matches!(self.kind, MessageType::Odometry | MessageType::Transform | MessageType::Transforms)
        {
            // REP 105: what is given in odom is the robot's own odometry, and odom in something else corrects it.
            let own = |frames: &Frames| bare(&frames.frame) == "odom" || bare(&frames.child) == "odom";
            if !self.frames.is_empty() && self.frames.iter().all(own) {
                let topic = shown(&chosen.topic);
                warnings.push(format!(
                    "{topic} is given in frame odom, so it is odometry and no reference; name the topic {topic} as the reference if it is one"
                ));
            }
            self.frames.retain(|frames| !own(frames));
        }
        if self.frames.len() > 1 && self.frames.iter().any(Frames::moves) {
            self.frames.retain(Frames::moves);
        }
        if self.frames.len() > 1 {
            let topic = shown(&chosen.topic);
            let frames = self.frames.iter().map(|frames| match frames.child.as_str() {
                "" => format!("{topic}:{}", shown(&frames.frame)),
                child => format!("{topic}:{} (in {})", shown(child), shown(&frames.frame)),
            });
            let (role, argument) = ("the reference", Argument::Reference);
            return Err(LogProblem::AmbiguousTopic { role, topics: listed(frames), argument });
        }
        Ok(self.frames.pop().map(|frames| frames.rows).unwrap_or_default())
    }
}

impl Frames {
    fn moves(&self) -> bool {
        self.rows.iter().any(|row| row.1 != self.rows[0].1)
    }
}

/// A frame's name as tf2 has it, without the slash of tf1.
fn bare(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

/// The rate at which a gyro turns, in place of a heading.
fn turn_rate(fields: &Fields) -> Result<PlanarPose, String> {
    let rate = fields.number(Number::TurnRate);
    if !(rate.abs() <= FASTEST) {
        return Err(format!("turns at {rate}, where a finite number in rad/s of at most {FASTEST:e} is allowed"));
    }
    Ok(PlanarPose { x: 0.0, y: 0.0, heading: Some(rate) })
}

/// The pose of a message, seen from above.
pub(in crate::layout) fn place(fields: &Fields) -> Result<PlanarPose, String> {
    let [x, y] = [Number::X, Number::Y].map(|number| fields.number(number));
    if let Some(value) = [x, y].into_iter().find(|value| !(value.abs() <= FARTHEST)) {
        return Err(format!("has position {value}, where a finite number in m of at most {FARTHEST:e} is allowed"));
    }
    let [qx, qy, qz, qw] = [Number::Qx, Number::Qy, Number::Qz, Number::Qw].map(|number| fields.number(number));
    let square = qx * qx + qy * qy + qz * qz + qw * qw;
    if square == 0.0 {
        return Ok(PlanarPose { x, y, heading: None });
    }
    if !(0.98..=1.02).contains(&square) {
        return Err(format!("has orientation [{qx}, {qy}, {qz}, {qw}], which is no unit quaternion"));
    }
    let heading = libm::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
    Ok(PlanarPose { x, y, heading: Some(heading) })
}

/// The rows on a clock, as those of any track.
pub(in crate::layout) fn timed(rows: Vec<(Times, PlanarPose)>, clock: &Clock, file: &str, topic: &str) -> TrackRows {
    TrackRows {
        file: file.to_owned(),
        column: format!("{topic} {}", clock.name()),
        lines: (1..=rows.len()).collect(),
        time: rows.iter().map(|(times, _)| clock.seconds(times)).collect(),
        poses: rows.iter().map(|(_, place)| (place.x, place.y, place.heading)).collect(),
        lost: 0,
        rates: false,
    }
}
