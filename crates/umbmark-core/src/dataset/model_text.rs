//! `model.toml` as text.

use crate::effect::Model;
use std::fmt::Write;

/// A `model.toml` that reads back as this model, to the last bit. Scatter of parameters from trial to trial is not in a model.
///
/// ```
/// use umbmark_core::{dataset::{model_text, parse_model}, drive::Robot, effect::Model};
/// let mut model = Model::new(&Robot::labmate());
/// model.set("wheelbase", "e_b", 1.01)?;
/// model.add("wheelbase")?.free = true;
/// let text = model_text(&model);
/// assert_eq!(text, "[[effect]]\nname = \"wheelbase\"\ne_b = 1.01\nfree = true\n");
/// assert_eq!(parse_model("model.toml", &text, &Robot::labmate())?.0, model);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn model_text(model: &Model) -> String {
    let mut text = String::new();
    for part in model.parts() {
        if !text.is_empty() {
            text.push('\n');
        }
        // Writing to a string does not fail.
        let _ = writeln!(text, "[[effect]]\nname = \"{}\"", part.effect.about.name);
        for (parameter, value) in part.effect.about.parameters.iter().zip(&part.values) {
            let _ = match parameter.choices.get(*value as usize) {
                Some(word) => writeln!(text, "{} = \"{word}\"", parameter.name),
                None => writeln!(text, "{} = {value:?}", parameter.name),
            };
        }
        if part.free {
            text.push_str("free = true\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::parse_model;
    use crate::drive::Robot;
    use crate::effect::CATALOGUE;

    #[test]
    fn a_model_of_every_effect_reads_back_to_the_last_bit() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for (i, entry) in CATALOGUE.iter().enumerate() {
            model.add(entry.about.name).unwrap().free = i % 2 == 0;
            for parameter in entry.about.parameters.iter().filter(|p| p.choices.is_empty()) {
                let value = parameter.default.resolve(&robot) + parameter.typical / 3.0;
                model.set(entry.about.name, parameter.name, value).unwrap();
            }
        }
        let (read, draws) = parse_model("model.toml", &model_text(&model), &robot).unwrap();
        assert_eq!(read, model);
        assert!(draws.is_empty());
    }
}
