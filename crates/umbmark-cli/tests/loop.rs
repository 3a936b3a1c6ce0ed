//! `umbmark compare`, `diagnose`, `fit` and `learn`: their output, to the letter.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli` writes the golden files anew.

use serde_json::{Value, json};
use snapbox::{assert_data_eq, file};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

/// Standard output of a command that ends with `code`; nothing on standard error.
fn said(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = umbmark(folder, arguments);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{arguments:?}");
    assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that fails and prints nothing.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = umbmark(folder, arguments);
    assert_eq!((String::from_utf8_lossy(&output.stdout), output.status.code()), ("".into(), Some(1)), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn document(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&said(folder, &[arguments, &["--json"]].concat(), 0)).unwrap()
}

fn fits_the_terminal(text: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

/// A copy of a folder of the test data with only those returns that pass.
fn folder_of(name: &str, keep: impl Fn(&str) -> bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data().join(name).join("robot.toml"), folder.path().join("robot.toml")).unwrap();
    let sheet = std::fs::read_to_string(data().join(name).join("returns.csv")).unwrap();
    let kept: Vec<&str> = sheet.lines().filter(|line| line.starts_with("direction") || keep(line)).collect();
    std::fs::write(folder.path().join("returns.csv"), kept.join("\n")).unwrap();
    folder
}

#[test]
fn a_robot_whose_e_d_and_e_b_are_all_is_told_so_and_what_cannot_be_seen() {
    let text = said(&data(), &["diagnose", "labmate", "--check"], 0);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/diagnose.txt"]);
}

#[test]
fn a_sloping_floor_is_found_with_its_class_and_code_3() {
    let text = said(&data(), &["diagnose", "slope", "--check"], 3);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/diagnose_slope.txt"]);
    let found = document(&data(), &["diagnose", "slope"]);
    assert_eq!(found["verdict"], "missing_effect");
    let first = &found["ranking"][0];
    for key in ["class", "best", "f", "p_adjusted", "estimate", "standard_error", "expected_drop"] {
        assert!(!first[key].is_null(), "{key}");
    }
    let drift = first["estimate"]["drift_x"].as_f64().unwrap();
    assert!((drift - 3e-3).abs() < 3.0 * first["standard_error"]["drift_x"].as_f64().unwrap());
    assert!(first["class"].as_array().unwrap().iter().any(|name| name == "carpet_nap"));
    assert!(found["invisible"].as_array().unwrap().iter().any(|name| name == "scale"));
    assert!(found["minimum_detectable"]["floor_slope"].as_f64().unwrap() > 0.0);
    let next = &found["next_experiments"][0];
    assert!(next["separates"].as_array().unwrap().len() == 2 && next["sd"].is_f64() && next["minutes"].is_f64());
}

#[test]
fn the_story_of_a_sloping_floor_ends_in_a_model_that_explains_fresh_runs() {
    let folder = folder_of("slope", |_| true);
    let text = said(folder.path(), &["learn", ".", "-o", "learnt.toml"], 0);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/learn.txt"]);
    let learnt = document(folder.path(), &["learn", "."]);
    let steps = learnt["steps"].as_array().unwrap();
    assert!(
        steps[0]["added"].is_null() && steps[1]["added"] == "wheel_diameter_ratio" && steps[2]["added"] == "wheelbase"
    );
    for key in ["class", "p_adjusted", "rmse_m", "heldout_rmse_m", "heldout_heading_rmse_rad"] {
        assert!(!steps[3][key].is_null(), "{key}");
    }
    assert_eq!(learnt["verdict"], "explained");
    assert!(learnt["model"]["effect"].as_array().unwrap().len() == 3);
    // The model, run on the same floor another day.
    let model = folder.path().join("learnt.toml");
    let model = model.to_str().unwrap();
    let fresh = said(&data(), &["compare", "slope_again", "--model", model, "--check"], 0);
    fits_the_terminal(&fresh.replace(model, "learnt.toml"));
    assert!(fresh.contains("runs: explained: means"), "{fresh}");
    // Return poses do not tell the noise of wheels and tape apart.
    assert!(!std::fs::read_to_string(model).unwrap().contains("[noise]") && learnt["model"].get("noise").is_none());
    let again = umbmark(folder.path(), &["learn", ".", "-o", "learnt.toml"]);
    assert_eq!(String::from_utf8_lossy(&again.stderr).matches("exists already").count(), 1);
}

#[test]
fn models_are_compared_side_by_side_and_code_3_says_that_none_explains() {
    let text = said(&data(), &["compare", "slope"], 0);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/compare.txt"]);
    let folder = folder_of("slope", |_| true);
    std::fs::write(folder.path().join("nominal.toml"), "").unwrap();
    let text = said(folder.path(), &["compare", ".", "--model", "nominal.toml", "--check"], 3);
    assert!(text.contains("not explained: mean x"), "{text}");
    let compared = document(folder.path(), &["compare", "."]);
    assert_eq!(compared["models"].as_array().unwrap().len(), 2);
    assert_eq!(compared["models"][0]["explains"], false);
    assert!(compared["contrasts"][0]["interval"].is_array());
}

/// A simulated robot on a small square, watched at 20 Hz, with a floor slope.
fn watched(runs: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    let path = ["--side", "1", "--runs", runs, "--seed", "4", "--force"];
    let robot = ["--eb", "1.01", "--slope-x", "0.01", "--wheel-noise", "4e-4", "--json"];
    // It says on stderr which lengths of the robot it assumed.
    assert!(umbmark(folder.path(), &[&["simulate", "-o", place], &path[..], &robot[..]].concat()).status.success());
    folder
}

#[test]
fn on_tracks_it_is_told_where_the_error_is_made_and_what_it_depends_on() {
    let folder = watched("5");
    let text = said(folder.path(), &["compare", "."], 0);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/compare_tracks.txt"]);
    let compared = document(folder.path(), &["compare", "."]);
    assert_eq!(
        (&compared["observed"], &compared["n_cw"], &compared["n_ccw"]),
        (&"tracks".into(), &5.into(), &5.into())
    );
    let fitted = &compared["models"][1];
    assert_eq!(fitted["explains"], false);
    let mut against = fitted["against"].as_array().unwrap().iter();
    let heading = against.find(|a| a["rate"] == "forward_m_per_m" && a["covariate"] == "heading").unwrap();
    let downhill = &heading["bins"][0];
    assert!((downhill["mean"].as_f64().unwrap() - 0.01).abs() < 2e-3, "{downhill}");
    assert!(downhill["interval"].is_array() && downhill["runs"] == 10);
    let share: f64 =
        fitted["parts"]["moves"].as_array().unwrap().iter().map(|p| p["share"]["position"].as_f64().unwrap()).sum();
    assert!((share - 1.0).abs() < 1e-9);
    // The model with the slope explains; beside one without, --check is content.
    said(folder.path(), &["fit", ".", "--add", "floor_slope", "-o", "slope.toml"], 0);
    std::fs::write(folder.path().join("nominal.toml"), "").unwrap();
    said(folder.path(), &["compare", ".", "--model", "slope.toml", "--check"], 0);
    said(folder.path(), &["compare", ".", "--model", "nominal.toml", "--model", "slope.toml", "--check"], 0);
    said(folder.path(), &["compare", ".", "--model", "nominal.toml", "--check"], 3);
    let returns = document(folder.path(), &["compare", ".", "--return-poses"]);
    assert_eq!(returns["observed"], "end_poses");
}

#[test]
fn two_runs_show_where_the_error_is_made_and_accuse_nothing() {
    let compared = document(&data(), &["compare", "tracked", "--check"]);
    let nominal = &compared["models"][0];
    assert!(nominal["p"].is_null() && nominal["explains"].is_null());
    assert_eq!(nominal["parts"]["moves"].as_array().unwrap().len(), 16);
    assert!(nominal["parts"]["moves"][0]["forward_m"]["interval"].is_null());
    assert!(said(&data(), &["compare", "tracked"], 0).contains("note      Few runs, 2 in all"));
}

#[test]
fn one_direction_is_refused_and_told_why() {
    let folder = folder_of("labmate", |line| line.starts_with("ccw") && line.contains("systematic"));
    let text = said(folder.path(), &["diagnose", ".", "--check"], 1);
    fits_the_terminal(&text);
    assert_data_eq!(text, file!["golden/diagnose_one_direction.txt"]);
}

#[test]
fn a_fit_is_told_with_intervals_and_written_as_a_model() {
    let folder = folder_of("slope", |_| true);
    let text = said(folder.path(), &["fit", ".", "--add", "floor_slope", "-o", "model.toml"], 0);
    assert_data_eq!(text, file!["golden/fit.txt"]);
    let model = std::fs::read_to_string(folder.path().join("model.toml")).unwrap();
    assert_data_eq!(model, file!["golden/fit_model.toml"]);
    // Fitted again from its own values, it stays.
    said(folder.path(), &["fit", ".", "--model", "model.toml", "-o", "model.toml", "--force"], 0);
    let fitted = document(folder.path(), &["fit", ".", "--model", "model.toml"]);
    assert!(fitted["fitted"].as_array().unwrap().len() == 4 && fitted["not_shown"].as_array().unwrap().is_empty());
    let known = ["fit", ".", "--bound", "wheelbase.e_b=:0.99", "--prior", "wheel_diameter_ratio.e_d=1.05:0.0001"];
    let fitted = document(folder.path(), &known);
    let [bound, prior] = [0, 1].map(|k| &fitted["known"][k]);
    assert_eq!((&bound["value"], &bound["held"], &bound["low"]), (&json!(0.99), &json!(true), &Value::Null));
    assert!(prior["contradiction"].as_f64().unwrap().abs() > 10.0 && fitted["ended"]["converged"] == true, "{fitted}");
    let text = said(folder.path(), &known, 0);
    assert!(text.contains("e_b of wheelbase is held at 0.99") && text.contains("The runs contradict that"), "{text}");
    let scale = umbmark(folder.path(), &["fit", ".", "--add", "scale"]);
    let warned = String::from_utf8_lossy(&scale.stderr).into_owned();
    assert!(warned.starts_with("warning: scale was not fitted: this data cannot separate it"), "{warned}");
    assert_eq!(
        refused(folder.path(), &["fit", ".", "--add", "floor_slop"]),
        "error: there is no effect \"floor_slop\"; did you mean \"floor_slope\"?\n"
    );
}

#[test]
fn data_without_a_robot_says_what_is_needed() {
    let folder = folder_of("labmate", |_| true);
    std::fs::remove_file(folder.path().join("robot.toml")).unwrap();
    for verb in ["compare", "diagnose", "fit", "learn"] {
        let error = refused(folder.path(), &[verb, "returns.csv"]);
        assert!(error.contains("robot.toml"), "{verb}: {error}");
    }
}
