//! What can be wrong with a log of messages.

use crate::remedy::{Argument, Remedy, Words};
use std::fmt;

/// What makes a log of messages unusable, without the name of its file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LogProblem {
    /// The file does not begin as files of messages do.
    #[error("is no MCAP file and no bag of ROS: it {found}; record with `ros2 bag record`, or convert the log")]
    Unknown {
        /// What it does instead.
        found: String,
    },
    /// Nothing could be read before the damage.
    #[error("cannot be read: {damage}; nothing before that can be used; record or copy the log again")]
    Damaged {
        /// Where and what.
        damage: String,
    },
    /// No topic has what is needed.
    #[error(
        "no topic holds wheel counts; it needs sensor_msgs/JointState positions, integers called left and right, or nav_msgs/Odometry; there are: {topics}"
    )]
    NoTicks {
        /// The topics that are there, with their types.
        topics: String,
    },
    /// Two topics or more could be meant.
    #[error("{}", self.worded(&Words::PLAIN))]
    AmbiguousTopic {
        /// "the wheels" or "the reference".
        role: &'static str,
        /// The candidates.
        topics: String,
        /// The argument that decides.
        argument: Argument,
    },
    /// A topic that was asked for and is not there.
    #[error("{}", self.worded(&Words::PLAIN))]
    UnknownTopic {
        /// What was asked for, quoted.
        topic: String,
        /// The argument that asked for it.
        argument: Argument,
        /// The topics that are there.
        topics: String,
    },
    /// A topic whose messages cannot be what it is needed for.
    #[error("{}", self.worded(&Words::PLAIN))]
    Topic {
        /// The topic, quoted.
        topic: String,
        /// What is wrong with it.
        found: String,
        /// What to do.
        remedy: Remedy,
    },
    /// A message that cannot be decoded, or that holds what cannot be.
    #[error("topic {topic}: message {number} {found}; record again, or cut the message out")]
    Message {
        /// The topic, quoted.
        topic: String,
        /// Which message of the topic, from 1.
        number: usize,
        /// What is wrong with it.
        found: String,
    },
}

impl LogProblem {
    /// The message, which names the arguments as an edge does.
    pub fn worded(&self, words: &Words) -> String {
        match self {
            LogProblem::AmbiguousTopic { role, topics, argument } => {
                format!("{role} could be {topics}; {}", Remedy::which(*argument).worded(words))
            }
            LogProblem::UnknownTopic { topic, argument, topics } => {
                format!("there is no topic {topic} for {}; there are: {topics}", words.name(*argument))
            }
            LogProblem::Topic { topic, found, remedy } => format!("topic {topic}: {found}; {}", remedy.worded(words)),
            _ => self.to_string(),
        }
    }
}

/// Names for a message: as they are, separated by commas, and no more than a few.
pub(in crate::layout) fn listed<T: fmt::Display>(names: impl IntoIterator<Item = T>) -> String {
    const MAX_NAMES: usize = 12;
    let mut names = names.into_iter();
    let mut shown: Vec<String> = names.by_ref().take(MAX_NAMES).map(|name| name.to_string()).collect();
    let others = names.count();
    if others > 0 {
        shown.push(format!("and {others} more"));
    }
    if shown.is_empty() { "none".to_owned() } else { shown.join(", ") }
}
