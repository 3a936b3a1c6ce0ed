//! `umbmark open`: the workbench in the browser.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_web::{Served, Workbench};

use crate::Session;
use crate::data_arguments::TopicArguments;
use crate::test_arguments::TestArguments;
use crate::words::ACTIONS;

/// Where files go that are dropped on the page.
const DROPS: &str = "umbmark_open";

/// Arguments of `open`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A dataset folder or file to begin with; without it, drop files on the page, or type returns into its table
    data: Option<PathBuf>,

    /// The port on 127.0.0.1; 0 takes any that is free
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = crate::numbers::whole_in::<u16>(0..=65_535))]
    port: u16,

    /// Print the address, and open no browser
    #[arg(long)]
    no_browser: bool,

    /// The folder into which files are written that are dropped on the page, or typed there
    #[arg(long, default_value = DROPS, value_name = "FOLDER")]
    drops: PathBuf,

    #[command(flatten)]
    topics: TopicArguments,

    #[command(flatten)]
    test: TestArguments,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    if let Some(place) = &arguments.data {
        session.needs(umbmark_io::memory_to_read(place))?;
    }
    let served = Served {
        place: arguments.data,
        topics: arguments.topics.topics(),
        drops: arguments.drops,
        options: arguments.test.options(session),
        port: arguments.port,
        threads: session.threads(),
        actions: ACTIONS,
    };
    let workbench = Workbench::open(served)?;
    let address = workbench.address();
    if session.json() {
        session.print_json(&serde_json::json!({ "address": address, "version": umbmark_core::VERSION }))?;
    } else {
        writeln!(session.out(), "{address}")?;
    }
    session.flush()?;
    session.message("note", "the page is for this machine only, and for whoever has its address; Ctrl-C ends it");
    if !arguments.no_browser
        && let Err(error) = open::that_detached(&address)
    {
        session.message("note", &format!("no browser could be opened ({error}); open the address yourself"));
    }
    let stop = session.catch_interrupt();
    workbench.serve(&stop)?;
    Ok(ExitCode::SUCCESS)
}
