//! `umbmark fit`: the free parameters of a model, fitted to a dataset.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use umbmark_core::evidence::{Fit, fit};
use umbmark_core::likelihood::USUAL_NOISE;
use umbmark_core::result;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::level_argument::LevelArgument;
use crate::model_report::{estimates_table, meaning_text, model_of, outliers_text, write_model};
use crate::numbers::number;
use crate::prose::hanging;
use crate::setup_report::{disturbances_text, doubts_text, taken_text};

/// Arguments of `fit`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// The model whose free effects are fitted [default: E_d and E_b]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    /// Add an effect and fit it too; may be given more than once
    #[arg(long, value_name = "EFFECT")]
    add: Vec<String>,

    /// Keep a parameter of a free effect at its value, or at VALUE; may be given more than once
    #[arg(long, value_name = "EFFECT.PARAMETER[=VALUE]", value_parser = fixed)]
    fix: Vec<Fixed>,

    /// Write the fitted model
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    intervals: LevelArgument,

    /// Replace a file that exists
    #[arg(long)]
    force: bool,
}

/// A parameter that is not fitted.
#[derive(Clone, Debug)]
struct Fixed {
    effect: String,
    parameter: String,
    value: Option<f64>,
}

fn fixed(text: &str) -> Result<Fixed, String> {
    let (name, value) = text.split_once('=').map_or((text, None), |(name, value)| (name, Some(value)));
    let (effect, parameter) =
        name.trim().split_once('.').ok_or("write EFFECT.PARAMETER or EFFECT.PARAMETER=VALUE, as in scale.e_s=1")?;
    let value = value.map(|value| number(value.trim())).transpose()?;
    Ok(Fixed { effect: effect.to_owned(), parameter: parameter.to_owned(), value })
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load(session)?;
    let mut model = model_of(arguments.model.as_deref(), &data, session)?;
    for effect in &arguments.add {
        model.add(effect)?.free = true;
    }
    for Fixed { effect, parameter, value } in &arguments.fix {
        value.map_or(Ok(()), |value| model.set(effect, parameter, value)).context("--fix")?;
        model.fix(effect, parameter).context("--fix")?;
    }
    if !model.is_free() {
        anyhow::bail!("no effect of the model is free: write free = true in its file, or use --add EFFECT");
    }
    let fitted = session.on_threads(|| fit(&data, &model))??;
    let Fit { model, estimates, noise, .. } = &fitted;
    if let Some(file) = &arguments.output {
        write_model(model, *noise, file, arguments.force)?;
    }
    if session.json() {
        session.print_json(&result::Fitted::new(&fitted, arguments.intervals.level))?;
        return Ok(ExitCode::SUCCESS);
    }
    for warning in &data.warnings {
        session.message("warning", warning);
    }
    for effect in result::not_shown(model, estimates) {
        let why = "this data cannot separate it from the rest of the model; it keeps its values";
        session.message("warning", &format!("{effect} was not fitted: {why}"));
    }
    write!(session.out(), "{}", told(&fitted, arguments.intervals.level))?;
    if let Some(file) = &arguments.output {
        writeln!(session.out(), "\nwrote {}", file.display())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The fitted values, what they mean, and what was left out of the fit.
pub fn told(fitted: &Fit, level: f64) -> String {
    let Fit { model, estimates, outliers, usual_noise, setup, taken, .. } = fitted;
    let disturbed = doubts_text(setup) + &disturbances_text(setup) + &outliers_text(outliers, setup);
    let meant = meaning_text(estimates, model) + &taken_text(taken) + &disturbed;
    let note = if *usual_noise { hanging("note", 10, USUAL_NOISE) } else { String::new() };
    format!("{}\n{meant}{note}", estimates_table(estimates, level))
}
