//! `umbmark changed`: what moved between two tests, and its exit code.

use crate::solve::{document, flowing, said};
use std::path::Path;

/// Simulates a test of return poses.
fn test(folder: &Path, name: &str, flags: &[&str]) {
    said(folder, &[&["simulate", "-o", name, "--reference-rate", "0"], flags].concat(), 0);
}

#[test]
fn a_wider_wheelbase_is_named_and_fails_a_check_and_the_same_robot_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    test(folder, "march", &["--eb", "0.992", "--seed", "3"]);
    test(folder, "again", &["--eb", "0.992", "--seed", "5"]);
    test(folder, "april", &["--eb", "1.01", "--seed", "4"]);
    let text = flowing(&said(folder, &["changed", "march", "april", "--check"], 3));
    assert!(text.starts_with("The wheelbase over the mean wheel diameter rose by 1."), "{text}");
    assert!(text.contains("One length accounts for it: the wheelbase alone, 1."), "{text}");
    let found = document(folder, &["changed", "march", "april"]);
    assert_eq!((&found["changed"], &found["as_before"]), (&true.into(), &false.into()));
    let row = &found["robot"][1];
    assert_eq!((&row["key"], &row["changed"]), (&"wheelbase_over_diameter".into(), &true.into()));
    let [low, high] = [0, 1].map(|end| row["interval"][end].as_f64().unwrap());
    let truth = (1.01 - 0.992) * 0.34 / 0.15;
    assert!(low < truth && truth < high, "{low} {high} {truth}");
    let same = flowing(&said(folder, &["changed", "march", "again", "--check"], 0));
    assert!(same.starts_with("These tests show no change of the wheel diameter ratio"), "{same}");
}
