//! `umbmark convert`: a dataset in another layout.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};
use umbmark_core::dataset::{Alignment, Dataset, Existing, LAYOUTS, Layout, Measured, RunClock};

use crate::Session;
use crate::prose::hanging;
use crate::table::{table, with_precision_of};

/// Arguments of `convert`.
#[derive(Debug, clap::Args)]
#[command(after_help = layouts())]
pub struct Arguments {
    /// A dataset folder, an OptiOdom folder or its metadata file, or one file of either
    #[arg(value_name = "DATA")]
    data: PathBuf,

    /// Folder to write
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,

    /// The layout to write
    #[arg(long, value_name = "LAYOUT", default_value = "csv", value_parser = names())]
    to: String,

    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(LAYOUTS.iter().map(|layout| layout.name))
}

fn layouts() -> String {
    let lines = LAYOUTS.iter().map(|layout| hanging(&format!("  {}", layout.name), 12, layout.about));
    format!(
        "Layouts:\n{}\nWhere a track has a clock of its own (reference/NAME.csv or .tum beside runs/NAME.csv; *_opti.csv of OptiOdom), \
         its clock is set by the motion, and its poses are written into the log.",
        lines.collect::<String>()
    )
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = Dataset::load(&arguments.data)?;
    let existing = if arguments.force { Existing::Replace } else { Existing::Keep };
    let layout = LAYOUTS.iter().find(|layout| layout.name == arguments.to).unwrap_or(&LAYOUTS[0]);
    let lost = data.convert(layout, &arguments.output, existing)?;
    if session.json() {
        session.print_json(&document(&arguments, layout, &data, &lost))?;
    } else {
        write!(session.out(), "{}", text(&arguments, layout, &data, &lost))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn text(arguments: &Arguments, layout: &Layout, data: &Dataset, lost: &[String]) -> String {
    let (place, runs) = (arguments.output.display(), data.runs.len());
    let mut text = format!("wrote {runs} runs to {place} as {}\n", layout.name);
    if !data.clocks.is_empty() {
        text += &format!("\n{}\n", clocks_table(&data.clocks));
    }
    text += "\nwhat is lost\n";
    if lost.is_empty() {
        text += &hanging("  -", 4, "nothing");
    }
    for sentence in lost {
        text += &hanging("  -", 4, sentence);
    }
    if !data.warnings.is_empty() {
        text += "\nnoticed while reading\n";
        for warning in &data.warnings {
            text += &hanging("  -", 4, warning);
        }
    }
    text
}

/// Clocks set by the motion, each with half its 95 % interval.
pub(super) fn clocks_table(clocks: &[RunClock]) -> String {
    let rows = clocks.iter().map(|clock| {
        let a = &clock.alignment;
        let cell = |measured: &Measured, scale: f64| {
            let half = scale * (measured.interval.high - measured.value);
            let value = with_precision_of(scale * measured.value, half);
            format!("{value} ± {}", with_precision_of(half, half))
        };
        let or_dash = |measured: &Option<Measured>, scale: f64| {
            measured.as_ref().map_or("-".into(), |m| format!("{:.1}", scale * m.value))
        };
        vec![
            clock.run.clone(),
            cell(&a.offset, 1.0),
            cell(&a.rate, 1.0),
            or_dash(&a.lever_ahead, 1e3),
            or_dash(&a.lever_left, 1e3),
            or_dash(&a.yaw, 1f64.to_degrees()),
        ]
    });
    table(&["clock; 95 %", "offset s", "rate", "ahead mm", "left", "yaw deg"], rows)
}

fn document(arguments: &Arguments, layout: &Layout, data: &Dataset, lost: &[String]) -> Value {
    json!({
        "output": arguments.output.display().to_string(),
        "layout": layout.name,
        "runs": data.runs.len(),
        "clocks": data.clocks.iter().map(clock_json).collect::<Vec<Value>>(),
        "lost": lost,
        "warnings": data.warnings,
        "version": umbmark_core::VERSION,
    })
}

/// A clock that was set, with its run and its track.
pub(super) fn clock_json(clock: &RunClock) -> Value {
    let mut document = alignment_json(&clock.alignment);
    document["run"] = json!(clock.run);
    document["track"] = json!(clock.track);
    document
}

/// An alignment: each quantity with standard error and 95 % interval.
pub(super) fn alignment_json(alignment: &Alignment) -> Value {
    let measured = |m: &Measured| json!({ "value": m.value, "std_error": m.std_error, "interval": [m.interval.low, m.interval.high] });
    json!({
        "offset_s": measured(&alignment.offset),
        "rate": measured(&alignment.rate),
        "lever_ahead_m": alignment.lever_ahead.as_ref().map(measured),
        "lever_left_m": alignment.lever_left.as_ref().map(measured),
        "yaw_rad": alignment.yaw.as_ref().map(measured),
        "misfit_m": alignment.misfit,
        "windows": alignment.windows,
        "left_out": alignment.left_out,
    })
}
