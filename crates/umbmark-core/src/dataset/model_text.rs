//! `model.toml` as text.

use super::ModelFile;
use super::robot_text::robot_text;
use crate::effect::{Formula, Model, Part};
use crate::monte_carlo::{Distribution, Draw};
use crate::parameter::Parameter;
use std::fmt::Write;

impl ModelFile {
    /// A model whose parameters are not drawn.
    pub fn new(model: Model) -> ModelFile {
        ModelFile { model, draws: Vec::new(), conversion: None }
    }

    /// A `model.toml` that reads back as this, to the last bit, with its nominal robot. Effects that a program has added to the
    /// catalogue's are read by nobody.
    ///
    /// ```
    /// use umbmark_core::{dataset::ModelFile, drive::Robot, effect::Model};
    /// let mut model = Model::new(&Robot::labmate());
    /// model.set("wheelbase", "e_b", 1.01)?;
    /// let file = ModelFile::new(model);
    /// assert!(file.text().ends_with("\n[[effect]]\nname = \"wheelbase\"\ne_b = 1.01\n"));
    /// assert_eq!(ModelFile::parse("model.toml", &file.text(), None)?, file);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn text(&self) -> String {
        let robot = robot_text(self.model.robot());
        let effects = effects_with(&self.model, &self.draws);
        if effects.is_empty() { robot } else { format!("{robot}\n{effects}") }
    }
}

/// The effects of a model as they stand in a `model.toml`.
pub fn effects_text(model: &Model) -> String {
    effects_with(model, &[])
}

fn effects_with(model: &Model, draws: &[Draw]) -> String {
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
        let file = ModelFile::new(model);
        assert_eq!(ModelFile::parse("model.toml", &file.text(), None).unwrap(), file);
        assert_eq!(ModelFile::parse("model.toml", &effects_text(&file.model), Some(&robot)).unwrap(), file);
    }
    #[test]
    fn what_is_drawn_reads_back_with_its_distribution() {
        let text = "[[effect]]\nname = \"scale\"\ne_s = { mean = 1.002, sd = 0.0005 }\n\n\
                    [[effect]]\nname = \"crab\"\nangle_rad = { min = 0.0, max = 0.01 }\n";
        let file = ModelFile::parse("model.toml", text, None).unwrap();
        assert!(file.text().starts_with("[robot]\nname = \"TRC LabMate\"\n") && file.text().ends_with(text));
    }
}
