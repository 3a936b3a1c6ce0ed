//! The catalogue of effects.

use super::finite;
use crate::drive::Kind;
use crate::effect::{Entry, Formula, FormulaVariable};
use crate::parameter::{DefaultValue, Parameter};
use serde_json::{Value, json};

/// What people should know of an effect.
pub fn about(entry: &Entry) -> Value {
    let about = &entry.about;
    let parameters: Vec<Value> = about.parameters.iter().map(parameter_json).collect();
    json!({
        "name": about.name,
        "title": about.title,
        "acts_on": about.acts_on.name(),
        "drives": entry.drives().each().map(Kind::name).collect::<Vec<_>>(),
        "equation": about.equation,
        "physics": about.physics,
        "signature": about.signature,
        "confused_with": entry.confused_with(),
        "separated_by": about.separated_by,
        "source": about.source,
        "parameters": parameters,
    })
}

/// What formulas may depend on, as a document.
pub fn formula_variables() -> Value {
    let one = |variable: &FormulaVariable| json!({ "name": variable.name, "unit": variable.unit, "meaning": variable.meaning });
    Formula::variables().iter().map(one).collect()
}

fn parameter_json(parameter: &Parameter) -> Value {
    let default = match parameter.default {
        DefaultValue::Value(value) => parameter.word(value).map_or(json!(value), |word| json!(word)),
        DefaultValue::OfRobot(_) => json!("of the robot"),
    };
    json!({
        "name": parameter.name,
        "flag": format!("--{}", parameter.flag),
        "unit": parameter.unit,
        "default": default,
        "typical": parameter.typical,
        "bounds": [finite(parameter.bounds.0), finite(parameter.bounds.1)],
        "choices": parameter.choices(),
        "meaning": parameter.meaning,
    })
}
