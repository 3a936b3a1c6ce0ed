//! Each piece of unusable input gets one clear error: file, line, column or key, value, what is allowed, what to do.

use crate::bad_input::{Case, cases};
use crate::sentences::{COMMAND, sentences};
use std::path::Path;

/// What loading a case says, without the path of its folder.
fn said(case: &Case) -> String {
    let folder = tempfile::tempdir().unwrap();
    case.write(folder.path());
    let before = contents(case, folder.path());
    let path = if case.load.is_empty() { folder.path().to_owned() } else { folder.path().join(&case.load) };
    let said = match umbmark_io::load(path) {
        Ok(data) => format!("no error, and {:?}", data.warnings),
        Err(error) => error.worded(&COMMAND),
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

/// The tables of `docs/bad_input.md`, which are made of the cases; `SNAPSHOTS=overwrite` writes it anew.
#[test]
fn the_tables_in_the_documentation_are_those_of_the_cases() {
    let shown = |text: &str| text.replace('|', "\\|").replace('<', "&lt;");
    let mut text = String::from(
        "# Bad input\n\nWhat cannot be used, and what is said of it. The tables are made of the cases that the tests run.\n",
    );
    let (of_text, of_logs) = (cases(), sentences(include_str!("bad_input/mcap_cases.txt")));
    let of_text = of_text.iter().map(|case| (&*case.name, &*case.says)).collect();
    let files = [
        ("Text files", "cases.txt", "which holds the input too", of_text),
        ("MCAP logs", "mcap_cases.txt", "whose input `mcap_bad_input.rs` makes", of_logs),
    ];
    for (heading, name, input, sentences) in files {
        let link = format!("[`{name}`](../crates/umbmark-io/tests/bad_input/{name})");
        text += &format!("\n## {heading}\n\n{link}, {input}.\n\n| what is wrong | what is said |\n|---|---|\n");
        for (wrong, says) in sentences {
            text += &format!("| {} | {} |\n", shown(wrong), shown(says));
        }
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bad_input.md");
    if std::env::var("SNAPSHOTS").is_ok_and(|what| what == "overwrite") {
        std::fs::write(&file, &text).unwrap();
    }
    assert!(
        std::fs::read_to_string(&file).is_ok_and(|written| written == text),
        "write it anew with SNAPSHOTS=overwrite"
    );
}
