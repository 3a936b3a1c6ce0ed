//! Why a formula is invalid.

use super::program::LONGEST;
use super::variable::VARIABLES;
use crate::effect::MAX_PARAMETERS;

/// Why a formula is invalid. Columns count characters, from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormulaError {
    /// An unknown character.
    #[error("column {column}: '{found}' means nothing here; a formula has + - * / ^ ( ) , numbers and names")]
    Character {
        /// Where.
        column: usize,
        /// What.
        found: char,
    },
    /// An unexpected token.
    #[error("column {column}: expected {expected}, got {found}")]
    Expected {
        /// Where.
        column: usize,
        /// The expected token.
        expected: &'static str,
        /// The token that was found.
        found: String,
    },
    /// An unknown name.
    #[error("column {column}: there is no \"{name}\"{}", nearest.as_ref().map_or_else(|| format!("; {}", offered()), |n| format!("; did you mean \"{n}\"?")))]
    Name {
        /// Where.
        column: usize,
        /// The name that was given.
        name: String,
        /// The most similar known name.
        nearest: Option<String>,
    },
    /// A function without, or a number with, its parentheses.
    #[error("column {column}: \"{name}\" {problem}")]
    Call {
        /// Where.
        column: usize,
        /// The function or number.
        name: String,
        /// What is wrong.
        problem: String,
    },
    /// Too long or too deep.
    #[error("column {column}: the formula is too long; it may have {LONGEST} operations, nested 16 deep")]
    TooLong {
        /// Where.
        column: usize,
    },
    /// Two sides of a sum or comparison with different units.
    #[error(
        "column {column}: \"{left}\" is in {left_unit} and \"{right}\" in {right_unit}: they do not add up or compare"
    )]
    Units {
        /// Where the right side begins.
        column: usize,
        /// The left side.
        left: String,
        /// Its unit.
        left_unit: String,
        /// The right side.
        right: String,
        /// Its unit.
        right_unit: String,
    },
    /// A function of an argument with a unit.
    #[error(
        "column {column}: {function} takes a plain number or an angle, and \"{argument}\" is in {unit}; divide it by a parameter of that unit"
    )]
    Argument {
        /// Where the argument begins.
        column: usize,
        /// The function.
        function: &'static str,
        /// Its argument.
        argument: String,
        /// The unit of that.
        unit: String,
    },
    /// A result whose unit does not fit what the formula acts on.
    #[error(
        "the formula is in {unit}, and {acts_on} in {wanted}; multiply it by a parameter, which then has the unit that is missing"
    )]
    Result {
        /// What the formula acts on.
        acts_on: &'static str,
        /// The unit of that.
        wanted: String,
        /// The formula's unit.
        unit: String,
    },
    /// More parameters than an effect may have.
    #[error("an effect has {MAX_PARAMETERS} parameters at most, got {count}")]
    TooManyParameters {
        /// How many there are.
        count: usize,
    },
    /// A name that a parameter or effect cannot have.
    #[error("\"{name}\" cannot be the name of {what}: {why}")]
    Naming {
        /// The name.
        name: String,
        /// An effect, or a parameter.
        what: &'static str,
        /// The reason.
        why: &'static str,
    },
    /// A parameter that does not occur.
    #[error("the parameter {name} does not occur in the formula; take it away")]
    Unused {
        /// Its name.
        name: String,
    },
}

/// The elements of formulas, for messages.
fn offered() -> String {
    let variables: Vec<&str> = VARIABLES.iter().map(|variable| variable.name).collect();
    let functions = "sin, cos, tan, exp, log, sqrt, abs, sign, min, max, tanh";
    format!("name it among the parameters, or use {}, pi and the functions {functions}", variables.join(", "))
}

/// The column of a byte of the text.
pub(super) fn column(text: &str, byte: usize) -> usize {
    text.get(..byte).unwrap_or(text).chars().count() + 1
}
