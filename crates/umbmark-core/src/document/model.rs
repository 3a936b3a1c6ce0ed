//! Models.

use crate::effect::{Model, Part};
use crate::parameter::Parameter;
use serde_json::{Map, Value, json};

/// A model, as in `model.toml`.
pub fn model(model: &Model) -> Value {
    let part = |part: &Part| {
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
        Value::Object(effect)
    };
    json!({ "effect": model.parts().iter().map(part).collect::<Vec<_>>() })
}
