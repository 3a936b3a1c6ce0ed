//! `umbmark compare`: models against measurements.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::compare::{
    Compared, Comparison, Judged, NoiseSource, Statistic, TrackComparison, compare, usual_models,
};
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::Options;
use umbmark_core::effect::Model;
use umbmark_core::prose::counted;
use umbmark_core::result;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{circle_table, contrasts_table, p_text, read_model};
use crate::prose::{details_text, hanging};
use crate::setup_report::{clocks_text, doubts_text, faults_text, remains_text, returns_text};
use crate::table::table;
use crate::test_arguments::TestArguments;
use crate::tracks_report;

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// A model to compare with the data, its values unchanged; may be given more than once
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
    let data = arguments.data.load_to_test(session)?;
    let options = arguments.test.options(session);
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    let compared = session
        .on_threads(|| anyhow::Ok(compare(&data, &models(&arguments, &data, &options, session)?, &options)?))??;
    let explained = match compared {
        Compared::Ends(comparison) => on_return_poses(&comparison, &options, session)?,
        Compared::Tracks(comparison) => on_tracks(&comparison, &options, session)?,
    };
    Ok(if arguments.check && !explained { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// Says whether some model explains the data.
fn on_return_poses(comparison: &Comparison, options: &Options, session: &mut Session) -> anyhow::Result<bool> {
    if session.json() {
        session.print_json(&result::Comparison::new(comparison, options))?;
    } else {
        let text = text(comparison, options, session.verbose());
        write!(session.out(), "{text}")?;
    }
    Ok(comparison.models.iter().any(|model| model.explains(options.size)))
}

/// Says whether some model explains the data.
fn on_tracks(comparison: &TrackComparison, options: &Options, session: &mut Session) -> anyhow::Result<bool> {
    if session.json() {
        session.print_json(&result::TrackComparison::new(comparison, options))?;
    } else {
        let look = tracks_report::Look { terminal: session.on_terminal(), verbose: session.verbose() };
        write!(session.out(), "{}", tracks_report::text(comparison, options, look))?;
    }
    Ok(comparison.models.iter().any(|model| model.explains(options.size) != Some(false)))
}

/// The models that were given, else the usual ones.
fn models(
    arguments: &Arguments,
    data: &Dataset,
    options: &Options,
    session: &Session,
) -> anyhow::Result<Vec<(String, Model)>> {
    if arguments.model.is_empty() {
        return Ok(usual_models(data, options)?);
    }
    let read = |file: &PathBuf| Ok((file.display().to_string(), read_model(file, data, session)?));
    arguments.model.iter().map(read).collect()
}

/// What each model explains of return poses, with the tables behind it where they are wanted.
pub fn text(comparison: &Comparison, options: &Options, verbose: bool) -> String {
    let [cw, ccw] = comparison.runs;
    let mut text = format!(
        "Comparison of {} with {cw} cw + {ccw} ccw return poses\n\n",
        counted(comparison.models.len(), "model")
    );
    let row = |m: &Judged| {
        let heading = m.heading_rmse.map_or("-".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        let explains = if m.explains(options.size) { "yes" } else { "no" };
        vec![m.name.clone(), format!("{:.1}", 1e3 * m.rmse), heading, p_text(m.p), explains.to_owned()]
    };
    text += &table(&["model", "error [mm]", "[deg]", "p", "explains"], comparison.models.iter().map(row));
    text += "\n";
    let setup = &comparison.setup;
    text += &(faults_text(setup) + &doubts_text(setup) + &clocks_text(setup) + &returns_text(setup));
    for judged in &comparison.models {
        text += &format!("\n{}\n\n", judged.name);
        if verbose {
            text += &table(&["", "measured", "predicted", "p"], judged.statistics.iter().map(statistic_row));
            text += "\n";
        }
        for sentence in &judged.sentences {
            text += &hanging("", 2, sentence);
        }
        text += &hanging("", 2, noise(judged.noise));
        text += &remains_text(Some(&judged.remains));
    }
    if !comparison.contrasts.is_empty() && verbose {
        text += &format!("\n{}\n", contrasts_table(&comparison.contrasts));
    }
    if !comparison.circle.is_empty() && verbose {
        text += &format!("\n{}\n", circle_table(&comparison.circle));
    }
    for remark in &comparison.remarks {
        text += &hanging("note", 10, remark);
    }
    if !verbose {
        text += &details_text("each statistic, measured and predicted");
    }
    text
}

fn noise(source: NoiseSource) -> &'static str {
    match source {
        NoiseSource::Model => "p: from simulated tests that scatter by the model's own random effects.",
        NoiseSource::Pooled => {
            "p: from simulated tests that scatter as these runs do (pooled over both directions), because the model has no random effect."
        }
    }
}

fn statistic_row(s: &Statistic) -> Vec<String> {
    let (scale, unit) = s.quantity.display();
    let number = |value: f64| format!("{:.2}{unit}", scale * value);
    vec![format!("{} {}", s.direction.name(), s.quantity.name()), number(s.measured), number(s.predicted), p_text(s.p)]
}
