//! A log before its messages are read: its topics, and the robot that it may bring along.

use super::container::{self, Channel, Container, Contents, Damage, Stop, Visit};
use super::message_type::{Encoding, MessageType};
use super::problem::LogProblem;
use super::topics::{Chosen, Topic, shown};
use crate::error::DatasetError;
use crate::source::unreadable;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The definition of a type of message.
#[derive(Clone, Debug, Default)]
pub(in crate::layout) struct Definition {
    pub name: String,
    pub encoding: String,
    pub data: Vec<u8>,
}

/// An open log, looked through.
pub(in crate::layout) struct Survey {
    pub(in crate::layout) file: String,
    path: PathBuf,
    /// The layout of such files.
    pub(in crate::layout) layout: &'static str,
    container: Box<dyn Container>,
    contents: Contents,
    pub(in crate::layout) topics: Vec<Topic>,
    damage: Option<Damage>,
}

impl Survey {
    /// Opens a log by what it says of itself or, where it says nothing, by reading all of it.
    pub fn open(path: &Path) -> Result<Survey, DatasetError> {
        let file = path.display().to_string();
        let opened = container::open(path);
        let (layout, container) = opened.map_err(|stop| match stop {
            Stop::System(error) => unreadable(path, &error),
            Stop::Problem(problem) => DatasetError::Messages { file: file.clone(), problem: Box::new(problem) },
            Stop::Damage(damage) => {
                let place = damage.at.map(|at| format!("at byte {at} (")).unwrap_or_default();
                let end = if damage.at.is_some() { ")" } else { "" };
                let problem = LogProblem::Damaged { damage: format!("{place}{}{end}", damage.what) };
                DatasetError::Messages { file: file.clone(), problem: Box::new(problem) }
            }
        })?;
        let mut survey = Survey {
            file,
            path: path.to_owned(),
            layout,
            container,
            contents: Contents::default(),
            topics: Vec::new(),
            damage: None,
        };
        match survey.container.contents() {
            Some(contents) => survey.contents = contents,
            None => {
                let (contents, end) = container::look_through(survey.container.as_mut());
                survey.contents = contents;
                survey.damage = survey.damage(end.map_or(Ok(()), Err))?;
            }
        }
        survey.list_topics();
        Ok(survey)
    }

    /// The text of the robot.toml that the log brings along.
    pub fn robot(&self) -> Option<&str> {
        self.contents.robot.as_deref()
    }

    fn list_topics(&mut self) {
        let mut topics: BTreeMap<&str, Topic> = BTreeMap::new();
        for (id, channel) in &self.contents.channels {
            let messages = self.contents.counts.as_ref().map(|counts| counts.get(id).copied().unwrap_or(0));
            if let Some(topic) = topics.get_mut(channel.topic.as_str()) {
                topic.messages = topic.messages.zip(messages).map(|(a, b)| a.saturating_add(b));
                continue;
            }
            let definition = self.contents.definitions.get(&channel.schema).cloned().unwrap_or_default();
            let encoding = Encoding::of(&channel.encoding, &definition.encoding);
            let known = encoding.and_then(|e| Some((e, MessageType::of(e, &definition.name, &definition.data)?)));
            let topic = Topic {
                name: channel.topic.clone(),
                schema: definition.name,
                known,
                encoding: channel.encoding.clone(),
                messages,
            };
            topics.insert(&channel.topic, topic);
        }
        self.topics = topics.into_values().collect();
    }

    /// Visits the records, but for messages of channels that are not wanted; says where there is damage.
    pub(in crate::layout) fn walk(
        &mut self,
        wanted: &dyn Fn(u16) -> bool,
        visit: &mut Visit,
    ) -> Result<Option<Damage>, DatasetError> {
        let walked = self.container.walk(wanted, visit);
        self.damage(walked)
    }

    /// Where a walk ended because of damage.
    fn damage(&self, walked: Result<(), Stop>) -> Result<Option<Damage>, DatasetError> {
        match walked {
            Ok(()) => Ok(None),
            Err(Stop::Damage(damage)) => Ok(Some(damage)),
            Err(Stop::Problem(problem)) => {
                Err(DatasetError::Messages { file: self.file.clone(), problem: Box::new(problem) })
            }
            Err(Stop::System(error)) => Err(unreadable(&self.path, &error)),
        }
    }

    /// How a chosen topic is written, and what it is.
    pub(in crate::layout) fn known(&self, chosen: &Chosen) -> Result<(Encoding, MessageType), LogProblem> {
        let topic = self.topics.iter().find(|topic| topic.name == chosen.topic);
        topic.and_then(|topic| topic.known.clone()).ok_or_else(|| LogProblem::NoTicks { topics: shown(&chosen.topic) })
    }

    /// The channels of a topic, how each is written, and its definition.
    pub(in crate::layout) fn channels_of(&self, topic: &str) -> impl Iterator<Item = (u16, &str, Definition)> {
        let of_topic = self.contents.channels.iter().filter(move |(_, channel)| channel.topic == topic);
        let definition =
            |channel: &Channel| self.contents.definitions.get(&channel.schema).cloned().unwrap_or_default();
        of_topic.map(move |(id, channel)| (*id, channel.encoding.as_str(), definition(channel)))
    }

    /// How many messages there are of a topic, as the log says or as were passed by.
    pub(in crate::layout) fn messages(&self, topic: &Topic) -> u64 {
        let of_topic = self.contents.channels.iter().filter(|(_, channel)| channel.topic == topic.name);
        topic.messages.unwrap_or_else(|| of_topic.filter_map(|(id, _)| self.contents.passed.get(id)).sum())
    }

    /// Time from the first message to the last \[s\]; `None` where there are none, or where only one time is known.
    pub(in crate::layout) fn duration(&self) -> Option<f64> {
        let [first, last] = self.contents.span?;
        (last > first).then(|| (last - first) as f64 / 1e9)
    }

    /// How many messages there are of some topics, by their shown names, where the log says so.
    pub(in crate::layout) fn messages_of(&self, topics: &[String]) -> Option<u64> {
        let wanted = self.topics.iter().filter(|topic| topics.contains(&shown(&topic.name)));
        wanted.map(|topic| topic.messages).try_fold(0u64, |sum, n| Some(sum.saturating_add(n?)))
    }

    /// Size of the file \[byte\].
    pub(in crate::layout) fn size(&self) -> u64 {
        self.container.size()
    }

    /// Damage for people.
    pub(in crate::layout) fn place(&self, damage: &Damage) -> String {
        match damage.at {
            Some(at) => format!("at byte {at} of {} ({})", self.size(), damage.what),
            None => format!("({})", damage.what),
        }
    }

    /// The damage, where that is why a topic was not found.
    pub(in crate::layout) fn blamed(&self, problem: LogProblem) -> LogProblem {
        match (&problem, &self.damage) {
            (LogProblem::NoTicks { .. }, Some(damage)) => LogProblem::Damaged { damage: self.place(damage) },
            _ => problem,
        }
    }
}
