//! Several datasets in one command.

use crate::solve::{document, examples, flowing, said};
use std::fs;
use std::path::Path;
use std::process::Command;

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    flowing(&String::from_utf8(output.stderr).unwrap())
}

/// Squares and rectangles of the robot of `examples`, whose hidden floor turns it: E_b .995 and E_s .998 behind it.
#[test]
fn a_model_of_two_paths_has_narrower_intervals_than_that_of_one_and_holds_the_truth() {
    let width = |sets: &[&str]| {
        let told = document(&examples(), &[&["solve"], sets].concat());
        let number = &told["correction"]["wheelbase_m"];
        let [low, high] = ["low", "high"].map(|key| number[key].as_f64().unwrap());
        assert!(low < 0.26 * 0.995 && 0.26 * 0.995 < high, "{number}");
        assert_eq!(told["verdict"], "explained");
        high - low
    };
    let (alone, both) = (width(&["hidden"]), width(&["hidden", "fresh_day"]));
    assert!(both < 0.95 * alone, "{both} {alone}");
}

#[test]
fn runs_are_named_by_their_set_and_a_path_that_differs_is_not_one() {
    let told = flowing(&said(&examples(), &["inspect", "hidden", "fresh_day"], 0));
    assert!(told.contains("hidden/cw_01") && told.contains("fresh_day/cw_01"), "{told}");
    assert!(told.contains("path not one: the datasets drive different paths"), "{told}");
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path().join("both").display().to_string();
    let told = flowing(&said(&examples(), &["convert", "hidden", "fresh_day", "-o", &at], 0));
    assert!(told.contains("which runs are of which session"), "{told}");
    let runs = fs::read_dir(folder.path().join("both/runs")).unwrap().count();
    let of = |set: &str| fs::read_dir(examples().join(set).join("runs")).unwrap().count();
    assert_eq!(runs, of("hidden") + of("fresh_day"));
}

/// Scores are those of one path; corrected logs stand in a folder for each dataset.
#[test]
fn scores_of_two_paths_are_doubted_and_logs_of_two_sets_are_written_apart() {
    let told = document(&examples(), &["score", "hidden", "fresh_day"]);
    assert!(told["warnings"][0].as_str().unwrap().starts_with("The datasets drive different paths"), "{told}");
    let folder = tempfile::tempdir().unwrap();
    let [model, at] = ["model.toml", "corrected"].map(|name| folder.path().join(name).display().to_string());
    said(&examples(), &["fit", "hidden", "-o", &model], 0);
    said(&examples(), &["apply", "hidden", "fresh_day", "--model", &model, "-o", &at], 0);
    let written = |set: &str| fs::read_dir(folder.path().join("corrected").join(set)).unwrap().count();
    let of = |set: &str| fs::read_dir(examples().join(set).join("runs")).unwrap().count();
    assert_eq!([written("hidden"), written("fresh_day")], [of("hidden"), of("fresh_day")]);
}

#[test]
fn one_set_given_twice_and_two_robots_are_refused() {
    let told = refused(&examples(), &["score", "hidden", "./hidden"]);
    assert!(told.contains("hidden: is given twice; its runs would count twice"), "{told}");
    let told = refused(&examples(), &["fit", "tape", "hidden"]);
    assert!(told.contains("hidden: wheelbase_m = 0.26, and 0.34 in tape"), "{told}");
}

/// The same counts beside another robot.toml: read by the robot of the first, they give the same numbers.
#[test]
fn counts_beside_another_nominal_robot_are_those_of_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("renamed");
    let runs = copy.join("runs");
    fs::create_dir_all(&runs).unwrap();
    for file in fs::read_dir(examples().join("fresh_day/runs")).unwrap().map(Result::unwrap) {
        fs::copy(file.path(), runs.join(file.file_name())).unwrap();
    }
    let robot = fs::read_to_string(examples().join("fresh_day/robot.toml")).unwrap();
    assert!(robot.contains("wheelbase_m = 0.26"));
    fs::write(copy.join("robot.toml"), robot.replace("wheelbase_m = 0.26", "wheelbase_m = 0.265")).unwrap();
    let second = copy.display().to_string();
    let fitted = |second: &str| document(&examples(), &["fit", "hidden", second])["fitted"].clone();
    assert_eq!(fitted(&second), fitted("fresh_day"));
}
