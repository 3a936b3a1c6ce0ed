//! `umbmark completions`: shell completions and the manual page, from the same definitions as the help.

use std::io::Write;
use std::process::ExitCode;

use crate::Session;

/// What to print.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum Script {
    Bash,
    Zsh,
    Fish,
    PowerShell,
    /// The manual page, in roff
    Man,
}

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The shell, or `man`
    kind: Script,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let mut command = crate::command();
    let mut text = Vec::new();
    let shell = match arguments.kind {
        Script::Bash => Some(clap_complete::Shell::Bash),
        Script::Zsh => Some(clap_complete::Shell::Zsh),
        Script::Fish => Some(clap_complete::Shell::Fish),
        Script::PowerShell => Some(clap_complete::Shell::PowerShell),
        Script::Man => None,
    };
    match shell {
        Some(shell) => clap_complete::generate(shell, &mut command, "umbmark", &mut text),
        None => {
            clap_mangen::Man::new(command.clone()).render(&mut text)?;
            for verb in command.get_subcommands() {
                writeln!(text)?;
                clap_mangen::Man::new(verb.clone()).title(format!("umbmark-{}", verb.get_name())).render(&mut text)?;
            }
        }
    }
    session.out().write_all(&text)?;
    Ok(ExitCode::SUCCESS)
}
