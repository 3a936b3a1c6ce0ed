//! `umbmark watch`: a folder that grows, its state, and its exit codes.

use crate::solve::{document, flowing, said};
use std::path::Path;
use std::process::Command;

/// Return errors of so many runs of a square of 4 m, in turns by direction; the last ones of a robot whose E_d moved.
fn write(folder: &Path, runs: usize, moved: usize) {
    let data = folder.join("robot");
    std::fs::create_dir_all(&data).unwrap();
    let robot = "[robot]\ndrive = \"differential\"\nwheelbase_m = 0.34\nwheel_diameter_m = 0.15\nticks_per_revolution = 2000\n\
                 [path]\nshape = \"square\"\nside_m = 4\n";
    std::fs::write(data.join("robot.toml"), robot).unwrap();
    let mut text = "direction,run,ex_mm,ey_mm\n".to_owned();
    for run in 0..runs {
        // 0.2 % of E_d.
        let (direction, shift) = if run % 2 == 0 { ("cw", [-181.0, -199.0]) } else { ("ccw", [194.6, -176.8]) };
        let [x, y] = if run < moved { [0.0; 2] } else { shift };
        let scatter = |k: usize| ((run * run * 7 + run * k) % 23) as f64 - 11.0;
        let (x, y) = (40.0 + x + scatter(3), 30.0 + y + scatter(5));
        text += &format!("{direction},{},{x},{y}\n", run / 2 + 1);
    }
    std::fs::write(data.join("returns.csv"), text).unwrap();
}

const WATCH: [&str; 5] = ["watch", "robot", "--state", "robot.watch.json", "--check"];

fn with(more: &[&'static str]) -> Vec<&'static str> {
    [&WATCH, more].concat()
}

#[test]
fn a_folder_that_grows_is_watched_until_the_robot_changes_and_then_until_it_is_restarted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, 5, 24);
    let text = flowing(&said(folder, &WATCH, 0));
    assert!(text.contains("because the baseline needs 1 more clockwise and 2 more counter-clockwise"), "{text}");
    write(folder, 24, 24);
    let text = flowing(&said(folder, &WATCH, 0));
    assert!(
        text.starts_with("24 runs watched, 19 of them new: nothing changed. Changes that would be found"),
        "{text}"
    );
    let state = std::fs::read(folder.join("robot.watch.json")).unwrap();
    let text = flowing(&said(folder, &WATCH, 0));
    assert!(text.starts_with("24 runs watched, 0 of them new: nothing changed."), "{text}");
    assert_eq!(std::fs::read(folder.join("robot.watch.json")).unwrap(), state);
    write(folder, 30, 24);
    let text = flowing(&said(folder, &WATCH, 3));
    assert!(text.starts_with("The robot changed: since run cw_13"), "{text}");
    assert!(text.contains("E_d moved from") && text.contains("one in 100 months of 60 runs"), "{text}");
    let again = document(folder, &WATCH[..4]);
    assert_eq!((&again["changed"], &again["new"]), (&true.into(), &0.into()));
    assert_eq!(again["change"]["since"], "cw_13");
    let text = flowing(&said(folder, &with(&["--restart", "cw_13"]), 0));
    assert!(text.starts_with("6 runs watched, 0 of them new"), "{text}");
    let text = flowing(&said(folder, &with(&["--restart", "now"]), 0));
    assert!(text.starts_with("0 runs watched"), "{text}");
    // Without a state, the data alone are asked, and nothing is written.
    said(folder, &["watch", "robot", "--check"], 3);
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 2);
}

#[test]
fn a_run_that_cannot_be_watched_does_not_pass_for_one_that_was() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, 24, 24);
    said(folder, &WATCH, 0);
    std::fs::create_dir(folder.join("robot/runs")).unwrap();
    let log: String = (0..50).map(|k| format!("{},{},{}\n", f64::from(k) / 50.0, 20 * k, 20 * k)).collect();
    std::fs::write(folder.join("robot/runs/cw_50.csv"), format!("t_s,ticks_left,ticks_right\n{log}")).unwrap();
    let text = flowing(&said(folder, &WATCH, 3));
    assert!(text.starts_with("24 runs watched, 0 of them new: nothing changed.") && text.contains("cw_50"), "{text}");
    said(folder, &WATCH[..4], 0);
}

#[test]
fn a_state_of_another_robot_or_rate_or_that_is_none_is_refused_by_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, 12, 12);
    said(folder, &WATCH, 0);
    let refused = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        flowing(&String::from_utf8(output.stderr).unwrap())
    };
    let text = refused(&with(&["--false-alarms", "0.1"]));
    assert!(text.contains("watched with 0.01 false alarms a month of 60 runs, and not with 0.1 of 60"), "{text}");
    let text = refused(&with(&["--restart", "cw_77"]));
    assert!(text.contains("no run is called \"cw_77\"; the last one is \"ccw_06\""), "{text}");
    let state = folder.join("robot.watch.json");
    let good = std::fs::read_to_string(&state).unwrap();
    std::fs::write(&state, good.replacen("\"x_m\":0", "\"x_m\":1", 1)).unwrap();
    let text = refused(&WATCH);
    assert!(text.contains("robot.watch.json is damaged: its checksum is"), "{text}");
    std::fs::write(&state, &good).unwrap();
    let robot = folder.join("robot/robot.toml");
    let other = std::fs::read_to_string(&robot).unwrap().replace("0.34", "0.35");
    std::fs::write(&robot, other).unwrap();
    let text = refused(&WATCH);
    assert!(text.contains("wheelbase_m = 0.34, and the data wheelbase_m = 0.35"), "{text}");
    assert_eq!(std::fs::read_to_string(&state).unwrap(), good);
}

/// Killed at 40 moments of its work, it leaves the old state or the new one, and the next call goes on.
#[cfg(unix)]
#[test]
fn a_watch_that_is_killed_leaves_the_old_or_the_new_state() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut known = 0;
    for moment in 0..40 {
        let runs = 10 + moment;
        write(folder, runs, 100);
        let mut child = Command::new(env!("CARGO_BIN_EXE_umbmark"))
            .current_dir(folder)
            .args(WATCH)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(5 * moment as u64));
        // SIGKILL.
        child.kill().unwrap();
        child.wait().unwrap();
        let next = document(folder, &WATCH[..4]);
        let new = next["new"].as_u64().unwrap() as usize;
        assert!(new == 0 || new == runs - known, "{new} of {runs}, {known} known");
        assert_eq!(next["runs"].as_array().unwrap().len(), runs);
        known = runs;
    }
}
