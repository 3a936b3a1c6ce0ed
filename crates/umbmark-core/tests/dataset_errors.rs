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
    assert!(cases.len() > 100);
    let mut wrong = Vec::new();
    for case in &cases {
        let said = said(case);
        if said != case.says {
            wrong.push(format!("{}\n   said: {said}\nwanted: {}", case.name, case.says));
        }
    }
    assert!(wrong.is_empty(), "{} differ:\n{}", wrong.len(), wrong.join("\n"));
}

/// The table of `docs/bad_input.md`, which is made of the cases; `SNAPSHOTS=overwrite` writes it anew.
#[test]
fn the_table_in_the_documentation_is_that_of_the_cases() {
    let shown = |text: &str| text.replace('|', "\\|").replace('<', "&lt;");
    let mut table = String::from(
        "# Bad input\n\nWhat cannot be used, and what is said of it. The table is made of the cases that the tests run \
         ([`cases.txt`](../crates/umbmark-core/tests/bad_input/cases.txt), which holds the input too).\n\n\
         | what is wrong | what is said |\n|---|---|\n",
    );
    for case in cases() {
        table += &format!("| {} | {} |\n", shown(&case.name), shown(&case.says));
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bad_input.md");
    if std::env::var("SNAPSHOTS").is_ok_and(|what| what == "overwrite") {
        std::fs::write(&file, &table).unwrap();
    }
    assert!(std::fs::read_to_string(&file).is_ok_and(|text| text == table), "write it anew with SNAPSHOTS=overwrite");
}
