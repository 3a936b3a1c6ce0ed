//! `umbmark fit`: the free parameters of a model, fitted to a dataset.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use umbmark_core::evidence::{Fit, KnownBefore, Leaves, fit_knowing};
use umbmark_core::fit::Prior;
use umbmark_core::likelihood::{Ended, Knowledge, KnownNumber, USUAL_NOISE};
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

    /// Keep a parameter from LOW to HIGH, of which one may be left out; may be given more than once
    #[arg(long, value_name = "EFFECT.PARAMETER=LOW:HIGH", value_parser = bounds)]
    bound: Vec<Pair>,

    /// An earlier measurement of a parameter with its standard deviation; may be given more than once
    #[arg(long, value_name = "EFFECT.PARAMETER=MEAN:SD", value_parser = measurement)]
    prior: Vec<Pair>,

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

/// A parameter with two numbers: bounds, or a mean and a standard deviation.
#[derive(Clone, Debug)]
struct Pair {
    effect: String,
    parameter: String,
    numbers: (f64, f64),
}

fn pair(text: &str, example: &str, of: impl Fn(&str, &str) -> Result<(f64, f64), String>) -> Result<Pair, String> {
    let split = || {
        let (name, numbers) = text.split_once('=')?;
        Some((name.trim().split_once('.')?, numbers.split_once(':')?))
    };
    let ((effect, parameter), (first, second)) = split().ok_or(format!("write {example}"))?;
    let numbers = of(first.trim(), second.trim())?;
    Ok(Pair { effect: effect.to_owned(), parameter: parameter.to_owned(), numbers })
}

fn bounds(text: &str) -> Result<Pair, String> {
    let side = |text: &str, open: f64| if text.is_empty() { Ok(open) } else { number(text) };
    let both = |low: &str, high: &str| Ok((side(low, f64::NEG_INFINITY)?, side(high, f64::INFINITY)?));
    pair(text, "EFFECT.PARAMETER=LOW:HIGH, as in wheelbase.e_b=0.95:1.05", both)
}

fn measurement(text: &str) -> Result<Pair, String> {
    let both = |mean: &str, sd: &str| Ok((number(mean)?, number(sd)?));
    pair(text, "EFFECT.PARAMETER=MEAN:SD, as in wheelbase.e_b=1.002:0.003", both)
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
    let mut knowledge = Knowledge::default();
    for Pair { effect, parameter, numbers: (low, high) } in &arguments.bound {
        knowledge.bound(effect, parameter, *low, *high).context("--bound")?;
    }
    for Pair { effect, parameter, numbers: (mean, sd) } in &arguments.prior {
        knowledge.measured(effect, parameter, *mean, *sd).context("--prior")?;
    }
    let fitted = session.on_threads(|| fit_knowing(&data, &model, knowledge))??;
    let Fit { model, noise, .. } = &fitted;
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
    for effect in result::not_shown(&fitted) {
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
    let ended = known_text(fitted) + &ended_text(fitted);
    format!("{}\n{meant}{note}{ended}", estimates_table(estimates, level))
}

/// How the fit ended, and what it leaves.
fn ended_text(fitted: &Fit) -> String {
    let Leaves { position, heading, chi2, residuals, aicc, .. } = fitted.leaves;
    let degrees = heading.map(|heading| format!(" and {:.3} deg", heading.to_degrees()));
    let chi2 = chi2.zip(residuals).map(|(chi2, count)| format!(", chi2 {chi2:.1} of {count} residuals"));
    let aicc = aicc.map(|aicc| format!(", AICc {aicc:.1}"));
    let [degrees, chi2, aicc] = [degrees, chi2, aicc].map(Option::unwrap_or_default);
    let Ended { termination, steps } = fitted.ended;
    let how = termination.name();
    let more = if termination.converged() { "" } else { "; other values may fit better" };
    let left = format!("{:.2} mm{degrees} left (root mean square){chi2}{aicc}", 1e3 * position);
    hanging("fit", 10, &format!("{how}, step {steps}{more}. {left}."))
}

/// The earlier measurements that the runs contradict are this many standard deviations from them.
const CONTRADICTED: f64 = 3.0;

/// What became of the numbers that were known before, a paragraph each.
fn known_text(fitted: &Fit) -> String {
    let one = |k: KnownBefore<'_>| {
        let KnownNumber { effect, parameter, known } = k.number;
        let name = format!("{parameter} of {effect}");
        let bound = k.held.then(|| {
            let said = format!(
                "{name} is held at {}; beyond it the runs would be fitted better. It has no interval.",
                k.value
            );
            hanging("bound", 10, &said)
        });
        let prior = known.prior.map(|Prior { mean, sd }| {
            let against = k.contradiction.filter(|z| z.abs() > CONTRADICTED);
            let against = against.map_or(String::new(), |z| {
                format!(" The runs contradict that: alone they are {:.1} standard deviations from it.", z.abs())
            });
            hanging(
                "prior",
                10,
                &format!("{name} was measured before as {mean} with a standard deviation of {sd}.{against}"),
            )
        });
        prior.unwrap_or_default() + &bound.unwrap_or_default()
    };
    fitted.known().map(one).collect()
}
