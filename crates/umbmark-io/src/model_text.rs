//! `model.toml` as text.

use super::model_file::{Doubt, ModelFile};
use super::robot_text::robot_text;
use umbmark_core::effect::{Model, effects_text_with};
use umbmark_core::likelihood::Noise;
use umbmark_core::monte_carlo::{Distribution, Draw};
use umbmark_core::solve::Solution;

impl ModelFile {
    /// A model whose parameters are not drawn.
    pub fn new(model: Model) -> ModelFile {
        ModelFile { model, draws: Vec::new(), conversion: None, noise: None, doubt: None }
    }

    /// The model of an answer, with what speaks against using it.
    pub fn learnt(solution: &Solution) -> ModelFile {
        let doubt = solution.doubt().map(|because| Doubt { because, alone: !solution.learnt.is_in_doubt() });
        let learnt = &solution.learnt;
        ModelFile { noise: learnt.noise, doubt, ..ModelFile::new(learnt.model.clone()) }
    }

    /// A `model.toml` that reads back as this, to the last bit, with its nominal robot. Effects that a program has added to the
    /// catalogue's are read by nobody.
    ///
    /// ```
    /// use umbmark_core::{drive::Robot, effect::Model};
    /// use umbmark_io::ModelFile;
    /// let mut model = Model::new(&Robot::labmate());
    /// model.set("wheelbase", "e_b", 1.01)?;
    /// let file = ModelFile::new(model);
    /// assert!(file.text().ends_with("\n[[effect]]\nname = \"wheelbase\"\ne_b = 1.01\n"));
    /// assert_eq!(ModelFile::parse("model.toml", &file.text(), None)?, file);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn text(&self) -> String {
        let effects = effects_with(&self.model, &self.draws);
        let noise = self.noise.as_ref().map(noise_text).unwrap_or_default();
        let doubt = self.doubt.as_ref().map(doubt_text).unwrap_or_default();
        let tables = [robot_text(self.model.robot()), effects, noise, doubt];
        tables.into_iter().filter(|table| !table.is_empty()).collect::<Vec<_>>().join("\n")
    }
}

/// The sizes of the noise, a line each.
fn noise_text(noise: &Noise) -> String {
    let lines = Noise::WRITTEN.iter().zip(noise.written()).map(|(size, value)| format!("{} = {value:?}\n", size.name));
    std::iter::once("[noise]\n".to_owned()).chain(lines).collect()
}

/// What speaks against the model.
fn doubt_text(doubt: &Doubt) -> String {
    let because = toml::Value::from(doubt.because.as_str());
    format!("[doubt]\nbecause = {because}\n{}", if doubt.alone { "alone = true\n" } else { "" })
}

/// The effects of a model, with the distributions of what is drawn.
fn effects_with(model: &Model, draws: &[Draw]) -> String {
    effects_text_with(model, |part, parameter| {
        let drawn = draws.iter().find(|d| d.effect() == part.effect.name() && d.parameter().name == parameter.name)?;
        Some(match drawn.distribution() {
            Distribution::Normal { mean, sd } => format!("{{ mean = {mean:?}, sd = {sd:?} }}"),
            Distribution::Uniform { min, max } => format!("{{ min = {min:?}, max = {max:?} }}"),
            Distribution::Triangular { min, mode, max } => {
                format!("{{ min = {min:?}, mode = {mode:?}, max = {max:?} }}")
            }
            Distribution::LogUniform { min, max } => format!("{{ min = {min:?}, max = {max:?}, scale = \"log\" }}"),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::drive::Robot;
    use umbmark_core::effect::{CATALOGUE, Formula, Target, effects_text};

    #[test]
    fn a_model_of_every_effect_reads_back_to_the_last_bit() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for (i, entry) in CATALOGUE.iter().enumerate() {
            model.add(entry.about.name).unwrap().free = i % 2 == 0;
            for parameter in entry.about.parameters.iter().filter(|p| p.choices().is_empty()) {
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
        let noise = Noise { heading_per_metre: 1e-3 / 3.0, within_heading: 0.0, ..Noise::default() };
        let doubt = Doubt { because: "With \"quotes\" and \\ lines.".into(), alone: true };
        let file = ModelFile { noise: Some(noise), doubt: Some(doubt), ..file };
        assert!(file.text().contains("\n[noise]\nheading_rad_per_sqrt_m = 0.000333"));
        assert_eq!(ModelFile::parse("model.toml", &file.text(), None).unwrap(), file);
    }

    #[test]
    fn what_is_drawn_reads_back_with_its_distribution() {
        let text = "[[effect]]\nname = \"scale\"\ne_s = { mean = 1.002, sd = 0.0005 }\n\n\
                    [[effect]]\nname = \"crab\"\nangle_rad = { min = 0.0, max = 0.01 }\n";
        let file = ModelFile::parse("model.toml", text, None).unwrap();
        assert!(file.text().starts_with("[robot]\nname = \"TRC LabMate\"\n") && file.text().ends_with(text));
    }
}
