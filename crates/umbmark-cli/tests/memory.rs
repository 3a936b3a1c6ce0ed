//! How much memory a command may take: what it needs is said, more is refused, and what takes more than it said is ended.

#![cfg(target_os = "linux")]
use std::path::Path;
use std::process::{Command, Output};

fn umbmark(folder: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbmark")).args(words.split(' ')).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn examples() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

#[test]
fn tests_that_need_more_than_there_may_be_are_refused_before_they_begin() {
    let folder = tempfile::tempdir().unwrap();
    let simulated = umbmark(folder.path(), "simulate --runs 5 --encoder-rate 10 --reference-rate 10 -o set");
    assert!(simulated.status.success(), "{simulated:?}");
    for verb in ["diagnose", "learn", "solve", "compare", "calibrate", "report"] {
        let refused = umbmark(folder.path(), &format!("{verb} set --memory 60MB"));
        let text = said(&refused);
        assert_eq!((refused.status.code(), refused.stdout.len()), (Some(1), 0), "{verb}: {refused:?}");
        assert!(text.starts_with("error: this needs about "), "{verb}: {text}");
        assert!(text.contains(" MB of memory, which is more than --memory (60 MB)"), "{verb}: {text}");
        assert!(text.contains("fewer or shorter runs") && text.lines().count() == 1, "{verb}: {text}");
    }
    assert!(!folder.path().join("report.html").exists());
    let inspected = umbmark(folder.path(), "inspect set --memory 1GB");
    assert!(inspected.status.success() && said(&inspected).is_empty(), "{inspected:?}");
    let wrong = umbmark(folder.path(), "inspect set --memory much");
    assert!(wrong.status.code() == Some(2) && said(&wrong).contains("2GB or 500MB"), "{wrong:?}");
}

#[test]
fn a_log_too_large_to_be_read_is_refused_before_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(examples().join("fresh_day/robot.toml"), folder.path().join("robot.toml")).unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    // A file of two gigabytes of nothing takes no place on the disk.
    let log = std::fs::File::create(folder.path().join("runs/cw_01.csv")).unwrap();
    log.set_len(2_000_000_000).unwrap();
    let refused = umbmark(folder.path(), "inspect . --memory 3GB");
    assert!(refused.status.code() == Some(1), "{refused:?}");
    assert!(said(&refused).starts_with("error: this needs about 10.0 GB of memory"), "{refused:?}");
}

/// Work of which nothing was said before: every trial of the sheet is kept, and the counters are read a million times a second.
#[test]
fn what_takes_more_than_there_may_be_is_ended_with_one_error_and_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let words = "simulate --runs 3 --encoder-rate 100000 -o set --memory 90MB";
    let ended = umbmark(folder.path(), words);
    assert_eq!(ended.status.code(), Some(1), "{ended:?}");
    let text = said(&ended);
    assert!(text.starts_with("error: stopped, because it took more memory than --memory (90 MB)"), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
