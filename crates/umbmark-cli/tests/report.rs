//! `umbmark plot` and `umbmark report`: what they write, and what they refuse.

use crate::solve::{SAID, Said};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name).display().to_string()
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(arguments).output().unwrap()
}

fn said(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr))
}

fn written(folder: &Path, arguments: &[&str], file: &str) -> Vec<u8> {
    let output = umbmark(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output).1);
    std::fs::read(folder.join(file)).unwrap()
}

#[test]
fn a_figure_is_written_in_the_format_that_its_name_says_and_the_same_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let slope = data("slope");
    for (file, begin) in [("a.svg", &b"<svg"[..]), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF"), ("a.json", b"{")] {
        let arguments = ["plot", "return_errors", &slope, "-o", file, "--draws", "99", "--force"];
        let first = written(folder.path(), &arguments, file);
        assert!(first.starts_with(begin), "{file}");
        assert!(first == written(folder.path(), &arguments, file), "{file}");
    }
    let again = umbmark(folder.path(), &["plot", "return_errors", &slope, "-o", "a.svg", "--draws", "99"]);
    assert_eq!(again.status.code(), Some(1));
    assert!(said(&again).1.contains("a.svg exists already; --force replaces it"));
}

#[test]
fn a_kind_that_there_is_not_is_answered_by_those_that_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let output = umbmark(folder.path(), &["plot", "pie", &data("slope"), "-o", "a.svg"]);
    assert_eq!(output.status.code(), Some(2));
    let error = said(&output).1;
    for line in
        ["there is no such kind of figure", "  return_errors   return errors, centres", "  tracks          measured"]
    {
        assert!(error.contains(line), "{error}");
    }
}

#[test]
fn files_of_other_endings_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = umbmark(folder.path(), &["plot", "tracks", &data("slope"), "-o", "a.jpg"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).1.contains("NAME.svg, NAME.png, NAME.pdf or NAME.json"));
    let output = umbmark(folder.path(), &["report", &data("slope"), "-o", "a.pdf"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).1.contains("a report is written as NAME.html"));
}

#[test]
fn what_cannot_be_drawn_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let output = umbmark(folder.path(), &["plot", "residuals_along", &data("slope"), "-o", "a.svg", "--draws", "99"]);
    assert_eq!(output.status.code(), Some(1));
    let error = said(&output).1;
    assert!(error.contains("residuals_along cannot be drawn from"), "{error}");
    assert!(error.contains("not on the way"), "{error}");
    assert!(!folder.path().join("a.svg").exists());
}

#[test]
fn a_report_tells_the_verdict_its_files_and_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let labmate = data("labmate");
    let arguments = ["report", &labmate, "--draws", "99", "-n", "100", "--json"];
    let output = umbmark(folder.path(), &arguments);
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(document["bytes"], page.len());
    assert!(page.len() < 5_000_000);
    let verdict = document["studies"][0]["verdict"].as_str().unwrap();
    assert!(verdict.starts_with("The robot comes back 267 mm off."), "{verdict}");
    assert!(page.contains(verdict) && page.contains("E_max,sys"));
    let outcome = document["studies"][0]["outcome"].as_str().unwrap();
    assert!(page.contains(&format!("<p class=\"verdict {outcome}\">")), "{outcome}");
    // SHA-256 of the sheet, as any other tool gives it.
    let sheet = PathBuf::from(&labmate).join("returns.csv");
    let sum = Command::new("sha256sum").arg(sheet).output();
    if let Ok(sum) = sum.map(|sum| String::from_utf8(sum.stdout).unwrap()) {
        assert!(page.contains(&sum[..64]), "{sum}");
    }
    assert!(page.contains("--draws 99 -n 100 --json"));
    let again = umbmark(folder.path(), &arguments);
    assert_eq!(again.status.code(), Some(1));
    assert!(said(&again).1.contains("report.html exists already; --force replaces it"));
}

#[test]
fn two_datasets_and_two_models_stand_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let (slope, labmate) = (data("slope"), data("labmate"));
    let page = written(
        folder.path(),
        &["report", &slope, &labmate, "--draws", "99", "-n", "100", "-o", "both.html"],
        "both.html",
    );
    let page = String::from_utf8(page).unwrap();
    assert!(page.contains("<h2><code>slope</code></h2>") && page.contains("<h2><code>labmate</code></h2>"));
    assert!(page.contains("id=\"return_errors-0\"") && page.contains("id=\"return_errors-1\""));
    std::fs::write(folder.path().join("nominal.toml"), "").unwrap();
    let effect = "[[effect]]\nname = \"wheelbase\"\ne_b = 1.0\nfree = true\n";
    std::fs::write(folder.path().join("wheelbase.toml"), effect).unwrap();
    let models = ["--model", "nominal.toml", "--model", "wheelbase.toml"];
    let arguments = [&["report", &slope, "--draws", "99", "-n", "100", "-o", "models.html"][..], &models].concat();
    let page = String::from_utf8(written(folder.path(), &arguments, "models.html")).unwrap();
    assert!(
        page.contains("<h2><code>nominal.toml</code></h2>") && page.contains("<h2><code>wheelbase.toml</code></h2>")
    );
}

/// The document of a verb.
fn document(folder: &Path, arguments: &[&str]) -> Value {
    let output = umbmark(folder, &[arguments, &["--draws", "99", "--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output).1);
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn headline_page_learn_and_compare_say_one_verdict() {
    // The last first: another test asks for the others at the same time.
    for (folder, known) in SAID.iter().rev() {
        let (set, Said { solved, learnt, compared, report, page }) = (folder.display(), &**known);
        let study = &report["studies"][0];
        assert_eq!((&study["verdict"], &learnt["verdict"]), (&solved["sentence"], &solved["verdict"]), "{set}");
        let outcome = study["outcome"].as_str().unwrap();
        let allowed: &[&str] = match learnt["verdict"].as_str().unwrap() {
            "explained" => &["explained", "partly"],
            "missing_effect" | "several_missing" | "unlisted_effect" => &["partly"],
            "not_enough_data" => &["not_enough_data"],
            _ => &["not_explained", "fault"],
        };
        assert!(allowed.contains(&outcome), "{set}: {outcome} where learn says {}", learnt["verdict"]);
        assert!(page.contains(&format!("<p class=\"verdict {outcome}\">")), "{set}");
        if outcome == "explained" {
            for other in ["does not explain the runs", "hardly explains", "does not account for"] {
                assert!(!page.contains(other), "{set}: {other}");
            }
            assert_ne!(compared.as_ref().unwrap()["models"][0]["explains"], false, "{set}");
        }
    }
}

#[test]
fn a_page_of_two_datasets_says_whether_the_robot_returns_better() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, wheelbase: &str, seed: &str| {
        let arguments =
            ["simulate", "--runs", "5", "--eb", wheelbase, "--wheel-noise", "0.0005", "--seed", seed, "-o", name];
        assert_eq!(umbmark(folder.path(), &arguments).status.code(), Some(0));
    };
    made("before", "1.02", "1");
    made("after", "1.0", "2");
    made("again", "1.02", "3");
    let change = |pair: [&str; 2]| {
        let page = format!("{}.html", pair.join("_"));
        let report = document(folder.path(), &["report", pair[0], pair[1], "--return-poses", "-n", "100", "-o", &page]);
        let page = std::fs::read_to_string(folder.path().join(page)).unwrap();
        let said = report["change"].as_str().unwrap().to_owned();
        assert!(page.contains(&format!("<p class=\"verdict {}\">", said.replace(' ', "_"))), "{said}");
        said
    };
    assert_eq!(change(["before", "after"]), "better");
    // What the returns say does not need the logs again.
    for name in ["before", "after", "again"] {
        std::fs::remove_dir_all(folder.path().join(name).join("runs")).unwrap();
    }
    assert_eq!(change(["after", "before"]), "worse");
    assert_eq!(change(["before", "again"]), "the same");
}
