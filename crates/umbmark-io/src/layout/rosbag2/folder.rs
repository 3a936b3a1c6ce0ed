//! A bag of several files, which its metadata.yaml lists in their order.

use super::super::messages::{self, Channel, Container, Contents, LONGEST, LogProblem, Opened, Record, Stop, Visit};
use super::METADATA;
use crate::error::quoted;
use crate::probe::names_in;
use crate::unfinished::Unfinished;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, copy};
use std::path::{Component, Path, PathBuf};
use tempfile::NamedTempFile;

/// What is read of metadata.yaml.
#[derive(Deserialize)]
struct Document {
    rosbag2_bagfile_information: Bag,
}

#[derive(Deserialize)]
struct Bag {
    #[serde(default)]
    relative_file_paths: Vec<PathBuf>,
    #[serde(default)]
    compression_format: String,
    #[serde(default)]
    compression_mode: String,
}

/// No log packs better than this; what claims to is not unpacked beyond `FREE` bytes.
const MOST_PACKED: u64 = 1000;
const FREE: u64 = 1 << 30;

/// Endings of files of a bag.
const PARTS: [&str; 6] = ["mcap", "db3", "mcap.zstd", "db3.zstd", "mcap.zst", "db3.zst"];

/// The number at the end of the name of a file that was split.
fn number_of(path: &Path) -> u64 {
    let name = path.display().to_string();
    let stem = name.split('.').next().unwrap_or_default();
    stem.rsplit('_').next().and_then(|number| number.parse().ok()).unwrap_or(0)
}

/// The files of a bag, read one after the other.
struct Folder {
    parts: Vec<Part>,
    /// Whether each message is packed.
    packs_messages: bool,
}

/// A file of a bag.
struct Part {
    name: String,
    container: Box<dyn Container>,
    /// Number of the whole for each channel of the file.
    numbers: BTreeMap<u16, u16>,
    /// Holds the unpacked file, where it was packed.
    _unpacked: Option<(NamedTempFile, Unfinished)>,
}

pub(super) fn open(folder: &Path) -> Opened {
    let text = std::fs::read_to_string(folder.join(METADATA))?;
    let document: Document = serde_saphyr::from_str(&text)
        .map_err(|error| Stop::damage(None, format!("{METADATA} does not list its files: {error}")))?;
    let bag = document.rosbag2_bagfile_information;
    let mode = bag.compression_mode.to_lowercase();
    let packed = matches!(mode.as_str(), "file" | "message");
    if packed && bag.compression_format != "zstd" {
        let found = format!("is packed by {}, where zstd can be read", quoted(&bag.compression_format));
        return Err(LogProblem::Unknown { found }.into());
    }
    let mut paths = bag.relative_file_paths;
    if paths.is_empty() {
        // A recorder that was killed lists nothing; files that were split are numbered.
        let is_part = |name: &String| PARTS.iter().any(|ending| name.to_lowercase().ends_with(&format!(".{ending}")));
        let names = names_in(folder).map_err(|_| Stop::damage(None, "its folder cannot be read"))?;
        paths = names.into_iter().filter(is_part).map(PathBuf::from).collect();
        paths.sort_by_key(|path| number_of(path));
    }
    if paths.is_empty() {
        return Err(Stop::damage(
            None,
            format!("{METADATA} lists no files, and there are none (.{})", PARTS.join(", .")),
        ));
    }
    let parts = paths.iter().map(|path| part(folder, path)).collect::<Result<_, _>>()?;
    Ok(Box::new(Folder { parts, packs_messages: mode == "message" }))
}

/// Opens a file of the folder.
fn part(folder: &Path, path: &Path) -> Result<Part, Stop> {
    let name = path.display().to_string();
    let inside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside {
        return Err(Stop::damage(None, format!("{METADATA} lists {}, which is outside of the folder", quoted(&name))));
    }
    // Older bags list paths that begin with the name of the folder.
    let places = [Some(folder.join(path)), path.file_name().map(|name| folder.join(name))];
    let file = places.into_iter().flatten().find(|place| place.is_file());
    let file =
        file.ok_or_else(|| Stop::damage(None, format!("{METADATA} lists {}, which is not there", quoted(&name))))?;
    let unpacked = file.extension().is_some_and(|ending| ending == "zstd" || ending == "zst");
    let unpacked = unpacked.then(|| unpack(&file)).transpose()?;
    let (_, container) = messages::open(unpacked.as_ref().map_or(&file, |(unpacked, _)| unpacked.path()))?;
    Ok(Part { name, container, numbers: BTreeMap::new(), _unpacked: unpacked })
}

/// A packed file beside it, unpacked; it goes away with what holds it.
fn unpack(file: &Path) -> Result<(NamedTempFile, Unfinished), Stop> {
    let (mut unpacked, unfinished) = Unfinished::begin(NamedTempFile::new, |file| file.path())?;
    let broken = |_| Stop::damage(None, format!("{} cannot be unpacked", quoted(&file.display().to_string())));
    let source = File::open(file)?;
    let most = FREE.saturating_add(MOST_PACKED.saturating_mul(source.metadata()?.len()));
    let mut source = zstd::Decoder::new(source).map_err(broken)?.take(most);
    if copy(&mut source, &mut unpacked).map_err(broken)? == most {
        let name = quoted(&file.display().to_string());
        return Err(Stop::damage(None, format!("{name} unpacks to more than {MOST_PACKED} times its size")));
    }
    Ok((unpacked, unfinished))
}

impl Container for Folder {
    fn size(&self) -> u64 {
        self.parts.iter().map(|part| part.container.size()).sum()
    }

    fn contents(&mut self) -> Option<Contents> {
        let mut whole = Contents { counts: Some(BTreeMap::new()), ..Contents::default() };
        for part in &mut self.parts {
            // Where a file does not say what it holds, all of it is read. Damage is told by the walk that reads messages.
            let container = part.container.as_mut();
            let own = container.contents().unwrap_or_else(|| messages::look_through(container).0);
            for (id, channel) in own.channels {
                let number = u16::try_from(whole.channels.len()).ok()?;
                let definition = own.definitions.get(&channel.schema).cloned();
                whole.definitions.insert(number, definition.unwrap_or_default());
                whole.channels.insert(number, Channel { schema: number, ..channel });
                part.numbers.insert(id, number);
                let count = own.counts.as_ref().map(|counts| counts.get(&id).copied().unwrap_or(0));
                let told = whole.counts.as_mut().zip(count).map(|(counts, count)| counts.insert(number, count));
                if told.is_none() {
                    whole.counts = None;
                }
                whole.passed.insert(number, count.or(own.passed.get(&id).copied()).unwrap_or(0));
            }
            let join = |[a, b]: [u64; 2], [c, d]: [u64; 2]| [a.min(c), b.max(d)];
            whole.span = match (whole.span, own.span.filter(|span| span[1] > 0)) {
                (Some(before), Some(own)) => Some(join(before, own)),
                (before, own) => before.or(own),
            };
            whole.robot = whole.robot.or(own.robot);
        }
        Some(whole)
    }

    fn walk(&mut self, wanted: &dyn Fn(u16) -> bool, visit: &mut Visit) -> Result<(), Stop> {
        let (mut at, mut buffer) = (0, Vec::new());
        for Part { name, container, numbers, .. } in &mut self.parts {
            let number = |id: u16| numbers.get(&id).copied().filter(|number| wanted(*number));
            let size = container.size();
            let walked = container.walk(&|id| number(id).is_some(), &mut |record| {
                let Record::Message { channel, log_time, data } = record else { return Ok(()) };
                let Some(channel) = number(channel) else { return Ok(()) };
                if !self.packs_messages {
                    return visit(Record::Message { channel, log_time, data });
                }
                buffer.clear();
                let unpacked = zstd::Decoder::new(data);
                let unpacked = unpacked.and_then(|source| source.take(LONGEST as u64).read_to_end(&mut buffer));
                if unpacked.is_err() {
                    return Err(LogProblem::Damaged { damage: "a message cannot be unpacked".to_owned() });
                }
                visit(Record::Message { channel, log_time, data: &buffer })
            });
            walked.map_err(|stop| match stop {
                Stop::Damage(damage) => Stop::damage(damage.at.map(|own| at + own), format!("{name}: {}", damage.what)),
                stop => stop,
            })?;
            at += size;
        }
        Ok(())
    }
}
