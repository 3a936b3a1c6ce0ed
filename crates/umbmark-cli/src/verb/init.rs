//! `umbmark init`: files to fill in.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use umbmark_io::{Existing, write_template};

use crate::Session;

/// Arguments of `init`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The folder for robot.toml and returns.csv; it is created if it does not exist
    #[arg(default_value = ".")]
    folder: PathBuf,

    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let existing = if arguments.force { Existing::Replace } else { Existing::Keep };
    let [robot, returns] = write_template(&arguments.folder, existing)?.map(|file| file.display().to_string());
    if session.json() {
        session.print_json(&json!({ "written": [robot, returns] }))?;
        return Ok(ExitCode::SUCCESS);
    }
    let folder = arguments.folder.to_string_lossy();
    let folder = shlex::try_quote(&folder)?;
    write!(
        session.out(),
        "wrote {robot}\n  enter the values of your robot's software: wheelbase, wheels, encoders, path\n\
         wrote {returns}\n  add one row for each drive round the path; the file says how to measure\n\n\
         then\n  umbmark inspect {folder}      is the data good?\n  \
         umbmark score {folder}        how large are the errors?\n  \
         umbmark calibrate {folder}    what corrects them?\n"
    )?;
    Ok(ExitCode::SUCCESS)
}
