//! `umbmark score` and `umbmark calibrate`: their output, to the letter.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli` writes the golden files anew.

use serde_json::Value;
use snapbox::{assert_data_eq, file};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

/// Standard output and standard error of a command that succeeds.
fn said(folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = umbmark(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// Standard error of a command that fails and prints nothing.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = umbmark(folder, arguments);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn document(folder: &Path, arguments: &[&str]) -> Value {
    let (text, errors) = said(folder, arguments);
    assert_eq!(errors, "");
    serde_json::from_str(&text).unwrap()
}

fn fits_the_terminal(text: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

/// The labmate's folder with only those returns that pass.
fn folder_of(keep: impl Fn(&str) -> bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data().join("labmate/robot.toml"), folder.path().join("robot.toml")).unwrap();
    let sheet = std::fs::read_to_string(data().join("labmate/returns.csv")).unwrap();
    let kept: Vec<&str> = sheet.lines().filter(|line| line.starts_with("direction") || keep(line)).collect();
    std::fs::write(folder.path().join("returns.csv"), kept.join("\n")).unwrap();
    folder
}

#[test]
fn the_score_of_a_sheet_with_bumps() {
    let (text, errors) = said(&data(), &["score", "labmate"]);
    assert_eq!(errors, "");
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/score.txt"]);
}

#[test]
fn the_score_as_json_has_the_keys_that_stay() {
    let score = document(&data(), &["score", "labmate", "--json"]);
    let [low, high] = [0, 1].map(|i| score["e_max_sys_interval_m"][i].as_f64().unwrap());
    let e_max = score["e_max_sys_m"].as_f64().unwrap();
    assert!(low < e_max && e_max < high && (e_max - 0.267).abs() < 1e-3);
    let ccw: Vec<f64> = score["centroid_ccw_m"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    assert!((ccw[0].hypot(ccw[1]) - e_max).abs() < 1e-12);
    assert_eq!((score["n_cw"].as_u64(), score["n_ccw"].as_u64()), (Some(5), Some(5)));
    assert_eq!(score["nonsys_convention"], "mean");
    let sum = document(&data(), &["score", "labmate", "--json", "--convention", "sum"]);
    let [mean, sum] = [&score, &sum].map(|s| s["nonsys_orientation_rad"].as_f64().unwrap());
    assert!((sum - 2.0 * mean).abs() < 1e-15 && (mean.to_degrees() - 5.93).abs() < 0.02);
    assert!(score["sigma_m"].is_f64() && score["centroid_cw_m"].is_array() && score["warnings"].is_array());
}

#[test]
fn one_direction_is_scored_without_e_max_sys_and_not_calibrated() {
    let folder = folder_of(|line| line.starts_with("cw") && line.contains("systematic"));
    let (text, errors) = said(folder.path(), &["score", "."]);
    assert_data_eq!(text, file!["golden/score_one_direction.txt"]);
    assert_data_eq!(errors, file!["golden/score_one_direction.err"]);
    assert_eq!(document(folder.path(), &["score", ".", "--json"])["e_max_sys_m"], Value::Null);
    assert_data_eq!(refused(folder.path(), &["calibrate", "."]), file!["golden/calibrate_one_direction.err"]);
}

#[test]
fn two_runs_a_direction_have_scores_and_no_intervals() {
    let folder = folder_of(|line| ["cw,1,s", "cw,2,s", "ccw,1,s", "ccw,2,s"].iter().any(|s| line.starts_with(s)));
    let (text, errors) = said(folder.path(), &["score", "."]);
    assert_data_eq!(text, file!["golden/score_two_runs.txt"]);
    assert_data_eq!(errors, file!["golden/score_two_runs.err"]);
}

#[test]
fn impossible_options_and_empty_sheets_are_refused() {
    for (verb, level) in [("score", "1.5"), ("calibrate", "0")] {
        let output = umbmark(&data(), &[verb, "labmate", "--level", level]);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains("'--level <P>': must be between 0 and 1, both excluded"), "{errors}");
    }
    let sheet = tempfile::tempdir().unwrap();
    std::fs::write(sheet.path().join("returns.csv"), "direction,run,ex_m,ey_m\ncw,1,0.1,0.2\n").unwrap();
    let message = refused(sheet.path(), &["calibrate", "returns.csv"]);
    assert!(message.contains("the nominal robot is not known"), "{message}");
}

#[test]
fn the_calibration_of_a_sheet() {
    let (text, errors) = said(&data(), &["calibrate", "labmate"]);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/calibrate.txt"]);
    assert_data_eq!(errors, file!["golden/calibrate.err"]);
}

#[test]
fn the_calibration_as_json_has_the_keys_that_stay() {
    let calibration = document(&data(), &["calibrate", "labmate", "--json"]);
    for method in ["closed_form_x", "closed_form_y", "closed_form_mean", "heading", "exact"] {
        let m = &calibration["methods"][method];
        for key in ["e_d", "e_b", "wheelbase_m", "wheel_diameter_left_m", "wheel_diameter_right_m"] {
            assert!(m[key].is_f64(), "{method} {key}");
        }
        assert!(m["e_s"].is_null());
        assert_eq!(m["covariance"].as_array().unwrap().len(), 2);
        assert!(m["e_max_sys_after_m"].as_f64() < m["e_max_sys_before_m"].as_f64());
        let (e_d, e_b) = (m["e_d"].as_f64().unwrap(), m["e_b"].as_f64().unwrap());
        let [left, right] = ["wheel_diameter_left_m", "wheel_diameter_right_m"].map(|k| m[k].as_f64().unwrap());
        assert!((right / left - e_d).abs() < 1e-12 && (left + right - 0.3).abs() < 1e-12);
        assert!((m["wheelbase_m"].as_f64().unwrap() - 0.34 * e_b).abs() < 1e-12);
    }
    assert!(calibration["warnings"][0].as_str().unwrap().starts_with("E_s is not determined"));
    let corrected = document(&data(), &["calibrate", "labmate", "--json", "--radius-wheelbase", "corrected"]);
    let e_d = |c: &Value| c["methods"]["closed_form_x"]["e_d"].as_f64().unwrap() - 1.0;
    let e_b = calibration["methods"]["closed_form_x"]["e_b"].as_f64().unwrap();
    assert!((e_d(&corrected) / e_d(&calibration) - e_b).abs() < 1e-5);
}

#[test]
fn exports_are_written_whole_and_never_over_another_file() {
    let folder = folder_of(|line| line.contains("systematic"));
    let export =
        ["calibrate", ".", "--export-ros2", "base.yaml", "--export-toml", "robot2.toml", "--export-c", "odometry.h"];
    let (text, _) = said(folder.path(), &export);
    assert!(text.ends_with("wrote base.yaml\nwrote robot2.toml\nwrote odometry.h\n"), "{text}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_data_eq!(read("base.yaml"), file!["golden/export.yaml"]);
    assert_data_eq!(read("robot2.toml"), file!["golden/export.toml"]);
    assert_data_eq!(read("odometry.h"), file!["golden/export.h"]);
    assert_eq!(refused(folder.path(), &export), "error: base.yaml exists already; --force replaces it\n");
    said(folder.path(), &[&export[..], &["--force", "--method", "closed-form-x"]].concat());
    assert_ne!(read("odometry.h"), std::fs::read_to_string(golden("export.h")).unwrap());
    // The exported robot, run on the same returns, is the corrected one.
    assert!(read("robot2.toml").contains("wheelbase_m = 0.33"));
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)
}

#[test]
fn runs_that_repeat_to_the_last_digit_have_no_scatter_and_no_nan() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data().join("tape/robot.toml"), folder.path().join("robot.toml")).unwrap();
    let row = |direction: &str, run: usize| format!("{direction},{run},0.1,0.02");
    let rows: Vec<String> = ["cw", "ccw"].iter().flat_map(|side| (1..6).map(move |run| row(side, run))).collect();
    let sheet = format!("direction,run,ex_m,ey_m\n{}\n", rows.join("\n"));
    std::fs::write(folder.path().join("returns.csv"), sheet).unwrap();
    let (text, _) = said(folder.path(), &["score", "."]);
    assert!(text.contains("sigma, radial [mm]") && !text.contains("NaN"), "{text}");
}
