//! The verbs, one file each.

mod completions;
mod mc;
mod simulate;

use std::process::ExitCode;

use crate::Session;

/// What the command can do.
#[derive(Debug, clap::Subcommand)]
pub enum Verb {
    /// Monte Carlo: simulate whole UMBmark tests by the thousand
    Mc(Box<mc::Arguments>),
    /// Simulate one test and write it as a dataset
    Simulate(Box<simulate::Arguments>),
    /// Print shell completions or the manual page
    Completions(completions::Arguments),
}

impl Verb {
    pub(crate) fn run(self, session: &mut Session) -> anyhow::Result<ExitCode> {
        match self {
            Verb::Mc(arguments) => mc::run(*arguments, session),
            Verb::Simulate(arguments) => simulate::run(*arguments, session),
            Verb::Completions(arguments) => completions::run(arguments, session),
        }
    }
}
