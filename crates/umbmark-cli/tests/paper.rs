//! `umbmark paper`, and robots of other drives, as their users meet them.

use snapbox::cmd::{Command, OutputAssert, cargo_bin};
use snapbox::str;

fn umbmark(arguments: &[&str]) -> OutputAssert {
    Command::new(cargo_bin!("umbmark")).args(arguments).assert()
}

fn json(arguments: &[&str]) -> serde_json::Value {
    let assert = umbmark(&[arguments, &["--json"]].concat()).success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

/// Seed 1, 300 tests each.
#[test]
fn published_numbers_stand_beside_their_simulated_distributions() {
    let document = json(&["paper", "table-1", "-n", "300"]);
    let rows = document["table_1"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows {
        let inside = row["e_max_sys_m"]["inside"].as_bool().unwrap();
        // The CLAPPER's 22 mm are systematic, and of what is not known.
        assert_eq!(inside, row["robot"] != "clapper", "{row}");
    }
    let document = json(&["paper", "table-2", "-n", "100"]);
    let found = &document["table_2"];
    let labmate = found["columns"][0]["recomputed"]["mean"].as_f64().unwrap().to_degrees();
    assert!((5.7..6.1).contains(&labmate), "{labmate}");
    let [on, off] = ["clapper_corrected_rad", "clapper_uncorrected_rad"].map(|key| found[key].as_f64().unwrap());
    assert!(off > 10.0 * on && on > 0.0, "{on} {off}");
}

#[test]
fn one_direction_hides_what_the_other_shows() {
    let rows = &json(&["paper", "figure-2"])["figure_2"]["rows"];
    let distance = |row: usize, direction: &str| {
        let error = &rows[row][direction];
        error[0].as_f64().unwrap().hypot(error[1].as_f64().unwrap())
    };
    assert!(distance(0, "ccw") > 0.5 && distance(1, "ccw") > 0.5);
    assert!(distance(2, "ccw") < 0.03 && distance(2, "cw") > 1.0);
}

#[test]
fn a_synchro_robot_is_simulated_calibrated_and_corrected() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let (data, corrected) = (place("k2a"), place("corrected.toml"));
    let truth = ["--steer-scale", "1.004", "--steer-coupling", "0.0015", "--wheel-noise", "0.0003"];
    umbmark(&[&["simulate", "--robot", "k2a", "-o", &data, "--reference-rate", "2"], &truth[..]].concat()).success();
    let found = json(&["calibrate", &data]);
    assert_eq!((&found["drive"], &found["return_poses_determine"]["rank"]), (&"synchro".into(), &2.into()));
    assert!(found["e_max_sys_after_m"].as_f64() < Some(0.02) && found["e_max_sys_before_m"].as_f64() > Some(0.1));
    umbmark(&["calibrate", &data, "--export-toml", &corrected]).success();
    let text = std::fs::read_to_string(corrected).unwrap();
    assert!(text.contains("drive = \"synchro\"") && text.contains("coupling_rad_per_m = 0.001"), "{text}");
    let header = place("x.h");
    umbmark(&["calibrate", &data, "--export-c", &header]).success();
    assert!(std::fs::read_to_string(header).unwrap().contains("#define UMBMARK_COUPLING_RAD_PER_M 0.001"));
    umbmark(&["calibrate", &data, "--export-ros2", &place("x.yaml")]).code(1).stdout_eq(str![""]);
}

#[test]
fn what_a_drive_does_not_have_is_refused_with_a_reason() {
    for (arguments, message) in [
        (
            &["mc", "--robot", "k2a", "--ed", "1.01"][..],
            "error: wheel_diameter_ratio is an effect of other drives (differential, clapper and skid_steer), and the robot has drive = \
             \"synchro\"; leave it out\n",
        ),
        (
            &["mc", "--robot", "k2a", "--wheelbase", "0.4"],
            "error: --wheelbase: a robot with drive = \"synchro\" has no wheelbase_m; give its own numbers in a robot.toml\n",
        ),
        (
            &["mc", "--robot", "clapper", "--shape", "circle"],
            "error: drive = \"clapper\" does not support paths with arcs\n",
        ),
    ] {
        umbmark(arguments).code(1).stdout_eq(str![""]).stderr_eq(message);
    }
}
