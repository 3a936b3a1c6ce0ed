//! `umbmark conditions`: what depends on a floor, and its exit code.

use crate::solve::{document, flowing, said};
use std::path::Path;
use std::process::Command;

/// Simulates a test of return poses.
fn test(folder: &Path, name: &str, flags: &[&str]) {
    said(folder, &[&["simulate", "-o", name, "--reference-rate", "0"], flags].concat(), 0);
}

#[test]
fn a_wheelbase_that_differs_between_floors_is_named_and_fails_a_check_and_the_same_robot_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    test(folder, "tile", &["--eb", "0.992", "--seed", "3"]);
    test(folder, "again", &["--eb", "0.992", "--seed", "5"]);
    test(folder, "carpet", &["--eb", "1.01", "--seed", "4"]);
    for (name, floor) in [("tile", "tile"), ("again", "tile"), ("carpet", "carpet")] {
        std::fs::write(folder.join(name).join("conditions.csv"), format!("floor\n{floor}\n")).unwrap();
    }
    let text = flowing(&said(folder, &["conditions", "tile", "carpet", "--check"], 3));
    assert!(
        text.starts_with("The effective wheelbase, E_b, differs between floors or sessions (p < 0.001): tile 0.99"),
        "{text}"
    );
    assert!(text.contains("note floor and session divide the runs alike"), "{text}");
    let found = document(folder, &["conditions", "tile", "carpet"]);
    assert_eq!(found["differs"], true);
    let row = &found["asked"][1];
    assert_eq!((&row["key"], &row["differs"]), (&"wheelbase.e_b".into(), &true.into()));
    let [low, high] = [0, 1].map(|end| row["largest"]["by"]["interval"][end].as_f64().unwrap());
    assert!(low < 0.018 && 0.018 < high, "{low} {high}");
    assert_eq!(found["numbers"][1]["depends_on"][0], "floor");
    let same = flowing(&said(folder, &["conditions", "tile", "again", "--check"], 0));
    assert!(same.starts_with("These runs show no difference between sessions for e_d ("), "{same}");
    assert!(same.contains("floor is the same in all 20 runs"), "{same}");
}

#[test]
fn runs_of_which_nothing_is_stated_are_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    test(folder, "tile", &["--seed", "3"]);
    let output = Command::new(env!("CARGO_BIN_EXE_umbmark")).current_dir(folder).args(["conditions", "tile"]).output();
    let output = output.unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    let refused = String::from_utf8(output.stderr).unwrap();
    assert!(refused.contains("nothing is stated of the conditions of the runs: write conditions.csv"), "{refused}");
}
