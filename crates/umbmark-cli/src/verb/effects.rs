//! `umbmark effects`: the catalogue.

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{About, CATALOGUE, find};
use umbmark_core::parameter::{DefaultValue, Parameter};

use crate::Session;
use crate::prose::hanging;

/// Where the texts of an explanation begin.
const INDENT: usize = 14;

/// Arguments of `effects`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The effect to explain; all are listed where none is named
    name: Option<String>,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (document, text) = match &arguments.name {
        Some(name) => {
            let about = &find(name)?.about;
            (about_json(about), explanation(about))
        }
        None => {
            let entries: Vec<Value> = CATALOGUE.iter().map(|entry| about_json(&entry.about)).collect();
            (json!({ "effects": entries, "version": umbmark_core::VERSION }), list())
        }
    };
    if session.json() {
        session.print_json(&document)?;
    } else {
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

fn list() -> String {
    let wide = CATALOGUE.iter().map(|entry| entry.about.name.len()).max().unwrap_or(0) + 2;
    let mut text = String::from("Effects, in the order in which they act on the motion:\n\n");
    for entry in CATALOGUE {
        text += &hanging(&format!("  {}", entry.about.name), wide + 2, entry.about.title);
    }
    text += "\n`umbmark effects NAME` explains one: equation, parameters, signature, source.\n";
    text
}

fn explanation(about: &About) -> String {
    let mut text = format!("{}: {}\n\n", about.name, about.title);
    let confused = if about.confused_with.is_empty() { "nothing".to_owned() } else { about.confused_with.join(", ") };
    for (head, body) in [
        ("acts on", about.acts_on.name()),
        ("equation", about.equation),
        ("physics", about.physics),
        ("signature", about.signature),
        ("looks like", &confused),
        ("told apart by", about.separated_by),
        ("source", about.source),
    ] {
        text += &hanging(head, INDENT + 2, body);
    }
    text += "\nparameters\n";
    for parameter in about.parameters {
        text += &hanging(&format!("  {}", parameter.name), INDENT + 2, parameter.meaning);
        text += &hanging("", INDENT + 2, &range(parameter));
    }
    text += "\nin a model.toml\n  [[effect]]\n";
    text += &format!("  name = \"{}\"\n", about.name);
    for parameter in about.parameters {
        text += &format!("  {} = {}\n", parameter.name, example(parameter));
    }
    text
}

/// "between 0.5 and 2; 1 by default; usual departure 0.00121; --ed".
fn range(parameter: &Parameter) -> String {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let default = match (parameter.default, parameter.choices) {
        (DefaultValue::OfRobot(_), _) => "the robot's own by default".to_owned(),
        (DefaultValue::Value(value), choices) => match choices.get(value as usize) {
            Some(word) => format!("{word} by default"),
            None => format!("{value}{unit} by default"),
        },
    };
    let usual =
        if parameter.choices.is_empty() { format!("; usual {}{unit}", parameter.typical) } else { String::new() };
    format!("{}; {default}{usual}; --{}", parameter.allowed(), parameter.flag)
}

/// A value that does something.
fn example(parameter: &Parameter) -> String {
    let default = parameter.default.resolve(&Robot::labmate());
    match parameter.choices.get(default as usize) {
        Some(word) => format!("\"{word}\""),
        None if default == 1.0 => format!("{}", default + parameter.typical),
        None if default == 0.0 => format!("{}", parameter.typical),
        None => format!("{default}"),
    }
}

fn about_json(about: &About) -> Value {
    let parameters: Vec<Value> = about.parameters.iter().map(parameter_json).collect();
    json!({
        "name": about.name,
        "title": about.title,
        "acts_on": about.acts_on.name(),
        "equation": about.equation,
        "physics": about.physics,
        "signature": about.signature,
        "confused_with": about.confused_with,
        "separated_by": about.separated_by,
        "source": about.source,
        "parameters": parameters,
    })
}

fn parameter_json(parameter: &Parameter) -> Value {
    let finite = |bound: f64| if bound.is_finite() { json!(bound) } else { Value::Null };
    let default = match parameter.default {
        DefaultValue::Value(value) => match parameter.choices.get(value as usize) {
            Some(word) => json!(word),
            None => json!(value),
        },
        DefaultValue::OfRobot(_) => json!("of the robot"),
    };
    json!({
        "name": parameter.name,
        "flag": format!("--{}", parameter.flag),
        "unit": parameter.unit,
        "default": default,
        "typical": parameter.typical,
        "bounds": [finite(parameter.bounds.0), finite(parameter.bounds.1)],
        "choices": parameter.choices,
        "meaning": parameter.meaning,
    })
}
