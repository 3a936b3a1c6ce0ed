//! A C header with the corrected numbers.

use super::text::number;
use super::{Comment, Export, ExportError, Target, Written};

/// One `#define` a number of the drive, and the sizes of the noise.
pub static TARGET: Target = Target {
    name: "c",
    about: "a C header with the corrected numbers and the noise, for every drive",
    holds_all: false,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let corrected = export.corrected()?;
    let (kind, mut notes) = (corrected.drive.kind(), export.uncorrected());
    let mut body = String::new();
    for (parameter, value) in kind.parameters().iter().zip(corrected.drive.values()) {
        let name = parameter.name.to_uppercase();
        body += &format!("#define UMBMARK_{name} {} /* {} */\n", number(value), parameter.meaning);
    }
    if kind.has_axle_wheels() {
        let per_tick = corrected.metres_per_tick();
        for (side, value) in [("LEFT", per_tick.left), ("RIGHT", per_tick.right)] {
            body += &format!("#define UMBMARK_METRES_PER_TICK_{side} {value:.12e}\n");
        }
    }
    if let Some(noise) = export.noise_or(&mut notes) {
        for (name, size, unit) in [
            ("HEADING_VARIANCE_PER_METRE", noise.heading_per_metre, "rad^2/m"),
            ("HEADING_VARIANCE_PER_RADIAN", noise.heading_per_radian, "rad^2/rad"),
            ("FORWARD_VARIANCE_PER_METRE", noise.forward_per_metre, "m^2/m"),
            ("SIDEWAYS_VARIANCE_PER_METRE", noise.sideways_per_metre, "m^2/m"),
        ] {
            body += &format!("#define UMBMARK_{name} {} /* {unit} */\n", number(size * size));
        }
    }
    let head = Comment::C.line(&export.heading()) + &Comment::C.lines(&notes);
    let guard = "#ifndef UMBMARK_ODOMETRY_H\n#define UMBMARK_ODOMETRY_H\n";
    Ok(Written { text: format!("{head}{guard}\n{body}\n#endif\n"), notes })
}
