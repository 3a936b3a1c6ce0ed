//! `umbmark simulate` as its users meet it.

use snapbox::cmd::{Command, OutputAssert, cargo_bin};
use snapbox::str;
use umbmark_core::dataset::Dataset;
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

fn simulate(arguments: &[&str]) -> OutputAssert {
    Command::new(cargo_bin!("umbmark")).arg("simulate").args(arguments).assert()
}

#[test]
fn the_dataset_reads_back_with_the_return_errors_that_were_printed() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("my robot");
    let name = place.to_str().unwrap();
    let arguments = ["-o", name, "--side", "1", "--runs", "3", "--eb", "1.01", "--bumps", "10", "--json"];
    let assert = simulate(&arguments).success();
    let document: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let dataset = Dataset::load(&place).unwrap();
    assert_eq!(dataset.runs.len(), 12);
    let printed = document["runs"].as_array().unwrap();
    for test in [TestKind::Systematic, TestKind::Bumps] {
        for direction in Direction::BOTH {
            let read: Vec<f64> = dataset.returns(test, direction).map(|error| error.x).collect();
            let said: Vec<f64> = printed
                .iter()
                .filter(|run| run["direction"] == direction.name() && run["test"] == test.name())
                .map(|run| run["ex_m"].as_f64().unwrap())
                .collect();
            assert_eq!(read, said);
            assert_eq!(read.len(), 3);
        }
    }
    let log = dataset.runs[0].log.as_ref().unwrap();
    assert!(log.time.len() > 1000 && log.reference.len() > 200);
}

#[test]
fn the_same_seed_writes_the_same_bytes_and_nothing_is_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let write = |name: &str, seed: &str| {
        let place = place(name);
        simulate(&["-o", place.to_str().unwrap(), "--side", "0.5", "--runs", "2", "--seed", seed]).success();
        ["returns.csv", "runs/ccw_02.csv"].map(|file| std::fs::read(place.join(file)).unwrap())
    };
    let first = write("a", "3");
    assert_eq!(first, write("b", "3"));
    assert_ne!(first[0], write("c", "4")[0]);
    simulate(&["-o", place("a").to_str().unwrap()]).code(1).stdout_eq(str![""]);
}

#[test]
fn with_a_tape_measure_only_the_end_pose_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("tape");
    let arguments = ["-o", place.to_str().unwrap(), "--side", "0.5", "--runs", "1", "--reference-rate", "0"];
    simulate(&arguments).success();
    let dataset = Dataset::load(&place).unwrap();
    for run in &dataset.runs {
        let log = run.log.as_ref().unwrap();
        assert_eq!(log.reference.iter().map(|r| r.sample).collect::<Vec<_>>(), [log.time.len() - 1]);
    }
}
