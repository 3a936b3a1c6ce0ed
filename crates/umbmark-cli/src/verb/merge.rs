//! `umbmark merge`: shards or checkpoints of `mc` into one result.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;

use crate::Session;
use crate::checkpoint::Checkpoint;
use crate::ensemble_report::Report;

/// Arguments of `merge`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Files of `mc --checkpoint`, of one study
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Write the merged checkpoint
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Replace a file that exists
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (first, rest) = arguments.files.split_first().context("no file to merge")?;
    let mut merged = Checkpoint::load(first)?;
    for file in rest {
        let other = Checkpoint::load(file)?;
        let name = || format!("cannot merge {} with what comes before it", file.display());
        merged.ensemble.merge(&other.ensemble).with_context(name)?;
    }
    let missing = merged.ensemble.missing();
    for range in &missing {
        session.message("missing", &format!("trials {} to {}", range.start, range.end - 1));
    }
    if let Some(file) = &arguments.output {
        anyhow::ensure!(arguments.force || !file.exists(), "{} exists already; --force replaces it", file.display());
        Checkpoint::save(file, &merged.description, &merged.ensemble)?;
    }
    let Checkpoint { description, ensemble } = &merged;
    let report = Report { description, ensemble, partial: !missing.is_empty(), took: None };
    if session.json() {
        session.print_json(&report.json())?;
    } else {
        let text = report.text(session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}
