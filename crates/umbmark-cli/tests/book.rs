//! The pages of the book that are made of the command itself: its help, and the catalogue of effects.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli --test book` writes them anew.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use snapbox::{Data, assert_data_eq};
use std::path::Path;
use std::process::Command;
use umbmark_core::effect::ActsOn;

fn umbmark(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbmark"));
    let output = command.args(arguments).env("COLUMNS", "100").env("NO_COLOR", "1").output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn page(name: &str) -> Data {
    Data::read_from(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name), None)
}

fn without_trailing_blanks(text: &str) -> String {
    text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim_end().to_owned()
}

#[test]
fn the_page_of_the_commands_is_their_help() {
    let help = umbmark(&["--help"]);
    let list = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let verbs = list.lines().filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
    let verbs: Vec<&str> = verbs.map(|line| line.split(' ').next().unwrap()).filter(|verb| *verb != "help").collect();
    assert!(verbs.contains(&"mc") && verbs.contains(&"learn"), "{verbs:?}");
    let mut text = String::from("# Commands\n\nWhat `umbmark --help` and each verb's `--help` say.\n");
    text += &format!("\n```text\n{}\n```\n", without_trailing_blanks(&help));
    for verb in verbs {
        let help = without_trailing_blanks(&umbmark(&[verb, "--help"]));
        text += &format!("\n## umbmark {verb}\n\n```text\n{help}\n```\n");
    }
    assert_data_eq!(text, page("commands.md").raw());
}

#[test]
fn the_page_of_the_catalogue_has_every_effect() {
    let document: Value = serde_json::from_str(&umbmark(&["effects", "--json"])).unwrap();
    let effects = document["effects"].as_array().unwrap();
    let mut text = String::from(
        "# The catalogue of effects\n\nWhat can make a wheeled robot err, as `umbmark effects NAME` explains it. The values are \
         between the\nbounds in the tables; the usual one is what diagnosis takes for a typical size. The pictures show where the\n\
         robot is, seen from where it believes to be, as it drives round a square of 4 m.\n",
    );
    for kind in ActsOn::ALL {
        text += &format!("\n## Acting on {}\n", kind.name());
        for effect in effects.iter().filter(|effect| word(effect, "acts_on") == kind.name()) {
            text += &section(effect);
        }
    }
    assert_data_eq!(text, page("catalogue.md").raw());
}

fn word<'a>(effect: &'a Value, key: &str) -> &'a str {
    effect[key].as_str().unwrap()
}

fn section(effect: &Value) -> String {
    let list = |key: &str, mark: &str| {
        let words = effect[key].as_array().unwrap().iter().map(|one| format!("{mark}{}{mark}", one.as_str().unwrap()));
        words.collect::<Vec<_>>().join(", ")
    };
    let name = word(effect, "name");
    let mut text = format!("\n### {name}\n\n*{}*", word(effect, "title"));
    text += &format!(" ({} drive)\n\n```text\n{}\n```\n\n", list("drives", ""), word(effect, "equation"));
    text += &format!("{}\n\n", word(effect, "physics"));
    text += &format!("- **Signature**: {}\n", word(effect, "signature"));
    let alike = list("confused_with", "`");
    text += &format!("- **Looks like**: {}\n", if alike.is_empty() { "nothing else" } else { &alike });
    text += &format!("- **Told apart by**: {}\n", word(effect, "separated_by"));
    text += &format!("- **Source**: {}\n", word(effect, "source"));
    text += "\n| parameter | unit | bounds | default | usual | flag | meaning |\n|---|---|---|---|---|---|---|\n";
    for parameter in effect["parameters"].as_array().unwrap() {
        text += &row(parameter);
    }
    text + &picture(name)
}

fn row(parameter: &Value) -> String {
    let shown = |value: &Value| match value {
        Value::String(word) => word.clone(),
        Value::Null => "any".to_owned(),
        number => number.as_f64().unwrap().to_string(),
    };
    let choices = parameter["choices"].as_array().unwrap();
    let bounds = match choices.as_slice() {
        [] => format!("{} to {}", shown(&parameter["bounds"][0]), shown(&parameter["bounds"][1])),
        choices => choices.iter().map(shown).collect::<Vec<_>>().join(", "),
    };
    let usual = if choices.is_empty() { shown(&parameter["typical"]) } else { String::new() };
    format!(
        "| `{}` | {} | {bounds} | {} | {usual} | `{}` | {} |\n",
        word(parameter, "name"),
        word(parameter, "unit"),
        shown(&parameter["default"]),
        word(parameter, "flag"),
        word(parameter, "meaning"),
    )
}

/// The picture in the effect's explanation, where it has one.
fn picture(name: &str) -> String {
    let explanation = umbmark(&["effects", name]);
    let lines: Vec<&str> = explanation.lines().skip_while(|line| !line.starts_with("picture")).collect();
    let drawn: Vec<&str> = lines.into_iter().take_while(|line| !line.starts_with("parameters")).collect();
    if drawn[0].contains("none") {
        return String::new();
    }
    let shown = without_trailing_blanks(&drawn.join("\n").replacen("picture", "       ", 1));
    format!("\n```text\n{shown}\n```\n")
}
