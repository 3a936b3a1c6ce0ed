//! `umbmark plan`: its output to the letter, its sheets, and what it refuses.
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
    let few = ["plan", "--draws", "99"];
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(few).args(arguments).output().unwrap()
}

fn said(folder: &Path, arguments: &[&str]) -> String {
    let output = umbmark(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(arguments: &[&str]) -> String {
    let output = umbmark(&data(), arguments);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_plan_says_how_many_runs_and_what_they_show() {
    let text = said(&data(), &["--see", "eb=1.005", "--see", "es=1.003", "--sigma", "50mm"]);
    assert_data_eq!(&text, file!["golden/plan.txt"]);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn the_document_has_every_number_of_runs_and_more_runs_show_more() {
    let document: Value = serde_json::from_str(&said(&data(), &["labmate", "--see", "eb=1.002", "--json"])).unwrap();
    let rows = document["by_runs"].as_array().unwrap();
    let runs: Vec<u64> = rows.iter().map(|row| row["runs"].as_u64().unwrap()).collect();
    assert_eq!(runs, (3..=30).collect::<Vec<u64>>());
    let least = |row: &Value| row["minimum_detectable"][1]["size"].as_f64().unwrap();
    assert!(rows.windows(2).all(|pair| least(&pair[1]) < least(&pair[0])));
    let seen = &document["see"][0];
    assert_eq!((seen["seen_by"].as_str(), seen["parameter"].as_str()), (Some("calibrate"), Some("e_b")));
    // More scatter takes more runs.
    let at = |i: usize| seen["runs_at_sigma_interval"][i].as_u64().unwrap();
    assert!(at(0) <= seen["runs"].as_u64().unwrap() && seen["runs"].as_u64().unwrap() <= at(1), "{seen}");
    assert_eq!(document["alternatives"][4]["minimum_detectable"][0]["size"], Value::Null);
}

#[test]
fn the_experiments_that_tell_two_effects_apart_are_ranked_for_the_data() {
    let text = said(&data(), &["labmate", "--separate", "wheelbase", "scale"]);
    assert_data_eq!(text, file!["golden/plan_separate.txt"]);
}

#[test]
fn sheets_are_written_whole_with_the_columns_of_returns_and_not_over_files_that_exist() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["-o", "protocol.md", "-o", "protocol.html", "--bumps", "10", "--separate", "scale", "wheelbase"];
    said(folder.path(), &arguments);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_data_eq!(read("protocol.md"), file!["golden/protocol.md"]);
    let html = read("protocol.html");
    assert_eq!((html.matches("<tr>").count(), html.matches("<th>").count()), (21, 9));
    let again = umbmark(folder.path(), &arguments);
    assert_eq!(again.status.code(), Some(1));
    assert!(String::from_utf8(again.stderr).unwrap().contains("protocol.md exists already; --force replaces it"));
}

#[test]
fn what_cannot_be_planned_is_refused_with_what_to_do() {
    let cases = [
        (vec!["--see", "ebb=1.1"], "no effect has a size \"ebb\"; did you mean \"eb\"?"),
        (vec!["--see", "eb=1"], "eb = 1 has no effect"),
        (vec!["--direction", "cw"], "remove --direction"),
        (vec!["--power", "0.04"], "--power must be greater than --size"),
        (vec!["--eb-sd", "0.01"], "remove --eb-sd"),
        (vec!["labmate", "--wheelbase", "0.5"], "the robot is that of the data"),
        (vec!["-o", "sheet.pdf"], "the name of a protocol ends in .md, .txt or .html"),
        (vec!["--separate", "scale", "scale"], "--separate needs two effects"),
    ];
    for (arguments, sentence) in cases {
        let error = refused(&arguments);
        assert!(error.contains(sentence), "{arguments:?}: {error}");
    }
}

/// One watched square each way: a straight shows the scale that E_b hides from return poses, turns on the spot do not.
#[test]
fn experiments_beside_tracks_are_drives_that_are_watched_as_the_tracks_were() {
    let ranked = |pair: [&str; 2]| -> Vec<(String, f64, f64)> {
        let text = said(&data(), &["tracked", "--separate", pair[0], pair[1], "--json"]);
        let document: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(document["separates"], serde_json::json!(pair));
        let told = |e: &Value| {
            let number = |key: &str| e[key].as_f64().unwrap();
            (e["experiment"].as_str().unwrap().to_owned(), number("sd"), number("minutes"))
        };
        document["next_experiments"].as_array().unwrap().iter().map(told).collect()
    };
    let found = ranked(["turn_slip", "crab"]);
    let worth = |(_, sd, minutes): &(String, f64, f64)| sd * sd / minutes;
    assert!(found.len() > 8 && found.windows(2).all(|pair| worth(&pair[0]) >= worth(&pair[1])), "{found:?}");
    let sd = |found: &[(String, f64, f64)], what: &str| found.iter().find(|e| e.0.starts_with(what)).unwrap().1;
    let fitted = ranked(["wheelbase", "scale"]);
    assert!(sd(&fitted, "a straight of 10 m,") > 2.0 * sd(&fitted, "5 turns on the spot,"), "{fitted:?}");
    assert!(refused(&["tracked", "--separate", "crab", "crab"]).contains("--separate needs two effects"));
}
