//! Models.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::Keyed;
use crate::effect;
use crate::likelihood::Noise;
use crate::parameter::Parameter;

/// A model, as in `model.toml`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Model {
    /// Its effects in the order in which they act: each with its name, its parameters, whether it is free, and which parameters are fixed all the same.
    pub effect: Vec<Map<String, Value>>,
    /// The sizes of the noise, where it was fitted to tracks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<Keyed<f64>>,
}

impl Model {
    /// A model with the noise that was fitted with it.
    pub fn with_noise(model: &effect::Model, noise: Option<&Noise>) -> Model {
        let sizes = |noise: &Noise| Noise::WRITTEN.iter().map(|size| size.name).zip(noise.written()).collect();
        Model { noise: noise.map(sizes), ..model.into() }
    }
}

impl From<&effect::Model> for Model {
    fn from(model: &effect::Model) -> Self {
        Model { effect: model.parts().iter().map(part).collect(), noise: None }
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
    if !part.fixed.is_empty() {
        effect.insert("fixed".to_owned(), json!(part.fixed));
    }
    effect
}
