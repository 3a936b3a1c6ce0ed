//! `umbmark paper`: the experiments of Borenstein & Feng (1995), beside their numbers.

mod figures;
mod tables;

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Map, Value, json};

use crate::Session;

/// An experiment of the paper.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum Experiment {
    /// Table I: E_max,sys and sigma of every robot
    #[value(name = "table-1")]
    TableOne,
    /// Table II: the extended test with ten bumps of 10 mm
    #[value(name = "table-2")]
    TableTwo,
    /// Figures 2 to 4: two errors that cancel in one direction and add up in the other
    #[value(name = "figure-2")]
    FigureTwo,
    /// Figure 5: two clusters of return positions
    #[value(name = "figure-5")]
    FigureFive,
    /// Figure 6: where the bumps lie
    #[value(name = "figure-6")]
    FigureSix,
    /// Section 3.1: what a figure-eight hides
    #[value(name = "figure-eight")]
    FigureEight,
    /// Section 4.5: the 7 x 4 m rectangle instead of the square
    #[value(name = "rectangle")]
    Rectangle,
    /// All of them
    #[value(name = "all")]
    All,
}

/// Arguments of `paper`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment
    #[arg(value_enum, value_name = "EXPERIMENT", default_value = "all")]
    experiment: Experiment,

    /// Simulated tests of each robot, for the tables
    #[arg(short = 'n', long, default_value_t = 2000, value_name = "N", value_parser = clap::value_parser!(u64).range(10..=10_000_000))]
    trials: u64,
}

/// What an experiment found: for people, and as a document.
pub(crate) struct Found {
    /// Its key in the document.
    key: &'static str,
    text: String,
    document: Value,
}

/// What experiments need to know.
struct Bench<'a> {
    session: &'a Session,
    trials: u64,
}

type Run = fn(&Bench) -> anyhow::Result<Found>;

const EXPERIMENTS: [(Experiment, Run); 7] = [
    (Experiment::TableOne, tables::one),
    (Experiment::TableTwo, tables::two),
    (Experiment::FigureTwo, figures::masking),
    (Experiment::FigureFive, figures::clusters),
    (Experiment::FigureSix, figures::bump_places),
    (Experiment::FigureEight, figures::figure_eight),
    (Experiment::Rectangle, figures::rectangle),
];

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let wanted = |experiment: Experiment| [experiment, Experiment::All].contains(&arguments.experiment);
    let mut found = Vec::new();
    for (_, run) in EXPERIMENTS.iter().filter(|(experiment, _)| wanted(*experiment)) {
        found.push(run(&Bench { session, trials: arguments.trials })?);
    }
    if session.json() {
        let mut document: Map<String, Value> =
            found.into_iter().map(|found| (found.key.to_owned(), found.document)).collect();
        document.insert("seed".to_owned(), json!(session.seed()));
        document.insert("version".to_owned(), json!(umbmark_core::VERSION));
        session.print_json(&Value::Object(document))?;
        return Ok(ExitCode::SUCCESS);
    }
    let texts: Vec<String> = found.into_iter().map(|found| found.text).collect();
    writeln!(session.out(), "{}", texts.join("\n\n\n"))?;
    Ok(ExitCode::SUCCESS)
}
