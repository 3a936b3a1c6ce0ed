//! The `umbmark` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    umbmark_cli::main(std::env::args_os())
}
