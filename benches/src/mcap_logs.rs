//! A long MCAP log of a robot that drives about, as `umbmark simulate` writes it, and one of only what is read of it.

use crate::Draws;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use umbmark_core::dataset::{Dataset, ReferencePose, Run, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_io::Existing;

/// Ten minutes and more at 100 Hz, with poses at 20 Hz.
pub const SAMPLES: usize = 100_000;

/// The topics that are read.
pub const READ: [&str; 2] = ["/joint_states", "/ground_truth"];

fn log() -> TickLog {
    let mut draws = Draws::new(20_260_102);
    let (mut left, mut right) = (0.0, 0.0);
    let mut log = TickLog::default();
    for sample in 0..SAMPLES {
        log.time.push(sample as f64 / 100.0);
        log.left.push(left);
        log.right.push(right);
        if sample % 5 == 0 {
            let (x, y) = (1e-3 * draws.unit(), 1e-3 * draws.unit());
            log.reference.push(ReferencePose { sample, x, y, heading: Some(draws.unit()) });
        }
        left += (18.0 * draws.unit()).floor();
        right += (18.0 * draws.unit()).floor();
    }
    log
}

/// Writes the log.
pub fn write(file: &Path) {
    let run = Run {
        name: "log".into(),
        number: 1,
        direction: None,
        test: TestKind::Systematic,
        log: Some(log()),
        returned: None,
    };
    let data = Dataset { robot: Some(Robot::labmate()), runs: vec![run], ..Dataset::default() };
    umbmark_io::save_mcap(&data, file, Existing::Replace).expect("a log that can be written");
}

/// Writes the messages of some topics of a log into another, packed or not.
pub fn rewrite(from: &Path, to: &Path, topics: &[&str], compression: Option<mcap::Compression>) {
    let bytes = std::fs::read(from).expect("the log");
    let options = mcap::WriteOptions::new().profile("ros2").compression(compression).compression_threads(0);
    let mut writer = options.create(BufWriter::new(File::create(to).expect("a file"))).expect("a log");
    for message in mcap::MessageStream::new(&bytes).expect("a log") {
        let message = message.expect("a message");
        if topics.contains(&message.channel.topic.as_str()) {
            writer.write(&message).expect("room");
        }
    }
    writer.finish().expect("room");
    writer.into_inner().flush().expect("room");
    let robot = umbmark_io::RobotFile::new(Robot::labmate(), None).text();
    std::fs::write(to.with_file_name("robot.toml"), robot).expect("room");
}

/// Bytes of all messages of a log, not packed and without their headers.
pub fn message_bytes(file: &Path) -> u64 {
    let bytes = std::fs::read(file).expect("the log");
    mcap::MessageStream::new(&bytes).expect("a log").map(|message| message.expect("a message").data.len() as u64).sum()
}
