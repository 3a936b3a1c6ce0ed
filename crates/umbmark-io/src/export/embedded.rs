//! A model as a table of constants for odometry on the robot.

use super::{Comment, Export, ExportError, Target, Written};
use umbmark_core::apply::compiled;
use umbmark_core::likelihood::Noise;

/// A header of C with the table that `umbmark_odometry.h` reads.
pub static TARGET: Target = Target {
    name: "embedded",
    about: "a C header with the whole model as a table, for the umbmark-odometry library on the robot",
    holds_all: true,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let (rows, notes) = rows(export, |meaning| format!(" /* {meaning} */"))?;
    let head = Comment::C.line(&export.heading()) + &Comment::C.lines(&notes);
    let guard = "#ifndef UMBMARK_MODEL_H\n#define UMBMARK_MODEL_H\n";
    let text = format!("{head}{guard}\nstatic const double umbmark_model[] = {{\n{rows}}};\n\n#endif\n");
    Ok(Written { text, notes })
}

/// The numbers of the table, a line each meaning with what it means, and what has to be said of them.
pub(super) fn rows(export: &Export, comment: impl Fn(&str) -> String) -> Result<(String, Vec<String>), ExportError> {
    let mut notes = Vec::new();
    let noise: Option<Noise> = export.noise_or(&mut notes);
    let mut rows: Vec<(&str, String)> = Vec::new();
    for (meaning, number) in compiled(export.model, noise.as_ref(), export.start)? {
        match rows.last_mut() {
            // The numbers of a law stand behind it.
            Some((_, row)) if meaning.is_empty() => *row += &format!(" {number:?},"),
            _ => rows.push((meaning, format!("    {number:?},"))),
        }
    }
    let late: Vec<&str> =
        export.model.parts().iter().map(|part| part.effect.name()).filter(|name| is_late(name)).collect();
    if !late.is_empty() {
        notes.push(format!(
            "a pose is final 0.05 s after its reading, because speeds are taken over 0.1 s, for {}",
            late.join(", ")
        ));
    }
    let lines = rows.iter().map(|(meaning, row)| format!("{row}{}\n", comment(meaning)));
    Ok((lines.collect(), notes))
}

/// Whether an effect needs the speeds of the wheels.
fn is_late(effect: &str) -> bool {
    umbmark_odometry::law::Law::named(effect).is_some_and(|law| law.reads_speed)
}
