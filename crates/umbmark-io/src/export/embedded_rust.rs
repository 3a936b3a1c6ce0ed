//! The same table for a program in Rust.

use super::embedded::rows;
use super::{Export, ExportError, Target, Written};

/// A file of Rust with the table that `umbmark_odometry::Table` reads.
pub static TARGET: Target = Target {
    name: "embedded_rust",
    about: "the same table as a file of Rust, for include! or mod",
    holds_all: true,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let (rows, notes) = rows(export, |meaning| format!(" // {meaning}"))?;
    let said = std::iter::once(export.heading()).chain(notes.iter().cloned());
    let head: String = said.map(|sentence| format!("// {sentence}\n")).collect();
    let text = format!(
        "{head}\n/// A model for `umbmark_odometry::Table`.\npub static UMBMARK_MODEL: &[f64] = &[\n{rows}];\n"
    );
    Ok(Written { text, notes })
}
