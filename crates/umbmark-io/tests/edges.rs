//! Core and io know nothing of the command: no message of theirs names a flag or a verb. What is done next is an `Action`, and edges word it.

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

/// Whether a verb stands behind the name of the command, or by itself between backticks. As a word of a sentence, as in "fit it anew", it
/// names what is done, and may stand.
fn names_a_verb(code: &str, verbs: &[String]) -> bool {
    let begins = |rest: &str| {
        let word = rest.split(|c: char| !c.is_ascii_lowercase()).next().unwrap_or_default();
        verbs.iter().any(|verb| verb == word).then_some(word.len())
    };
    let quoted = |at: usize| begins(&code[at + 1..]).is_some_and(|long| code[at + 1 + long..].starts_with(['`', ' ']));
    code.match_indices("umbmark ").any(|(at, name)| begins(&code[at + name.len()..]).is_some())
        || code.match_indices('`').any(|(at, _)| quoted(at))
}

/// The command's verbs: each has a file.
fn verbs(crates: &Path) -> Vec<String> {
    let files = std::fs::read_dir(crates.join("umbmark-cli/src/verb")).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
    files.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect()
}

#[test]
fn no_message_of_core_or_io_names_a_flag_or_a_verb_of_the_command() {
    assert!(names_a_flag("\"say --force\"") && names_a_flag("\"--ticks\"") && !names_a_flag("a - -b --1"));
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let verbs = verbs(crates);
    assert!(verbs.len() > 25 && ["learn", "mc", "init"].iter().all(|verb| verbs.iter().any(|known| known == verb)));
    let is_verb = |code: &str| names_a_verb(code, &verbs);
    assert!(
        is_verb("(`umbmark init` writes one)") && is_verb("umbmark inspect, score") && is_verb("`mc` and `simulate`")
    );
    assert!(is_verb("`apply LOG`") && !is_verb("learn or fit it anew; `scale`, `fitted` of umbmark 0.1"));
    let mut files = Vec::new();
    for folder in ["umbmark-core/src", "umbmark-io/src", "umbmark-odometry/src"] {
        sources(&crates.join(folder), &mut files);
    }
    assert!(files.len() > 200);
    let mut named = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
        let lines = code.filter(|(_, line)| names_a_flag(line) || is_verb(line));
        named.extend(lines.map(|(n, line)| format!("{}:{}: {line}", file.display(), n + 1)));
    }
    assert!(named.is_empty(), "{}", named.join("\n"));
}
