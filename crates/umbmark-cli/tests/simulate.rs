//! `umbmark simulate` as its users meet it.

use snapbox::cmd::{Command, OutputAssert, cargo_bin};
use snapbox::str;
use std::path::Path;
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

fn simulate(arguments: &[&str]) -> OutputAssert {
    Command::new(cargo_bin!("umbmark")).arg("simulate").args(arguments).assert()
}

#[test]
fn the_dataset_reads_back_with_the_return_errors_that_were_printed() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("my robot");
    let name = place.to_str().unwrap();
    let arguments = ["-o", name, "--side", "1", "--runs", "3", "--eb", "1.01", "--bumps", "10", "--json"];
    let assert = simulate(&arguments).success();
    let document: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let dataset = umbmark_io::load(&place).unwrap();
    assert_eq!(dataset.runs.len(), 12);
    let printed = document["runs"].as_array().unwrap();
    for test in [TestKind::Systematic, TestKind::Bumps] {
        for direction in Direction::BOTH {
            let read: Vec<f64> = dataset.returns(test, direction).map(|error| error.x).collect();
            let said: Vec<f64> = printed
                .iter()
                .filter(|run| run["direction"] == direction.name() && run["test"] == test.name())
                .map(|run| run["ex_m"].as_f64().unwrap())
                .collect();
            assert_eq!(read, said);
            assert_eq!(read.len(), 3);
        }
    }
    let log = dataset.runs[0].log.as_ref().unwrap();
    assert!(log.time.len() > 1000 && log.reference.len() > 200);
}

#[test]
fn the_same_seed_writes_the_same_bytes_and_nothing_is_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let write = |name: &str, seed: &str| {
        let place = place(name);
        simulate(&["-o", place.to_str().unwrap(), "--side", "0.5", "--runs", "2", "--seed", seed]).success();
        ["returns.csv", "runs/ccw_02.csv"].map(|file| std::fs::read(place.join(file)).unwrap())
    };
    let first = write("a", "3");
    assert_eq!(first, write("b", "3"));
    assert_ne!(first[0], write("c", "4")[0]);
    simulate(&["-o", place("a").to_str().unwrap()]).code(1).stdout_eq(str![""]);
}

#[test]
fn a_robot_that_is_wired_otherwise_is_written_as_its_wires_are_and_reads_back_as_it_drove() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str, wiring: &str| {
        let (robot, place) = (folder.path().join(format!("{name}.toml")), folder.path().join(name));
        let text = format!("[robot]\nwheelbase_m = 0.3\nwheel_diameter_m = 0.1\nticks_per_revolution = 2000\n{wiring}");
        std::fs::write(&robot, text).unwrap();
        let path = |path: &Path| path.to_str().unwrap().to_owned();
        simulate(&["--robot", &path(&robot), "-o", &path(&place), "--side", "0.5", "--runs", "1", "--ed", "1.01"])
            .success();
        let log = std::fs::read_to_string(place.join("runs/ccw_01.csv")).unwrap();
        let last = log.lines().last().unwrap().split(',').skip(1).take(2).map(|cell| cell.parse().unwrap());
        let [left, right] = last.collect::<Vec<f64>>().try_into().unwrap();
        ([left, right], umbmark_io::load(&place).unwrap())
    };
    let ([left, right], plain) = written("plain", "");
    let (columns, wired) = written("wired", "wheels_exchanged = true\nleft_counts_backward = true\n");
    assert_ne!(left, right);
    assert_eq!(columns, [-right, left]);
    let logs = [&plain, &wired].map(|data| data.runs[0].log.as_ref().unwrap().clone());
    assert_eq!((&logs[0].left, &logs[0].right), (&logs[1].left, &logs[1].right));
}

#[test]
fn with_a_tape_measure_only_the_end_pose_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("tape");
    let arguments = ["-o", place.to_str().unwrap(), "--side", "0.5", "--runs", "1", "--reference-rate", "0"];
    simulate(&arguments).success();
    let dataset = umbmark_io::load(&place).unwrap();
    for run in &dataset.runs {
        let log = run.log.as_ref().unwrap();
        assert_eq!(log.reference.iter().map(|r| r.sample).collect::<Vec<_>>(), [log.time.len() - 1]);
    }
}

#[test]
fn a_narrow_counter_rolls_over_in_the_file_and_is_unrolled_when_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("robot.toml");
    let text =
        "[robot]\nwheelbase_m = 0.34\nwheel_diameter_m = 0.15\nticks_per_revolution = 2000\nencoder_rate_hz = 100\n";
    std::fs::write(&robot, text.to_owned() + "counter_bits = 8\n[path]\nshape = \"square\"\nside_m = 0.5\n").unwrap();
    let place = folder.path().join("rolled");
    let arguments = ["-o", place.to_str().unwrap(), "--runs", "1", "--robot", robot.to_str().unwrap()];
    simulate(&arguments).success();
    let sheet = std::fs::read_to_string(place.join("runs/cw_01.csv")).unwrap();
    let counts = sheet.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse::<i64>().unwrap());
    assert_eq!((counts.clone().min(), counts.max()), (Some(0), Some(255)));
    let log = umbmark_io::load(&place).unwrap().runs.remove(0).log.unwrap();
    // Four legs of 2122 ticks, and a turn to the right at each corner.
    assert!(*log.left.last().unwrap() > 10_000.0, "{:?}", log.left.last());
}

#[test]
fn one_run_can_be_written_as_a_log_of_ros_2_which_brings_its_robot_along() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run.mcap");
    let name = place.to_str().unwrap();
    let assert =
        simulate(&["-o", name, "--side", "0.5", "--wheelbase", "0.4", "--direction", "cw", "--json"]).success();
    let document: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(document["runs"].as_array().unwrap().len(), 1);
    let dataset = umbmark_io::load(&place).unwrap();
    assert_eq!(dataset.nominal_robot().unwrap().drive.wheelbase(), 0.4);
    assert_eq!(dataset.runs[0].direction, Some(Direction::Cw));
    let log = dataset.runs[0].log.as_ref().unwrap();
    assert!(log.time.len() > 1000 && log.reference.len() > 200);
    let inspect = |flags: &[&str]| {
        Command::new(cargo_bin!("umbmark")).arg("inspect").arg(&place).args(flags).args(["--json"]).assert()
    };
    let poses = |flags: &[&str]| {
        let assert = inspect(flags).success();
        let document: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
        document["logs"][0]["reference"]["poses"].as_u64()
    };
    assert_eq!(poses(&[]), Some(log.reference.len() as u64));
    assert_eq!(poses(&["--reference", "none"]), None);
    assert_eq!(poses(&["--ticks", "/joint_states", "--reference", "/odom"]), Some(log.time.len() as u64));
    inspect(&["--ticks", "/wheels"]).code(1).stderr_eq(str![[r#"
error: [..]run.mcap: there is no topic "/wheels" for --ticks; there are: /ground_truth (geometry_msgs/msg/PoseStamped), /joint_states (sensor_msgs/msg/JointState), /odom (nav_msgs/msg/Odometry), /scene/computed_path (nav_msgs/msg/Path), /scene/errors (visualization_msgs/msg/MarkerArray), /scene/true_path (nav_msgs/msg/Path), /tf (tf2_msgs/msg/TFMessage)

"#]]);
    let told =
        String::from_utf8(Command::new(cargo_bin!("umbmark")).arg("inspect").arg(&place).output().unwrap().stdout);
    let told = told.unwrap();
    let topics = told.lines().find(|line| line.contains("/joint_states")).unwrap();
    assert_eq!(topics.split_whitespace().collect::<Vec<_>>(), ["run", "/joint_states", "/ground_truth"]);
    simulate(&["-o", name]).code(1);
    simulate(&["-o", name, "--force", "--runs", "2"]).code(1).stderr_eq(str![[r#"
error: an MCAP log holds one run, got --runs 2; remove it, or give a folder

"#]]);
}

#[test]
fn a_test_written_as_mcap_is_converted_to_csv_with_the_topics_that_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let run = |arguments: &[&str]| Command::new(cargo_bin!("umbmark")).args(arguments).assert().success();
    let setup = ["--side", "0.5", "--runs", "2", "--seed", "7", "--eb", "1.02"];
    for to in ["csv", "mcap"] {
        simulate(&[&["-o", &place(to), "--to", to][..], &setup].concat()).success();
    }
    assert!(Path::new(&place("mcap/runs/ccw_02.mcap")).is_file() && Path::new(&place("mcap/returns.csv")).is_file());
    run(&["convert", &place("mcap"), "-o", &place("back")]);
    let (written, back) = (umbmark_io::load(place("csv")).unwrap(), umbmark_io::load(place("back")).unwrap());
    assert_eq!(written.runs.len(), 4);
    for (a, b) in written.runs.iter().zip(&back.runs) {
        let (log, read) = (a.log.as_ref().unwrap(), b.log.as_ref().unwrap());
        assert_eq!((&a.name, a.returned, &log.left, &log.right), (&b.name, b.returned, &read.left, &read.right));
        assert_eq!(log.reference.len(), read.reference.len());
        for (a, b) in log.reference.iter().zip(&read.reference) {
            assert_eq!((a.sample, a.x, a.y), (b.sample, b.x, b.y));
            assert!((a.heading.unwrap() - b.heading.unwrap()).abs() < 4e-14);
        }
    }
    run(&["convert", &place("mcap"), "-o", &place("without"), "--reference", "none"]);
    assert!(umbmark_io::load(place("without")).unwrap().runs[0].log.as_ref().unwrap().reference.is_empty());
}
