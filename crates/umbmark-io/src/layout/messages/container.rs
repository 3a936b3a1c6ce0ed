//! What messages lie in: MCAP, SQLite, a bag of ROS 1, or several of them one after the other.

use super::super::{LAYOUTS, folder_of_messages};
use super::problem::LogProblem;
use super::survey::Definition;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;

/// The longest record, message or unpacked chunk that is read \[byte\].
pub(in crate::layout) const LONGEST: usize = 128 << 20;

/// A record that matters here.
pub(in crate::layout) enum Record<'a> {
    /// A message definition.
    Schema { id: u16, definition: Definition },
    /// A topic and how its messages are written.
    Channel { id: u16, channel: Channel },
    /// A message.
    Message { channel: u16, log_time: u64, data: &'a [u8] },
    /// The text of the robot.toml that a log brings along.
    Robot(String),
}

/// A topic, and how its messages are written.
#[derive(Clone, Debug)]
pub(in crate::layout) struct Channel {
    pub schema: u16,
    pub topic: String,
    pub encoding: String,
}

/// What a container says of itself.
#[derive(Clone, Debug, Default)]
pub(in crate::layout) struct Contents {
    pub definitions: HashMap<u16, Definition>,
    pub channels: BTreeMap<u16, Channel>,
    /// Messages of each channel, where it says so.
    pub counts: Option<BTreeMap<u16, u64>>,
    /// The messages of each that were passed by, where it does not.
    pub passed: BTreeMap<u16, u64>,
    /// Time of the first and of the last message \[ns\].
    pub span: Option<[u64; 2]>,
    /// The text of the robot.toml that it brings along.
    pub robot: Option<String>,
}

/// Where reading ended before the end.
#[derive(Clone, Debug)]
pub(in crate::layout) struct Damage {
    /// First byte that was not used, where there is such an order.
    pub at: Option<u64>,
    /// What is wrong there.
    pub what: String,
}

/// What ends a walk early.
pub(in crate::layout) enum Stop {
    Damage(Damage),
    Problem(LogProblem),
    System(io::Error),
}

impl Stop {
    /// Damage at this byte.
    pub fn damage(at: impl Into<Option<u64>>, what: impl Into<String>) -> Stop {
        Stop::Damage(Damage { at: at.into(), what: what.into() })
    }

    pub fn at(self, at: u64) -> Stop {
        match self {
            Stop::Damage(Damage { what, .. }) => Stop::damage(at, what),
            stop => stop,
        }
    }
}

impl From<LogProblem> for Stop {
    fn from(problem: LogProblem) -> Stop {
        Stop::Problem(problem)
    }
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Stop {
        Stop::System(error)
    }
}

/// What opening a file gives.
pub(in crate::layout) type Opened = Result<Box<dyn Container>, Stop>;

/// Takes the records of a walk.
pub(in crate::layout) type Visit<'v> = dyn FnMut(Record) -> Result<(), LogProblem> + 'v;

/// An open file of messages, or several that are read as one.
pub(in crate::layout) trait Container {
    /// Its size \[byte\].
    fn size(&self) -> u64;

    /// What it says of itself, where that is there and sound.
    fn contents(&mut self) -> Option<Contents>;

    /// Visits its records, in the order in which they lie there. Messages of channels that are not wanted may be left out.
    ///
    /// # Errors
    /// What ends the walk before the end of the file.
    fn walk(&mut self, wanted: &dyn Fn(u16) -> bool, visit: &mut Visit) -> Result<(), Stop>;
}

/// What a container holds, found by reading all of it, and what ended that early.
pub(in crate::layout) fn look_through(container: &mut dyn Container) -> (Contents, Option<Stop>) {
    let mut contents = Contents::default();
    let end = container.walk(&|_| true, &mut |record| {
        match record {
            Record::Schema { id, definition } => {
                contents.definitions.entry(id).or_insert(definition);
            }
            Record::Channel { id, channel } => {
                contents.channels.entry(id).or_insert(channel);
            }
            Record::Message { channel, log_time, .. } => {
                *contents.passed.entry(channel).or_insert(0) += 1;
                let [first, last] = contents.span.unwrap_or([log_time; 2]);
                contents.span = Some([first.min(log_time), last.max(log_time)]);
            }
            Record::Robot(text) => contents.robot = Some(text),
        }
        Ok(())
    });
    (contents, end.err())
}

/// Opens a file of messages, whatever its name is: its first bytes tell what it is.
pub(in crate::layout) fn open(path: &Path) -> Result<(&'static str, Box<dyn Container>), Stop> {
    if let Some((layout, open)) = folder_of_messages(path) {
        return Ok((layout.name, open(path)?));
    }
    let mut file = File::open(path)?;
    let mut start = Vec::new();
    file.by_ref().take(32).read_to_end(&mut start)?;
    file.rewind()?;
    let known = LAYOUTS.iter().find_map(|layout| {
        let messages = layout.messages.filter(|messages| start.starts_with(messages.magic))?;
        Some((layout.name, messages.open))
    });
    if let Some((layout, open)) = known {
        return Ok((layout, open(path, file)?));
    }
    let found = match start {
        _ if start.is_empty() => "is empty".to_owned(),
        _ if start.starts_with(&[0x1f, 0x8b]) => "is packed by gzip (unpack it first)".to_owned(),
        _ => format!("begins with the bytes {:02x?}", &start[..start.len().min(8)]),
    };
    Err(LogProblem::Unknown { found }.into())
}
