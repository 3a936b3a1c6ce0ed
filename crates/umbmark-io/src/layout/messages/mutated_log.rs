//! No log makes the reader panic, hang or swell: good logs with random damage, always the same damage for the same seed.
//!
//! The tool is this file: mutation by our own Philox streams on stable Rust, in layers, so that damage gets past the
//! checksums of chunks: whole files, records inside of chunks that are packed anew, schemas, and messages. A short run is
//! part of every test run; `UMBMARK_MUTATIONS=1500000` sets how many inputs a layer gets. That many were run: 12 million
//! schemas and messages, 1.5 million of JSON and 3 million of protobuf; and 200 000 whole files with
//! `UMBMARK_MUTATIONS=4000000`. They found one panic in a library, which is guarded against (docs/studies/mutations.md).

use super::super::mcap::write;
use super::damaged::{exaggerated, read_file, rounds};
use super::definitions::{JOINT_STATE, KnownType, ODOMETRY, POSE_STAMPED, TF};
use super::fields::Fields;
use super::message_type::{Encoding, MessageType, PoseType};
use super::plan::Plan;
use super::protobuf;
use super::schema::Schema;
use super::{Topics, json};
use crate::RobotFile;
use crate::mutated_input::damage;
use std::io::{Cursor, Write};
use umbmark_core::dataset::{ReferencePose, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::random::Stream;

fn log() -> TickLog {
    let pose = |sample: usize| ReferencePose { sample, x: 0.01 * sample as f64, y: 0.0, heading: Some(0.1) };
    TickLog {
        time: (0..40).map(|i| 0.05 * f64::from(i)).collect(),
        left: (0..40).map(|i| f64::from(3 * i)).collect(),
        right: (0..40).map(|i| f64::from(2 * i)).collect(),
        reference: (0..40).step_by(4).map(pose).collect(),
        ..TickLog::default()
    }
}

fn file_of(log: &TickLog) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    write(&mut file, &RobotFile::new(Robot::labmate(), None), log, 0.0).unwrap();
    file.into_inner()
}

/// Damages files as they are, and files of records without chunks, where no checksum stands in the way.
#[test]
fn damaged_files() {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    let mut read = |bytes: &[u8], wish: &Topics| {
        let handle = file.as_file_mut();
        handle.set_len(0).unwrap();
        std::io::Seek::rewind(handle).unwrap();
        handle.write_all(bytes).unwrap();
        read_file(file.path(), wish, &Robot::labmate()).is_ok()
    };
    let packed = file_of(&log());
    let loose = loose(&packed);
    let wishes = [Topics::default(), Topics { ticks: Some("/odom".into()), reference: Some("/tf".into()) }];
    for (purpose, good) in [(31, &packed), (32, &loose)] {
        let mut stream = Stream::new(7, purpose, 0);
        let mut fine = 0;
        assert!(wishes.iter().all(|wish| read(good, wish)), "the undamaged file is good");
        let rounds = rounds(40);
        for round in 0..rounds {
            let bytes = if round % 3 == 0 { exaggerated(good, &mut stream) } else { damage(good, &mut stream) };
            fine += u64::from(read(&bytes, &wishes[round as usize % 2]));
        }
        assert!(fine > 0 && fine < rounds, "{fine}: damage too heavy or too light to tell anything");
    }
}

/// The records of a file in one chunk that is neither packed nor has a checksum.
fn loose(packed: &[u8]) -> Vec<u8> {
    let options = mcap::WriteOptions::new().compression(None).calculate_chunk_crcs(false).emit_summary_records(false);
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    for message in mcap::MessageStream::new(packed).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

fn types() -> [(KnownType, MessageType); 4] {
    [
        (JOINT_STATE, MessageType::Joints),
        (ODOMETRY, MessageType::Odometry),
        (POSE_STAMPED, MessageType::Pose(PoseType::Stamped)),
        (TF, MessageType::Transforms),
    ]
}

/// A message of a type.
fn message_of(definition: &KnownType) -> Vec<u8> {
    let packed = file_of(&log());
    let messages = mcap::MessageStream::new(&packed).unwrap().map(Result::unwrap);
    let of_type =
        |message: &mcap::Message| message.channel.schema.as_ref().is_some_and(|schema| schema.name == definition.name);
    messages.filter(of_type).nth(7).unwrap().data.into_owned()
}

/// Whether a message could be decoded; ends long before its claims would.
fn decoded(plan: &Plan, data: &[u8]) -> bool {
    let mut visited = 0;
    let read = plan.read(data, &mut Fields::default(), &mut |_| {
        visited += 1;
        Ok::<(), ()>(())
    });
    assert!(visited <= data.len());
    read.is_ok()
}

#[test]
fn damaged_schemas_and_messages() {
    for (number, (definition, kind)) in types().into_iter().enumerate() {
        let text = definition.text();
        let message = message_of(&definition);
        let plan = |text: &[u8]| Plan::new(Encoding::Cdr, &Schema::parse(definition.name, text)?, &kind.layout());
        let whole = plan(text.as_bytes()).unwrap();
        assert!(decoded(&whole, &message), "{}", definition.name);
        let mut stream = Stream::new(7, 33 + number as u64, 0);
        let (mut planned, mut fine) = (0, 0);
        for _ in 0..rounds(1) {
            if let Ok(plan) = plan(&damage(text.as_bytes(), &mut stream)) {
                planned += 1;
                decoded(&plan, &message);
            }
            fine += u64::from(decoded(&whole, &damage(&message, &mut stream)));
        }
        assert!(planned > 0 && planned < rounds(1), "{planned}");
        assert!(fine > 0 && fine < rounds(1), "{fine}");
    }
}

#[test]
fn damaged_json() {
    let good = r#"{"timestamp": {"sec": 5, "nsec": 7}, "frame_id": "a", "pose": {"position": {"x": 1.0, "y": -2e3, "z": 0},
        "orientation": {"x": 0, "y": 0, "z": 0.6, "w": 0.8}}}"#;
    let layout = MessageType::Pose(PoseType::InFrame).layout();
    let read = |data: &[u8]| json::read(&layout, data, &mut Fields::default(), &mut |_| Ok::<(), ()>(())).is_ok();
    assert!(read(good.as_bytes()));
    let mut stream = Stream::new(7, 37, 0);
    let fine = (0..rounds(1)).filter(|_| read(&damage(good.as_bytes(), &mut stream))).count() as u64;
    assert!(fine > 0 && fine < rounds(1), "{fine}");
}

/// A set of descriptors of one message: `double x = 1; double y = 2;` in the form of the wire.
fn descriptors() -> Vec<u8> {
    let field = |name: u8, number: u8| vec![0x12, 9, 0x0a, 1, name, 0x18, number, 0x20, 1, 0x28, 1];
    let message = [vec![0x0a, 1, b'P'], field(b'x', 1), field(b'y', 2)].concat();
    let file = [vec![0x0a, 1, b'f', 0x22, message.len() as u8], message].concat();
    [vec![0x0a, file.len() as u8], file].concat()
}

#[test]
fn damaged_protobuf() {
    use super::fields::{Layout, Number, Slot};
    let layout = Layout::default().need("x", Slot::Number(Number::X)).need("y", Slot::Number(Number::Y));
    let good = descriptors();
    let data: Vec<u8> = [&[0x09][..], &1.5f64.to_le_bytes(), &[0x11], &2.5f64.to_le_bytes()].concat();
    let whole = protobuf::descriptor("P", &good).unwrap();
    let mut fields = Fields::default();
    let mut read = |descriptor: &_, data: &[u8]| {
        protobuf::read(descriptor, &layout, data, &mut fields, &mut |_| Ok::<(), ()>(())).is_ok()
    };
    assert!(read(&whole, &data));
    let mut stream = Stream::new(7, 38, 0);
    let (mut defined, mut fine) = (0, 0);
    for _ in 0..rounds(1) {
        if let Ok(descriptor) = protobuf::descriptor("P", &damage(&good, &mut stream)) {
            defined += 1;
            read(&descriptor, &data);
        }
        fine += u64::from(read(&whole, &damage(&data, &mut stream)));
    }
    assert!(defined > 0 && fine > 0 && fine < rounds(1), "{defined} {fine}");
}
