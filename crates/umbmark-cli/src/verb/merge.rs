//! `umbmark merge`: shards or checkpoints of `mc` into one result.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_io::checkpoint::Written;

use crate::Session;
use crate::ensemble_report::Report;
use crate::files::Pending;

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
    let merged = Written::merged(&arguments.files)?;
    let missing = merged.ensemble.missing();
    for range in &missing {
        session.message("missing", &format!("trials {} to {}", range.start, range.end - 1));
    }
    if let Some(file) = &arguments.output {
        Pending::write_whole(file, arguments.force, &merged.text()?)?;
    }
    let Written { seed, study, ensemble } = &merged;
    let report = Report { study, seed: *seed, ensemble, partial: !missing.is_empty(), took: None };
    if session.json() {
        session.print_json(&report.result())?;
    } else {
        let text = report.text(session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}
