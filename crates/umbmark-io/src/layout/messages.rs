//! Logs of messages: MCAP and bags of ROS, without ROS.
//!
//! A log is opened (`survey`: which topics are there), the topics of the wheels and of the reference are chosen
//! (`topics`), and the messages of these two are decoded (`decoder`: `wire`, `json`, `protobuf`) as they come out of their
//! file (`container`) into columns (`wheels`, `track`), which become a [`Recording`] and the rows of a track to put into it.
//! Nothing else of a log is kept, so its size does not matter. Each kind of file is a layout of its own.

mod clock;
mod container;
mod contents;
#[cfg(test)]
pub(super) mod damaged;
mod decoder;
mod definitions;
mod fields;
mod joints;
mod json;
mod message_type;
#[cfg(test)]
mod mutated_log;
mod odometer;
mod plan;
mod problem;
mod protobuf;
mod schema;
mod survey;
mod topics;
mod track;
mod wheels;
mod wire;

pub(super) use clock::is_calendar;
pub(super) use container::{Channel, Container, Contents, LONGEST, Opened, Record, Stop, Visit, look_through, open};
pub(super) use contents::look;
pub(super) use definitions::{DEFINITIONS, JOINT_STATE, KnownType, MARKER_ARRAY, ODOMETRY, PATH, POSE_STAMPED, TF};
pub use problem::LogProblem;
pub(super) use survey::{Definition, Survey};
pub use topics::Topics;

use crate::RobotFile;
use crate::assembly::Assembly;
use crate::error::{DatasetError, quoted};
use crate::label;
use crate::probe::{Probe, stem};
use crate::recording::Recording;
use crate::remedy::{Argument, Remedy};
use crate::track_rows::TrackRows;
use clock::Clock;
use container::Damage;
use decoder::Decoder;
use fields::Fields;
use std::fs::File;
use std::path::Path;
use topics::{Chosen, shown};
use track::Track;
use umbmark_core::dataset::Dataset;
use umbmark_core::dataset::{RunTopics, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::run::dead_reckoning::EndPose;
use umbmark_core::run::place;
use wheels::Wheels;

/// How a file of messages is opened: its first bytes, and what it holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenMessages {
    pub magic: &'static [u8],
    pub open: fn(&Path, File) -> Opened,
}

/// Adds a log as a run.
pub(super) fn add(assembly: &mut Assembly, file: &Path, topics: &Topics) -> Result<(), DatasetError> {
    add_survey(assembly, Survey::open(file)?, file, topics)
}

fn add_survey(assembly: &mut Assembly, survey: Survey, file: &Path, topics: &Topics) -> Result<(), DatasetError> {
    let mut warnings = Vec::new();
    let reading = survey.read(topics, assembly.robot(), &mut warnings)?;
    let stem = stem(file);
    assembly.topics.push(reading.topics(&stem));
    let log = reading.into_log(assembly.robot(), &mut warnings)?;
    assembly.warnings.append(&mut warnings);
    assembly.add_log(file.display().to_string(), log, None, &stem, label::parse(&stem), EndPose::Standing)
}

/// One log, with the robot that stands beside it, or with the one that it brings along.
pub(super) fn read(probe: &Probe, topics: &Topics) -> Result<Dataset, DatasetError> {
    let file = &probe.path;
    let survey = Survey::open(file)?;
    let robot_file = match (probe.robot_file()?, survey.robot()) {
        (None, Some(text)) => Some(RobotFile::parse(&format!("{} (its robot.toml)", file.display()), text)?),
        (found, _) => found,
    };
    let mut assembly = Assembly::new(robot_file);
    add_survey(&mut assembly, survey, file, topics)?;
    assembly.finish()
}

/// More messages of a topic are not kept: hours of a fast robot, and 300 MB.
const MOST_MESSAGES: usize = 2_000_000;

/// The wheels and the poses of a log, each with its times.
pub(super) struct Reading {
    recording: Recording,
    begin_ns: i64,
    are_counts: bool,
    track: TrackRows,
    topics: [String; 2],
}

impl Reading {
    /// The topics that were read, for a run.
    pub fn topics(&self, run: &str) -> RunTopics {
        let [wheels, reference] = self.topics.clone();
        let reference = (!self.track.poses.is_empty()).then_some(reference);
        RunTopics { run: run.to_owned(), wheels, reference }
    }

    /// The log, checked as every recording is, with the poses in it. Both have one clock.
    pub fn into_log(mut self, robot: Option<&Robot>, warnings: &mut Vec<String>) -> Result<TickLog, DatasetError> {
        let file = self.recording.file.clone();
        let bits = robot.and_then(|robot| robot.encoder.counter_bits()).filter(|_| self.are_counts);
        let (mut log, _) = self.recording.into_log(robot, bits, warnings)?;
        log.begin_ns = self.begin_ns;
        self.track.put_in_order(warnings)?;
        self.track.count_turns();
        let poses = self.track.poses.len();
        let dropped = place(&mut log, &self.track.time, &self.track.poses);
        if dropped > 0 {
            warnings.push(format!(
                "{file}: {dropped} of {poses} poses fall into gaps of the wheels, or outside of them, and were left out"
            ));
        }
        if self.track.rates && !log.reference.is_empty() {
            (log.relative, log.headings_only) = (true, true);
        }
        Ok(log)
    }
}

/// What is decoded at once: both topics, message by message.
struct Decoding {
    /// By channel; there are few.
    decoders: Vec<(u16, Decoder, Role)>,
    fields: Fields,
    wheels: Wheels,
    track: Option<Track>,
    topics: [String; 2],
    messages: [usize; 2],
}

/// What was decoded: readings of the wheels in the unit of their messages, and poses, on one clock.
struct Gathered {
    wheels: Wheels,
    clock: Clock,
    track: TrackRows,
    topics: [String; 2],
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Wheels,
    Reference,
}

impl Survey {
    /// Reads the wheels and the reference.
    pub fn read(
        mut self,
        wish: &Topics,
        robot: Option<&Robot>,
        warnings: &mut Vec<String>,
    ) -> Result<Reading, DatasetError> {
        let needed = |wheels: &Wheels| match wheels.need_robot() && robot.is_none() {
            true => Err(umbmark_core::dataset::NoRobot.into()),
            false => Ok(()),
        };
        let Gathered { wheels, clock, track, topics } = self.gather(wish, &needed, warnings)?;
        let are_counts = wheels.are_counts();
        let recording = wheels.into_recording(&self.file, &topics[0], &clock, robot, warnings);
        Ok(Reading { recording, begin_ns: clock.zero(), are_counts, track, topics })
    }

    /// Decodes the wheels and the reference, where these wheels are of use.
    fn gather(
        &mut self,
        wish: &Topics,
        of_use: &dyn Fn(&Wheels) -> Result<(), DatasetError>,
        warnings: &mut Vec<String>,
    ) -> Result<Gathered, DatasetError> {
        let file = self.file.clone();
        let refuse = |problem| DatasetError::Messages { file: file.clone(), problem: Box::new(problem) };
        let ticks = topics::ticks(&self.topics, wish).map_err(|problem| refuse(self.blamed(problem)))?;
        let reference = topics::reference(&self.topics, wish, &ticks).map_err(refuse)?;
        let mut decoding = self.decoding(&ticks, reference.as_ref()).map_err(refuse)?;
        of_use(&decoding.wheels)?;
        let channels: Vec<u16> = decoding.decoders.iter().map(|(id, ..)| *id).collect();
        let damage = self.walk(&|channel| channels.contains(&channel), &mut |record| decoding.take(record))?;
        let Decoding { wheels, track, topics, messages, .. } = decoding;
        if wheels.times.is_empty() {
            return Err(refuse(self.without_wheels(&topics[0], &wheels, damage)));
        }
        warnings.extend(self.lost(damage, &topics, messages));
        let rates = track.as_ref().is_some_and(Track::tells_rates);
        let rows = match (track, &reference) {
            (Some(track), Some(reference)) => {
                let mut said = Vec::new();
                let rows = track.choose(reference, &mut said).map_err(refuse)?;
                warnings.extend(said.into_iter().map(|text| format!("{file}: {text}")));
                rows
            }
            _ => Vec::new(),
        };
        // What was taken for a reference is the robot's own odometry: a gyro is one.
        let gyro = topics::gyro(&self.topics).filter(|_| rows.is_empty() && wish.reference.is_none() && !rates);
        if let Some(gyro) = gyro {
            let wish = Topics { reference: Some(gyro.name.clone()), ..wish.clone() };
            return self.gather(&wish, of_use, warnings);
        }
        let clock = Clock::of(wheels.times.iter(), rows.iter().map(|(times, _)| times));
        let track = TrackRows { rates, ..track::timed(rows, &clock, &file, &topics[1]) };
        Ok(Gathered { wheels, clock, track, topics })
    }

    /// Decoders for the topics that were chosen.
    fn decoding(&self, ticks: &Chosen, reference: Option<&Chosen>) -> Result<Decoding, LogProblem> {
        let problem =
            |topic: &str, found: String, remedy: Remedy| LogProblem::Topic { topic: quoted(topic), found, remedy };
        if reference.is_some_and(|reference| reference.topic == ticks.topic) {
            let found = "it cannot be both the wheels and the reference".to_owned();
            return Err(problem(&ticks.topic, found, Remedy::NameAnother));
        }
        let remedy = Remedy::Name {
            purpose: "name the wheels as",
            argument: Argument::Ticks,
            value: "TOPIC:LEFT,RIGHT (joints), TOPIC:left,right or TOPIC:right,left (lists of counts)",
        };
        let wheels = Wheels::new(&self.known(ticks)?.1, ticks.part.as_deref());
        let wheels = wheels.map_err(|found| problem(&ticks.topic, found, remedy))?;
        let track = reference.map(|reference| Ok(Track::new(&self.known(reference)?.1))).transpose()?;
        let mut decoders = Vec::new();
        for (chosen, role) in [(Some(ticks), Role::Wheels), (reference, Role::Reference)] {
            let Some(chosen) = chosen else { continue };
            let (encoding, kind) = self.known(chosen)?;
            for (id, _, schema) in self.channels_of(&chosen.topic) {
                let decoder = Decoder::new(encoding, &kind, &schema.name, &schema.data).map_err(|found| {
                    problem(&chosen.topic, found, "record it with the schema of its messages".into())
                })?;
                decoders.push((id, decoder, role));
            }
        }
        let topics = [shown(&ticks.topic), reference.map_or(String::new(), |reference| shown(&reference.topic))];
        Ok(Decoding { decoders, fields: Fields::default(), wheels, track, topics, messages: [0; 2] })
    }

    /// Why there are no wheels though there is a topic of them.
    fn without_wheels(&self, topic: &str, wheels: &Wheels, damage: Option<Damage>) -> LogProblem {
        match (damage, wheels.missing_joints()) {
            (Some(damage), _) => LogProblem::Damaged { damage: self.place(&damage) },
            (None, Some(found)) => {
                let (purpose, value) = ("name the joints with", "TOPIC:LEFT,RIGHT");
                let remedy = Remedy::Name { purpose, argument: Argument::Ticks, value };
                LogProblem::Topic { topic: topic.to_owned(), found, remedy }
            }
            (None, None) => {
                let (purpose, value) = ("choose another with", "TOPIC");
                let remedy = Remedy::Name { purpose, argument: Argument::Ticks, value };
                LogProblem::Topic { topic: topic.to_owned(), found: "there are no messages".to_owned(), remedy }
            }
        }
    }

    /// What was lost to damage.
    fn lost(&self, damage: Option<Damage>, topics: &[String; 2], messages: [usize; 2]) -> Option<String> {
        let file = &self.file;
        let read = messages[0] + messages[1];
        let expected = self.messages_of(topics).map(|n| n as usize).filter(|n| *n > read);
        let of = expected.map_or(String::new(), |n| format!(" of {n}"));
        match (damage, expected) {
            (Some(damage), _) => {
                let place = self.place(&damage);
                let lost = damage.at.map_or(String::new(), |at| {
                    let lost = self.size().saturating_sub(at);
                    let share = 100.0 * lost as f64 / self.size() as f64;
                    format!("; {lost} bytes ({share:.1} %) of the file are lost")
                });
                Some(format!(
                    "{file}: damaged {place}; read up to there: {read}{of} messages of the wheels and the reference{lost}"
                ))
            }
            (None, Some(_)) => Some(format!(
                "{file}: {read}{of} messages of the wheels and the reference are there; the others are missing"
            )),
            (None, None) => None,
        }
    }
}

impl Decoding {
    fn take(&mut self, record: Record) -> Result<(), LogProblem> {
        let Record::Message { channel, log_time, data } = record else { return Ok(()) };
        let Some((_, decoder, role)) = self.decoders.iter().find(|(id, ..)| *id == channel) else { return Ok(()) };
        let place = *role as usize;
        self.messages[place] += 1;
        let (wheels, track) = (&mut self.wheels, &mut self.track);
        let decoded = decoder.read(data, &mut self.fields, &mut |fields| match (role, &mut *track) {
            (Role::Reference, Some(track)) => track.take(log_time, fields),
            _ => wheels.take(log_time, fields),
        });
        let problem = |found| {
            let (topic, number) = (self.topics[place].clone(), self.messages[place]);
            LogProblem::Message { topic, number, found }
        };
        decoded.map_err(problem)?.map_err(problem)?;
        if self.messages[place] > MOST_MESSAGES {
            return Err(LogProblem::Topic {
                topic: self.topics[place].clone(),
                found: format!("there are more than {MOST_MESSAGES} messages"),
                remedy: "cut the log into runs".into(),
            });
        }
        Ok(())
    }
}
