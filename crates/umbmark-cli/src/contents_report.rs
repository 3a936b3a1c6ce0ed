//! What logs hold whose robot is not known, for people.

use umbmark_core::inspect::{LogContents, LogPart, ReferenceFound, WheelsFound};

use umbmark_core::prose::counted;

use crate::prose::{hanging, shortened};
use crate::table::table;

/// Where the text begins behind "wheels" and "reference".
const INDENT: usize = 11;

/// Each log: its topics or columns, and which of them would be read.
pub fn contents_text(contents: &[LogContents]) -> String {
    contents.iter().map(log_text).collect::<Vec<_>>().join("\n")
}

fn log_text(log: &LogContents) -> String {
    let lasts = log.duration.map(|seconds| format!(", {seconds:.1} s")).unwrap_or_default();
    let what = if log.layout == "csv" { "column" } else { "topic" };
    let title = format!("{} ({}{lasts})", log.file, log.layout.to_uppercase());
    let kind = if log.layout == "csv" { "holds" } else { "type" };
    let mut text = hanging("", 0, &title);
    text += &table(&[what, kind, "count", "Hz", "used"], log.parts.iter().map(part_row));
    text += "\n";
    match &log.wheels {
        Ok(wheels) => text += &hanging("wheels", INDENT, &wheels_line(wheels)),
        Err(problem) => text += &hanging("wheels", INDENT, &format!("cannot be read: {problem}")),
    }
    match &log.reference {
        Ok(Some(reference)) => text += &hanging("reference", INDENT, &reference_line(reference)),
        Ok(None) if log.wheels.is_err() => {}
        Ok(None) => text += &hanging("reference", INDENT, "no absolute poses: ends by tape are needed (returns.csv)"),
        Err(problem) => text += &hanging("reference", INDENT, &format!("cannot be read: {problem}")),
    }
    for note in &log.notes {
        text += &hanging("note", INDENT, note);
    }
    text
}

fn part_row(part: &LogPart) -> Vec<String> {
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".into());
    vec![
        shortened(&part.name, 30),
        // As people write the types of ROS 2.
        part.kind.replace("/msg/", "/"),
        or_dash(part.count.map(|count| count.to_string())),
        or_dash(part.rate.map(rate)),
        part.used.unwrap_or("-").to_owned(),
    ]
}

fn rate(hertz: f64) -> String {
    let decimals = if hertz < 10.0 { 2 } else { 1 };
    format!("{hertz:.decimals$}")
}

fn wheels_line(wheels: &WheelsFound) -> String {
    let (source, unit, readings) = (&wheels.source, wheels.unit.name(), &wheels.readings);
    let readings = counted(*readings, "reading");
    let mut line = format!("{source}: {readings} of {unit} at {} Hz", rate(wheels.rate));
    if let Some(steps) = wheels.ticks_per_revolution {
        line += &format!(", in steps of 1/{steps} turn");
    }
    if let Some(bits) = wheels.counter_bits {
        line += &format!(", which roll over as counters of {bits} bits");
    }
    line
}

fn reference_line(reference: &ReferenceFound) -> String {
    let ReferenceFound { source, poses, headings, .. } = reference;
    let rate = reference.rate.map(|hertz| format!(" at {} Hz", rate(hertz))).unwrap_or_default();
    let with = if headings == poses { "all with a heading".to_owned() } else { format!("{headings} with a heading") };
    format!("{source}: {}{rate}, {with}", counted(*poses, "pose"))
}
