//! The `umbmark` command as a library: one file per verb.
//!
//! Parsing only parses: each verb's `Arguments` are turned into one resolved configuration of the core before anything is
//! computed. Results go to stdout, messages and progress to stderr.

mod answer;
mod budget;
mod checkpoint_flags;
mod contents_report;
mod data_arguments;
mod distribution_text;
mod effect_flags;
mod ensemble_report;
mod files;
mod heat_map;
mod level_argument;
mod model_report;
mod numbers;
mod output_arguments;
mod plan_report;
mod prose;
mod residual_strips;
mod robot_flags;
mod sensitivity_report;
mod session;
mod setup;
mod setup_report;
mod signature;
mod study_arguments;
mod study_flags;
mod sweep;
mod table;
mod terminal;
mod test_arguments;
pub mod told;
mod tracks_report;
mod unlisted;
mod vary;
mod verb;
mod words;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

pub use session::Session;
pub use verb::Verb;

/// Measure, explain and correct the odometry error of wheeled robots.
///
/// UMBmark (Borenstein & Feng, 1995): drive a square in both directions, and compare where the robot ends with where its odometry
/// says it is. This tool scores such tests, calibrates the robot, and finds other error sources. It also simulates thousands of tests.
#[derive(Debug, Parser)]
#[command(
    name = "umbmark",
    version,
    propagate_version = true,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done; 1 the data or the arguments are unusable; 2 wrong usage; 3 with --check: the model does not explain the data; 130 stopped by Ctrl-C or SIGTERM, what was done until then is told and marked partial."
)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,

    #[command(flatten)]
    session: session::Options,
}

/// The whole command, for help pages, manuals and completions.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command with its arguments, the program's name first.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // clap sends help to stdout and wrong usage to stderr; a closed pipe there is no failure.
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    let mut session = Session::new(cli.session);
    let begun = session.begin();
    let outcome =
        begun.and_then(|()| cli.verb.run(&mut session)).and_then(|code| Ok(session.flush().map(|()| code)?));
    match outcome {
        Ok(_) if session.was_interrupted() => ExitCode::from(session::INTERRUPTED),
        Ok(code) => code,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {}", session::visible(&words::worded(&error)));
            ExitCode::from(1)
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| cause.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe))
}

#[cfg(test)]
mod tests {
    #[test]
    fn flags_of_all_verbs_are_consistent() {
        super::command().debug_assert();
    }
}
