//! `runs/*.bag`: bags of ROS 1, version 2.0, without ROS.
//!
//! Records follow one another, each with a header of named fields; messages lie in chunks, plain or packed by bzip2 or lz4. The index at the
//! end tells which topics there are and where; a bag without one, as a recorder leaves that was killed, is read from its beginning.
//!
//! Source: <https://wiki.ros.org/Bags/Format/2.0>.

use super::messages::{
    self, Channel, Container, Contents, Definition, LONGEST, OpenMessages, Opened, Record, Stop, Visit,
};
use super::{Layout, ReadLogs};
use crate::error::quoted;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};

pub(super) const LAYOUT: Layout = Layout::new("rosbag", "the same with bags of ROS 1, runs/*.bag; one run as NAME.bag")
    .reads_data((|probe| probe.extension() == "bag", messages::read))
    .reads_messages(OpenMessages { magic: MAGIC, open: |_, file| open(file) })
    .reads_logs(ReadLogs {
        ending: "bag",
        add: |assembly, file, _, topics| messages::add(assembly, file, topics),
        look: messages::look,
    });

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// Kinds of records.
mod op {
    pub const MESSAGE: u8 = 2;
    pub const BAG: u8 = 3;
    pub const INDEX: u8 = 4;
    pub const CHUNK: u8 = 5;
    pub const CHUNK_INFO: u8 = 6;
    pub const CONNECTION: u8 = 7;
}

/// An open bag.
struct Bag {
    file: BufReader<File>,
    size: u64,
    /// Where the index begins; 0 where there is none.
    index: u64,
    /// Where each chunk begins, and which connections it has messages of, where the bag says so.
    chunks: HashMap<u64, Vec<u16>>,
}

/// A record: its fields, and where its data lie.
struct Head {
    fields: Vec<u8>,
    data: u64,
}

fn open(file: File) -> Opened {
    let size = file.metadata()?.len();
    let mut bag = Bag { file: BufReader::with_capacity(1 << 16, file), size, index: 0, chunks: HashMap::new() };
    bag.file.seek(SeekFrom::Start(MAGIC.len() as u64))?;
    let first = bag.head(MAGIC.len() as u64)?;
    let fields = Fields(&first.fields);
    if fields.op() != Some(op::BAG) {
        return Err(Stop::damage(MAGIC.len() as u64, "its first record is not that of a bag"));
    }
    if fields.text("encryptor").is_some_and(|name| !name.is_empty()) {
        return Err(Stop::damage(MAGIC.len() as u64, "it is encrypted; decrypt it first"));
    }
    bag.index = fields.number("index_pos").unwrap_or(0);
    Ok(Box::new(bag))
}

impl Container for Bag {
    fn size(&self) -> u64 {
        self.size
    }

    fn contents(&mut self) -> Option<Contents> {
        if self.index == 0 || self.index >= self.size {
            return None;
        }
        let (mut contents, mut chunks, mut at) = (Contents::default(), HashMap::new(), self.index);
        let mut counts = BTreeMap::<u16, u64>::new();
        self.file.seek(SeekFrom::Start(at)).ok()?;
        while at < self.size {
            let head = self.head(at).ok()?;
            let data = self.data(at, head.data).ok()?;
            let fields = Fields(&head.fields);
            match fields.op()? {
                op::CONNECTION => {
                    let (id, channel, definition) = connection(&fields, &data)?;
                    contents.channels.insert(id, channel);
                    contents.definitions.insert(id, definition);
                }
                op::CHUNK_INFO => {
                    let [first, last] = [fields.time("start_time")?, fields.time("end_time")?];
                    let own = data.chunks_exact(8).map(|pair| (word(&pair[..4]), word(&pair[4..])));
                    let own: Vec<(u16, u32)> =
                        own.map(|(id, n)| Some((u16::try_from(id).ok()?, n))).collect::<Option<_>>()?;
                    own.iter().for_each(|(id, n)| *counts.entry(*id).or_insert(0) += u64::from(*n));
                    if !own.is_empty() {
                        let [from, to] = contents.span.unwrap_or([first, last]);
                        contents.span = Some([from.min(first), to.max(last)]);
                    }
                    chunks.insert(fields.number("chunk_pos")?, own.into_iter().map(|(id, _)| id).collect());
                }
                _ => return None,
            }
            at = self.file.stream_position().ok()?;
        }
        if contents.channels.is_empty() {
            return None;
        }
        contents.counts = Some(counts);
        self.chunks = chunks;
        Some(contents)
    }

    fn walk(&mut self, wanted: &dyn Fn(u16) -> bool, visit: &mut Visit) -> Result<(), Stop> {
        let mut at = MAGIC.len() as u64;
        self.file.seek(SeekFrom::Start(at))?;
        // Connections are told once by the index, and by every chunk again.
        let end = if self.index > 0 && !self.chunks.is_empty() { self.index.min(self.size) } else { self.size };
        while at < end {
            let head = self.head(at)?;
            let fields = Fields(&head.fields);
            let length = head.data;
            match fields.op() {
                Some(op::CHUNK) if self.is_wanted(at, wanted) => {
                    let data = self.data(at, length)?;
                    let size = fields.number("size").unwrap_or(0);
                    let data = unpacked(data, fields.text("compression").unwrap_or_default(), size)
                        .map_err(|what| Stop::damage(at, what))?;
                    records(&data, visit).map_err(|stop| stop.at(at))?;
                }
                Some(op::MESSAGE | op::CONNECTION) => {
                    let data = self.data(at, length)?;
                    record(&fields, &data, visit).map_err(|stop| stop.at(at))?;
                }
                Some(op::BAG | op::INDEX | op::CHUNK | op::CHUNK_INFO) => self.step_over(at, length)?,
                other => {
                    let kind =
                        other.map_or("without a kind".to_owned(), |op| format!("of kind {op}, which does not exist"));
                    return Err(Stop::damage(at, format!("a record {kind}")));
                }
            }
            at = self.file.stream_position()?;
        }
        Ok(())
    }
}

impl Bag {
    fn is_wanted(&self, chunk: u64, wanted: &dyn Fn(u16) -> bool) -> bool {
        self.chunks.get(&chunk).is_none_or(|connections| connections.iter().any(|id| wanted(*id)))
    }

    /// The header of the record that begins at a byte, where the file stands.
    fn head(&mut self, at: u64) -> Result<Head, Stop> {
        let length = self.length(at)?;
        let fields = self.data(at, length)?;
        let data = self.length(at)?;
        Ok(Head { fields, data })
    }

    fn length(&mut self, at: u64) -> Result<u64, Stop> {
        let mut bytes = [0; 4];
        match self.file.read_exact(&mut bytes) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Err(cut(at)),
            read => Ok(read.map(|()| u64::from(u32::from_le_bytes(bytes)))?),
        }
    }

    fn data(&mut self, at: u64, length: u64) -> Result<Vec<u8>, Stop> {
        if self.file.stream_position()?.saturating_add(length) > self.size {
            return Err(cut(at));
        }
        let length = usize::try_from(length).ok().filter(|length| *length <= LONGEST).ok_or_else(|| too_long(at))?;
        let mut data = vec![0; length];
        self.file.read_exact(&mut data)?;
        Ok(data)
    }

    fn step_over(&mut self, at: u64, length: u64) -> Result<(), Stop> {
        if self.file.stream_position()?.saturating_add(length) > self.size {
            return Err(cut(at));
        }
        Ok(self.file.seek_relative(length as i64)?)
    }
}

fn cut(at: u64) -> Stop {
    Stop::damage(at, "the file ends in the middle of a record")
}

fn too_long(at: u64) -> Stop {
    Stop::damage(at, format!("a record or chunk of more than {} MiB", LONGEST >> 20))
}

/// What a chunk holds.
fn unpacked(data: Vec<u8>, compression: &str, size: u64) -> Result<Vec<u8>, String> {
    let most = LONGEST as u64;
    if size > most {
        return Err(format!("a chunk of more than {} MiB", LONGEST >> 20));
    }
    let mut out = Vec::new();
    let read = match compression {
        "" | "none" => return Ok(data),
        "bz2" => bzip2::read::BzDecoder::new(&data[..]).take(most).read_to_end(&mut out),
        "lz4" => lz4::Decoder::new(&data[..]).and_then(|decoder| decoder.take(most).read_to_end(&mut out)),
        other => return Err(format!("a chunk packed with {}, where bz2, lz4 or none can be read", quoted(other))),
    };
    match read {
        Ok(_) if out.len() as u64 == size => Ok(out),
        _ => Err("a chunk that cannot be unpacked".to_owned()),
    }
}

/// The records of a chunk.
fn records(mut data: &[u8], visit: &mut Visit) -> Result<(), Stop> {
    fn part<'d>(data: &mut &'d [u8]) -> Option<&'d [u8]> {
        let (length, rest) = data.split_first_chunk::<4>()?;
        let (part, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        *data = rest;
        Some(part)
    }
    while !data.is_empty() {
        let (Some(fields), Some(body)) = (part(&mut data), part(&mut data)) else {
            return Err(Stop::damage(0, "a chunk that ends in the middle of a record"));
        };
        record(&Fields(fields), body, visit)?;
    }
    Ok(())
}

/// Passes a record on, if it is of those that matter.
fn record(fields: &Fields, data: &[u8], visit: &mut Visit) -> Result<(), Stop> {
    let broken = || Stop::damage(0, "a record that contradicts itself");
    match fields.op() {
        Some(op::MESSAGE) => {
            let (id, log_time) = fields.id().zip(fields.time("time")).ok_or_else(broken)?;
            Ok(visit(Record::Message { channel: id, log_time, data })?)
        }
        Some(op::CONNECTION) => {
            let (id, channel, definition) = connection(fields, data).ok_or_else(broken)?;
            visit(Record::Schema { id, definition })?;
            Ok(visit(Record::Channel { id, channel })?)
        }
        _ => Ok(()),
    }
}

/// A connection: its number, its topic, and its type.
fn connection(fields: &Fields, data: &[u8]) -> Option<(u16, Channel, Definition)> {
    let (id, of) = (fields.id()?, Fields(data));
    let topic = fields.text("topic").filter(|topic| !topic.is_empty()).or_else(|| of.text("topic"))?;
    let channel = Channel { schema: id, topic: topic.to_owned(), encoding: "ros1".to_owned() };
    let definition = Definition {
        name: of.text("type")?.to_owned(),
        encoding: "ros1msg".to_owned(),
        data: of.bytes("message_definition")?.to_vec(),
    };
    Some((id, channel, definition))
}

/// Named fields: each a length, a name, an equals sign and a value.
struct Fields<'d>(&'d [u8]);

impl<'d> Fields<'d> {
    fn bytes(&self, wanted: &str) -> Option<&'d [u8]> {
        let mut rest = self.0;
        while let Some((length, after)) = rest.split_first_chunk::<4>() {
            let (field, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
            let middle = field.iter().position(|byte| *byte == b'=')?;
            if &field[..middle] == wanted.as_bytes() {
                return Some(&field[middle + 1..]);
            }
            rest = after;
        }
        None
    }

    fn op(&self) -> Option<u8> {
        self.bytes("op")?.first().copied()
    }

    fn text(&self, name: &str) -> Option<&'d str> {
        std::str::from_utf8(self.bytes(name)?).ok()
    }

    /// A number of 4 or 8 bytes.
    fn number(&self, name: &str) -> Option<u64> {
        let bytes = self.bytes(name)?;
        matches!(bytes.len(), 4 | 8).then(|| bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    fn id(&self) -> Option<u16> {
        self.number("conn").and_then(|id| u16::try_from(id).ok())
    }

    /// A time in whole seconds and nanoseconds, in nanoseconds.
    fn time(&self, name: &str) -> Option<u64> {
        let (seconds, rest) = self.bytes(name)?.split_at_checked(4)?;
        (rest.len() == 4).then(|| u64::from(word(seconds)) * 1_000_000_000 + u64::from(word(rest)))
    }
}

fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::super::messages::damaged::{Damaged, read};
    use super::*;
    use umbmark_core::drive::Robot;

    /// A record of some fields.
    fn written(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
        let field = |(name, value): &(&str, &[u8])| {
            let text = [name.as_bytes(), b"=", value].concat();
            [&(text.len() as u32).to_le_bytes()[..], &text].concat()
        };
        let head: Vec<u8> = fields.iter().flat_map(field).collect();
        [&(head.len() as u32).to_le_bytes()[..], &head, &(data.len() as u32).to_le_bytes(), data].concat()
    }

    /// A bag of counts, in a chunk that is packed, or without chunks as a stream.
    fn bag(compression: Option<&str>) -> Vec<u8> {
        let of_type =
            [("type", &b"demo/Ticks"[..]), ("message_definition", b"int32 left\nint32 right\n"), ("md5sum", b"0")];
        let named = written(&of_type, &[]);
        let named = &named[4..named.len() - 4];
        let mut records = written(&[("op", &[op::CONNECTION]), ("conn", &[3, 0, 0, 0]), ("topic", b"/ticks")], named);
        for k in 0..40_i32 {
            let time =
                [1_600_000_000_u32 + k as u32 / 10, 100_000_000 * (k as u32 % 10)].map(u32::to_le_bytes).concat();
            let data = [3 * k, 2 * k].map(i32::to_le_bytes).concat();
            records.extend(written(&[("op", &[op::MESSAGE]), ("conn", &[3, 0, 0, 0]), ("time", &time)], &data));
        }
        let body = match compression {
            None => records,
            Some(name) => {
                let size = (records.len() as u32).to_le_bytes();
                let mut packed = Vec::new();
                match name {
                    "bz2" => {
                        let mut encoder = bzip2::read::BzEncoder::new(&records[..], bzip2::Compression::best());
                        encoder.read_to_end(&mut packed).unwrap();
                    }
                    _ => packed = records,
                }
                written(&[("op", &[op::CHUNK]), ("compression", name.as_bytes()), ("size", &size)], &packed)
            }
        };
        let head = written(&[("op", &[op::BAG]), ("index_pos", &[0; 8]), ("conn_count", &[1, 0, 0, 0])], &[b' '; 64]);
        [MAGIC, &head, &body].concat()
    }

    #[test]
    fn counts_and_times_are_those_of_the_messages() {
        for compression in [None, Some("none"), Some("bz2")] {
            let log = read(&bag(compression)).unwrap();
            assert_eq!(log.left[..3], [0.0, 3.0, 6.0]);
            assert_eq!(log.right[39], 78.0);
            assert!((log.time[39] - log.time[0] - 3.9).abs() < 1e-9);
        }
    }

    #[test]
    fn what_cannot_be_read_is_said_and_what_can_is_kept() {
        let good = bag(None);
        let log = read(&good[..good.len() - 200]).unwrap();
        assert!((30..39).contains(&log.time.len()), "{}", log.time.len());
        let said = |bytes: &[u8]| read(bytes).unwrap_err();
        assert!(said(&bag(Some("zip"))).contains("packed with \"zip\", where bz2, lz4 or none can be read"));
        assert!(said(&good[..40]).contains("ends in the middle of a record"), "{}", said(&good[..40]));
        assert!(
            said(&[MAGIC, &written(&[("op", &[9])], &[])].concat()).contains("its first record is not that of a bag")
        );
        let locked =
            written(&[("op", &[op::BAG]), ("index_pos", &[0; 8]), ("encryptor", b"rosbag/AesCbcEncryptor")], &[]);
        assert!(said(&[MAGIC, &locked].concat()).contains("it is encrypted"));
    }

    #[test]
    fn damage_makes_no_panic_and_no_number_that_is_none() {
        for (purpose, good) in [(41, bag(None)), (42, bag(Some("none"))), (43, bag(Some("bz2")))] {
            Damaged { good: &good, purpose, share: 20 }.read_all(&Robot::labmate());
        }
    }
}
