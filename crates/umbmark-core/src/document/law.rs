//! What repeats beside a model, and the laws that it may follow.

use super::finite;
use crate::diagnose::{Repeated, UnlistedLaw};
use crate::effect::Formula;
use crate::effect::effects_text;
use serde_json::{Map, Value, json};

/// What repeats most beside a model.
pub(super) fn repeats(repeated: &Repeated) -> Value {
    let Value::Object(mut all) = law(&repeated.law) else { return Value::Null };
    let alike = repeated.others.iter().filter(|other| other.is_alike());
    all.extend([
        ("p".to_owned(), json!(repeated.p)),
        ("standard_deviations".to_owned(), json!(repeated.deviations)),
        ("laws".to_owned(), json!(repeated.laws)),
        ("class".to_owned(), json!(alike.filter_map(text_of).collect::<Vec<_>>())),
        ("others".to_owned(), json!(repeated.others.iter().map(law).collect::<Vec<_>>())),
    ]);
    Value::Object(all)
}

/// A law that no catalogue lists.
fn law(law: &UnlistedLaw) -> Value {
    let part = law.model.as_ref().and_then(|model| model.parts().first());
    let formula = part.and_then(|part| part.effect.formula());
    let parameters = part.map(|part| {
        let numbers = part.effect.parameters().iter().zip(&part.values);
        Map::from_iter(numbers.map(|(parameter, value)| (parameter.name.to_owned(), finite(*value))))
    });
    json!({
        "number": law.number,
        "toml": law.model.as_ref().map(effects_text),
        "formula": formula.map(Formula::text),
        "parameters": parameters,
        "acts_on": formula.map(|formula| formula.target().name()),
        "motion": law.acts_on,
        "per": law.per,
        "meaning": law.words(),
        "by": law.by(),
        "means": law.means,
        "nearest": law.nearest.map(|(effect, share)| json!({ "effect": effect, "share": share })),
        "with_sense": law.with_sense,
        "length": formula.map(|_| law.length),
        "heldout_rmse_m": law.left_out[0],
        "heldout_rmse_with_law_m": law.left_out[1],
        "gain": law.gain,
        "likeness": law.likeness,
    })
}

/// A law as it stands in a model file: what it acts on, and its formula.
fn text_of(law: &UnlistedLaw) -> Option<String> {
    let formula = law.model.as_ref()?.parts().first()?.effect.formula()?;
    Some(format!("{} = {}", formula.target().name(), formula.text()))
}
