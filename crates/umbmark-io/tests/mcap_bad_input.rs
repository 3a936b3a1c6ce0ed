//! Each unusable MCAP log gets one clear error: file, topic or place in the file, what is wrong, what to do.

use crate::mcap_log::*;
use crate::sentences::{COMMAND, sentences};
use mcap::{Compression, WriteOptions};
use std::collections::BTreeMap;
use umbmark_io::Topics;

struct Case {
    name: &'static str,
    file: Vec<u8>,
    topics: Topics,
    robot: bool,
}

fn case(name: &'static str, file: Vec<u8>) -> Case {
    Case { name, file, topics: Topics::default(), robot: true }
}

fn asked(name: &'static str, file: Vec<u8>, ticks: &str, reference: &str) -> Case {
    let wish = |text: &str| (!text.is_empty()).then(|| text.to_owned());
    Case { name, file, topics: Topics { ticks: wish(ticks), reference: wish(reference) }, robot: true }
}

fn said(case: &Case) -> String {
    let folder = tempfile::tempdir().unwrap();
    if case.robot {
        std::fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
    }
    let file = folder.path().join("run.mcap");
    std::fs::write(&file, &case.file).unwrap();
    let said = match umbmark_io::load_with(&file, &case.topics) {
        Ok(data) => format!("no error, and {:?}", data.warnings),
        Err(error) => error.worded(&COMMAND),
    };
    assert_eq!(std::fs::read(&file).unwrap(), case.file, "{}: reading touched the file", case.name);
    said.replace(&format!("{}/", folder.path().display()), "")
}

fn containers() -> Vec<Case> {
    let good = good().bytes();
    let chunk = good.iter().position(|byte| *byte == 6).unwrap();
    let mut broken_chunk = good.clone();
    broken_chunk[chunk + 200] ^= 0xff;
    let without_summary = |bytes: &[u8]| bytes[..bytes.len() - 200].to_vec();
    let chunk_of = |compression: &str, size: u64, records: &[u8]| {
        let mut body = vec![0; 16];
        body.extend(size.to_le_bytes());
        body.extend([0; 4]);
        body.extend((compression.len() as u32).to_le_bytes());
        body.extend(compression.as_bytes());
        body.extend((records.len() as u64).to_le_bytes());
        body.extend(records);
        (6, body)
    };
    let mut huge = file_of(&[]);
    huge.push(5);
    huge.extend((1u64 << 40).to_le_bytes());
    let unpacked = 64 << 20;
    let mut endless = file_of(&[]);
    endless.push(6);
    endless.extend([0xff; 30]);
    vec![
        case("a chunk that claims all there can be", endless),
        case("an empty file", Vec::new()),
        case("a text", b"t_s,ticks_left,ticks_right\n".to_vec()),
        case("a bag of ROS 1", b"#ROSBAG V2.0\n".to_vec()),
        case("a bag in SQLite", b"SQLite format 3\0".to_vec()),
        case("a log packed by gzip", b"\x1f\x8b\x08\0\0\0\0\0\0\x03".to_vec()),
        case("nothing behind the first bytes", mcap::MAGIC.to_vec()),
        case("a record that does not exist", [mcap::MAGIC, &[0; 40]].concat()),
        case("a record that claims a terabyte", huge),
        case("cut off in its first record", good[..20].to_vec()),
        case("a first chunk whose checksum is wrong", without_summary(&broken_chunk)),
        case("a packing that nobody knows", file_of(&[chunk_of("brotli", 100, &[1; 50])])),
        case("a chunk that is no zstd", file_of(&[chunk_of("zstd", 100, &[1; 50])])),
        case("a chunk that claims to unpack to a terabyte", file_of(&[chunk_of("zstd", 1 << 40, &bomb())])),
        case(
            "chunks that unpack to a thousand times their size",
            file_of(&vec![chunk_of("zstd", unpacked, &bomb()); 20]),
        ),
        case(
            "a chunk whose record is longer than it",
            file_of(&[chunk_of("", 20, &[5, 255, 255, 255, 0, 0, 0, 0, 0, 1, 1])]),
        ),
        case("a message shorter than its header", file_of(&[(5, vec![0; 3])])),
        case("no messages", Log::new().topic("/joint_states", joint_state()).bytes()),
        case("no topics", Log::new().bytes()),
    ]
}

/// 64 MiB of one message that nobody asks for, packed with zstd.
fn bomb() -> Vec<u8> {
    let mut log = Log::with(WriteOptions::new().compression(Some(Compression::Zstd)).chunk_size(Some(1 << 30)));
    log = log.topic("/zeros", json("z", "{}"));
    // With its schema, channel and header it fills 64 MiB to the byte.
    log = log.message("/zeros", 0, &vec![0; (64 << 20) - 102]);
    let file = log.bytes();
    let zstd = [0x28, 0xb5, 0x2f, 0xfd];
    let start = file.windows(4).position(|bytes| bytes == zstd).unwrap();
    file[start..].to_vec()
}

fn topics() -> Vec<Case> {
    let image = || ros2("sensor_msgs/msg/Image", "uint8[] data\n");
    let pair = |a: &str, b: &str, kind: fn() -> Type, make: Make| {
        Log::new().topic(a, kind()).topic(b, kind()).messages(20, &[(a, make), (b, make)])
    };
    let list = || ros2("std_msgs/msg/Int32MultiArray", "uint8 layout\nint32[] data\n");
    let with_poses = |frames: [&'static str; 2]| {
        let mut log = Log::new().topic("/joint_states", joint_state()).topic("/tf", tf());
        for ms in (0..200).step_by(10) {
            log = log.message("/joint_states", ms * 1_000_000, &wheels(ms));
            for child in frames {
                let mut message = somewhere(ms)[4..].to_vec();
                let numbers = message.split_off(16);
                let length = (child.len() + 1) as u32;
                let name = [&length.to_le_bytes()[..], child.as_bytes(), &[0]].concat();
                let padding = vec![0; (8 - (4 + message.len() + name.len()) % 8) % 8];
                let body = [&[0, 1, 0, 0, 1, 0, 0, 0][..], &message, &name, &padding, &numbers].concat();
                log = log.message("/tf", ms * 1_000_000, &body);
            }
        }
        log.bytes()
    };
    let cameras = || Log::new().topic("/camera", image()).topic("/wheel\n\u{1b}[31m", image()).bytes();
    vec![
        case("no topic of wheels, and a name with control characters", cameras()),
        case("two topics of joints", pair("/a", "/b", joint_state, wheels).bytes()),
        case(
            "two topics of poses",
            pair("/a", "/b", pose_stamped, somewhere)
                .topic("/joint_states", joint_state())
                .messages(20, &[("/joint_states", wheels)])
                .bytes(),
        ),
        asked("a topic that is not there", good().bytes(), "/wheels", ""),
        asked("a topic of another type", good().bytes(), "/mocap", ""),
        asked("a reference that is no pose", good().bytes(), "", "/joint_states"),
        case(
            "counts in a list without order",
            Log::new().topic("/ticks", list()).message("/ticks", 1, &[0, 1, 0, 0, 0, 0, 0, 0]).bytes(),
        ),
        asked("joints that are not there", good().bytes(), "/joint_states:l,r", ""),
        case("transforms of two frames", with_poses(["base_link", "trolley"])),
        asked("a frame that is not there", with_poses(["base_link", "trolley"]), "", "/tf:cart"),
        Case { robot: false, ..case("joints without a robot", good().bytes()) },
    ]
}

fn schemas() -> Vec<Case> {
    let with = |text: &str| {
        let kind = ros2("sensor_msgs/msg/JointState", text);
        Log::new().topic("/joint_states", kind).messages(3, &[("/joint_states", wheels)]).bytes()
    };
    let rest = "string[] name\nfloat64[] position\n";
    let deep: String = (0..50).map(|i| format!("===\nMSG: a/T{i}\na/T{} x\n", i + 1)).collect();
    let wide: String = (0..14).map(|i| format!("===\nMSG: a/T{i}\na/T{n} x\na/T{n} y\n", n = i + 1)).collect();
    let protobuf = |schema: &str, data: &[u8]| {
        let kind = ("foxglove.PoseInFrame", "protobuf", schema.to_owned(), "protobuf");
        let log = Log::new().topic("/joint_states", joint_state()).topic("/pose", kind);
        log.messages(3, &[("/joint_states", wheels)]).message("/pose", 5, data).bytes()
    };
    vec![
        case("a schema that is nonsense", with("string c \"\nfloat64[ x\n")),
        case("a schema without positions", with("string[] name\n")),
        case("positions of another type", with("string[] name\nstring[] position\n")),
        case("a schema that holds itself", with(&format!("sensor_msgs/JointState self\n{rest}"))),
        case("a schema that lacks a definition", with(&format!("std_msgs/Header header\n{rest}"))),
        case("a schema that is too deep", with(&format!("a/T0 x\n{rest}{deep}===\nMSG: a/T50\nint8 x\n"))),
        case("a schema that doubles again and again", with(&format!("a/T0 x\n{rest}{wide}===\nMSG: a/T14\nint8 x\n"))),
        case("wide text before the positions", with(&format!("wstring w\n{rest}"))),
        case("an invalid protobuf schema", protobuf("nonsense", &[])),
    ]
}

fn messages() -> Vec<Case> {
    let one = |data: Vec<u8>| {
        let log = Log::new().topic("/joint_states", joint_state());
        log.messages(3, &[("/joint_states", wheels)]).message("/joint_states", 30_000_000, &data).bytes()
    };
    let names = ["left_wheel", "right_wheel"];
    let placed = |numbers: [f64; 7]| {
        let log = Log::new().topic("/joint_states", joint_state()).topic("/mocap", pose_stamped());
        let log = log.messages(30, &[("/joint_states", wheels)]);
        log.message("/mocap", 20_000_000, &pose(20_000_000, "map", numbers)).bytes()
    };
    let text = |text: &str| {
        let log = Log::new().topic("/ticks", json_ticks()).message("/ticks", 0, br#"{"left": 0, "right": 0}"#);
        log.message("/ticks", 10_000_000, text.as_bytes()).bytes()
    };
    let huge = [&[0, 1, 0, 0][..], &[0; 12], &4_000_000_000u32.to_le_bytes()].concat();
    vec![
        case("a message that ends early", one(wheels(30)[..60].to_vec())),
        case("a message of one byte", one(vec![0])),
        case("a list that claims four billion names", one(huge)),
        case("another kind of CDR", one([&[0, 3], &wheels(30)[2..]].concat())),
        case("a position that is no number", one(joints(30_000_000, &names, &[f64::NAN, 0.0]))),
        case("a position of 1e308", one(joints(30_000_000, &names, &[0.0, 1e308]))),
        case("fewer positions than names", one(joints(30_000_000, &names, &[0.0]))),
        case(
            "a name that is not UTF-8",
            one(wheels(30).into_iter().map(|b| if b == b'w' { 0xff } else { b }).collect()),
        ),
        case(
            "four wheels",
            Log::new()
                .topic("/joint_states", joint_state())
                .message(
                    "/joint_states",
                    0,
                    &joints(0, &["fl_left_wheel", "rl_left_wheel", "fr_right_wheel", "rr_right_wheel"], &[0.0; 4]),
                )
                .bytes(),
        ),
        case(
            "joints that are no wheels",
            Log::new()
                .topic("/joint_states", joint_state())
                .message("/joint_states", 0, &joints(0, &["elbow", "wrist\u{7}"], &[0.0; 2]))
                .bytes(),
        ),
        case("time that goes back", one(joints(10_000_000, &names, &[9.0; 2]))),
        case("a pose at infinity", placed([f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])),
        case("an orientation that is no rotation", placed([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0])),
        case("JSON that is cut off", text(r#"{"left": 1, "ri"#)),
        case("JSON of a thousand brackets", text(&"[".repeat(1000))),
        case("JSON without a field", text(r#"{"left": 1}"#)),
        case("JSON with a word for a count", text(r#"{"left": 1, "right": "two"}"#)),
        case("a count of 1e300", text(r#"{"left": 1, "right": 1e300}"#)),
    ]
}

#[test]
fn every_unusable_log_is_answered_with_its_sentence() {
    let mut sentences: BTreeMap<_, _> = sentences(include_str!("bad_input/mcap_cases.txt")).into_iter().collect();
    let mut wrong = Vec::new();
    let cases: Vec<Case> = [containers(), topics(), schemas(), messages()].into_iter().flatten().collect();
    assert!(cases.len() >= 50, "{}", cases.len());
    for case in &cases {
        let said = said(case);
        if sentences.remove(case.name) != Some(&said) {
            wrong.push(format!("# {}\nsays {said}\n", case.name));
        }
    }
    assert!(sentences.is_empty(), "no test makes {:?}", sentences.keys());
    assert!(wrong.is_empty(), "{} differ:\n{}", wrong.len(), wrong.join("\n"));
}
