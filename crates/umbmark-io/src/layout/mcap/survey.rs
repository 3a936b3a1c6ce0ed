//! A log before its messages are read: its topics, and the robot that it may bring along.

use super::container::{Container, Damage, Record, Visit};
use super::message_type::{Encoding, MessageType};
use super::problem::McapProblem;
use super::topics::{Chosen, Topic, shown};
use crate::error::DatasetError;
use crate::source::unreadable;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Metadata with the robot of a simulated log, and its key.
pub(super) const METADATA: &str = "umbmark";
pub(super) const ROBOT: &str = "robot.toml";

/// The definition of a type of message.
#[derive(Clone, Debug, Default)]
pub(super) struct Definition {
    pub name: String,
    encoding: String,
    pub data: Vec<u8>,
}

#[derive(Clone, Debug)]
struct Channel {
    schema: u16,
    topic: String,
    encoding: String,
}

/// An open log, looked through.
pub(in super::super) struct Survey {
    pub(super) file: String,
    path: PathBuf,
    container: Container,
    definitions: HashMap<u16, Definition>,
    channels: BTreeMap<u16, Channel>,
    /// Messages of each channel, where the log says so.
    counts: Option<BTreeMap<u16, u64>>,
    /// The messages that were passed by where it does not.
    passed: BTreeMap<u16, u64>,
    /// Time of the first and of the last message \[ns\].
    span: Option<[u64; 2]>,
    /// Which channels each chunk has messages of, where the log says so, and where it begins.
    chunks: Vec<(u64, Vec<u16>)>,
    pub(super) topics: Vec<Topic>,
    damage: Option<Damage>,
    /// The text of the robot.toml that the log brings along.
    pub robot: Option<String>,
}

impl Survey {
    /// Opens a log by its summary or, without one, by reading all of it.
    pub fn open(path: &Path) -> Result<Survey, DatasetError> {
        let file = path.display().to_string();
        let opened = File::open(path).and_then(Container::open).map_err(|error| unreadable(path, &error))?;
        let container =
            opened.map_err(|problem| DatasetError::Mcap { file: file.clone(), problem: Box::new(problem) })?;
        let mut survey = Survey {
            file,
            path: path.to_owned(),
            container,
            definitions: HashMap::new(),
            channels: BTreeMap::new(),
            counts: None,
            passed: BTreeMap::new(),
            span: None,
            chunks: Vec::new(),
            topics: Vec::new(),
            damage: None,
            robot: None,
        };
        match survey.container.summary().filter(|summary| !summary.channels.is_empty()) {
            Some(summary) => survey.take_summary(&summary)?,
            None => survey.look_through()?,
        }
        survey.list_topics();
        Ok(survey)
    }

    fn take_summary(&mut self, summary: &mcap::Summary) -> Result<(), DatasetError> {
        for (id, channel) in &summary.channels {
            let schema = channel.schema.as_ref();
            if let Some(schema) = schema {
                let (name, encoding) = (schema.name.clone(), schema.encoding.clone());
                self.definitions.insert(schema.id, Definition { name, encoding, data: schema.data.to_vec() });
            }
            let (topic, encoding) = (channel.topic.clone(), channel.message_encoding.clone());
            self.channels.insert(*id, Channel { schema: schema.map_or(0, |schema| schema.id), topic, encoding });
        }
        self.counts = summary.stats.as_ref().map(|statistics| statistics.channel_message_counts.clone());
        self.span = summary.stats.as_ref().map(|of| [of.message_start_time, of.message_end_time]);
        let with_index = summary.chunk_indexes.iter().filter(|chunk| !chunk.message_index_offsets.is_empty());
        self.chunks = with_index
            .map(|chunk| (chunk.chunk_start_offset, chunk.message_index_offsets.keys().copied().collect()))
            .collect();
        let ours = summary.metadata_indexes.iter().any(|index| index.name == METADATA);
        if ours {
            // What the metadata says stands before the chunks, all of which are stepped over.
            let all = summary.chunk_indexes.iter().map(|chunk| chunk.chunk_start_offset).collect();
            let mut robot = None;
            self.walk(&all, &mut |record| {
                take_robot(&record, &mut robot);
                Ok(())
            })?;
            self.robot = robot;
        }
        Ok(())
    }

    fn look_through(&mut self) -> Result<(), DatasetError> {
        let (mut definitions, mut channels, mut robot) = (HashMap::new(), BTreeMap::new(), None);
        let (mut passed, mut span) = (BTreeMap::new(), None::<[u64; 2]>);
        let damage = self.walk(&HashSet::new(), &mut |record| {
            take_robot(&record, &mut robot);
            match record {
                Record::Schema { id, name, encoding, data } => {
                    definitions.entry(id).or_insert_with(|| Definition { name, encoding, data: data.to_vec() });
                }
                Record::Channel { id, schema, topic, encoding } => {
                    channels.entry(id).or_insert(Channel { schema, topic, encoding });
                }
                Record::Message { channel, log_time, .. } => {
                    *passed.entry(channel).or_insert(0) += 1;
                    let [first, last] = span.unwrap_or([log_time; 2]);
                    span = Some([first.min(log_time), last.max(log_time)]);
                }
                Record::Metadata(_) => {}
            }
            Ok(())
        })?;
        (self.passed, self.span) = (passed, span);
        (self.definitions, self.channels, self.robot, self.damage) = (definitions, channels, robot, damage);
        Ok(())
    }

    fn list_topics(&mut self) {
        let mut topics: BTreeMap<&str, Topic> = BTreeMap::new();
        for (id, channel) in &self.channels {
            let messages = self.counts.as_ref().map(|counts| counts.get(id).copied().unwrap_or(0));
            if let Some(topic) = topics.get_mut(channel.topic.as_str()) {
                topic.messages = topic.messages.zip(messages).map(|(a, b)| a.saturating_add(b));
                continue;
            }
            let definition = self.definitions.get(&channel.schema).cloned().unwrap_or_default();
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

    /// Visits the records but for the chunks in `skip`; says where there is damage.
    pub(super) fn walk(&mut self, skip: &HashSet<u64>, visit: &mut Visit) -> Result<Option<Damage>, DatasetError> {
        let walked = self.container.walk(skip, visit).map_err(|error| unreadable(&self.path, &error))?;
        walked.map_err(|problem| DatasetError::Mcap { file: self.file.clone(), problem: Box::new(problem) })
    }

    /// Where the chunks begin that have no message of a wanted channel.
    pub(super) fn chunks_without(&self, wanted: impl Fn(u16) -> bool) -> HashSet<u64> {
        let without = self.chunks.iter().filter(|(_, channels)| !channels.iter().any(|channel| wanted(*channel)));
        without.map(|(start, _)| *start).collect()
    }

    /// How a chosen topic is written, and what it is.
    pub(super) fn known(&self, chosen: &Chosen) -> Result<(Encoding, MessageType), McapProblem> {
        let topic = self.topics.iter().find(|topic| topic.name == chosen.topic);
        topic.and_then(|topic| topic.known.clone()).ok_or_else(|| McapProblem::NoTicks { topics: shown(&chosen.topic) })
    }

    /// The channels of a topic, with their definitions.
    pub(super) fn channels_of(&self, topic: &str) -> impl Iterator<Item = (u16, Definition)> {
        let of_topic = self.channels.iter().filter(move |(_, channel)| channel.topic == topic);
        of_topic.map(|(id, channel)| (*id, self.definitions.get(&channel.schema).cloned().unwrap_or_default()))
    }

    /// How many messages there are of a topic, as the log says or as were passed by.
    pub(super) fn messages(&self, topic: &Topic) -> u64 {
        let of_topic = self.channels.iter().filter(|(_, channel)| channel.topic == topic.name);
        topic.messages.unwrap_or_else(|| of_topic.filter_map(|(id, _)| self.passed.get(id)).sum())
    }

    /// Time from the first message to the last \[s\]; `None` where there are none, or where only one time is known.
    pub(super) fn duration(&self) -> Option<f64> {
        let [first, last] = self.span?;
        (last > first).then(|| (last - first) as f64 / 1e9)
    }

    /// How many messages there are of some topics, by their shown names, where the log says so.
    pub(super) fn messages_of(&self, topics: &[String]) -> Option<u64> {
        let wanted = self.topics.iter().filter(|topic| topics.contains(&shown(&topic.name)));
        wanted.map(|topic| topic.messages).try_fold(0u64, |sum, n| Some(sum.saturating_add(n?)))
    }

    /// Size of the file \[byte\].
    pub(super) fn size(&self) -> u64 {
        self.container.size
    }

    /// Damage for people.
    pub(super) fn place(&self, damage: &Damage) -> String {
        format!("at byte {} of {} ({})", damage.at, self.size(), damage.what)
    }

    /// The damage, where that is why a topic was not found.
    pub(super) fn blamed(&self, problem: McapProblem) -> McapProblem {
        match (&problem, &self.damage) {
            (McapProblem::NoTicks { .. }, Some(damage)) => McapProblem::Damaged { damage: self.place(damage) },
            _ => problem,
        }
    }
}

fn take_robot(record: &Record, robot: &mut Option<String>) {
    if let Record::Metadata(metadata) = record
        && metadata.name == METADATA
    {
        *robot = metadata.metadata.get(ROBOT).cloned();
    }
}
