//! Standard input and output, pipes, devices and links in place of files.

#![cfg(unix)]
use std::io::Write;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn examples(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbmark"));
    command.current_dir(folder).args(arguments);
    command
}

fn umbmark(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// The command with some bytes on its standard input.
fn fed(folder: &Path, arguments: &[&str], bytes: &[u8]) -> Output {
    let mut child =
        command(folder, arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let bytes = bytes.to_vec();
    // What is not read to its end breaks the pipe.
    let writer = std::thread::spawn(move || drop(input.write_all(&bytes)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder with a robot and ten numbers from a tape.
fn tape() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["robot.toml", "returns.csv"] {
        std::fs::copy(examples("tape").join(name), folder.path().join(name)).unwrap();
    }
    folder
}

#[test]
fn a_file_on_standard_output_stands_there_alone() {
    let folder = tempfile::tempdir().unwrap();
    let written = |place: &str| {
        let output = umbmark(folder.path(), &["mc", "-n", "20", "--out", place]);
        assert!(output.status.success(), "{output:?}");
        output
    };
    let file = written("trials.csv");
    let rows = std::fs::read(folder.path().join("trials.csv")).unwrap();
    for place in ["-", "/dev/stdout"] {
        let through = written(place);
        assert_eq!(text(&through.stdout), text(&rows), "{place}");
        // What the verb tells is the same, but elsewhere.
        assert!(!file.stdout.is_empty() && text(&through.stderr).contains("E_max,sys"), "{through:?}");
    }
    let tape = tape();
    let figure = umbmark(tape.path(), &["plot", "returns", ".", "-o", "/dev/stdout"]);
    assert_ne!(figure.status.code(), Some(101), "{figure:?}");
    let model = umbmark(tape.path(), &["fit", ".", "--add", "wheel_diameter_ratio", "-o", "-"]);
    assert!(model.status.success() && text(&model.stdout).contains("[[effect]]"), "{model:?}");
    let refused = umbmark(tape.path(), &["convert", ".", "-o", "-"]);
    assert!(
        !refused.status.success() && text(&refused.stderr).contains("standard output cannot hold one"),
        "{refused:?}"
    );
}

#[test]
fn links_devices_and_named_pipes_stay_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("real.csv"), "old").unwrap();
    std::os::unix::fs::symlink("real.csv", at("link.csv")).unwrap();
    std::os::unix::fs::symlink("/dev/null", at("nothing.csv")).unwrap();
    let kept = umbmark(folder.path(), &["mc", "-n", "20", "--out", "link.csv"]);
    assert!(!kept.status.success() && text(&kept.stderr).contains("exists"), "{kept:?}");
    for place in ["link.csv", "nothing.csv", "/dev/null"] {
        let output = umbmark(folder.path(), &["mc", "-n", "20", "--out", place, "--force"]);
        assert!(output.status.success(), "{place}: {output:?}");
    }
    assert!(at("link.csv").is_symlink() && at("nothing.csv").is_symlink());
    assert_eq!(std::fs::read_to_string(at("real.csv")).unwrap().lines().count(), 21);
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let pipe = at("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    let output = umbmark(folder.path(), &["mc", "-n", "20", "--out", "pipe", "--force"]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(reader.join().unwrap(), std::fs::read_to_string(at("real.csv")).unwrap());
    assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
    let refused = umbmark(folder.path(), &["mc", "-n", "20", "--checkpoint", "/dev/null", "--force"]);
    assert!(!refused.status.success() && text(&refused.stderr).contains("not a regular file"), "{refused:?}");
    let refused = umbmark(folder.path(), &["mc", "-n", "20", "--out", ".", "--force"]);
    assert!(!refused.status.success() && text(&refused.stderr).contains("is a folder"), "{refused:?}");
}

#[test]
fn what_comes_through_a_pipe_is_read_like_a_file() {
    let folder = tape();
    let sheet = std::fs::read(folder.path().join("returns.csv")).unwrap();
    let file = umbmark(folder.path(), &["score", "returns.csv", "--json"]);
    assert!(file.status.success(), "{file:?}");
    for name in ["-", "/dev/stdin"] {
        let piped = fed(folder.path(), &["score", name, "--json"], &sheet);
        assert_eq!(text(&piped.stdout), text(&file.stdout), "{name}: {piped:?}");
    }
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let writer = std::thread::spawn({
        let (pipe, sheet) = (pipe.clone(), sheet.clone());
        move || std::fs::write(pipe, sheet).unwrap()
    });
    let piped = umbmark(folder.path(), &["score", "pipe", "--json"]);
    writer.join().unwrap();
    assert_eq!(text(&piped.stdout), text(&file.stdout), "{piped:?}");
    // An error names the pipe and not the copy.
    let broken = text(&sheet).replacen("cw,", "sideways,", 1);
    let told = fed(folder.path(), &["score", "-"], broken.as_bytes());
    assert!(!told.status.success() && text(&told.stderr).contains("standard input:"), "{told:?}");
    assert!(!text(&told.stderr).contains("umbmark-"), "{told:?}");
}

/// The hidden robot with another number of ticks per revolution in its robot.toml. Three runs each way: of all five the verbs say the same.
fn with_ticks(ticks: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    let from = examples("hidden");
    for entry in std::fs::read_dir(from.join("runs")).unwrap() {
        let entry = entry.unwrap();
        let is_left_out = |end: &&str| entry.file_name().to_str().unwrap().ends_with(end);
        if ["04.csv", "05.csv"].iter().any(is_left_out) {
            continue;
        }
        std::fs::copy(entry.path(), folder.path().join("runs").join(entry.file_name())).unwrap();
    }
    let robot = std::fs::read_to_string(from.join("robot.toml")).unwrap();
    assert!(robot.contains("ticks_per_revolution = 1440.0 "), "{robot}");
    let robot = robot.replace("ticks_per_revolution = 1440.0 ", &format!("ticks_per_revolution = {ticks} "));
    std::fs::write(folder.path().join("robot.toml"), robot).unwrap();
    folder
}

#[test]
fn counts_that_are_a_factor_off_are_named_by_every_verb_with_the_line_that_mends_them() {
    for (ticks, told) in [
        ("5760", "ticks_per_revolution = 1440 "),
        ("360", "ticks_per_revolution = 1440 "),
        ("2880", "ticks_per_revolution = 1440 "),
        ("1440000", "ticks_per_revolution"),
    ] {
        let folder = with_ticks(ticks);
        for verb in ["inspect", "learn", "diagnose", "compare", "solve", "calibrate", "fit"] {
            let output = umbmark(folder.path(), &[verb, "."]);
            let said = text(&output.stdout) + &text(&output.stderr);
            let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
            assert_ne!(output.status.code(), Some(101), "{verb} of {ticks}: {said}");
            assert!(said.contains(told), "{verb} of {ticks}: {said}");
            assert!(!said.contains("no sign of a further effect"), "{verb} of {ticks}: {said}");
        }
    }
}

/// Names may hold anything; a terminal must not do what they say.
#[cfg(unix)]
#[test]
fn a_name_moves_no_cursor_and_one_that_is_no_text_is_told() {
    use std::os::unix::ffi::OsStringExt;
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("runs");
    std::fs::create_dir(&runs).unwrap();
    std::fs::copy(examples("fresh_day/robot.toml"), folder.path().join("robot.toml")).unwrap();
    for name in ["cw_01.csv", "cw_02\u{1b}[31m\u{7}.csv", "notes\u{1b}[2J.mat"] {
        std::fs::copy(examples("fresh_day/runs/cw_01.csv"), runs.join(name)).unwrap();
    }
    let output = umbmark(folder.path(), &["inspect", "."]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(output.status.success() && said.contains("notes?[2J.mat: is no log"), "{said}");
    assert!(said.chars().all(|c| c == '\n' || !c.is_control()), "{said:?}");
    let name = std::ffi::OsString::from_vec(b"cw_03\xff.csv".to_vec());
    std::fs::copy(examples("fresh_day/runs/cw_01.csv"), runs.join(name)).unwrap();
    let output = umbmark(folder.path(), &["inspect", "."]);
    assert!(
        !output.status.success() && text(&output.stderr).contains("its name is not UTF-8; rename it"),
        "{output:?}"
    );
    // A key of YAML that would begin others.
    let model = examples("hidden");
    let fitted = umbmark(folder.path(), &["fit", model.to_str().unwrap(), "-o", "model.toml"]);
    assert!(fitted.status.success(), "{fitted:?}");
    let words = ["export", "model.toml", "--to", "ros2_control", "-o", "r.yaml", "--controller", "x:\n  evil: 1"];
    let refused = umbmark(folder.path(), &words);
    assert!(!refused.status.success() && text(&refused.stderr).contains("the name of a controller"), "{refused:?}");
    assert!(!folder.path().join("r.yaml").exists());
}
