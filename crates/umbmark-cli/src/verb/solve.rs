//! `umbmark solve`: one answer, from data to the numbers on the robot.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::diagnose::Verdict;
use umbmark_core::effect::Model;
use umbmark_core::result;
use umbmark_core::solve::{Solution, solve};

use crate::Session;
use crate::answer::{answer_text, parts_text};
use crate::data_arguments::DataArguments;
use crate::model_report::{estimates_table, meaning_text, write_learnt};
use crate::setup_report::{disturbances_text, faults_text, reasons_text, remains_text, taken_text};
use crate::test_arguments::TestArguments;
use crate::words::ACTIONS;

/// Arguments of `solve`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// Write the model that the answer rests on
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Exit with code 3 if the robot has an error that the model does not explain
    #[arg(long)]
    check: bool,

    #[command(flatten)]
    test: TestArguments,

    /// Replace a file that exists, and write the model even if it does not explain the runs
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load_to_test(session)?;
    let options = arguments.test.options(session);
    let start = Model::new(data.nominal_robot()?);
    let solution = session.watched("% of the steps at most", |watch| solve(&data, &start, &options, watch))??;
    if solution.learnt.partial {
        session.message("partial", "stopped before the search for missing effects ended");
    }
    let withheld = solution.learnt.is_in_doubt() && !arguments.force;
    if let Some(file) = arguments.output.as_ref().filter(|_| !withheld) {
        write_learnt(&solution, file, arguments.force)?;
    }
    if session.json() {
        session.print_json(&result::Solution::new(&solution, &options, ACTIONS))?;
    } else {
        for warning in &data.warnings {
            session.message("warning", warning);
        }
        let mut text = answer_text(&solution, 1.0 - options.size);
        if session.verbose() {
            text += &details(&solution, 1.0 - options.size);
        }
        write!(session.out(), "{text}")?;
    }
    match &arguments.output {
        Some(file) if withheld => anyhow::bail!(
            "{}: was not written, because the model does not explain the runs; --force writes it anyway",
            file.display()
        ),
        Some(file) if !session.json() => writeln!(session.out(), "\nwrote {}", file.display())?,
        _ => {}
    }
    Ok(match solution.learnt.verdict {
        _ if !arguments.check => ExitCode::SUCCESS,
        // Runs that test nothing are no reason to pass.
        Verdict::NotEnoughData => ExitCode::FAILURE,
        _ if solution.misses_something() => ExitCode::from(3),
        _ => ExitCode::SUCCESS,
    })
}

/// The model, what it leaves, and what was found of the data.
fn details(solution: &Solution, level: f64) -> String {
    let (learnt, diagnosis) = (&solution.learnt, &solution.learnt.diagnosis);
    let mut text = parts_text(solution);
    text += "\n";
    text += &(faults_text(&diagnosis.setup) + &reasons_text(&diagnosis.reasons) + &taken_text(&diagnosis.taken));
    text += &(remains_text(diagnosis.remains.as_ref()) + &disturbances_text(&diagnosis.setup));
    if !diagnosis.fitted.is_empty() {
        text += &format!("\n{}\n", estimates_table(&diagnosis.fitted, level));
        text += &meaning_text(&diagnosis.fitted, &learnt.model);
    }
    text
}
