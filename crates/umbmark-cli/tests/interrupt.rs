//! Ctrl-C and SIGTERM: what is done so far, marked partial, and nothing half-written.

#![cfg(unix)]
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// The command, interrupted once after some time.
fn interrupted(folder: &Path, after: Duration, arguments: &[&str]) -> Output {
    ended_by("-INT", folder, after, arguments)
}

/// The command, ended by a signal after some time.
fn ended_by(signal: &str, folder: &Path, after: Duration, arguments: &[&str]) -> Output {
    let child = Command::new(env!("CARGO_BIN_EXE_umbmark"))
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(after);
    Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    child.wait_with_output().unwrap()
}

fn told(output: &Output) -> serde_json::Value {
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A scheduler ends jobs by SIGTERM. The checkpoint holds what is done, though the next was due in an hour.
#[test]
fn a_study_that_is_told_to_end_saves_its_last_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["mc", "-n", "100000000", "--checkpoint", "study.json", "--checkpoint-every", "3600", "--json"];
    let output = ended_by("-TERM", folder.path(), Duration::from_secs(3), &words);
    assert_eq!(told(&output)["partial"], true);
    let saved = std::fs::read(folder.path().join("study.json")).unwrap();
    assert!(!saved.is_empty());
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["study.json"]);
}

/// Work far longer than the test waits for.
#[test]
fn studies_end_with_what_is_done_marked_as_partial() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/tolerances.toml"),
        folder.path().join("tolerances.toml"),
    )
    .unwrap();
    for arguments in [
        "mc --sweep ed=0.999:1.001:1000 --sweep eb=0.99:1.01:1000 -n 20 -o sweep.csv",
        "plan --see eb=1.005 --see ed=1.0004 --draws 20000",
        "tolerance tolerances.toml -n 10000000",
    ] {
        let words: Vec<&str> = arguments.split(' ').chain(["--json"]).collect();
        let output = interrupted(folder.path(), Duration::from_millis(2500), &words);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        if errors.starts_with("error: stopped before") {
            // A slow machine had nothing yet to tell.
            assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{arguments}");
            continue;
        }
        assert_eq!(told(&output)["partial"], true, "{arguments}");
        assert!(errors.starts_with("partial: stopped "), "{arguments}: {errors}");
    }
    let rows = std::fs::read_to_string(folder.path().join("sweep.csv")).unwrap().lines().count();
    assert!((2..1_000_000).contains(&rows), "{rows}");
}

#[test]
fn sensitivities_end_with_whole_scrambles_or_say_that_there_is_nothing_to_tell() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["sensitivity", "--vary", "eb=normal:1:0.003", "--noise-free", "-n", "4194304", "--json"];
    let output = interrupted(folder.path(), Duration::from_secs(2), &words);
    if output.status.code() == Some(130) {
        assert_eq!(told(&output)["partial"], true);
    } else {
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(errors.starts_with("error: stopped before"), "{errors}");
    }
}

/// The page is written whole, with what is missing said in it, and no file of the writing is left beside it.
#[test]
fn a_report_is_whole_and_says_what_is_missing() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/slope");
    let folder = tempfile::tempdir().unwrap();
    let words = ["report", data.to_str().unwrap(), "-o", "report.html", "-n", "50000000", "--json"];
    let output = interrupted(folder.path(), Duration::from_millis(700), &words);
    assert_eq!(told(&output)["partial"], true);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("<strong>PARTIAL.</strong>") && page.trim_end().ends_with("</html>"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// What a process does about signals, by their numbers: which it ignores or catches.
#[cfg(target_os = "linux")]
fn signals(process: u32, kind: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix(kind)?.strip_prefix(':')).unwrap();
    u64::from_str_radix(mask.trim(), 16).unwrap()
}

/// `nohup umbmark mc ...` goes on when the terminal closes.
#[cfg(target_os = "linux")]
#[test]
fn a_hang_up_that_is_to_be_ignored_is_ignored() {
    const HANG_UP: u64 = 1;
    const TERMINATE: u64 = 1 << 14;
    let mut cases = vec![("trap '' HUP; ", "SigIgn"), ("", "SigCgt")];
    if signals(std::process::id(), "SigIgn") & HANG_UP != 0 {
        println!("skipped in part: the tests themselves ignore a hang-up, and so does what they start");
        cases.pop();
    }
    for (shell, kind) in cases {
        let script = format!("{shell}exec \"$0\" mc -n 100000000");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_umbmark")]).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().unwrap();
        // Until it catches what ends it, which on a busy machine takes its time.
        let begun = std::time::Instant::now();
        let is_set = || signals(child.id(), "SigCgt") & TERMINATE != 0 && signals(child.id(), kind) & HANG_UP != 0;
        while !is_set() && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(100));
        let found = signals(child.id(), kind) & HANG_UP;
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(found, HANG_UP, "{kind}");
    }
}
