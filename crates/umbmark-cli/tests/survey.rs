//! `umbmark survey`: a row for each robot of a folder.

use crate::solve::{document, flowing, said};

#[test]
fn each_folder_is_a_robot_and_the_one_that_is_far_off_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("fleet")).unwrap();
    for (name, e_b, seed) in
        [("a", "1.001", "1"), ("b", "0.999", "2"), ("c", "1.002", "3"), ("d", "1.0", "4"), ("e", "1.06", "5")]
    {
        let place = format!("fleet/{name}");
        said(folder, &["simulate", "-o", &place, "--reference-rate", "0", "--eb", e_b, "--seed", seed], 0);
    }
    let text = flowing(&said(folder, &["survey", "fleet", "--check", "--draws", "99"], 3));
    assert!(text.starts_with("Of 5 robots, one stands out from the others: e."), "{text}");
    let found = document(folder, &["survey", "fleet", "--no-diagnosis"]);
    assert_eq!(found["robots"].as_array().unwrap().len(), 5);
    assert_eq!(found["robots"][4]["stands_out"][0]["key"], "wheelbase.e_b");
    assert_eq!((&found["among"][1]["robots"], &found["robots"][0]["verdict"]), (&4.into(), &serde_json::Value::Null));
    // One that cannot be read does not stop the others.
    std::fs::write(folder.join("fleet/b/returns.csv"), "direction,run\n").unwrap();
    let found = document(folder, &["survey", "fleet", "--no-diagnosis"]);
    assert_eq!(found["failed"][0]["robot"], "b");
    assert_eq!(found["robots"].as_array().unwrap().len(), 4);
}
