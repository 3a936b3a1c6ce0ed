//! `umbmark apply`: corrected odometry from logs and a model.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MODEL: &str =
    "[[effect]]\nname = \"wheelbase\"\ne_b = 0.995\n\n[[effect]]\nname = \"floor_slope_yaw\"\nsine_rad_per_m = 0.01\n";
const NOISE: &str = "\n[noise]\nheading_rad_per_sqrt_m = 0.0015\nforward_m_per_sqrt_m = 0.0003\n";

/// The folder of a model with noise and of one without.
fn models() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("model.toml"), format!("{MODEL}{NOISE}")).unwrap();
    std::fs::write(folder.path().join("plain.toml"), MODEL).unwrap();
    folder
}

fn runs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/fresh_day")
}

fn apply(folder: &Path, data: &str, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbmark"));
    command.current_dir(folder).args(["apply", data]).args(more).output().unwrap()
}

fn document(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(output: &Output) -> String {
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Last row of a file, as numbers.
fn last_row(file: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn a_log_gives_a_row_a_sample_that_ends_where_the_summary_says() {
    let folder = models();
    let log = runs().join("runs/cw_01.csv");
    let rows = std::fs::read_to_string(&log).unwrap().lines().count();
    let said = document(&apply(
        folder.path(),
        log.to_str().unwrap(),
        &["--model", "model.toml", "-o", "corrected.csv", "--json"],
    ));
    let run = &said["runs"][0];
    assert_eq!((run["run"].as_str(), run["samples"].as_u64()), (Some("cw_01"), Some(rows as u64 - 1)));
    let last = last_row(&folder.path().join("corrected.csv"));
    for (i, value) in last[1..4].iter().enumerate() {
        assert_eq!(run["end"][i].as_f64(), Some(*value));
    }
    let sd = [last[4], last[6], last[9]].map(f64::sqrt);
    for (i, sd) in sd.into_iter().enumerate() {
        assert_eq!(run["end_standard_deviation"][i].as_f64(), Some(sd));
        assert!(sd > 1e-4 && sd < 0.1, "{sd}");
    }
}

#[test]
fn a_folder_gives_a_file_a_run_and_start_turns_a_slope() {
    let folder = models();
    let data = runs();
    let data = data.to_str().unwrap();
    let refusal = refused(&apply(folder.path(), data, &["--model", "model.toml", "-o", "corrected.csv"]));
    assert!(
        refusal.ends_with("there are 6 runs, and corrected.csv holds one; name a folder, and the format with --to\n"),
        "{refusal}"
    );
    let said = apply(folder.path(), data, &["--model", "model.toml", "-o", "here", "--to", "tum"]);
    let text = String::from_utf8_lossy(&said.stdout).into_owned();
    assert!(text.contains("wrote 6 files to here") && text.contains("the covariances"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert_eq!(std::fs::read_dir(folder.path().join("here")).unwrap().count(), 6);
    let end = |start: &str, place: &str| {
        let start = format!("--start={start}");
        assert!(apply(folder.path(), data, &["--model", "model.toml", "-o", place, &start]).status.success());
        let row = last_row(&folder.path().join(place).join("ccw_01.csv"));
        [row[1], row[2], row[3]]
    };
    let [here, there, turned] =
        [end("0,0,0", "a"), end("2,-1,0", "b"), end(&format!("0,0,{}", std::f64::consts::FRAC_PI_2), "c")];
    assert!((there[0] - here[0] - 2.0).abs() < 1e-9 && (there[1] - here[1] + 1.0).abs() < 1e-9);
    // Seen from START it ends elsewhere: the slope has another direction there.
    assert!((turned[1] - here[0]).hypot(-turned[0] - here[1]) > 5e-3, "{turned:?} {here:?}");
}

#[test]
fn a_model_without_noise_gives_poses_alone_and_says_so() {
    let folder = models();
    let log = runs().join("runs/cw_01.csv");
    let output = apply(folder.path(), log.to_str().unwrap(), &["--model", "plain.toml", "-o", "c.csv"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("plain.toml has no [noise]: no covariance is given"), "{said}");
    assert_eq!(last_row(&folder.path().join("c.csv")).len(), 4);
    let again = apply(folder.path(), log.to_str().unwrap(), &["--model", "plain.toml", "-o", "c.csv"]);
    assert!(refused(&again).ends_with("c.csv exists already; --force replaces it\n"));
    let wrong =
        apply(folder.path(), log.to_str().unwrap(), &["--model", "plain.toml", "-o", "d.csv", "--start", "1,2"]);
    assert_eq!(wrong.status.code(), Some(2));
    let drawn = "[[effect]]\nname = \"wheelbase\"\ne_b = { mean = 1.0, sd = 0.01 }\n";
    std::fs::write(folder.path().join("drawn.toml"), drawn).unwrap();
    let drawn = apply(folder.path(), log.to_str().unwrap(), &["--model", "drawn.toml", "-o", "d.csv"]);
    assert_eq!(refused(&drawn), "error: drawn.toml: e_b of wheelbase is drawn; give it a value\n");
    let returns = runs().join("returns.csv");
    let none = apply(folder.path(), returns.to_str().unwrap(), &["--model", "plain.toml", "-o", "d.csv"]);
    assert!(refused(&none).contains("no run has wheel counts"));
}
