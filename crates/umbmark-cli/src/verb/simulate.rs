//! `umbmark simulate`: one test, written as a dataset.

use std::io::Write;
use std::process::ExitCode;

use serde_json::json;
use umbmark_core::effect::TestKind;
use umbmark_core::monte_carlo::draw_parameters;
use umbmark_core::prose::counted;
use umbmark_core::result::SimulatedRun;
use umbmark_core::simulate::{is_extended, record_test};

use crate::Session;
use crate::output_arguments::{OutputArguments, layouts};
use crate::setup::{Directions, Setup, SetupFlags};
use crate::table::table;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
#[command(after_help = layouts())]
pub struct Arguments {
    #[command(flatten)]
    output: OutputArguments,

    /// Runs in each direction [default: 5, and 1 for NAME.mcap]
    #[arg(long, value_name = "N", value_parser = crate::numbers::whole_in::<u32>(1..=10_000))]
    runs: Option<u32>,

    /// Rate at which the absolute pose is measured on the way; 0 for the end pose alone
    #[arg(long, default_value_t = 20.0, value_name = "HZ", value_parser = crate::numbers::number)]
    reference_rate: f64,

    #[command(flatten)]
    setup: SetupFlags,
}

impl Arguments {
    /// Whether one log is to be written, and no folder.
    fn is_log(&self) -> bool {
        self.output.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"))
    }

    /// Numbers of runs \[cw, ccw\]; a log holds one, counter-clockwise where nothing else is said.
    fn numbers(&self) -> anyhow::Result<[usize; 2]> {
        let direction = self.setup.direction;
        if !self.is_log() {
            return Ok(direction.runs(self.runs.unwrap_or(5) as usize));
        }
        if let Some(runs @ 2..) = self.runs {
            anyhow::bail!("an MCAP log holds one run, got --runs {runs}; remove it, or give a folder");
        }
        let direction = if direction == Directions::Both { Directions::Ccw } else { direction };
        Ok(direction.runs(1))
    }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let Setup { path, model, draws, assumed, .. } = arguments.setup.resolve()?;
    let model = draw_parameters(&model, &draws, session.seed(), 0)?;
    let tests = match (is_extended(&model), arguments.is_log()) {
        (true, false) => &[TestKind::Systematic, TestKind::Bumps][..],
        (true, true) => &[TestKind::Bumps],
        (false, _) => &[TestKind::Systematic],
    };
    let dataset =
        record_test(&model, &path, tests, arguments.numbers()?, arguments.reference_rate, [session.seed(), 0])?;
    let lost = arguments.output.write(&dataset)?;
    let kind = model.robot().drive.kind();
    if !kind.has_tick_logs() {
        let name = kind.name();
        session
            .message("note", &format!("a robot with drive = \"{name}\" has no tick logs: only returns were written"));
    }
    for text in &assumed {
        session.message("assumed", text);
    }
    for text in &lost {
        session.message("lost", text);
    }
    if session.json() {
        let runs: Vec<SimulatedRun> = dataset.runs.iter().map(SimulatedRun::from).collect();
        session.print_json(&json!({
            "output": arguments.output.output.display().to_string(),
            "layout": arguments.output.layout().name,
            "lost": lost,
            "seed": session.seed(),
            "runs": runs,
            "version": umbmark_core::VERSION,
        }))?;
        return Ok(ExitCode::SUCCESS);
    }
    let rows = dataset.runs.iter().filter_map(|run| {
        let error = run.returned?;
        let heading = error.heading.map_or("-".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        Some(vec![run.name.clone(), format!("{:.1}", error.x * 1e3), format!("{:.1}", error.y * 1e3), heading])
    });
    let text = table(&["run", "ex [mm]", "ey [mm]", "etheta [deg]"], rows);
    let count = dataset.runs.len();
    let place = arguments.output.output.display();
    writeln!(session.out(), "{text}\n")?;
    let seed = session.seed();
    writeln!(session.out(), "{} of {} in {place}, seed {seed}", counted(count, "run"), model.robot().name)?;
    Ok(ExitCode::SUCCESS)
}
