//! `umbmark convert`: a dataset in another layout.

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};
use umbmark_core::dataset::{Dataset, RunClock};
use umbmark_core::prose::counted;
use umbmark_core::result::Clock;
use umbmark_core::stats::Measured;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::output_arguments::{OutputArguments, layouts};
use crate::prose::hanging;
use crate::table::{table, with_precision_of};

/// Arguments of `convert`.
#[derive(Debug, clap::Args)]
#[command(after_help = about())]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    #[command(flatten)]
    output: OutputArguments,
}

fn about() -> String {
    format!(
        "{}\nWhere a track has a clock of its own (reference/NAME.csv or .tum beside runs/NAME.csv; *_opti.csv of OptiOdom), \
         its clock is aligned from the motion, and its poses are written into the log.",
        layouts()
    )
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load(session)?;
    let lost = arguments.output.write(&data)?;
    if session.json() {
        session.print_json(&document(&arguments.output, &data, &lost))?;
    } else {
        write!(session.out(), "{}", text(&arguments.output, &data, &lost))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn text(arguments: &OutputArguments, data: &Dataset, lost: &[String]) -> String {
    let (place, runs) = (arguments.output.display(), data.runs.len());
    let mut text = format!("wrote {} to {place} as {}\n", counted(runs, "run"), arguments.layout().name);
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

/// Clocks aligned from the motion, each with half its 95 % interval.
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

fn document(arguments: &OutputArguments, data: &Dataset, lost: &[String]) -> Value {
    json!({
        "output": arguments.output.display().to_string(),
        "layout": arguments.layout().name,
        "runs": data.runs.len(),
        "clocks": data.clocks.iter().map(Clock::from).collect::<Vec<_>>(),
        "lost": lost,
        "warnings": data.warnings,
        "version": umbmark_core::VERSION,
    })
}
