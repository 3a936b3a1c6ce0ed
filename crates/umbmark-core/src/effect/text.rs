//! The effects of a model as text.

use std::fmt::Write;

use super::{Formula, Model, Part};
use crate::parameter::Parameter;

/// The effects of a model as they stand in a `model.toml`.
pub fn effects_text(model: &Model) -> String {
    effects_text_with(model, |_, _| None)
}

/// The same, where other text than the value stands at some parameters.
pub fn effects_text_with(model: &Model, other: impl Fn(&Part, &Parameter) -> Option<String>) -> String {
    let mut text = String::new();
    for part in model.parts() {
        if !text.is_empty() {
            text.push('\n');
        }
        // Writing to a string does not fail.
        let _ = writeln!(text, "[[effect]]\nname = \"{}\"", part.effect.name());
        text += &part.effect.formula().map_or_else(|| numbers(part, &other), |formula| own(formula, &part.values));
        if part.free {
            text.push_str("free = true\n");
        }
        if !part.fixed.is_empty() {
            let names: Vec<String> = part.fixed.iter().map(|name| format!("\"{name}\"")).collect();
            let _ = writeln!(text, "fixed = [{}]", names.join(", "));
        }
    }
    text
}

/// The numbers of an effect of the catalogue.
fn numbers(part: &Part, other: &impl Fn(&Part, &Parameter) -> Option<String>) -> String {
    let line = |(parameter, value): (&Parameter, &f64)| {
        let word = parameter.word(*value).map(|word| format!("\"{word}\""));
        let written = word.or_else(|| other(part, parameter)).unwrap_or_else(|| format!("{value:?}"));
        format!("{} = {written}\n", parameter.name)
    };
    part.effect.parameters().iter().zip(&part.values).map(line).collect()
}

/// An effect of the user's own.
fn own(formula: &Formula, values: &[f64]) -> String {
    let pair = |(parameter, value): (&Parameter, &f64)| format!("{} = {value:?}", parameter.name);
    let pairs: Vec<String> = formula.parameters().iter().zip(values).map(pair).collect();
    let numbers = if pairs.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", pairs.join(", ")) };
    // A formula holds nothing that TOML wants escaped.
    let (target, text) = (formula.target().name(), formula.text());
    format!("acts_on = \"{target}\"\nformula = \"{text}\"\nparameters = {numbers}\n")
}
