//! The pages of the book that are made of the code: the help of the command, effects, drives and paths.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-cli --test all book` writes them anew.

use serde_json::Value;
use snapbox::{Data, assert_data_eq};
use std::path::Path;
use std::process::Command;
use umbmark_core::drive::{Drive, DriveKind, DriveKinds, Robot};
use umbmark_core::effect::{ActsOn, CATALOGUE};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::SHAPES;

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
    let mut text =
        String::from("# Commands\n\nThis page has the output of `umbmark --help` and of the `--help` of each verb.\n");
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
        "# The catalogue of effects\n\nThe known error sources of wheeled robots, as `umbmark effects NAME` explains them. The tables have the bounds of each\n\
         parameter; diagnosis takes the usual value for a typical size. The pictures show the true position and heading of the\n\
         robot relative to its odometry, as it drives round a square of 4 m.\n",
    );
    for kind in ActsOn::ALL {
        text += &format!("\n## Acting on {}\n", kind.name());
        for effect in effects.iter().filter(|effect| word(effect, "acts_on") == kind.name()) {
            text += &section(effect);
        }
    }
    assert_data_eq!(text, page("catalogue.md").raw());
}

#[test]
fn the_page_of_the_drives_has_every_kind_and_its_keys() {
    let mut text = String::from(
        "# Drives\n\nThis page lists the values of `drive` in `[robot]` of a [robot.toml](files.md#robottoml), with the keys of each. Those of\n\
         a differential drive also have other names. [The last table](#effects) groups the known effects by drive.\n",
    );
    for kind in DriveKind::ALL {
        let drive = kind.usual();
        text += &format!("\n## {}\n\n{}\n\n", kind.name(), kind.about());
        text += "| key | allowed | if left out | meaning |\n|---|---|---|---|\n";
        for p in kind.parameters() {
            let left_out = if p.nothing().is_some() { "0" } else { "refused" };
            text += &format!("| `{}` | {} | {left_out} | {} |\n", p.name, p.allowed(), p.meaning);
        }
        let counters = kind.columns().into_iter().map(|counter| format!("`ticks_{counter}`"));
        let columns = if kind.has_tick_logs() { listed(counters) } else { "none, only return poses".to_owned() };
        let paths = SHAPES.iter().filter(|shape| shape.usual().suits(&robot(drive))).map(|shape| shape.name);
        text += &format!("\n- **Columns of its logs**: {columns}\n");
        text += &format!("- **Paths that it can drive**: {}\n", listed(paths));
        text += &format!("- **Effects that are fitted first**: {}\n", listed(drive.first_effects().map(effect_link)));
    }
    text += "\n## Effects\n\n| drives | effects |\n|---|---|\n";
    let mut groups: Vec<DriveKinds> = CATALOGUE.iter().map(|entry| entry.drives()).collect();
    groups.sort_by_key(|drives| (std::cmp::Reverse(drives.each().count()), drives.to_string()));
    groups.dedup();
    for drives in groups {
        let own = CATALOGUE.iter().filter(|entry| entry.drives() == drives);
        text += &format!("| {drives} | {} |\n", listed(own.map(|entry| effect_link(entry.about.name))));
    }
    assert_data_eq!(text, page("drives.md").raw());
}

#[test]
fn the_page_of_the_paths_has_every_shape_and_its_keys() {
    let mut text = String::from(
        "# Paths\n\nThis page lists the values of `shape` in `[path]` of a [robot.toml](files.md#robottoml), with their sizes. Closed paths\n\
         end at START after whole turns; waypoints end at their last point.\n\n\
         | shape | is | ends at START | drives that can make it |\n|---|---|---|---|\n",
    );
    for shape in SHAPES {
        let drives =
            DriveKind::ALL.iter().filter(|kind| shape.usual().suits(&robot(kind.usual()))).map(|kind| kind.name());
        let ends = if shape.closed { "yes" } else { "no" };
        text += &format!("| `{}` | {} | {ends} | {} |\n", shape.name, shape.about, listed(drives));
    }
    text += "\n| shape | key | flag | allowed | usual | meaning |\n|---|---|---|---|---|---|\n";
    for (shape, p) in SHAPES.iter().flat_map(|shape| shape.parameters.iter().map(move |p| (shape, p))) {
        let Parameter { name, flag, typical, meaning, .. } = p;
        text += &format!("| `{}` | `{name}` | `--{flag}` | {} | {typical} | {meaning} |\n", shape.name, p.allowed());
    }
    assert_data_eq!(text, page("paths.md").raw());
}

fn robot(drive: Drive) -> Robot {
    Robot { drive, ..Robot::labmate() }
}

fn listed<T: ToString>(words: impl IntoIterator<Item = T>) -> String {
    words.into_iter().map(|word| word.to_string()).collect::<Vec<_>>().join(", ")
}

fn effect_link(name: &str) -> String {
    format!("[`{name}`](catalogue.md#{name})")
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
    text += &format!("- **Separated by**: {}\n", word(effect, "separated_by"));
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
