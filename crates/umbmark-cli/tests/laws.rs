//! Laws that no catalogue lists, on the squares of `examples/unnamed`: what `learn` and `report` say of them.

use std::path::{Path, PathBuf};
use std::process::Command;

fn unnamed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/unnamed")
}

/// Standard output, in one line.
fn said(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_umbmark"))
        .current_dir(folder)
        .args(arguments)
        .arg(unnamed())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_wave_is_added_with_what_it_means_and_with_the_drive_that_tells_it_from_what_looks_the_same() {
    let text = said(Path::new("."), &["learn"]);
    for part in [
        "verdict explained, by a law that the catalogue does not have (added as a formula)",
        "separates periodic_yaw from law 2 of the table",
        "The robot turns by up to 0.6",
        "to the left and to the right in turn, once in 17.0",
        " 1 3.5 21 heading_per_metre = a * cos(2 * pi * time / c)",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}

#[test]
fn another_law_of_the_table_keeps_its_number() {
    let text = said(Path::new("."), &["learn", "--law", "2"]);
    let row = "*2 3.9 21 heading_per_metre = a * cos(2 * pi * distance / c)";
    assert!(text.contains(row) && text.contains(" 1 3.5 21 heading_per_metre = a * cos(2 * pi * time / c)"), "{text}");
}

#[test]
fn a_formula_of_the_user_that_another_law_makes_needless_is_said_to_be_that() {
    let folder = tempfile::tempdir().unwrap();
    // In the second, nothing depends on t.
    for (formula, parts) in [
        ("k * exp(-time / t)", &["cooling of the given model is not needed"][..]),
        ("k * exp(-0 * t)", &["cooling of the given model is not needed", "t of cooling is kept at 10"]),
    ] {
        let own = format!(
            "[[effect]]\nname = \"cooling\"\nacts_on = \"heading_per_metre\"\nformula = \"{formula}\"\nparameters = {{ k = 0.0, t = 10 }}\n\
             free = true\n"
        );
        std::fs::write(folder.path().join("own.toml"), own).unwrap();
        let text = said(folder.path(), &["learn", "--model", "own.toml"]);
        for part in parts {
            assert!(text.contains(part), "{part}\n{text}");
        }
    }
}

#[test]
fn the_page_says_of_a_law_what_learn_says() {
    let folder = tempfile::tempdir().unwrap();
    said(folder.path(), &["report", "-o", "page.html"]);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    let fall = "The cross-validated error fell from 48.0 to 3.5 mm";
    for part in ["Explained, by a law without a name.", "a law that is not in the catalogue: periodic yaw", fall] {
        assert!(page.contains(part), "{part}");
    }
}
