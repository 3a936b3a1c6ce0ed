//! `model.toml` as text.

use crate::effect::{Formula, Model, Part};
use crate::monte_carlo::{Distribution, Draw};
use crate::parameter::Parameter;
use std::fmt::Write;

/// A `model.toml` that reads back as this model, to the last bit. Scatter of parameters from trial to trial is not in a model,
/// and effects that a program has added to the catalogue's are read by nobody.
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
    model_text_with(model, &[])
}

/// The same with the distributions of the parameters that are drawn from trial to trial.
pub fn model_text_with(model: &Model, draws: &[Draw]) -> String {
    let mut text = String::new();
    for part in model.parts() {
        if !text.is_empty() {
            text.push('\n');
        }
        // Writing to a string does not fail.
        let _ = writeln!(text, "[[effect]]\nname = \"{}\"", part.effect.name());
        text += &part.effect.formula().map_or_else(|| numbers(part, draws), |formula| own(formula, &part.values));
        if part.free {
            text.push_str("free = true\n");
        }
    }
    text
}

/// The numbers of an effect of the catalogue.
fn numbers(part: &Part, draws: &[Draw]) -> String {
    let line = |(parameter, value): (&Parameter, &f64)| {
        let drawn = draws.iter().find(|d| d.effect() == part.effect.name() && d.parameter().name == parameter.name);
        let written = match (parameter.choices.get(*value as usize), drawn.map(Draw::distribution)) {
            (Some(word), _) => format!("\"{word}\""),
            (None, Some(Distribution::Normal { mean, sd })) => format!("{{ mean = {mean:?}, sd = {sd:?} }}"),
            (None, Some(Distribution::Uniform { min, max })) => format!("{{ min = {min:?}, max = {max:?} }}"),
            (None, Some(Distribution::Triangular { min, mode, max })) => {
                format!("{{ min = {min:?}, mode = {mode:?}, max = {max:?} }}")
            }
            (None, Some(Distribution::LogUniform { min, max })) => {
                format!("{{ min = {min:?}, max = {max:?}, scale = \"log\" }}")
            }
            (None, None) => format!("{value:?}"),
        };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::parse_model;
    use crate::drive::Robot;
    use crate::effect::{CATALOGUE, Target};

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
        let own = Formula::new("own", Target::LeftWheelScale, "a *\tsin(heading / b)", &["b", "a"]).unwrap();
        model.add_formula(own, &[1.0 / 3.0, -1e-300]).unwrap().free = true;
        let bare = Formula::new("bare", Target::ForwardScale, "0.001", &[]).unwrap();
        model.add_formula(bare, &[]).unwrap();
        let (read, draws) = parse_model("model.toml", &model_text(&model), &robot).unwrap();
        assert_eq!(read, model);
        assert!(draws.is_empty());
    }
    #[test]
    fn what_is_drawn_reads_back_with_its_distribution() {
        let text = "[[effect]]\nname = \"scale\"\ne_s = { mean = 1.002, sd = 0.0005 }\n\n\
                    [[effect]]\nname = \"crab\"\nangle_rad = { min = 0.0, max = 0.01 }\n";
        let (model, draws) = parse_model("model.toml", text, &Robot::labmate()).unwrap();
        assert_eq!(model_text_with(&model, &draws), text);
    }
}
