//! The law of an effect of a model: an entry, or a formula of the user.

use super::{CATALOGUE, Changes, Entry, Formula, RandomLaws};
use crate::parameter::Parameter;
use std::fmt;
use std::sync::Arc;

/// The law of one effect of a model.
#[derive(Clone, Debug)]
pub enum Law {
    /// An effect written in Rust, in the [`CATALOGUE`] or not.
    Entry(&'static Entry),
    /// A formula.
    Formula(Arc<Formula>),
}

impl Law {
    /// The effect's name in files.
    pub fn name(&self) -> &'static str {
        match self {
            Law::Entry(entry) => entry.about.name,
            Law::Formula(formula) => formula.name(),
        }
    }

    /// The effect's numbers.
    pub fn parameters(&self) -> &[Parameter] {
        match self {
            Law::Entry(entry) => entry.about.parameters,
            Law::Formula(formula) => formula.parameters(),
        }
    }

    /// The entry, unless it is a formula.
    pub fn entry(&self) -> Option<&'static Entry> {
        match self {
            Law::Entry(entry) => Some(entry),
            Law::Formula(_) => None,
        }
    }

    /// The formula, if it is one.
    pub fn formula(&self) -> Option<&Formula> {
        match self {
            Law::Entry(_) => None,
            Law::Formula(formula) => Some(formula),
        }
    }

    /// Whether it varies along the path at these values; a formula is assumed to.
    pub fn varies(&self, values: &[f64]) -> bool {
        self.entry().is_none_or(|entry| (entry.varies)(values))
    }

    /// Whether it may depend on the robot's place in the room: a formula with x or y, or an effect outside the catalogue, about which
    /// nothing is known.
    pub(super) fn reads_place(&self) -> bool {
        self.formula().map_or_else(|| self.order() == CATALOGUE.len(), Formula::reads_place)
    }

    /// Whether it is an effect of a program's own, outside the catalogue.
    pub(crate) fn is_of_program(&self) -> bool {
        self.entry().is_some() && self.order() == CATALOGUE.len()
    }

    /// What it changes.
    pub(crate) fn changes(&self) -> Changes {
        self.entry().map_or(Changes::WHEELS.and(Changes::BODY), |entry| entry.changes)
    }

    /// Its random part; a formula has none.
    pub(crate) fn scatter(&self) -> &'static RandomLaws {
        static NOTHING: RandomLaws = RandomLaws::NOTHING;
        self.entry().map_or(&NOTHING, |entry| &entry.scatter)
    }

    /// A number that names its random stream.
    pub(crate) fn purpose(&self) -> u64 {
        self.entry().map_or(0, Entry::purpose)
    }

    /// Its place in the catalogue; effects that are not in it come after all others.
    pub(super) fn order(&self) -> usize {
        CATALOGUE.iter().position(|entry| self == entry).unwrap_or(CATALOGUE.len())
    }
}

impl fmt::Display for Law {
    /// The name, and the whole formula, so that different laws have different texts.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Law::Entry(entry) => f.write_str(entry.about.name),
            Law::Formula(formula) => formula.fmt(f),
        }
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Law) -> bool {
        match (self, other) {
            (Law::Entry(a), Law::Entry(b)) => a == b,
            (Law::Formula(a), Law::Formula(b)) => a == b,
            _ => false,
        }
    }
}

impl PartialEq<Entry> for Law {
    fn eq(&self, other: &Entry) -> bool {
        self.entry() == Some(other)
    }
}

impl PartialEq<&Entry> for Law {
    fn eq(&self, other: &&Entry) -> bool {
        self.entry() == Some(other)
    }
}
