//! `umbmark watch`: whether a robot that is tested again and again changes.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::drift::{Arrived, Kind, Record, Restart, Watched};
use umbmark_core::result;
use umbmark_io::WatchState;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::numbers::{probability, whole_in};
use crate::prose::hanging;
use crate::table::table;

/// Arguments of `watch`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// File in which the runs are kept until the next call; it is made if it does not exist
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,

    /// Probability of a false alarm in a month [default: that of the state, or 0.01]
    #[arg(long, value_name = "P", value_parser = probability)]
    false_alarms: Option<f64>,

    /// Runs in a month [default: that of the state, or 60]
    #[arg(long, value_name = "N", value_parser = whole_in::<u32>(1..=100_000))]
    runs_per_month: Option<u32>,

    /// Begin the baseline anew with this run, or "now": with the next new run
    #[arg(long, value_name = "RUN")]
    restart: Option<String>,

    /// Exit with code 3 if the robot changed, or if there is no new run but some that cannot be watched
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let mut state = arguments.state.as_deref().map(WatchState::open).transpose()?;
    let data = arguments.data.load(session)?;
    let known = state.as_ref().and_then(WatchState::record).cloned();
    let mut record = Record::resumed(known, &data, arguments.false_alarms, arguments.runs_per_month)?;
    let arrived = record.add(&data)?;
    if let Some(run) = arguments.restart {
        record.restart(&if run == "now" { Restart::Now } else { Restart::At(run) })?;
    }
    let (robot, seed) = (data.nominal_robot()?, session.seed());
    let watched = session.on_threads(|| Watched::of(&record, robot, data.path.as_ref(), seed))?;
    if let Some(state) = &mut state {
        state.keep(&record)?;
    }
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    if session.json() {
        session.print_json(&result::Watched::new(&watched, &arrived))?;
    } else {
        let verbose = session.verbose();
        write!(session.out(), "{}", told(&watched, &arrived, verbose))?;
    }
    let is_unwatched = arrived.new == 0 && !arrived.left_out.is_empty();
    let is_accused = arguments.check && (watched.change.is_some() || is_unwatched);
    Ok(if is_accused { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// The sentence and, where they are wanted, the runs.
pub fn told(watched: &Watched, arrived: &Arrived, verbose: bool) -> String {
    let mut text = hanging("", 0, &watched.sentence(arrived));
    if verbose {
        let header = ["run", "used", "p", "numbers", "limit", "place", "limit", "scatter", "limit"];
        let rows = watched.runs.iter().enumerate().map(|(place, run)| {
            let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.1}"));
            let height = |kind: Kind| number(run.heights.map(|all| all[kind as usize]));
            let limit = |kind: Kind| number(run.limits.map(|all| all[kind as usize]));
            let used = if watched.outlying.contains(&place) { "outlying" } else { run.used.name() };
            let p = run.p.map_or(String::new(), |p| format!("{p:.3}"));
            let own = [run.name.clone(), used.replace('_', " "), p];
            own.into_iter().chain(Kind::ALL.into_iter().flat_map(|kind| [height(kind), limit(kind)])).collect()
        });
        text += &format!("\n{}\n", table(&header, rows));
    }
    text
}
