//! Models.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::effect;
use crate::parameter::Parameter;

/// A model, as in `model.toml`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Model {
    /// Its effects in the order in which they act: each with its name, its parameters and whether it is free.
    pub effect: Vec<Map<String, Value>>,
}

impl From<&effect::Model> for Model {
    fn from(model: &effect::Model) -> Self {
        Model { effect: model.parts().iter().map(part).collect() }
    }
}

fn part(part: &effect::Part) -> Map<String, Value> {
    let mut effect = Map::from_iter([("name".to_owned(), json!(part.effect.name()))]);
    let number = |(parameter, value): (&Parameter, &f64)| {
        let word = parameter.word(*value);
        (parameter.name.to_owned(), word.map_or(json!(value), |word| json!(word)))
    };
    let mut numbers: Map<String, Value> = part.effect.parameters().iter().zip(&part.values).map(number).collect();
    match part.effect.formula() {
        Some(formula) => {
            effect.insert("acts_on".to_owned(), json!(formula.target().name()));
            effect.insert("formula".to_owned(), json!(formula.text()));
            effect.insert("parameters".to_owned(), Value::Object(numbers));
        }
        None => effect.append(&mut numbers),
    }
    effect.insert("free".to_owned(), json!(part.free));
    effect
}
