//! `umbmark solve`: its output to the letter, and one answer in every verb.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli` writes the golden files anew.

use serde_json::Value;
use snapbox::{assert_data_eq, file};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

pub(crate) fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

/// Standard output of a command that ends with `code`.
pub(crate) fn said(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = umbmark(folder, arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    if !arguments.contains(&"--json") {
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{arguments:?}: {text}");
    }
    text
}

pub(crate) fn document(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&said(folder, &[arguments, &["--json"]].concat(), 0)).unwrap()
}

/// Text without its breaks.
pub(crate) fn flowing(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What verbs say of a dataset.
pub(crate) struct Said {
    pub(crate) solved: Value,
    pub(crate) learnt: Value,
    /// Of the model that was learnt, where it explains the runs.
    pub(crate) compared: Option<Value>,
    pub(crate) report: Value,
    pub(crate) page: String,
}

impl Said {
    fn of(folder: &Path) -> Said {
        let place = tempfile::tempdir().unwrap();
        let [model, learnt, page] = ["solved.toml", "learnt.toml", "page.html"].map(|name| place.path().join(name));
        let read = |file: &Path| std::fs::read_to_string(file).unwrap();
        let solved = document(folder, &["solve", ".", "-o", model.to_str().unwrap()]);
        let model_of_learn = learnt.to_str().unwrap();
        let answer = document(folder, &["learn", ".", "-o", model_of_learn]);
        let compared = || document(folder, &["compare", ".", "--model", model_of_learn]);
        let said = Said {
            solved,
            compared: (answer["verdict"] == "explained").then(compared),
            learnt: answer,
            report: document(folder, &["report", ".", "-n", "100", "-o", page.to_str().unwrap()]),
            page: read(&page),
        };
        // Both files hold the same model under another heading.
        let lines = |file: &Path| {
            read(file).lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(lines(&model), lines(&learnt), "{}", folder.display());
        said
    }
}

/// What verbs say, asked when the first test needs it.
pub(crate) type Asked = LazyLock<Said, Box<dyn FnOnce() -> Said + Send>>;

/// Datasets of `tests/data` and of `examples`, for all tests that need the same of them.
pub(crate) static SAID: LazyLock<Vec<(PathBuf, Asked)>> = LazyLock::new(|| {
    let own = ["labmate", "slope", "tape", "tracked"].map(|name| data().join(name));
    let examples = ["hidden", "tape", "unnamed"].map(|name| examples().join(name));
    let asked = |folder: PathBuf| {
        let place = folder.clone();
        (folder, Asked::new(Box::new(move || Said::of(&place))))
    };
    own.into_iter().chain(examples).map(asked).collect()
});

#[test]
fn the_answer_of_ten_returns_and_of_a_floor_that_turns_the_robot() {
    assert_data_eq!(said(&examples(), &["solve", "tape", "--check"], 0), file!["golden/solve_tape.txt"]);
    assert_data_eq!(said(&examples(), &["solve", "hidden", "--verbose"], 0), file!["golden/solve_hidden.txt"]);
}

/// The floor of `examples/hidden` has E_b .995 and E_s .998 behind it, which a fit of E_d, E_b and E_s alone takes for .988 and .994.
#[test]
fn what_is_exported_is_the_truth_where_a_floor_hides_it() {
    let (_, said_of_it) = SAID.iter().find(|(folder, _)| folder.ends_with("hidden")).unwrap();
    let found = &said_of_it.solved;
    let of = |key: &str| ["old", "new", "low", "high"].map(|end| found["correction"][key][end].as_f64().unwrap());
    let [old, new, low, high] = of("wheelbase_m");
    assert!(low <= 0.995 * old && 0.995 * old <= high && (new / old - 0.9952).abs() < 1e-4, "{new} {low} {high}");
    let mean = |place: usize| 0.5 * (of("wheel_diameter_left_m")[place] + of("wheel_diameter_right_m")[place]);
    assert!((mean(1) / mean(0) - 0.998).abs() < 1e-4);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("robot.toml");
    said(&examples(), &["calibrate", "hidden", "--export-toml", file.to_str().unwrap()], 0);
    let text = std::fs::read_to_string(file).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("wheelbase_m = ")).unwrap();
    let written: f64 = line.split_whitespace().next().unwrap().parse().unwrap();
    assert!((written - new).abs() < 1e-9, "{written} {new}");
}

/// The numbers are those of one model, whichever verb is asked; and what that model leaves is what `compare` says of it.
#[test]
fn every_verb_gives_the_same_answer() {
    for (folder, known) in SAID.iter().filter(|(folder, _)| !folder.ends_with("unnamed")) {
        let Said { solved: answer, learnt, compared, report, .. } = &**known;
        let what = folder.display();
        for key in ["correction", "sentence", "verdict", "left_m", "repeats_m", "model"] {
            assert_eq!(answer[key], learnt[key], "{what}: {key}");
        }
        let calibrated = document(folder, &["calibrate", "."]);
        assert_eq!(
            (&answer["sentence"], &calibrated["exported"]),
            (&calibrated["sentence"], &"model".into()),
            "{what}"
        );
        for (key, change) in answer["correction"].as_object().unwrap() {
            let [own, other] = [&change["new"], &calibrated["methods"]["model"][key]].map(|v| v.as_f64().unwrap());
            assert!((own / other - 1.0).abs() < 1e-9, "{what}: {key} {own} {other}");
        }
        let [own, other] =
            [&answer["left_m"], &compared.as_ref().unwrap()["left_m"]].map(|left| left.as_f64().unwrap());
        assert!((own / other - 1.0).abs() < 0.01, "{what}: {own} {other}");
        assert_eq!(answer["sentence"], report["studies"][0]["verdict"], "{what}");
        let sentence = answer["sentence"].as_str().unwrap();
        for verb in ["solve", "learn", "calibrate"] {
            assert!(flowing(&said(folder, &[verb, "."], 0)).contains(sentence), "{what}: {verb}");
        }
        // Each step of the error is the sum of its parts.
        let off = &answer["off"];
        let number = |value: &Value| value.as_f64().unwrap();
        let sum = |parts: &Value| parts.as_object().unwrap().values().map(number).sum::<f64>();
        let written = number(&off["driven_m"]) - sum(&off["reference_m"]) - sum(&off["written_m"]);
        assert!((written - number(&answer["remains_m"])).abs() < 1e-9, "{what}");
        assert!((written - sum(&off["known_m"]) - number(&off["rest_m"])).abs() < 1e-9, "{what}");
    }
}

#[test]
fn one_direction_is_not_enough_and_the_next_step_is_said() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data().join("tape/robot.toml"), folder.path().join("robot.toml")).unwrap();
    let sheet = std::fs::read_to_string(data().join("tape/returns.csv")).unwrap();
    let one: Vec<&str> = sheet.lines().filter(|line| !line.starts_with("cw,")).collect();
    std::fs::write(folder.path().join("returns.csv"), one.join("\n")).unwrap();
    let found = document(folder.path(), &["solve", "."]);
    assert_eq!((&found["verdict"], &found["correction"]), (&"not_enough_data".into(), &serde_json::json!({})));
    assert!(found["next"][0].as_str().unwrap().contains("three runs in each direction"), "{found}");
    // Runs that test nothing are no reason for a job to pass.
    let run = |arguments: &[&str]| umbmark(folder.path(), arguments).status.code();
    for verb in ["diagnose", "solve"] {
        assert_eq!([run(&[verb, ".", "--check"]), run(&[verb, "."])], [Some(1), Some(0)], "{verb}");
    }
}
