//! The container: records one after the other, chunk by chunk, up to the end or to the damage.
//!
//! The file is walked record by record, so that a chunk or an attachment that nobody asked for is stepped over, and the
//! place of damage is known to the byte. Chunks are unpacked by the `mcap` crate, each with its checksum tested before
//! any of its messages is used. No more than one chunk is in memory.

use super::super::messages::{Channel, Container, Contents, Definition, LONGEST, Opened, Record, Stop, Visit};
use crate::error::quoted;
use crate::file_names::ROBOT;
use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::{
    LinearReadEvent, LinearReader, LinearReaderOptions, SummaryReadEvent, SummaryReader, SummaryReaderOptions,
};
use std::collections::HashSet;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// No long log packs better than this; what claims to is not unpacked beyond `FREE` bytes.
const MOST_PACKED: u64 = 1000;
const FREE: u64 = 1 << 30;
/// Opcode and length of a record.
const HEAD: usize = 9;
/// Start of a chunk: its times and its unpacked size.
const CHUNK_SIZES: usize = 24;

/// Metadata with the robot of a simulated log.
pub(super) const METADATA: &str = "umbmark";

/// An open file.
struct McapFile {
    file: BufReader<File>,
    size: u64,
    /// What came out of chunks \[byte\].
    unpacked: u64,
    /// Where each chunk begins, and which channels it has messages of, where the log says so.
    chunks: Vec<(u64, Vec<u16>)>,
}

/// Begins a file.
pub(super) fn open(file: File) -> Opened {
    let size = file.metadata()?.len();
    Ok(Box::new(McapFile { file: BufReader::with_capacity(1 << 16, file), size, unpacked: 0, chunks: Vec::new() }))
}

impl Container for McapFile {
    fn size(&self) -> u64 {
        self.size
    }

    fn contents(&mut self) -> Option<Contents> {
        let summary = self.summary().filter(|summary| !summary.channels.is_empty())?;
        let mut contents = Contents::default();
        for (id, channel) in &summary.channels {
            let schema = channel.schema.as_ref();
            if let Some(schema) = schema {
                let (name, encoding) = (schema.name.clone(), schema.encoding.clone());
                contents.definitions.insert(schema.id, Definition { name, encoding, data: schema.data.to_vec() });
            }
            let (topic, encoding) = (channel.topic.clone(), channel.message_encoding.clone());
            contents.channels.insert(*id, Channel { schema: schema.map_or(0, |schema| schema.id), topic, encoding });
        }
        contents.counts = summary.stats.as_ref().map(|statistics| statistics.channel_message_counts.clone());
        contents.span = summary.stats.as_ref().map(|of| [of.message_start_time, of.message_end_time]);
        let with_index = summary.chunk_indexes.iter().filter(|chunk| !chunk.message_index_offsets.is_empty());
        self.chunks = with_index
            .map(|chunk| (chunk.chunk_start_offset, chunk.message_index_offsets.keys().copied().collect()))
            .collect();
        if summary.metadata_indexes.iter().any(|index| index.name == METADATA) {
            // What the metadata says stands before the chunks, all of which are stepped over.
            let all = summary.chunk_indexes.iter().map(|chunk| chunk.chunk_start_offset).collect();
            let robot = &mut contents.robot;
            // Damage is told by the walk that reads messages.
            let _ = self.records(&all, &mut |record| {
                if let Record::Robot(text) = record {
                    *robot = Some(text);
                }
                Ok(())
            });
        }
        Some(contents)
    }

    fn walk(&mut self, wanted: &dyn Fn(u16) -> bool, visit: &mut Visit) -> Result<(), Stop> {
        let without = self.chunks.iter().filter(|(_, channels)| !channels.iter().any(|channel| wanted(*channel)));
        let skip = without.map(|(start, _)| *start).collect();
        self.records(&skip, visit)
    }
}

impl McapFile {
    /// The summary at the end of the file, where there is one and it is sound.
    fn summary(&mut self) -> Option<mcap::Summary> {
        let options = SummaryReaderOptions::default().with_file_size(self.size).with_record_length_limit(LONGEST);
        let mut reader = SummaryReader::new_with_options(options);
        let file = &mut self.file;
        let read = catch_unwind(AssertUnwindSafe(|| {
            while let Some(event) = reader.next_event() {
                match event.ok()? {
                    SummaryReadEvent::ReadRequest(n) => {
                        let read = file.read(reader.insert(n)).ok()?;
                        reader.notify_read(read);
                    }
                    SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(file.seek(to).ok()?),
                }
            }
            reader.finish()
        }));
        read.ok().flatten()
    }

    /// Visits the records of the data section but for the chunks that begin at the bytes in `skip`.
    fn records(&mut self, skip: &HashSet<u64>, visit: &mut Visit) -> Result<(), Stop> {
        let mut at = mcap::MAGIC.len() as u64;
        let mut body = Vec::new();
        self.file.seek(SeekFrom::Start(at))?;
        self.unpacked = 0;
        loop {
            let damaged = |what: &str| Stop::damage(at, what);
            if self.size - at < HEAD as u64 {
                return Err(damaged("the file ends without the end of an MCAP file"));
            }
            let mut head = [0; HEAD];
            self.file.read_exact(&mut head)?;
            let opcode = head[0];
            let length = u64::from_le_bytes([head[1], head[2], head[3], head[4], head[5], head[6], head[7], head[8]]);
            let left = self.size - at - HEAD as u64;
            match opcode {
                op::DATA_END | op::FOOTER => return Ok(()),
                0 => return Err(damaged(NO_RECORD)),
                op::CHUNK if length > left || !skip.contains(&at) => self.chunk(at, head, length, visit)?,
                _ if length > left => return Err(damaged("the file ends in the middle of a record")),
                op::SCHEMA | op::CHANNEL | op::MESSAGE | op::METADATA => {
                    let length = usize::try_from(length).ok().filter(|length| *length <= LONGEST);
                    body.resize(length.ok_or_else(|| damaged(&too_long("record")))?, 0);
                    self.file.read_exact(&mut body)?;
                    record(opcode, &body, visit).map_err(|stop| stop.at(at))?;
                }
                _ => self.file.seek_relative(length as i64)?,
            }
            at += HEAD as u64 + length;
        }
    }

    /// A chunk. Where it is whole, none of its records is used if its checksum is wrong; where its end is missing, they
    /// are used as far as they can be unpacked.
    fn chunk(&mut self, at: u64, head: [u8; HEAD], length: u64, visit: &mut Visit) -> Result<(), Stop> {
        let damaged = |what: String| Stop::damage(at, what);
        let left = self.size - at - HEAD as u64;
        let whole = length <= left;
        let mut start = [0; CHUNK_SIZES];
        let started = usize::try_from(length.min(left)).unwrap_or(CHUNK_SIZES).min(CHUNK_SIZES);
        self.file.read_exact(&mut start[..started])?;
        let unpacked = start[CHUNK_SIZES - 8..].iter().rev().fold(0, |size, byte| size << 8 | u64::from(*byte));
        if whole && length > LONGEST as u64 || unpacked > LONGEST as u64 {
            return Err(damaged(too_long("chunk")));
        }
        let mut chunk = Unpacking {
            reader: LinearReader::new_with_options(options().with_prevalidate_chunk_crcs(whole)),
            source: head.chain(&start[..started]).chain(self.file.by_ref().take(length - started as u64)),
            left: HEAD as u64 + length.min(left),
            unpacked: &mut self.unpacked,
            most: FREE.saturating_add(MOST_PACKED.saturating_mul(at + length.min(left))),
        };
        // The crate's arithmetic overflows on some inconsistent chunks; in builds that check for it, that is a panic.
        let read = catch_unwind(AssertUnwindSafe(|| chunk.read(visit)));
        match read.unwrap_or_else(|_| Err(Stop::damage(at, "a chunk that contradicts itself"))) {
            Err(Stop::Damage(damage)) if whole => Err(damaged(damage.what)),
            Ok(()) if whole => Ok(()),
            Ok(()) | Err(Stop::Damage(_)) => Err(damaged("the file ends in the middle of a chunk".into())),
            stop => stop,
        }
    }
}

/// A chunk that is being unpacked.
struct Unpacking<'c, R> {
    reader: LinearReader,
    source: R,
    /// Bytes of the source that can still come.
    left: u64,
    /// What came out of all chunks, and may come out \[byte\].
    unpacked: &'c mut u64,
    most: u64,
}

impl<R: Read> Unpacking<'_, R> {
    fn read(&mut self, visit: &mut Visit) -> Result<(), Stop> {
        let damaged = |what: String| Stop::damage(0, what);
        while let Some(event) = self.reader.next_event() {
            match event.map_err(|error| damaged(described(&error)))? {
                LinearReadEvent::ReadRequest(n) => {
                    let size = n.max(1 << 16).min(usize::try_from(self.left).unwrap_or(usize::MAX)).max(1);
                    let read = self.source.read(&mut self.reader.insert(size)[..size])?;
                    self.left -= (read as u64).min(self.left);
                    self.reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode: 0, .. } => return Err(damaged(NO_RECORD.to_owned())),
                LinearReadEvent::Record { opcode, data } => {
                    *self.unpacked += (HEAD + data.len()) as u64;
                    if *self.unpacked > self.most {
                        return Err(damaged(format!("a chunk that unpacks to more than {MOST_PACKED} times its size")));
                    }
                    record(opcode, data, visit)?;
                }
            }
        }
        Ok(())
    }
}

const NO_RECORD: &str = "a record of kind 0, which does not exist";

fn options() -> LinearReaderOptions {
    let options = LinearReaderOptions::default().with_skip_start_magic(true).with_skip_end_magic(true);
    options.with_record_length_limit(LONGEST)
}

/// Passes a record on, if it is of those that matter.
fn record(opcode: u8, body: &[u8], visit: &mut Visit) -> Result<(), Stop> {
    if opcode == op::MESSAGE {
        let (Some((head, data)), true) = (body.split_first_chunk::<22>(), body.len() >= 22) else {
            return Err(Stop::damage(0, "a message that is shorter than its header"));
        };
        let channel = u16::from_le_bytes([head[0], head[1]]);
        let log_time = head[6..14].iter().rev().fold(0, |time, byte| time << 8 | u64::from(*byte));
        return Ok(visit(Record::Message { channel, log_time, data })?);
    }
    if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::METADATA) {
        return Ok(());
    }
    let parsed = mcap::parse_record(opcode, body).map_err(|error| Stop::damage(0, described(&error)))?;
    let record = match &parsed {
        mcap::records::Record::Schema { header, data } => {
            let (name, encoding) = (header.name.clone(), header.encoding.clone());
            Record::Schema { id: header.id, definition: Definition { name, encoding, data: data.to_vec() } }
        }
        mcap::records::Record::Channel(channel) => Record::Channel {
            id: channel.id,
            channel: Channel {
                schema: channel.schema_id,
                topic: channel.topic.clone(),
                encoding: channel.message_encoding.clone(),
            },
        },
        mcap::records::Record::Metadata(metadata) if metadata.name == METADATA => {
            let Some(robot) = metadata.metadata.get(ROBOT) else { return Ok(()) };
            Record::Robot(robot.clone())
        }
        _ => return Ok(()),
    };
    Ok(visit(record)?)
}

fn too_long(what: &str) -> String {
    format!("a {what} of more than {} MiB", LONGEST >> 20)
}

/// What the crate found, in words for people.
fn described(error: &McapError) -> String {
    match error {
        McapError::BadChunkCrc { .. } => "a chunk whose checksum is wrong".to_owned(),
        McapError::DecompressionError(_) | McapError::Io(_) => "a chunk that cannot be unpacked".to_owned(),
        McapError::UnsupportedCompression(name) => {
            format!("a chunk packed with {}, where zstd, lz4 or none can be read", quoted(name))
        }
        McapError::RecordTooLarge { .. } | McapError::ChunkTooLarge(_) => too_long("record or chunk"),
        McapError::UnexpectedEof | McapError::UnexpectedEoc => "a chunk that ends in the middle of a record".to_owned(),
        _ => "a record that contradicts itself".to_owned(),
    }
}
