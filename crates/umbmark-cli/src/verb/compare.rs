//! `umbmark compare`: models against measurements.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::{Map, Value, json};
use umbmark_core::compare::tracks::TrackComparison;
use umbmark_core::compare::{Comparison, Judged, NoiseSource, Statistic, compare, compare_tracks};
use umbmark_core::dataset::{Dataset, read_model};
use umbmark_core::diagnose::{Level, Options, base_model, first_model};
use umbmark_core::effect::Model;
use umbmark_core::learn::{fit, fit_to_returns};

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{circle_table, contrasts_table, p_text, square_json};
use crate::prose::hanging;
use crate::table::table;
use crate::test_arguments::TestArguments;
use crate::tracks_report;

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// A model to hold against it, with the values it has; may be given more than once
    /// [default: the nominal robot, and E_d and E_b (on tracks E_s too) fitted to this data]
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,

    #[command(flatten)]
    test: TestArguments,

    /// Exit with code 3 if no model explains the data
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load()?;
    let options = arguments.test.options(session);
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    let explained = match options.evidence(&data) {
        Level::Ends => on_return_poses(&arguments, &data, &options, session)?,
        Level::Tracks => on_tracks(&arguments, &data, &options, session)?,
    };
    Ok(if arguments.check && !explained { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// Says whether some model explains the data.
fn on_return_poses(
    arguments: &Arguments,
    data: &Dataset,
    options: &Options,
    session: &mut Session,
) -> anyhow::Result<bool> {
    let comparison = session.on_threads(|| -> anyhow::Result<Comparison> {
        Ok(compare(data, &models(arguments, data, Level::Ends)?, options)?)
    })??;
    if session.json() {
        session.print_json(&document(&comparison, options))?;
    } else {
        write!(session.out(), "{}", text(&comparison, options))?;
    }
    Ok(comparison.models.iter().any(|model| model.explains(options.size)))
}

/// Says whether some model explains the data.
fn on_tracks(arguments: &Arguments, data: &Dataset, options: &Options, session: &mut Session) -> anyhow::Result<bool> {
    let comparison = session.on_threads(|| -> anyhow::Result<TrackComparison> {
        Ok(compare_tracks(data, &models(arguments, data, Level::Tracks)?, options)?)
    })??;
    if session.json() {
        session.print_json(&tracks_report::document(&comparison, options))?;
    } else {
        let terminal = session.on_terminal();
        write!(session.out(), "{}", tracks_report::text(&comparison, options, terminal))?;
    }
    Ok(comparison.models.iter().any(|model| model.explains(options.size) != Some(false)))
}

/// The models that were given; else the nominal robot, and that with its first errors fitted.
fn models(arguments: &Arguments, data: &Dataset, level: Level) -> anyhow::Result<Vec<(String, Model)>> {
    let robot = data.nominal_robot()?;
    if arguments.model.is_empty() {
        let (name, fitted) = match level {
            Level::Ends => ("E_d and E_b, fitted to these runs", fit_to_returns(data, &base_model(robot)?)?.0),
            Level::Tracks => ("E_d, E_b, E_s fitted", fit(data, &first_model(data)?)?.model),
        };
        return Ok(vec![("nominal robot".into(), Model::new(robot)), (name.into(), fitted)]);
    }
    let read = |file: &PathBuf| Ok((file.display().to_string(), read_model(file, robot)?.0));
    arguments.model.iter().map(read).collect()
}

fn document(comparison: &Comparison, options: &Options) -> Value {
    let mut document = json!({
        "observed": "end_poses",
        "n_cw": comparison.runs[0],
        "n_ccw": comparison.runs[1],
        "models": comparison.models.iter().map(|m| model_json(m, options)).collect::<Vec<_>>(),
        "remarks": comparison.remarks,
        "size": options.size,
        "draws": options.draws,
        "seed": options.seed,
        "version": umbmark_core::VERSION,
    });
    if let Some(map) = document.as_object_mut() {
        map.extend(square_json(&comparison.contrasts, &comparison.circle));
    }
    document
}

fn model_json(judged: &Judged, options: &Options) -> Value {
    let mut statistics: Map<String, Value> = Map::new();
    for s in &judged.statistics {
        let of_direction = statistics.entry(s.direction.name()).or_insert_with(|| json!({}));
        if let Some(map) = of_direction.as_object_mut() {
            let told = json!({ "measured": s.measured, "predicted": s.predicted, "p": s.p });
            map.insert(s.quantity.key().to_owned(), told);
        }
    }
    json!({
        "name": judged.name,
        "explains": judged.explains(options.size),
        "p": judged.p,
        "noise": match judged.noise { NoiseSource::Model => "model", NoiseSource::Pooled => "pooled" },
        "rmse_m": judged.rmse,
        "heading_rmse_rad": judged.heading_rmse,
        "statistics": statistics,
        "sentences": judged.sentences,
    })
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
