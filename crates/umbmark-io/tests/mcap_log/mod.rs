//! MCAP files made for tests, record by record.

#![allow(dead_code, reason = "each test file uses a part")]

use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use re_cdr::{CdrWriter, LittleEndian};
use std::collections::BTreeMap;
use std::io::Cursor;

pub const ROBOT: &str = "[robot]\nwheelbase_m = 0.4\nwheel_diameter_m = 0.1\nticks_per_revolution = 1000\n";

const STAMP: &str = "===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
                     ===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const POSE: &str = "===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n\
                    ===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n\
                    ===\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

/// Type, encoding of its definition, definition, encoding of its messages.
pub type Type = (&'static str, &'static str, String, &'static str);

/// A message of so many milliseconds after the beginning.
pub type Make = fn(u64) -> Vec<u8>;

pub fn ros2(name: &'static str, text: &str) -> Type {
    (name, "ros2msg", text.to_owned(), "cdr")
}

pub fn joint_state() -> Type {
    let own = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n";
    ros2("sensor_msgs/msg/JointState", &format!("{own}{STAMP}"))
}

pub fn pose_stamped() -> Type {
    let own = "std_msgs/Header header\ngeometry_msgs/Pose pose\n";
    ros2("geometry_msgs/msg/PoseStamped", &format!("{own}{STAMP}{POSE}"))
}

pub fn tf() -> Type {
    let own = "geometry_msgs/TransformStamped[] transforms\n\
               ===\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\nTransform transform\n\
               ===\nMSG: geometry_msgs/Transform\nPoint translation\nQuaternion rotation\n";
    ros2("tf2_msgs/msg/TFMessage", &format!("{own}{STAMP}{POSE}"))
}

pub fn json(name: &'static str, schema: &str) -> Type {
    (name, "jsonschema", schema.to_owned(), "json")
}

pub fn json_ticks() -> Type {
    json("wheel_ticks", r#"{"properties": {"left": {"type": "integer"}, "right": {"type": "integer"}}}"#)
}

/// Writes CDR: a header, then what `fill` writes.
pub fn cdr(time: u64, frame: &str, fill: impl FnOnce(&mut CdrWriter<'_, LittleEndian>)) -> Vec<u8> {
    let mut body = Vec::new();
    let mut writer = CdrWriter::new(&mut body);
    writer.write_i32((time / 1_000_000_000) as i32);
    writer.write_u32((time % 1_000_000_000) as u32);
    writer.write_string(frame);
    fill(&mut writer);
    [vec![0, 1, 0, 0], body].concat()
}

pub fn joints(time: u64, names: &[&str], positions: &[f64]) -> Vec<u8> {
    cdr(time, "", |cdr| {
        cdr.write_u32(names.len() as u32);
        names.iter().for_each(|name| cdr.write_string(name));
        cdr.write_u32(positions.len() as u32);
        positions.iter().for_each(|position| cdr.write_f64(*position));
        cdr.write_u32(0);
        cdr.write_u32(0);
    })
}

/// The position of a wheel after so many milliseconds: it stands for 0.1 s, then turns.
pub fn turned(ms: u64) -> f64 {
    ms.saturating_sub(100) as f64 * 1e-3
}

pub fn wheels(ms: u64) -> Vec<u8> {
    joints(ms * 1_000_000, &["left_wheel", "right_wheel"], &[turned(ms), 1.1 * turned(ms)])
}

pub fn pose(time: u64, frame: &str, numbers: [f64; 7]) -> Vec<u8> {
    cdr(time, frame, |cdr| numbers.into_iter().for_each(|number| cdr.write_f64(number)))
}

pub fn somewhere(ms: u64) -> Vec<u8> {
    pose(ms * 1_000_000, "map", [0.05 * turned(ms), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
}

/// A file in the making.
pub struct Log {
    writer: Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<String, u16>,
}

impl Log {
    pub fn new() -> Log {
        Log::with(WriteOptions::new().compression(Some(Compression::Zstd)).chunk_size(Some(4096)))
    }

    pub fn with(options: WriteOptions) -> Log {
        let writer = options.compression_threads(0).create(Cursor::new(Vec::new())).unwrap();
        Log { writer, channels: BTreeMap::new() }
    }

    pub fn topic(mut self, topic: &str, (name, encoding, schema, messages): Type) -> Log {
        let schema = self.writer.add_schema(name, encoding, schema.as_bytes()).unwrap();
        let channel = self.writer.add_channel(schema, topic, messages, &BTreeMap::new()).unwrap();
        self.channels.insert(topic.to_owned(), channel);
        self
    }

    pub fn message(mut self, topic: &str, time: u64, data: &[u8]) -> Log {
        let header =
            MessageHeader { channel_id: self.channels[topic], sequence: 0, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, data).unwrap();
        self
    }

    /// A message every ten milliseconds on each topic.
    pub fn messages(mut self, count: u64, topics: &[(&str, Make)]) -> Log {
        for ms in (0..count).map(|i| 10 * i) {
            for (topic, make) in topics {
                self = self.message(topic, ms * 1_000_000, &make(ms));
            }
        }
        self
    }

    pub fn bytes(mut self) -> Vec<u8> {
        self.writer.finish().unwrap();
        self.writer.into_inner().into_inner()
    }
}

/// A log that is good: 1 s of wheels and poses in several chunks.
pub fn good() -> Log {
    let log = Log::new().topic("/joint_states", joint_state()).topic("/mocap", pose_stamped());
    log.messages(100, &[("/joint_states", wheels), ("/mocap", somewhere)])
}

/// The records of a file that has no more than these: magic, header, and what is given.
pub fn file_of(records: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    for (opcode, body) in [(1u8, vec![0; 8])].iter().chain(records) {
        file.push(*opcode);
        file.extend((body.len() as u64).to_le_bytes());
        file.extend(body);
    }
    file
}
