//! Each command that cannot be carried out gets one clear error, and leaves no file.
//!
//! The commands stand in `bad_flags/cases.txt`, and what is said of them in `docs/bad_flags.md`, which
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all bad_flags` writes anew.

use snapbox::{Data, assert_data_eq};
use std::path::Path;
use std::process::Command;

/// What `umbmark` says of a command in a folder with the example's ten return poses, in one paragraph.
fn said(command: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let data = folder.path().join("tape");
    std::fs::create_dir(&data).unwrap();
    for name in ["robot.toml", "returns.csv"] {
        std::fs::copy(examples.join("tape").join(name), data.join(name)).unwrap();
    }
    std::fs::copy(examples.join("tolerances.toml"), folder.path().join("tolerances.toml")).unwrap();
    let words = shlex::split(command).unwrap();
    let mut umbmark = Command::new(env!("CARGO_BIN_EXE_umbmark"));
    let output = umbmark.args(words).current_dir(folder.path()).env("NO_COLOR", "1").output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(matches!(output.status.code(), Some(1 | 2)), "{command}: {:?} {errors}", output.status.code());
    assert!(output.stdout.is_empty() && errors.starts_with("error: "), "{command}: {errors}");
    assert!(!errors.contains("panicked"), "{command}: {errors}");
    let left = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 2, "{command}: a file was left");
    let lines = errors.trim_start_matches("error: ").lines().map(str::trim).filter(|line| !line.is_empty());
    lines.filter(|line| !line.starts_with("For more information")).collect::<Vec<_>>().join(" ")
}

#[test]
fn every_command_that_cannot_be_carried_out_is_answered_with_its_sentence() {
    let mut text = String::from(
        "# Bad flags\n\nWhat commands that cannot be carried out are answered. `tape` is the dataset of `examples/tape`. The exit code is 2 \
         where the\ncommand itself is not understood and 1 where what it asks for is impossible; no file is written.\n",
    );
    let mut rows = 0;
    for line in include_str!("bad_flags/cases.txt").lines().filter(|line| !line.is_empty()) {
        match line.strip_prefix("# ") {
            Some(title) => text += &format!("\n## {title}\n\n| command | what is said |\n|---|---|\n"),
            None => {
                let shown = said(line).replace('|', "\\|").replace('<', "&lt;");
                text += &format!("| `umbmark {}` | {shown} |\n", line.replace('|', "\\|"));
                rows += 1;
            }
        }
    }
    assert!(rows >= 60, "{rows}");
    assert_data_eq!(
        text,
        Data::read_from(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bad_flags.md"), None).raw()
    );
}
