//! The catalogue of effects.

use schemars::JsonSchema;
use serde::Serialize;

use super::{NumberOrWord, finite};
use crate::drive::DriveKind;
use crate::effect::Entry;
use crate::parameter::{self, DefaultValue};

/// A number of an effect.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// Its flag.
    pub flag: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its default; a word if it takes words or comes from the robot.
    pub default: NumberOrWord,
    /// Its usual size.
    pub typical: f64,
    /// Its allowed range; an open end is null.
    pub bounds: [Option<f64>; 2],
    /// The allowed words; empty if it takes numbers.
    pub choices: Vec<&'static str>,
    /// What it means.
    pub meaning: &'static str,
}

impl From<&parameter::Parameter> for Parameter {
    fn from(parameter: &parameter::Parameter) -> Self {
        let default = match parameter.default {
            DefaultValue::Value(value) => match parameter.word(value) {
                Some(word) => NumberOrWord::Word(word.to_owned()),
                None => NumberOrWord::Number(value),
            },
            DefaultValue::OfRobot(_) => NumberOrWord::Word("of the robot".to_owned()),
        };
        Parameter {
            name: parameter.name,
            flag: format!("--{}", parameter.flag),
            unit: parameter.unit,
            default,
            typical: parameter.typical,
            bounds: [finite(parameter.bounds.0), finite(parameter.bounds.1)],
            choices: parameter.choices().to_vec(),
            meaning: parameter.meaning,
        }
    }
}

/// An effect of the catalogue: equation, cause, signature, and effects that look like it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Effect {
    /// Its name.
    pub name: &'static str,
    /// Its name in words.
    pub title: &'static str,
    /// What it acts on.
    pub acts_on: &'static str,
    /// The drives that have it.
    pub drives: Vec<&'static str>,
    /// Its law.
    pub equation: &'static str,
    /// Its cause.
    pub physics: &'static str,
    /// How it shows.
    pub signature: &'static str,
    /// Effects that look like it.
    pub confused_with: Vec<&'static str>,
    /// How to separate it from these.
    pub separated_by: &'static str,
    /// Its source.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
}

impl From<&Entry> for Effect {
    fn from(entry: &Entry) -> Self {
        let about = &entry.about;
        Effect {
            name: about.name,
            title: about.title,
            acts_on: about.acts_on.name(),
            drives: entry.drives().each().map(DriveKind::name).collect(),
            equation: about.equation,
            physics: about.physics,
            signature: about.signature,
            confused_with: entry.confused_with(),
            separated_by: about.separated_by,
            source: about.source,
            parameters: about.parameters.iter().map(Parameter::from).collect(),
        }
    }
}
