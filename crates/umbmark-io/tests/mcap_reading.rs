//! What is made of good, damaged and unusual MCAP logs; and that what is written is read back.

use crate::mcap_log::*;
use mcap::{Compression, WriteOptions};
use umbmark_core::dataset::{Dataset, ReferencePose, Run, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_core::path::Path;
use umbmark_io::{DatasetError, Existing, Topics};

fn load_with(file: &[u8], topics: &Topics) -> Result<Dataset, DatasetError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
    let place = folder.path().join("ccw_01.mcap");
    std::fs::write(&place, file).unwrap();
    let mut data = umbmark_io::load_with(&place, topics)?;
    let folder = format!("{}/", folder.path().display());
    data.warnings.iter_mut().for_each(|warning| *warning = warning.replace(&folder, ""));
    Ok(data)
}

fn load(file: &[u8]) -> Dataset {
    load_with(file, &Topics::default()).unwrap()
}

fn log(data: &Dataset) -> &TickLog {
    data.runs[0].log.as_ref().unwrap()
}

/// The same second of wheels and poses, packed and laid out in every way.
#[test]
fn packing_chunks_and_summary_do_not_change_what_is_read() {
    let expected = load(&good().bytes());
    assert_eq!((log(&expected).time.len(), log(&expected).reference.len()), (100, 100));
    assert!((log(&expected).left[99] - turned(990) * 1000.0 / std::f64::consts::TAU).abs() < 1e-9);
    assert_eq!(expected.warnings, Vec::<String>::new());
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        for chunk_size in [Some(300), Some(1 << 20), None] {
            for summary in [true, false] {
                let options = WriteOptions::new()
                    .compression(compression)
                    .use_chunks(chunk_size.is_some())
                    .chunk_size(chunk_size)
                    .emit_summary_records(summary)
                    .emit_message_indexes(summary);
                let made = Log::with(options).topic("/joint_states", joint_state()).topic("/mocap", pose_stamped());
                let data = load(&made.messages(100, &[("/joint_states", wheels), ("/mocap", somewhere)]).bytes());
                assert_eq!(data.runs, expected.runs, "{compression:?} {chunk_size:?} {summary}");
                assert_eq!(data.warnings, Vec::<String>::new());
            }
        }
    }
}

#[test]
fn a_log_that_was_cut_off_is_read_up_to_the_cut_wherever_it_is() {
    let whole = good().bytes();
    let expected = load(&whole);
    let mut rows = 0;
    for cut in (600..whole.len() - 1).step_by(97) {
        let Ok(data) = load_with(&whole[..cut], &Topics::default()) else {
            assert!(cut < 1500, "nothing read of {cut} bytes");
            continue;
        };
        let n = log(&data).time.len();
        assert!(n >= rows && log(&data).left[..] == log(&expected).left[..n], "{cut}");
        rows = n;
        let lost = data.warnings.iter().find(|warning| warning.contains("are lost"));
        assert!(n == 100 || lost.is_some(), "{cut}: {:?}", data.warnings);
    }
    assert_eq!(rows, 100);
}

#[test]
fn the_cut_is_said_with_its_place_and_with_what_was_lost() {
    let whole = good().bytes();
    let chunks: Vec<usize> = (0..whole.len()).filter(|i| whole[*i..].starts_with(&[0x28, 0xb5, 0x2f, 0xfd])).collect();
    assert!(chunks.len() > 3, "{}", chunks.len());
    // Its last chunk has no end.
    let cut = &whole[..chunks[2] + 300];
    let said = load(cut).warnings.join("\n");
    let size = cut.len();
    assert!(
        said.contains(&format!("of {size} (the file ends in the middle of a chunk); read up to there: ")),
        "{said}"
    );
    // A chunk in the middle is damaged; the summary knows how much there was.
    let mut broken = whole.clone();
    broken[chunks[2] + 100] ^= 0x55;
    let data = load(&broken);
    let said = data.warnings.join("\n");
    assert!(said.contains(" of 200 messages of the wheels and the reference; "), "{said}");
    assert!(said.contains("whose checksum is wrong") || said.contains("cannot be unpacked"), "{said}");
    let n = log(&data).time.len();
    assert!(n > 20 && n < 80, "{n}");
}

#[test]
fn odometry_of_the_robot_is_no_reference_of_itself_unless_the_user_says_so() {
    let own = "std_msgs/Header header\nstring child_frame_id\nA pose\nB twist\n\
               ===\nMSG: nav_msgs/A\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n\
               ===\nMSG: nav_msgs/B\nC twist\nfloat64[36] covariance\n\
               ===\nMSG: nav_msgs/C\ngeometry_msgs/Point linear\ngeometry_msgs/Point angular\n";
    let schema = own.to_owned() + &pose_stamped().2.replace("std_msgs/Header header\ngeometry_msgs/Pose pose\n", "");
    let made = |frame: &'static str| {
        let mut log =
            Log::new().topic("/joint_states", joint_state()).topic("/odom", ros2("nav_msgs/msg/Odometry", &schema));
        for ms in (0..1000).step_by(10) {
            log = log.message("/joint_states", ms * 1_000_000, &wheels(ms));
            let odometry = cdr(ms * 1_000_000, frame, |cdr| {
                cdr.write_string("base_link");
                [0.05 * turned(ms), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].iter().for_each(|number| cdr.write_f64(*number));
                (0..36 + 6 + 36).for_each(|_| cdr.write_f64(0.0));
            });
            log = log.message("/odom", ms * 1_000_000, &odometry);
        }
        log.bytes()
    };
    let data = load(&made("odom"));
    assert!(log(&data).reference.is_empty());
    assert!(data.warnings[0].contains("name the topic /odom as the reference if it is one"), "{:?}", data.warnings);
    let said = Topics { ticks: None, reference: Some("/odom".into()) };
    assert_eq!(log(&load_with(&made("odom"), &said).unwrap()).reference.len(), 100);
    assert_eq!(log(&load(&made("map"))).reference.len(), 100);
    let none = Topics { ticks: None, reference: Some("none".into()) };
    assert!(log(&load_with(&made("map"), &none).unwrap()).reference.is_empty());
    // Wheels by the odometry: 0.05 m a second are 0.05 / (0.1 pi) turns.
    let wheels = Topics { ticks: Some("/odom".into()), reference: None };
    let left = log(&load_with(&made("odom"), &wheels).unwrap()).left[99];
    assert!((left - turned(990) * 0.05 / (0.1 * std::f64::consts::PI) * 1000.0).abs() < 1e-9, "{left}");
}

#[test]
fn poses_between_two_readings_get_counts_between_theirs() {
    let mut log_ = Log::new().topic("/joint_states", joint_state()).topic("/mocap", pose_stamped());
    log_ = log_.messages(100, &[("/joint_states", wheels)]);
    for ms in (3..990).step_by(50) {
        log_ = log_.message("/mocap", ms * 1_000_000, &somewhere(ms));
    }
    let data = load(&log_.bytes());
    let log = log(&data);
    assert_eq!((log.time.len(), log.reference.len()), (120, 20));
    for pose in &log.reference {
        let ms = (log.time[pose.sample] * 1e3).round() as u64;
        assert_eq!(ms % 50, 3);
        let exact = turned(ms) * 1000.0 / std::f64::consts::TAU;
        // The corner at which the wheels begin to turn is cut.
        assert!((log.left[pose.sample] - exact).abs() < if ms == 103 { 0.5 } else { 1e-9 }, "{ms}");
    }
}

#[test]
fn positions_that_start_anew_at_a_full_turn_are_unwound() {
    let mut made = Log::new().topic("/joint_states", joint_state());
    for ms in (0..20_000).step_by(10) {
        let turned = 2.0 * turned(ms);
        let wrapped = umbmark_core::geometry::wrap(turned);
        let message = joints(ms * 1_000_000, &["left_wheel", "right_wheel"], &[wrapped, -wrapped]);
        made = made.message("/joint_states", ms * 1_000_000, &message);
    }
    let data = load(&made.bytes());
    let ticks = 2.0 * turned(19_990) * 1000.0 / std::f64::consts::TAU;
    let log = log(&data);
    assert!((log.left[1999] - ticks).abs() < 1e-6 && (log.right[1999] + ticks).abs() < 1e-6, "{}", log.left[1999]);
    assert_eq!(data.warnings.iter().filter(|warning| warning.contains("start anew at a full turn")).count(), 2);
}

#[test]
fn counters_that_roll_over_are_unrolled_and_joints_are_not() {
    let mut made = Log::new().topic("/ticks", json_ticks());
    for i in 0..100u64 {
        let (left, right) = ((i * 1000) % 65536, (65536 - (i * 900) % 65536) % 65536);
        let text = format!(r#"{{"left": {left}, "right": {right}}}"#);
        made = made.message("/ticks", i * 100_000_000, text.as_bytes());
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.toml"), format!("{ROBOT}counter_bits = 16\n")).unwrap();
    std::fs::write(folder.path().join("run.mcap"), made.bytes()).unwrap();
    let data = umbmark_io::load(folder.path().join("run.mcap")).unwrap();
    assert_eq!((log(&data).left[99], log(&data).right[99]), (99_000.0, -89_100.0));
    std::fs::write(folder.path().join("run.mcap"), good().bytes()).unwrap();
    assert_eq!(log(&umbmark_io::load(folder.path().join("run.mcap")).unwrap()).time.len(), 100);
}

fn one_run(log: TickLog) -> Dataset {
    let run = Run {
        name: "a".into(),
        number: 1,
        direction: None,
        test: TestKind::Systematic,
        log: Some(log),
        returned: None,
    };
    Dataset { robot: Some(Robot::labmate()), path: Some(Path::umbmark()), runs: vec![run], ..Dataset::default() }
}

#[test]
fn a_log_is_read_back_as_it_was_written_with_its_robot_and_the_same_bytes_each_time() {
    let pose = |sample: usize, heading| ReferencePose { sample, x: 0.001 * sample as f64, y: -1e-7, heading };
    let log = TickLog {
        time: (0..500).map(|i| f64::from(i) / 30.0).collect(),
        left: (0..500).map(|i| f64::from(i / 3)).collect(),
        right: (0..500).map(|i| -f64::from(i) * 7.0).collect(),
        reference: vec![pose(0, Some(0.0)), pose(3, None), pose(7, Some(-3.0)), pose(499, Some(-3.2))],
        ..TickLog::default()
    };
    let data = one_run(log);
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    umbmark_io::save_mcap(&data, &first, Existing::Keep).unwrap();
    umbmark_io::save_mcap(&data, &second, Existing::Keep).unwrap();
    assert_eq!(std::fs::read(&first).unwrap(), std::fs::read(&second).unwrap());
    let read = umbmark_io::load(&first).unwrap();
    assert_eq!(read.robot, data.robot);
    assert_eq!(read.path.unwrap().values(), Path::umbmark().values());
    let (log, read) = (data.runs[0].log.as_ref().unwrap(), read.runs[0].log.as_ref().unwrap());
    assert_eq!((&read.left, &read.right), (&log.left, &log.right));
    for (a, b) in log.time.iter().zip(&read.time) {
        assert!((a - b).abs() <= 0.5e-9);
    }
    for (a, b) in log.reference.iter().zip(&read.reference) {
        assert_eq!((a.sample, a.x, a.y, a.heading.is_some()), (b.sample, b.x, b.y, b.heading.is_some()));
        assert!((a.heading.unwrap_or(0.0) - b.heading.unwrap_or(0.0)).abs() < 4e-15);
    }
}

#[test]
fn what_an_mcap_file_cannot_hold_is_refused_and_nothing_is_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    let said = |log: TickLog| umbmark_io::save_mcap(&one_run(log), &file, Existing::Keep).unwrap_err().to_string();
    let at = |time: [f64; 2], left: f64| TickLog {
        time: time.to_vec(),
        left: vec![0.0, left],
        right: vec![0.0; 2],
        ..TickLog::default()
    };
    assert!(said(at([0.0, 3e9], 1.0)).contains("time 3000000000 s cannot be written; stamps go from 0"));
    // Two times of the same nanosecond.
    assert!(said(at([0.0, 1e-10], 1.0)).contains("too far apart for one moment"));
    assert!(said(at([0.0, 1e-10], 0.0)).contains("its log would not be read back as it is"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    std::fs::write(&file, "mine").unwrap();
    assert!(said(at([0.0, 1.0], 1.0)).contains("is there already"));
    assert_eq!(std::fs::read(&file).unwrap(), b"mine");
}
