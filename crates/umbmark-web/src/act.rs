//! Changes of the work, as the user says them.

use std::collections::BTreeMap;

use serde::Deserialize;
use umbmark_core::diagnose::first_model;
use umbmark_core::effect::{Formula, Model, Part, Target};
use umbmark_io::ModelFile;

use crate::bench::{Bench, Trouble};
use crate::state::{Draft, Held, Step};
use crate::words;

/// A change of the work.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "act", rename_all = "snake_case", deny_unknown_fields)]
pub enum Act {
    /// Adds the effects that are usually fitted first.
    First,
    /// Adds an effect, free to be fitted.
    Add {
        /// Its name.
        effect: String,
        /// Values to begin with.
        #[serde(default)]
        values: BTreeMap<String, Option<f64>>,
        /// p of the suggestion.
        #[serde(default)]
        p: Option<f64>,
    },
    /// Adds a law of the user's own.
    Formula {
        /// Its name.
        name: String,
        /// What it acts on.
        acts_on: String,
        /// The formula.
        formula: String,
        /// Start values of its parameters.
        parameters: BTreeMap<String, f64>,
    },
    /// Takes an effect out.
    Remove {
        /// Its name.
        effect: String,
    },
    /// Sets a value.
    Set {
        /// The effect.
        effect: String,
        /// Its parameter.
        parameter: String,
        /// The value.
        value: f64,
    },
    /// Holds a number of a free effect in fits, or lets them change it again.
    Hold {
        /// The effect.
        effect: String,
        /// Its parameter.
        parameter: String,
        /// Whether fits keep its value.
        hold: bool,
    },
    /// Lets fits change an effect, or not.
    Free {
        /// The effect.
        effect: String,
        /// Whether they may.
        free: bool,
    },
    /// Takes the draft into the story.
    Accept,
    /// Drops the draft; without one, goes a step back.
    Undo,
    /// Goes to a step of the story.
    Goto {
        /// Its number, from 0.
        step: usize,
    },
    /// Says which runs are not drawn.
    Hide {
        /// Their names.
        runs: Vec<String>,
    },
}

/// A number that was moved to a value.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moved {
    /// Its effect.
    pub effect: String,
    /// Its name there.
    pub parameter: String,
    /// The value.
    pub value: f64,
}

impl Act {
    /// Whether it changes the model, so that its error has to be worked out.
    pub fn drafts(&self) -> bool {
        !matches!(self, Act::Accept | Act::Undo | Act::Goto { .. } | Act::Hide { .. })
    }
}

impl Bench {
    /// Does what the user says.
    pub fn act(&self, act: &Act) -> Result<(), Trouble> {
        match act {
            Act::First => {
                let usual = first_model(&self.data).map_err(Trouble::because)?;
                self.draft("wheels and wheelbase", None, |model| {
                    usual.parts().iter().for_each(|part| model.adopt(part));
                    Ok(())
                })
            }
            Act::Add { effect, values, p } => self.draft(&format!("+ {effect}"), *p, |model| {
                model.add(effect).map_err(Trouble::because)?.free = true;
                for (parameter, value) in values.iter().filter_map(|(name, value)| Some((name, (*value)?))) {
                    model.set(effect, parameter, value).map_err(Trouble::because)?;
                }
                model.check_drive().map_err(Trouble::because)
            }),
            Act::Formula { name, acts_on, formula, parameters } => self.draft(&format!("+ {name}"), None, |model| {
                let made = formula_of(name, acts_on, formula, parameters)?;
                let values: Vec<f64> = parameters.values().copied().collect();
                model.add_formula(made, &values).map_err(Trouble::because)?.free = true;
                Ok(())
            }),
            Act::Remove { effect } => self.draft(&format!("- {effect}"), None, |model| {
                *model = model.without(effect);
                Ok(())
            }),
            Act::Set { effect, parameter, value } => {
                let model = self.model()?;
                has(&model, effect)?;
                let own = Held { effect: effect.clone(), parameter: parameter.clone() };
                let words = if own.is_fixed(&model) {
                    words::held(effect, parameter, *value)
                } else {
                    words::set(effect, parameter)
                };
                self.draft(&words, None, |model| model.set(effect, parameter, *value).map_err(Trouble::because))
            }
            Act::Hold { effect, parameter, hold } => {
                let model = self.model()?;
                has(&model, effect)?;
                let value = model.get(effect, parameter);
                let value = value.ok_or_else(|| Trouble(format!("{effect} has no {parameter}.")))?;
                let words = if *hold { words::held(effect, parameter, value) } else { words::free(effect, parameter) };
                let own = Held { effect: effect.clone(), parameter: parameter.clone() };
                self.draft(&words, None, |model| {
                    fix(model, &own, *hold);
                    Ok(())
                })?;
                // What is held by name is so in the next fit too.
                self.change(|state| {
                    let draft = state.draft.as_mut().filter(|draft| draft.held.as_ref() == Some(&own));
                    draft.into_iter().for_each(|draft| draft.held = None);
                    Ok(())
                })
            }
            Act::Free { effect, free } => {
                self.draft(&format!("{effect} {}", if *free { "free" } else { "kept" }), None, |model| {
                    let mut part = has(model, effect)?.clone();
                    part.free = *free;
                    model.adopt(&part);
                    Ok(())
                })
            }
            Act::Accept => self.accept(),
            Act::Undo => self.change(|state| {
                if state.draft.take().is_none() {
                    state.at = state.at.checked_sub(1).ok_or_else(|| Trouble("There is nothing to undo.".into()))?;
                }
                Ok(())
            }),
            Act::Goto { step } => self.change(|state| {
                if *step >= state.steps.len() {
                    return Err(Trouble(format!("There is no step {step}.")));
                }
                (state.at, state.draft) = (*step, None);
                Ok(())
            }),
            Act::Hide { runs } => {
                let known = |name: &String| self.data.runs.iter().any(|run| run.name == *name);
                self.change(|state| {
                    state.hidden = runs.iter().filter(|name| known(name)).cloned().collect();
                    Ok(())
                })
            }
        }
    }

    fn draft(
        &self,
        words: &str,
        p: Option<f64>,
        of: impl FnOnce(&mut Model) -> Result<(), Trouble>,
    ) -> Result<(), Trouble> {
        let mut model = self.model()?;
        of(&mut model)?;
        let errors = self.errors(&model)?;
        let text = ModelFile::new(model).text();
        self.change(|state| {
            // Words of the draft tell all that was done since the step.
            let before = state.draft.take().map(|draft| (draft.words, draft.p_adjusted, draft.held));
            let (before, p_before, held) = before.unwrap_or_default();
            let words = words::after(&before, words);
            state.draft = Some(Draft { words, model: text, errors, fitted: false, held, p_adjusted: p.or(p_before) });
            Ok(())
        })
    }

    fn accept(&self) -> Result<(), Trouble> {
        let Some(draft) = self.draft_now() else {
            return Err(Trouble("There is no draft to accept.".into()));
        };
        let model = self.parse(&draft.model)?;
        let effects = model.parts().iter().map(|part| part.effect.name().to_owned()).collect();
        self.change(|state| {
            state.draft = None;
            state.steps.truncate(state.at + 1);
            let Draft { words, model, errors, p_adjusted, .. } = draft;
            state.steps.push(Step { words, learnt: false, model, effects, p_adjusted, errors });
            state.at = state.steps.len() - 1;
            Ok(())
        })
    }
}

/// Holds a number of a free effect in fits, or lets them change it again.
pub fn fix(model: &mut Model, number: &Held, hold: bool) {
    let own = model.parts().iter().find(|part| part.effect.name() == number.effect && part.free);
    let Some(mut part) = own.cloned() else { return };
    part.fixed.retain(|name| *name != number.parameter);
    let name = part.effect.parameters().iter().map(|p| p.name).find(|name| *name == number.parameter);
    part.fixed.extend(name.filter(|_| hold));
    model.adopt(&part);
}

/// The part of a model with this effect.
pub fn has<'m>(model: &'m Model, effect: &str) -> Result<&'m Part, Trouble> {
    let own = model.parts().iter().find(|part| part.effect.name() == effect);
    own.ok_or_else(|| Trouble(format!("The model has no {effect}.")))
}

/// A law of the user's own.
pub fn formula_of(
    name: &str,
    acts_on: &str,
    text: &str,
    parameters: &BTreeMap<String, f64>,
) -> Result<Formula, Trouble> {
    let target = Target::ALL.into_iter().find(|target| target.name() == acts_on);
    let target = target.ok_or_else(|| Trouble(format!("A formula does not act on \"{acts_on}\".")))?;
    let names: Vec<&str> = parameters.keys().map(String::as_str).collect();
    Formula::new(name, target, text, &names).map_err(Trouble::because)
}
