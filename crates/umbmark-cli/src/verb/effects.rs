//! `umbmark effects`: the catalogue.

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{ActsOn, CATALOGUE, Entry, Formula, FormulaVariable, find};
use umbmark_core::parameter::{DefaultValue, Parameter};
use umbmark_core::result::Effect;

use crate::Session;
use crate::prose::hanging;
use crate::signature::Signature;

/// Where the texts of an explanation begin.
const INDENT: usize = 14;

/// Arguments of `effects`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The effect to explain; without a name, all are listed
    name: Option<String>,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (document, text) = match &arguments.name {
        Some(name) => {
            let entry = find(name)?;
            let signature = Signature::of(entry)?;
            let mut document = json!(Effect::from(entry));
            document["picture"] = signature.as_ref().map_or(Value::Null, Signature::json);
            (document, explanation(entry, signature.as_ref()))
        }
        None => {
            let document = json!({
                "effects": CATALOGUE.iter().copied().map(Effect::from).collect::<Vec<_>>(),
                "formula_variables": Formula::variables(),
                "version": umbmark_core::VERSION,
            });
            (document, list())
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
    let mut text = String::from("Known error sources, grouped by what they change, in the order they act:\n");
    for kind in ActsOn::ALL {
        text += &format!("\n{}\n", kind.name());
        for entry in CATALOGUE.iter().filter(|entry| entry.about.acts_on == kind) {
            text += &hanging(&format!("  {}", entry.about.name), wide + 2, entry.about.title);
        }
    }
    text += "\n`umbmark effects NAME` explains one: equation, signature, parameters, source.\n";
    text + &own()
}

/// What formulas may depend on: "speed [m/s], ... x, y, distance [m] ... (+1 left, -1 right)".
fn variables() -> String {
    let variables = Formula::variables();
    let next = variables.iter().skip(1).map(Some).chain([None]);
    let one = |(variable, next): (&FormulaVariable, Option<&FormulaVariable>)| match variable.unit {
        unit if next.is_some_and(|next| next.unit == unit) => variable.name.to_owned(),
        "" => format!("{} (+1 left, -1 right)", variable.name),
        unit => format!("{} [{unit}]", variable.name),
    };
    variables.iter().zip(next).map(one).collect::<Vec<_>>().join(", ")
}

/// How to write an effect that is not listed.
fn own() -> String {
    let mut text = String::from(
        "\nYou can write your own effect as a formula in model.toml:\n\n  \
         [[effect]]\n  name = \"carpet\"\n  acts_on = \"heading_per_metre\"\n  formula = \"k * sin(heading - h0)\"\n  \
         parameters = { k = 0.0, h0 = 0.5 }\n  free = true\n\n",
    );
    for (head, body) in [
        (
            "acts_on",
            "heading_per_metre [rad/m], sideways_per_metre [m/m] to the left, forward_per_radian, sideways_per_radian [m/rad], \
             heading_per_second [rad/s], forward_per_second, sideways_per_second [m/s], \
             forward_scale, turn_scale, left_wheel_scale or right_wheel_scale: the part of the motion to which the formula adds, so that 0 \
             has no effect",
        ),
        (
            "variables",
            &format!("{}; heading, x and y are those in the room, from START, as the model predicts them", variables()),
        ),
        ("operators", "+ - * /, ^ with a whole number, ( ), pi, sin cos tan exp log sqrt abs sign min max tanh"),
    ] {
        text += &hanging(&format!("  {head}"), INDENT, body);
    }
    text
}

fn explanation(entry: &Entry, signature: Option<&Signature>) -> String {
    let (about, drives) = (&entry.about, entry.drives().to_string());
    let mut text = format!("{}: {}\n\n", about.name, about.title);
    let alike = entry.confused_with();
    let confused = if alike.is_empty() { "nothing".to_owned() } else { alike.join(", ") };
    for (head, body) in [
        ("acts on", about.acts_on.name()),
        ("drives", &drives),
        ("equation", about.equation),
        ("physics", about.physics),
        ("signature", about.signature),
        ("looks like", &confused),
        ("separated by", about.separated_by),
        ("source", about.source),
    ] {
        text += &hanging(head, INDENT + 2, body);
    }
    let none = || hanging("picture", INDENT + 2, "none: it acts at single places or by chance");
    text += "\n";
    text += &signature.map_or_else(none, |signature| signature.picture(INDENT + 2));
    text += "\nparameters\n";
    for parameter in about.parameters {
        text += &hanging(&format!("  {}", parameter.name), INDENT + 2, parameter.meaning);
        text += &hanging("", INDENT + 2, &range(parameter));
    }
    text += "\nin a model.toml\n  [[effect]]\n";
    text += &format!("  name = \"{}\"\n", about.name);
    for parameter in about.parameters {
        let value = parameter.usual(&Robot::labmate());
        let written = parameter.word(value).map_or_else(|| value.to_string(), |word| format!("{word:?}"));
        text += &format!("  {} = {written}\n", parameter.name);
    }
    text
}

/// "between 0.5 and 2; 1 by default; usual departure 0.00121; --ed".
fn range(parameter: &Parameter) -> String {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let default = match parameter.default {
        DefaultValue::OfRobot(_) => "the robot's own by default".to_owned(),
        DefaultValue::Value(value) => match parameter.word(value) {
            Some(word) => format!("{word} by default"),
            None => format!("{value}{unit} by default"),
        },
    };
    let usual =
        if parameter.choices().is_empty() { format!("; usual {}{unit}", parameter.typical) } else { String::new() };
    format!("{}; {default}{usual}; --{}", parameter.allowed(), parameter.flag)
}
