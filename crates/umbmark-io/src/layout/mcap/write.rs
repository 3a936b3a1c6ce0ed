//! A log written as ROS 2 records it: `/joint_states`, `/odom`, `/tf` and `/ground_truth`, and the [scene](super::scene).
//!
//! Joint positions are the counts in radians; `/odom` and `/tf` (odom to base_link, REP 105) are what the nominal robot
//! computes from them; `/ground_truth` holds the measured poses. A measured pose without heading has an orientation of
//! zeros, which is no rotation. The nominal robot goes along as metadata. Chunks are packed with zstd, and the same log
//! gives the same bytes.

use super::super::messages::{JOINT_STATE, KnownType, MARKER_ARRAY, ODOMETRY, PATH, POSE_STAMPED, TF};
use super::container::METADATA;
use super::parts::{Cdr, header, numbers, orientation};
use super::scene;
use crate::RobotFile;
use crate::file_names::ROBOT;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, McapResult, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::{Cursor, Seek, Write};
use umbmark_core::apply::{Corrected, Spread};
use umbmark_core::dataset::{ReferencePose, TickLog};
use umbmark_core::geometry::Pose2;
use umbmark_core::run::dead_reckoning::computed_poses;

/// Names of the joints, left and right.
const JOINTS: [&str; 2] = ["left_wheel_joint", "right_wheel_joint"];
/// Not packed smaller by more: the level of zstd that it calls its default.
const LEVEL: u32 = 3;

fn options() -> WriteOptions {
    WriteOptions::new()
        .profile("ros2")
        .library(format!("umbmark {}", umbmark_core::VERSION))
        .compression(Some(Compression::Zstd))
        .compression_level(LEVEL)
        .compression_threads(0)
}

/// Corrected odometry as `nav_msgs/Odometry` on `/odom`: the covariance of the pose is 0 where it is not known, and that of the twist is 0.
pub(crate) fn corrected(corrected: &Corrected) -> McapResult<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = options().create(&mut file)?;
    let mut odometry = Topic::add(&mut writer, "/odom", &ODOMETRY)?;
    let begin = if corrected.begin_ns > 0 { 0.0 } else { corrected.time.first().copied().unwrap_or(0.0).min(0.0) };
    for (sample, pose) in corrected.poses.iter().enumerate() {
        let before = sample.saturating_sub(1);
        let time =
            corrected.stamp_ns(sample).map_or_else(|| nanoseconds(corrected.time[sample] - begin), |ns| ns as u64);
        let duration = corrected.time[sample] - corrected.time[before];
        let twist = twist(&corrected.poses[before], pose, duration);
        let covariance = corrected.spread.as_ref().map_or([0.0; 36], |spread| of_axes(&spread[sample]));
        let mut of_twist = [0.0; 36];
        if let Some([forward, sideways, heading]) = corrected.motion_variances.as_ref().map(|all| all[sample])
            && duration > 0.0
        {
            for (place, variance) in [(0, forward), (7, sideways), (35, heading)] {
                of_twist[place] = variance / (duration * duration);
            }
        }
        odometry.write(&mut writer, time, |cdr| odom(cdr, time, pose, &covariance, twist, &of_twist))?;
    }
    writer.finish()?;
    drop(writer);
    Ok(file.into_inner())
}

/// A covariance by rows of x, y, z and the rotations about them.
fn of_axes(spread: &Spread) -> [f64; 36] {
    let mut covariance = [0.0; 36];
    let [xx, xy, yy, x_heading, y_heading, heading] = spread.numbers();
    for (row, column, value) in
        [(0, 0, xx), (0, 1, xy), (1, 1, yy), (0, 5, x_heading), (1, 5, y_heading), (5, 5, heading)]
    {
        covariance[6 * row + column] = value;
        covariance[6 * column + row] = value;
    }
    covariance
}

/// Writes a log into a file, its stamps counted from `begin` \[s\].
pub(in crate::layout) fn write(
    file: impl Write + Seek,
    robot_file: &RobotFile,
    log: &TickLog,
    begin: f64,
) -> McapResult<()> {
    let mut writer = options().create(file)?;
    let robot = &robot_file.robot;
    let robot_toml = BTreeMap::from([(ROBOT.to_owned(), robot_file.text())]);
    writer.write_metadata(&Metadata { name: METADATA.to_owned(), metadata: robot_toml })?;
    let mut joint_states = Topic::add(&mut writer, "/joint_states", &JOINT_STATE)?;
    let mut odometry = Topic::add(&mut writer, "/odom", &ODOMETRY)?;
    let mut transforms = Topic::add(&mut writer, "/tf", &TF)?;
    let mut ground_truth = match log.reference.first() {
        Some(_) => Some(Topic::add(&mut writer, "/ground_truth", &POSE_STAMPED)?),
        None => None,
    };
    let per_radian = TAU / robot.encoder.ticks_per_revolution();
    let [first, second] = robot.encoder.wiring().columns([log.left.clone(), log.right.clone()]);
    let poses = computed_poses(log, robot);
    write_scene(&mut writer, log, &poses, begin)?;
    let mut references = log.reference.iter().peekable();
    for (sample, pose) in poses.iter().enumerate() {
        let time = nanoseconds(log.time[sample] - begin);
        let positions = [first[sample] * per_radian, second[sample] * per_radian];
        joint_states.write(&mut writer, time, |cdr| joint_state(cdr, time, positions))?;
        let before = sample.saturating_sub(1);
        let twist = twist(&poses[before], pose, log.time[sample] - log.time[before]);
        odometry.write(&mut writer, time, |cdr| odom(cdr, time, pose, &[0.0; 36], twist, &[0.0; 36]))?;
        transforms.write(&mut writer, time, |cdr| transform(cdr, time, pose))?;
        while let (Some(topic), Some(pose)) = (&mut ground_truth, references.next_if(|pose| pose.sample == sample)) {
            topic.write(&mut writer, time, |cdr| pose_stamped(cdr, time, pose))?;
        }
    }
    writer.finish().map(|_| ())
}

/// Both paths and the errors between them, at the time of the first sample.
fn write_scene<W: Write + Seek>(writer: &mut Writer<W>, log: &TickLog, poses: &[Pose2], begin: f64) -> McapResult<()> {
    let Some(first) = log.time.first() else { return Ok(()) };
    let time = nanoseconds(first - begin);
    let mut computed = Topic::add(writer, "/scene/computed_path", &PATH)?;
    computed.write(writer, time, |cdr| scene::computed_path(cdr, time, poses))?;
    if !log.reference.is_empty() {
        let mut measured = Topic::add(writer, "/scene/true_path", &PATH)?;
        measured.write(writer, time, |cdr| scene::true_path(cdr, time, &log.reference))?;
        let mut errors = Topic::add(writer, "/scene/errors", &MARKER_ARRAY)?;
        errors.write(writer, time, |cdr| scene::errors(cdr, time, log, poses))?;
    }
    if !log.bumps.is_empty() {
        let mut bumps = Topic::add(writer, "/scene/bumps", &MARKER_ARRAY)?;
        bumps.write(writer, time, |cdr| scene::bumps(cdr, time, &log.bumps))?;
    }
    Ok(())
}

/// A time as ROS writes it \[ns\]. A double does not hold the nanoseconds of a calendar's time, so these are apart.
pub(super) fn nanoseconds(seconds: f64) -> u64 {
    let whole = seconds.floor();
    whole as u64 * 1_000_000_000 + ((seconds - whole) * 1e9).round() as u64
}

struct Topic {
    channel: u16,
    sequence: u32,
    message: Vec<u8>,
}

impl Topic {
    fn add<W: Write + Seek>(writer: &mut Writer<W>, topic: &str, definition: &KnownType) -> McapResult<Topic> {
        let schema = writer.add_schema(definition.name, "ros2msg", definition.text().as_bytes())?;
        let channel = writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        Ok(Topic { channel, sequence: 0, message: Vec::new() })
    }

    fn write<W: Write + Seek>(
        &mut self,
        writer: &mut Writer<W>,
        time: u64,
        fill: impl FnOnce(&mut Cdr),
    ) -> McapResult<()> {
        const LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];
        let mut body = Vec::new();
        fill(&mut Cdr::new(&mut body));
        self.message.clear();
        self.message.extend(LITTLE_ENDIAN);
        self.message.extend(&body);
        let (channel_id, sequence) = (self.channel, self.sequence);
        self.sequence = sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &self.message)
    }
}

fn joint_state(cdr: &mut Cdr, time: u64, positions: [f64; 2]) {
    header(cdr, time, "");
    cdr.write_sequence_length(JOINTS.len());
    for name in JOINTS {
        cdr.write_string(name);
    }
    cdr.write_sequence_length(positions.len());
    numbers(cdr, positions);
    for _velocity_effort in 0..2 {
        cdr.write_sequence_length(0);
    }
}

fn odom(
    cdr: &mut Cdr,
    time: u64,
    pose: &Pose2,
    covariance: &[f64; 36],
    [speed, turn_rate]: [f64; 2],
    of_twist: &[f64; 36],
) {
    header(cdr, time, "odom");
    cdr.write_string("base_link");
    numbers(cdr, [pose.x, pose.y, 0.0]);
    numbers(cdr, orientation(pose.heading));
    numbers(cdr, *covariance);
    numbers(cdr, [speed, 0.0, 0.0, 0.0, 0.0, turn_rate]);
    numbers(cdr, *of_twist);
}

fn transform(cdr: &mut Cdr, time: u64, pose: &Pose2) {
    cdr.write_sequence_length(1);
    header(cdr, time, "odom");
    cdr.write_string("base_link");
    numbers(cdr, [pose.x, pose.y, 0.0]);
    numbers(cdr, orientation(pose.heading));
}

fn pose_stamped(cdr: &mut Cdr, time: u64, pose: &ReferencePose) {
    header(cdr, time, "map");
    numbers(cdr, [pose.x, pose.y, 0.0]);
    numbers(cdr, pose.heading.map_or([0.0; 4], orientation));
}

/// Mean speed \[m/s\] and turn rate \[rad/s\] since the last sample.
fn twist(before: &Pose2, now: &Pose2, seconds: f64) -> [f64; 2] {
    if seconds <= 0.0 {
        return [0.0; 2];
    }
    let step = before.between(now);
    let turn = now.heading - before.heading;
    let half = 0.5 * turn;
    let stretch = if half.abs() < 1e-6 { 1.0 } else { half / libm::sin(half) };
    let along = step.x * libm::cos(half) + step.y * libm::sin(half);
    [along * stretch / seconds, turn / seconds]
}
