//! `umbmark compare`: models against measurements.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::compare::{Comparison, Judged, NoiseSource, Statistic, compare};
use umbmark_core::dataset::{Dataset, read_model};
use umbmark_core::diagnose::{Options, base_model};
use umbmark_core::document;
use umbmark_core::effect::Model;
use umbmark_core::learn::fit;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{circle_table, contrasts_table, p_text};
use crate::prose::hanging;
use crate::table::table;

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// A model to hold against it, with the values it has; may be given more than once
    /// [default: the nominal robot, and E_d and E_b fitted to this data]
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,

    /// Simulated tests for the p-values
    #[arg(long, default_value_t = 999, value_name = "N", value_parser = clap::value_parser!(u32).range(99..=99_999))]
    draws: u32,

    /// Probability with which a right model is accused all the same
    #[arg(long, default_value_t = 0.05, value_name = "P", value_parser = super::size)]
    size: f64,

    /// Exit with code 3 if no model explains the data
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load()?;
    let options =
        Options { size: arguments.size, draws: arguments.draws as usize, seed: session.seed(), ends_only: true };
    let comparison = session.on_threads(|| -> anyhow::Result<Comparison> {
        Ok(compare(&data, &models(&arguments, &data)?, &options)?)
    })??;
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    if session.json() {
        session.print_json(&document::comparison(&comparison, &options))?;
    } else {
        write!(session.out(), "{}", text(&comparison, &options))?;
    }
    let explained = comparison.models.iter().any(|model| model.explains(options.size));
    Ok(if arguments.check && !explained { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

fn models(arguments: &Arguments, data: &Dataset) -> anyhow::Result<Vec<(String, Model)>> {
    let robot = data.nominal_robot()?;
    if arguments.model.is_empty() {
        let (fitted, _) = fit(data, &base_model(robot)?)?;
        return Ok(vec![
            ("nominal robot".into(), Model::new(robot)),
            ("E_d and E_b, fitted to these runs".into(), fitted),
        ]);
    }
    let read = |file: &PathBuf| Ok((file.display().to_string(), read_model(file, robot)?.0));
    arguments.model.iter().map(read).collect()
}

fn text(comparison: &Comparison, options: &Options) -> String {
    let [cw, ccw] = comparison.runs;
    let mut text = format!("{cw} cw + {ccw} ccw return poses against {} model(s)\n\n", comparison.models.len());
    let row = |m: &Judged| {
        let heading = m.heading_rmse.map_or("-".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        let explains = if m.explains(options.size) { "yes" } else { "no" };
        vec![m.name.clone(), format!("{:.1}", 1e3 * m.rmse), heading, p_text(m.p), explains.to_owned()]
    };
    text += &table(&["model", "error [mm]", "[deg]", "p", "explains"], comparison.models.iter().map(row));
    text += "\n";
    for judged in &comparison.models {
        text += &format!("\n{}\n\n", judged.name);
        text += &table(&["", "measured", "predicted", "p"], judged.statistics.iter().map(statistic_row));
        text += "\n";
        for sentence in &judged.sentences {
            text += &hanging("", 2, sentence);
        }
        text += &hanging("", 2, noise(judged.noise));
    }
    if !comparison.contrasts.is_empty() {
        text += &format!("\n{}\n", contrasts_table(&comparison.contrasts));
    }
    if !comparison.circle.is_empty() {
        text += &format!("\n{}\n", circle_table(&comparison.circle));
    }
    for remark in &comparison.remarks {
        text += &hanging("note", 10, remark);
    }
    text
}

fn noise(source: NoiseSource) -> &'static str {
    match source {
        NoiseSource::Model => "Simulated tests scatter by the model's own random effects.",
        NoiseSource::Pooled => {
            "The model has no scatter of its own: simulated tests scatter as these runs do, both directions pooled."
        }
    }
}

fn statistic_row(s: &Statistic) -> Vec<String> {
    let (scale, unit) = s.quantity.display();
    let number = |value: f64| format!("{:.2}{unit}", scale * value);
    vec![format!("{} {}", s.direction.name(), s.quantity.name()), number(s.measured), number(s.predicted), p_text(s.p)]
}
