//! The numbers of a model that are the robot's.

use crate::effect::Model;
use crate::evidence::ends::names;

/// A number of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// The effect.
    pub effect: &'static str,
    /// The parameter, as in files: its unit stands in the name.
    pub parameter: &'static str,
}

impl Number {
    /// All of a model.
    pub(super) fn of(model: &Model) -> impl Iterator<Item = Number> {
        names(model).into_iter().map(|(effect, parameter)| Number { effect, parameter })
    }

    /// As in files.
    pub fn key(&self) -> String {
        format!("{}.{}", self.effect, self.parameter)
    }
}
