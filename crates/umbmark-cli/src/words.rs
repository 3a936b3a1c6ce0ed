//! Errors in the command's own words: remedies name its flags.

use std::error::Error;

use umbmark_core::plan::PlanError;
use umbmark_io::export::ExportError;
use umbmark_io::{DatasetError, Words};

/// How the command names its arguments.
pub const WORDS: Words = Words { replace: "say --force", before: "--", between: " " };

/// The message of an error, and those of what caused it.
pub fn worded(error: &anyhow::Error) -> String {
    error.chain().map(one).collect::<Vec<_>>().join(": ")
}

fn one(error: &(dyn Error + 'static)) -> String {
    if let Some(error) = error.downcast_ref::<DatasetError>() {
        error.worded(&WORDS)
    } else if let Some(error) = error.downcast_ref::<ExportError>() {
        error.worded(&WORDS)
    } else if let Some(PlanError::NoScatter) = error.downcast_ref() {
        format!("{error} (--wheel-noise 0.001)")
    } else {
        error.to_string()
    }
}
