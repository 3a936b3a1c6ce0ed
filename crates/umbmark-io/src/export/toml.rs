//! A `robot.toml` with the corrected numbers.

use super::text::to_nanometre;
use super::{Comment, Export, ExportError, Target, Written};
use crate::RobotFile;
use umbmark_core::drive::{Drive, Robot};

/// Lengths are rounded to the nanometre.
pub static TARGET: Target =
    Target { name: "toml", about: "a robot.toml with the corrected numbers, for every drive", holds_all: false, write };

fn write(export: &Export) -> Result<Written, ExportError> {
    let corrected = export.corrected()?;
    let kind = corrected.drive.kind();
    let numbers = kind.parameters().iter().zip(corrected.drive.values());
    let rounded: Vec<f64> =
        numbers.map(|(parameter, value)| if parameter.unit == "m" { to_nanometre(value) } else { value }).collect();
    let robot = Robot { drive: Drive::from_values(kind, &rounded)?, ..corrected };
    let notes = export.uncorrected();
    let file = match &export.beside {
        Some(beside) => RobotFile { robot, ..beside.clone() },
        None => RobotFile::new(robot, None),
    };
    let head = Comment::Hash.line(&export.heading()) + &Comment::Hash.lines(&notes);
    Ok(Written { text: head + &file.text(), notes })
}
