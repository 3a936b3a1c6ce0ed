//! Which topics hold the wheels and the reference.
//!
//! They are found by type. Of the topics that tell how the wheels turned, the one nearest to the encoders is taken:
//! integer counts, then joint positions, then odometry. Of those that tell where the robot was: poses, then single
//! transforms, then odometry that is not the wheels, then /tf, then gyros. Between two of the same kind the user must choose.

use super::message_type::{Encoding, MessageType};
use super::problem::{LogProblem, listed};
use crate::error::quoted;
use crate::remedy::{Argument, Remedy};

/// Topics of MCAP logs that hold what is measured; those that are not named are found by type.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topics {
    /// Topic of the wheels, `TOPIC` or `TOPIC:LEFT,RIGHT` with the names of the joints, or the order in a list of
    /// integers (`left,right` or `right,left`).
    pub ticks: Option<String>,
    /// Topic of the absolute poses, `TOPIC` or `TOPIC:CHILD_FRAME` for one of several transforms; `none` for no poses.
    pub reference: Option<String>,
}

/// A topic of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::layout) struct Topic {
    pub name: String,
    /// Name of its type.
    pub schema: String,
    /// What it is, where that means something here.
    pub known: Option<(Encoding, MessageType)>,
    /// How its messages are written, in the words of the file.
    pub encoding: String,
    /// Messages in the log, where it says so.
    pub messages: Option<u64>,
}

/// A topic that was chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::layout) struct Chosen {
    pub topic: String,
    /// What was said behind its name.
    pub part: Option<String>,
    /// Whether the user named it.
    pub named: bool,
}

struct Role {
    name: &'static str,
    argument: Argument,
    rank: fn(&MessageType) -> Option<u8>,
}

const TICKS: Role = Role {
    name: "the wheels",
    argument: Argument::Ticks,
    rank: |kind| match kind {
        MessageType::Counts { .. } => Some(0),
        MessageType::Joints => Some(1),
        MessageType::Odometry => Some(2),
        MessageType::CountList => Some(3),
        _ => None,
    },
};

const REFERENCE: Role = Role {
    name: "the reference",
    argument: Argument::Reference,
    rank: |kind| match kind {
        MessageType::Pose(_) => Some(0),
        MessageType::Transform => Some(1),
        MessageType::Odometry => Some(2),
        MessageType::Transforms => Some(3),
        MessageType::Imu => Some(4),
        _ => None,
    },
};

/// The topic of the wheels.
pub(in crate::layout) fn ticks(topics: &[Topic], wish: &Topics) -> Result<Chosen, LogProblem> {
    let found = match &wish.ticks {
        Some(wish) => Some(TICKS.named(topics, wish)?),
        None => TICKS.found(topics, None)?,
    };
    found.ok_or_else(|| LogProblem::NoTicks { topics: listed(topics.iter().map(described)) })
}

/// The topic of the reference, which is not that of the wheels; there may be none.
pub(in crate::layout) fn reference(
    topics: &[Topic],
    wish: &Topics,
    ticks: &Chosen,
) -> Result<Option<Chosen>, LogProblem> {
    match wish.reference.as_deref() {
        Some("none") => Ok(None),
        Some(wish) => REFERENCE.named(topics, wish).map(Some),
        None => REFERENCE.found(topics, Some(&ticks.topic)),
    }
}

/// The only gyro, where there is one.
pub(in crate::layout) fn gyro(topics: &[Topic]) -> Option<&Topic> {
    let is_gyro = |topic: &&Topic| {
        topic.messages != Some(0) && topic.known.as_ref().is_some_and(|(_, kind)| *kind == MessageType::Imu)
    };
    let mut gyros = topics.iter().filter(is_gyro);
    gyros.next().filter(|_| gyros.next().is_none())
}

impl Role {
    fn rank(&self, topic: &Topic) -> Option<u8> {
        topic.known.as_ref().and_then(|(_, kind)| (self.rank)(kind))
    }

    /// What the user asked for.
    fn named(&self, topics: &[Topic], wish: &str) -> Result<Chosen, LogProblem> {
        let whole = topics.iter().find(|topic| topic.name == wish).map(|topic| (topic, None));
        let found = whole.or_else(|| {
            let (name, part) = wish.rsplit_once(':')?;
            topics.iter().find(|topic| topic.name == name).map(|topic| (topic, Some(part.to_owned())))
        });
        let (topic, part) = found.ok_or_else(|| LogProblem::UnknownTopic {
            topic: quoted(wish),
            argument: self.argument,
            topics: listed(topics.iter().map(described)),
        })?;
        if self.rank(topic).is_none() {
            let found = format!("its type {} does not tell {}", quoted(&topic.schema), self.name);
            let able = topics.iter().filter(|topic| self.rank(topic).is_some()).map(described);
            let remedy = Remedy::CanBe { argument: self.argument, values: listed(able) };
            return Err(LogProblem::Topic { topic: quoted(&topic.name), found, remedy });
        }
        Ok(Chosen { topic: topic.name.clone(), part, named: true })
    }

    /// The only topic of the best kind.
    fn found(&self, topics: &[Topic], not: Option<&str>) -> Result<Option<Chosen>, LogProblem> {
        let able = |topic: &&Topic| topic.messages != Some(0) && Some(topic.name.as_str()) != not;
        let ranked = || topics.iter().filter(able).filter_map(|topic| Some((self.rank(topic)?, topic)));
        let Some(best) = ranked().map(|(rank, _)| rank).min() else { return Ok(None) };
        let candidates: Vec<&Topic> = ranked().filter(|(rank, _)| *rank == best).map(|(_, topic)| topic).collect();
        match candidates[..] {
            [topic] => Ok(Some(Chosen { topic: topic.name.clone(), part: None, named: false })),
            _ => {
                let topics = listed(candidates.into_iter().map(described));
                Err(LogProblem::AmbiguousTopic { role: self.name, topics, argument: self.argument })
            }
        }
    }
}

/// A topic for people: its name and its type, how it is written where that is not read, and whether it is empty.
fn described(topic: &Topic) -> String {
    let read = topic.known.is_some() || topic.encoding == "cdr" || topic.encoding == "json";
    let encoding = if read { String::new() } else { format!(", {}", quoted(&topic.encoding)) };
    let empty = if topic.messages == Some(0) { ", no messages" } else { "" };
    format!("{} ({}{encoding}{empty})", shown(&topic.name), shown(&topic.schema))
}

/// A name as it is where that is harmless, else quoted.
pub(in crate::layout) fn shown(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/_.-~".contains(c);
    if !name.is_empty() && name.len() <= 60 && name.chars().all(plain) { name.to_owned() } else { quoted(name) }
}
