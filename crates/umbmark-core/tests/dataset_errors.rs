//! Each piece of unusable input gets one clear error: file, line, column or key, value, what is allowed, what to do.

#![allow(clippy::unwrap_used)]

mod bad_input;

use bad_input::{Case, cases};
use std::path::Path;
use umbmark_core::dataset::Dataset;

/// What loading a case says, without the path of its folder.
fn said(case: &Case) -> String {
    let folder = tempfile::tempdir().unwrap();
    case.write(folder.path());
    let before = contents(case, folder.path());
    let path = if case.load.is_empty() { folder.path().to_owned() } else { folder.path().join(&case.load) };
    let said = match Dataset::load(path) {
        Ok(data) => format!("no error, and {:?}", data.warnings),
        Err(error) => error.to_string(),
    };
    assert_eq!(contents(case, folder.path()), before, "{}: loading touched the files", case.name);
    case.without_folder(&said, folder.path())
}

fn contents(case: &Case, folder: &Path) -> Vec<Vec<u8>> {
    case.files.iter().map(|(name, _)| std::fs::read(folder.join(name)).unwrap()).collect()
}

#[test]
fn every_piece_of_bad_input_is_answered_with_its_sentence() {
    let cases = cases();
    assert!(cases.len() > 80);
    let mut wrong = Vec::new();
    for case in &cases {
        let said = said(case);
        if said != case.says {
            wrong.push(format!("{}\n   said: {said}\nwanted: {}", case.name, case.says));
        }
    }
    assert!(wrong.is_empty(), "{} differ:\n{}", wrong.len(), wrong.join("\n"));
}
