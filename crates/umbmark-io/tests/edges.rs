//! Core and io know nothing of the command: no message of theirs names a flag.

use std::path::{Path, PathBuf};

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Whether two hyphens begin a word behind a quotation mark, a bracket or a space.
fn names_a_flag(code: &str) -> bool {
    code.match_indices("--").any(|(at, _)| {
        let before = code[..at].chars().next_back();
        let after = code[at + 2..].chars().next();
        before.is_some_and(|c| "\"`( ".contains(c)) && after.is_some_and(|c| c.is_ascii_lowercase())
    })
}

#[test]
fn no_message_of_core_or_io_names_a_flag_of_the_command() {
    assert!(names_a_flag("\"say --force\"") && names_a_flag("\"--ticks\"") && !names_a_flag("a - -b --1"));
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    for folder in ["umbmark-core/src", "umbmark-io/src"] {
        sources(&crates.join(folder), &mut files);
    }
    assert!(files.len() > 200);
    // What to do next after an answer is a command.
    files.retain(|file| !file.ends_with("umbmark-core/src/solve/words.rs"));
    let mut named = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
        let lines = code.filter(|(_, line)| names_a_flag(line));
        named.extend(lines.map(|(n, line)| format!("{}:{}: {line}", file.display(), n + 1)));
    }
    assert!(named.is_empty(), "{}", named.join("\n"));
}
