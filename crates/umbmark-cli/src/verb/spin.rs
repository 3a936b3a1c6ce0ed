//! `umbmark spin`: what a turn on the spot takes.

use std::io::Write;
use std::process::ExitCode;

use umbmark_core::result::Spin;

use crate::Session;
use crate::data_arguments::DataArguments;

/// Arguments of `spin`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load(session)?;
    let spin = Spin::new(data.nominal_robot()?);
    if session.json() {
        session.print_json(&spin)?;
    } else {
        writeln!(session.out(), "each wheel of {} rolls {:.3} m", spin.robot, spin.travel_m)?;
    }
    Ok(ExitCode::SUCCESS)
}
