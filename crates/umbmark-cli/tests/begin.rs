//! How people begin: with logs of their own and no description of the robot, or with files to fill in.

use std::path::Path;
use std::process::{Command, Output};

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

/// Standard output of a command that succeeds.
fn said(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = umbmark(folder, arguments);
    assert_eq!(status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// Standard error of a command that fails and prints nothing.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = umbmark(folder, arguments);
    assert_eq!((status.code(), String::from_utf8_lossy(&stdout).as_ref()), (Some(1), ""), "{arguments:?}");
    String::from_utf8(stderr).unwrap()
}

/// A folder `made` with three squares each way by a robot whose wheelbase is 1 % off.
fn made() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let robot = ["--side", "1", "--reference-rate", "10", "--encoder-rate", "20", "--wheel-noise", "0.0004"];
    said(place.path(), &[&["simulate", "-o", "made", "--runs", "3", "--eb", "0.99"][..], &robot].concat());
    place
}

fn copy_logs(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

#[test]
fn logs_that_are_copied_beside_a_sheet_nobody_filled_in_are_read_by_every_verb() {
    let place = made();
    said(place.path(), &["init", "mine"]);
    let sheet = place.path().join("mine/returns.csv");
    assert!(refused(place.path(), &["inspect", "mine"]).contains("mine/returns.csv: there are no rows"));
    copy_logs(&place.path().join("made/runs"), &place.path().join("mine/runs"));
    std::fs::copy(place.path().join("made/robot.toml"), place.path().join("mine/robot.toml")).unwrap();
    for verb in ["inspect", "score", "calibrate", "fit", "compare", "diagnose", "solve"] {
        let out: &[&str] = if verb == "fit" { &["-o", "fitted.toml", "--add", "wheelbase"] } else { &[] };
        let text = said(place.path(), &[&[verb, "mine"], out].concat());
        assert!(!text.contains("return sheet"), "{verb}: {text}");
    }
    // Without a header too.
    std::fs::write(&sheet, "# to be filled in\n").unwrap();
    assert!(said(place.path(), &["inspect", "mine"]).contains("systematic ccw"));
    // A row is a measurement again.
    std::fs::write(&sheet, "direction,run,ex_m,ey_m\ncw,1,0.1,oops\n").unwrap();
    assert!(refused(place.path(), &["inspect", "mine"]).contains("mine/returns.csv:2: column \"ey_m\""));
}

#[test]
fn an_empty_cell_of_the_computed_pose_means_start_and_is_told() {
    let place = made();
    let folder = place.path().join("tape");
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(place.path().join("made/robot.toml"), folder.join("robot.toml")).unwrap();
    let header = "direction,run,x_abs_mm,y_abs_mm,theta_abs_deg,x_calc_mm,y_calc_mm,theta_calc_deg\n";
    let score = |rows: &str| {
        std::fs::write(folder.join("returns.csv"), format!("{header}{rows}")).unwrap();
        let document = said(place.path(), &["score", "tape", "--json"]);
        let mut document: serde_json::Value = serde_json::from_str(&document).unwrap();
        document["warnings"].take();
        document
    };
    let zeros = score("cw,1,-31,12,1.5,0,0,0\ncw,2,-29,14,1.2,0,0,0\nccw,1,20,-9,,0,0,\nccw,2,23,-11,,0,0,\n");
    let blank = score("cw,1,-31,12,1.5,,,\ncw,2,-29,14,1.2,,,\nccw,1,20,-9,,,,\nccw,2,23,-11,,0,0,\n");
    assert_eq!(zeros, blank);
    let told = "3 of 4 rows leave a cell of the computed pose empty; it was taken as 0";
    let words = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    score("cw,1,-31,12,1.5,,,\ncw,2,-29,14,1.2,,,\nccw,1,20,-9,,,,\nccw,2,23,-11,,0,0,\n");
    assert!(words(said(place.path(), &["inspect", "tape"])).contains(told));
    // What was measured is never taken as 0.
    std::fs::write(folder.join("returns.csv"), format!("{header}cw,1,,12,1.5,0,0,0\n")).unwrap();
    assert!(refused(place.path(), &["score", "tape"]).contains("column \"x_abs_mm\" must be a finite number"));
}

const URDF: &str = "<robot name='rover'><link name='base'/>
<link name='wl'><collision><geometry><cylinder length='0.02' radius='0.075'/></geometry></collision></link>
<link name='wr'><collision><geometry><cylinder length='0.02' radius='0.075'/></geometry></collision></link>
<joint name='left_wheel_joint' type='continuous'><parent link='base'/><child link='wl'/><origin xyz='0 0.17 0'/></joint>
<joint name='right_wheel_joint' type='continuous'><parent link='base'/><child link='wr'/><origin xyz='0 -0.17 0'/></joint>
</robot>";

const FLAGS: [&str; 14] = [
    "--runs",
    "5",
    "--ed",
    "1.002",
    "--eb",
    "0.99",
    "--side",
    "1",
    "--encoder-rate",
    "20",
    "--reference-rate",
    "10",
    "--wheel-noise",
    "0.0004",
];

/// Messages of a simulated log in a bag as a robot records it: no robot.toml in it, but what else is said of the robot.
fn bag(from: &Path, to: &Path, description: Option<&str>) {
    let bytes = std::fs::read(from).unwrap();
    let mut writer = mcap::Writer::new(std::fs::File::create(to).unwrap()).unwrap();
    let mut first = None;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        first.get_or_insert(message.log_time);
        writer.write(&message).unwrap();
    }
    if let Some(text) = description {
        let schema = writer.add_schema("std_msgs/msg/String", "ros2msg", b"string data\n").unwrap();
        let channel = writer.add_channel(schema, "/robot_description", "cdr", &Default::default()).unwrap();
        let mut data = vec![0, 1, 0, 0];
        data.extend((text.len() as u32 + 1).to_le_bytes());
        data.extend(text.as_bytes());
        data.push(0);
        let time = first.unwrap();
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
}

/// A folder `bags` with ten folders as `ros2 bag record` makes them, all of which end in the same number.
fn bags(description: Option<&str>) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    said(place.path(), &[&["simulate", "-o", "made", "--to", "mcap"][..], &FLAGS].concat());
    for (index, entry) in std::fs::read_dir(place.path().join("made/runs")).unwrap().enumerate() {
        let folder = place.path().join(format!("bags/rosbag2_2026_11_02-10_{index:02}_07"));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("metadata.yaml"), "rosbag2_bagfile_information:\n  version: 9\n").unwrap();
        bag(&entry.unwrap().path(), &folder.join("recorded_0.mcap"), description);
    }
    place
}

/// The number behind a key of a YAML file.
fn number_of(text: &str, key: &str) -> f64 {
    let line = text.lines().find(|line| line.trim_start().starts_with(key)).unwrap_or_else(|| panic!("{key}: {text}"));
    line.split(':').nth(1).unwrap().split_whitespace().next().unwrap().parse().unwrap()
}

fn fits_the_terminal(text: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

/// Truth of the simulated robot: E_d = 1.002, E_b = 0.99. Its bags say what it is, so there is nothing to edit.
#[test]
fn three_commands_from_bags_of_ones_own_to_numbers_in_the_robot() {
    let place = bags(Some(URDF));
    let text = said(place.path(), &["init", "mine", "--logs", "bags"]);
    fits_the_terminal(&text);
    assert!(text.contains("put 10 logs into mine/runs") && !text.contains("FILL IN"), "{text}");
    said(place.path(), &["solve", "mine", "-o", "model.toml"]);
    said(place.path(), &["export", "model.toml", "--to", "ros2_control", "-o", "robot.yaml"]);
    let yaml = std::fs::read_to_string(place.path().join("robot.yaml")).unwrap();
    for (key, nominal) in [("wheel_separation", 0.34), ("wheel_radius", 0.075)] {
        assert!((number_of(&yaml, &format!("{key}:")) - nominal).abs() < 1e-9, "{yaml}");
    }
    assert!((number_of(&yaml, "wheel_separation_multiplier:") - 0.99).abs() < 1e-3, "{yaml}");
    let [left, right] = ["left", "right"].map(|side| number_of(&yaml, &format!("{side}_wheel_radius_multiplier:")));
    assert!((right / left - 1.002).abs() < 3e-4, "{yaml}");
    let robot = std::fs::read_to_string(place.path().join("mine/robot.toml")).unwrap();
    for line in ["name = \"rover\"", "ticks_per_revolution = 2000.0 ", "encoder_rate_hz = 20.0 "] {
        assert!(robot.contains(line), "{line}: {robot}");
    }
    // What was recorded is still where it was.
    assert_eq!(std::fs::read_dir(place.path().join("bags")).unwrap().count(), 10);
}

#[test]
fn what_logs_do_not_show_is_marked_and_refused_by_line_until_it_is_filled_in() {
    let place = made();
    let text = said(place.path(), &["init", "mine", "--logs", "made/runs"]);
    fits_the_terminal(&text);
    assert!(text.contains("fill in what is marked FILL IN in mine/robot.toml: 3 lines"), "{text}");
    let file = place.path().join("mine/robot.toml");
    let told = refused(place.path(), &["solve", "mine"]);
    let line =
        1 + std::fs::read_to_string(&file).unwrap().lines().position(|line| line.contains("wheelbase_m")).unwrap();
    assert_eq!(
        told,
        format!(
            "error: mine/robot.toml:{line}: wheelbase_m must be between 0.001 and 100 m, got \"fill in\"; no log shows it: put the number of your robot there\n"
        )
    );
    // The name plate.
    let mut robot = std::fs::read_to_string(&file).unwrap();
    for (key, value) in [("wheelbase_m", "0.34"), ("wheel_diameter_m", "0.15"), ("ticks_per_revolution", "2000")] {
        robot = robot.replace(&format!("{key} = \"fill in\""), &format!("{key} = {value}"));
    }
    std::fs::write(&file, robot).unwrap();
    assert!(said(place.path(), &["inspect", "mine"]).contains("wheelbase 0.34 m, wheels 0.15 m, 2000 ticks"));
    // The same on the command line, and as a document.
    let plate =
        ["--wheelbase", "0.34", "--wheel-diameter", "0.15", "--ticks-per-revolution", "2000", "--name", "rover"];
    let document = said(place.path(), &[&["init", "again", "--logs", "made", "--json"][..], &plate].concat());
    let document: serde_json::Value = serde_json::from_str(&document).unwrap();
    assert_eq!((&document["to_fill_in"], &document["numbers"][0]["value"]), (&serde_json::json!([]), &0.34.into()));
    assert!(said(place.path(), &["inspect", "again"]).starts_with("robot   rover: wheelbase 0.34 m"));
    let wrong = refused(place.path(), &["init", "third", "--logs", "made", "--wheelbase", "340"]);
    assert!(wrong.contains("--wheelbase") && wrong.contains("0.001"), "{wrong}");
}

/// The logs of a data logger, whose columns go by names of their own.
#[test]
fn columns_of_other_names_are_to_be_filled_in_and_then_read() {
    let place = made();
    let runs = place.path().join("made/runs");
    for entry in std::fs::read_dir(&runs).unwrap() {
        let file = entry.unwrap().path();
        let text = std::fs::read_to_string(&file).unwrap();
        let text = text.replacen("t_s,ticks_left,ticks_right", "Stamp,enc L,enc R", 1);
        std::fs::write(&file, text).unwrap();
    }
    let document = said(place.path(), &["init", "mine", "--logs", "made/runs", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&document).unwrap();
    let open = document["to_fill_in"].as_array().unwrap();
    assert!(["t_s", "ticks_left", "ticks_right"].iter().all(|name| open.contains(&(*name).into())), "{open:?}");
    let file = place.path().join("mine/robot.toml");
    let mut robot = std::fs::read_to_string(&file).unwrap();
    assert!(robot.contains("# The logs have \"stamp\", \"enc l\", \"enc r\""), "{robot}");
    let numbers = [("wheelbase_m", "0.34"), ("wheel_diameter_m", "0.15"), ("ticks_per_revolution", "2000")];
    for (key, value) in [&numbers[..], &[("encoder_rate_hz", "100"), ("t_s", "\"stamp\"")]].concat() {
        robot = robot.replace(&format!("{key} = \"fill in\""), &format!("{key} = {value}"));
    }
    std::fs::write(&file, &robot).unwrap();
    let told = refused(place.path(), &["inspect", "mine"]);
    assert!(told.contains("ticks_left must be what stands above this column") && told.contains("fill in"), "{told}");
    robot = robot.replace("ticks_left = \"fill in\"", "ticks_left = \"enc L\"");
    std::fs::write(&file, robot.replace("ticks_right = \"fill in\"", "ticks_right = \"enc R\"")).unwrap();
    let text = said(place.path(), &["inspect", "mine"]);
    assert!(text.contains("wheelbase 0.34 m, wheels 0.15 m, 2000 ticks"), "{text}");
}

#[test]
fn numbers_come_from_the_command_line_the_controller_and_the_urdf_in_this_order() {
    let place = made();
    std::fs::write(place.path().join("bot.urdf"), URDF).unwrap();
    let yaml = "base:\n  ros__parameters:\n    wheel_separation: 0.36\n    wheel_separation_multiplier: 0.5\n";
    std::fs::write(place.path().join("c.yaml"), yaml).unwrap();
    let numbers = |folder: &str, flags: &[&str]| {
        said(place.path(), &[&["init", folder, "--logs", "made"][..], flags].concat());
        let robot = std::fs::read_to_string(place.path().join(folder).join("robot.toml")).unwrap();
        let line = |key: &str| robot.lines().find(|line| line.starts_with(key)).unwrap().to_owned();
        (line("wheelbase_m"), line("wheel_diameter_m"))
    };
    let (base, wheel) = numbers("a", &["--urdf", "bot.urdf"]);
    assert_eq!(base, "wheelbase_m = 0.34                # the joints of the wheels in bot.urdf");
    assert!(wheel.starts_with("wheel_diameter_m = 0.15 "), "{wheel}");
    let (base, wheel) = numbers("b", &["--urdf", "bot.urdf", "--controller-yaml", "c.yaml"]);
    assert!(base.ends_with("# wheel_separation times wheel_separation_multiplier in c.yaml"), "{base}");
    assert!(base.starts_with("wheelbase_m = 0.18 ") && wheel.starts_with("wheel_diameter_m = 0.15 "), "{base} {wheel}");
    let (base, _) = numbers("c", &["--controller-yaml", "c.yaml", "--wheelbase", "0.5"]);
    assert!(base.starts_with("wheelbase_m = 0.5 "), "{base}");
    let told = refused(place.path(), &["init", "d", "--logs", "made", "--controller-yaml", "bot.urdf"]);
    assert!(told.contains("bot.urdf: ") && told.contains("diff_drive_controller"), "{told}");
}

#[test]
fn logs_that_are_in_runs_already_are_begun_from_where_they_are() {
    let place = made();
    let mine = place.path().join("mine");
    copy_logs(&place.path().join("made/runs"), &mine.join("runs"));
    let text = said(place.path(), &["init", "mine"]);
    assert!(text.contains("found 6 logs in mine/runs") && text.contains("wheelbase_m             FILL IN"), "{text}");
    assert!(!mine.join("returns.csv").exists());
    assert_eq!(std::fs::read_dir(mine.join("runs")).unwrap().count(), 6);
    let again = refused(place.path(), &["init", "mine"]);
    assert!(
        again.ends_with("mine/robot.toml: is there already; choose another folder, or say --force to replace it\n")
    );
    said(&mine, &["init", "--logs", "runs", "--force", "--wheelbase", "0.4"]);
    let robot = std::fs::read_to_string(mine.join("robot.toml")).unwrap();
    assert!(robot.contains("name = \"mine\"") && robot.contains("wheelbase_m = 0.4 "), "{robot}");
    std::fs::create_dir(place.path().join("none")).unwrap();
    assert_eq!(
        refused(place.path(), &["init", "x", "--logs", "none"]),
        "error: none: there is no log (.csv, .mcap, .db3, .bag) in it; give a log, or a folder of logs\n"
    );
    assert!(
        refused(place.path(), &["init", "x", "--wheelbase", "0.4"])
            .contains("x: there are no logs to begin from in runs")
    );
}

#[test]
fn inspect_lists_what_logs_hold_before_their_robot_is_known() {
    let place = bags(None);
    let text = said(place.path(), &["inspect", "bags"]);
    fits_the_terminal(&text.lines().filter(|line| !line.contains(".mcap")).collect::<Vec<_>>().join("\n"));
    let row = |name: &str| {
        text.lines().find(|line| line.trim_start().starts_with(name)).unwrap().split_whitespace().collect::<Vec<_>>()
    };
    assert_eq!(row("/joint_states ")[1], "sensor_msgs/JointState");
    assert_eq!(row("/joint_states ").last(), Some(&"wheels"));
    assert_eq!(row("/ground_truth ").last(), Some(&"reference"));
    assert!(text.contains("readings of joint") && text.contains("in steps of 1/2000 turn"), "{text}");
    assert!(text.contains("umbmark init my_robot --logs bags"), "{text}");
    let document = said(place.path(), &["inspect", "bags/rosbag2_2026_11_02-10_00_07/recorded_0.mcap", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&document).unwrap();
    let log = &document["contents"][0];
    assert_eq!((&log["layout"], &log["wheels"]["ticks_per_revolution"]), (&"mcap".into(), &2000.0.into()));
    assert!((log["wheels"]["rate_hz"].as_f64().unwrap() - 20.0).abs() < 0.1, "{log}");
    assert_eq!(log["problems"], serde_json::json!([]));

    // Poses that cannot be read do not hide the wheels.
    let other = said(place.path(), &["inspect", "bags", "--reference", "/nowhere"]);
    assert!(other.contains("reference  cannot be read: there is no topic \"/nowhere\" for --reference"), "{other}");
}

#[test]
fn inspect_lists_the_columns_of_a_csv_file() {
    let place = made();
    std::fs::copy(place.path().join("made/runs/cw_01.csv"), place.path().join("drive.csv")).unwrap();
    let text = said(place.path(), &["inspect", "drive.csv"]);
    fits_the_terminal(&text);
    for row in [" ticks_left ", " theta_ref_rad "] {
        assert!(text.contains(row), "{row}: {text}");
    }
    assert!(text.ends_with("\n      metres\n"), "{text}");
    std::fs::write(place.path().join("raw.csv"), "time,enc_l,enc_r,note\n0,0,0,a\n0.1,5,4.5,b\n").unwrap();
    let text = said(place.path(), &["inspect", "raw.csv"]);
    assert!(text.contains(" enc_r   0 to 4.5 ") && text.contains(" note "), "{text}");
    assert!(text.contains("wheels     cannot be read: there is no column t_s"), "{text}");
}
