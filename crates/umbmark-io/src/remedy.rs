//! What to do about an error. The command and Python call their arguments differently, so what names one is data.

use std::borrow::Cow;
use umbmark_core::action::{Action, Wording};

/// How an edge names its arguments in messages.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// What lets files be replaced, as in "say --force".
    pub replace: &'static str,
    /// What stands before the name of an argument.
    pub before: &'static str,
    /// What stands between an argument and its value.
    pub between: &'static str,
    /// What is done next; nothing is said of it where this is `None`.
    pub actions: Option<Wording>,
}

impl Words {
    /// For an error that no edge has worded.
    pub const PLAIN: Words = Words { replace: "ask", before: "", between: " ", actions: None };

    fn argument(&self, argument: Argument, value: &str) -> String {
        format!("{}{}{value}", self.name(argument), self.between)
    }

    /// What is done next, behind a message that may end there.
    pub(crate) fn behind(&self, action: Option<Action>) -> String {
        let said = action.zip(self.actions).map(|(action, words)| format!("; {}", action.remedy(words)));
        said.unwrap_or_default()
    }

    pub(crate) fn name(&self, argument: Argument) -> String {
        let name = match argument {
            Argument::Ticks => "ticks",
            Argument::Reference => "reference",
            Argument::Urdf => "urdf",
            Argument::Joints => "joints",
        };
        format!("{}{name}", self.before)
    }
}

/// An argument that a remedy names: a topic of an MCAP file or bag, or a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// The topic of the wheels.
    Ticks,
    /// The topic of the measured poses.
    Reference,
    /// The description of a robot that is edited.
    Urdf,
    /// The joints of the wheels in it.
    Joints,
}

/// What to do about an error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remedy {
    /// Something that needs no argument.
    Words(Cow<'static, str>),
    /// Something, and what is done next.
    Then {
        /// What needs no argument.
        words: &'static str,
        /// What is done next.
        action: Action,
    },
    /// Choose another place, or let what is there be replaced.
    Replace {
        /// "folder" or "name".
        another: &'static str,
    },
    /// Give an argument.
    Name {
        /// As in "name the joints with".
        purpose: &'static str,
        /// The argument.
        argument: Argument,
        /// The form of its value.
        value: &'static str,
    },
    /// Give another topic for the wheels or for the reference.
    NameAnother,
    /// Give an argument one of some values.
    CanBe {
        /// The argument.
        argument: Argument,
        /// What it can be.
        values: String,
    },
}

impl Remedy {
    /// In the words of an edge.
    pub fn worded(&self, words: &Words) -> String {
        match self {
            Remedy::Words(said) => said.clone().into_owned(),
            Remedy::Then { words: said, action } => format!("{said}{}", words.behind(Some(*action))),
            Remedy::Replace { another } => format!("choose another {another}, or {} to replace it", words.replace),
            Remedy::Name { purpose, argument, value } => format!("{purpose} {}", words.argument(*argument, value)),
            Remedy::NameAnother => {
                let [ticks, reference] = [Argument::Ticks, Argument::Reference].map(|argument| words.name(argument));
                format!("name another with {ticks} or {reference}")
            }
            Remedy::CanBe { argument, values } => format!("{} can be: {values}", words.name(*argument)),
        }
    }

    /// Which of several topics an argument means.
    pub(crate) fn which(argument: Argument) -> Remedy {
        Remedy::Name { purpose: "say which with", argument, value: "TOPIC" }
    }
}

impl From<&'static str> for Remedy {
    fn from(words: &'static str) -> Remedy {
        Remedy::Words(words.into())
    }
}

impl From<String> for Remedy {
    fn from(words: String) -> Remedy {
        Remedy::Words(words.into())
    }
}
