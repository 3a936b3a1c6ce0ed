//! What is said of each case in a file of cases.

use umbmark_core::action::Action;
use umbmark_io::Words;

/// How the command words what is said.
pub const COMMAND: Words = Words { replace: "say --force", before: "--", between: " ", actions: Some(actions) };

/// What the command calls the actions that these messages end in.
fn actions(action: Action) -> &'static str {
    match action {
        Action::ListEffects => "`umbmark effects`",
        Action::Begin => "`umbmark init`",
        Action::CheckLog => "`umbmark inspect LOG`",
        other => other.plain(),
    }
}

/// The name of each case and its sentence, in the order of the file.
pub fn sentences(cases: &'static str) -> Vec<(&'static str, &'static str)> {
    let mut sentences: Vec<(&str, &str)> = Vec::new();
    let mut name = "";
    for line in cases.lines() {
        if let Some(next) = line.strip_prefix("# ") {
            name = next;
        } else if let Some(says) = line.strip_prefix("says ") {
            assert!(sentences.iter().all(|(other, _)| *other != name), "{name} stands twice");
            sentences.push((name, says));
        }
    }
    sentences
}
