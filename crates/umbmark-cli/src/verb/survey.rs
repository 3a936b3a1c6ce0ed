//! `umbmark survey`: many robots of one kind, a row each, and how far they are apart.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::result;
use umbmark_core::survey::{Survey, survey};
use umbmark_io::{fleet_in, load};

use crate::Session;
use crate::model_report::p_text;
use crate::prose::hanging;
use crate::session::INTERRUPTED;
use crate::table::{table, with_precision_of};
use crate::test_arguments::TestArguments;

/// Rows that are printed; all of them stand in --json.
pub const MOST_ROWS: usize = 40;

/// Arguments of `survey`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The robots: a dataset folder or file each, or one folder of such folders
    #[arg(value_name = "ROBOTS", required = true)]
    places: Vec<PathBuf>,

    /// Only fit their numbers; do not ask whether these explain the runs
    #[arg(long)]
    no_diagnosis: bool,

    #[command(flatten)]
    test: TestArguments,

    /// Print every robot
    #[arg(long)]
    verbose: bool,

    /// Exit with code 3 if a robot stands out or could not be read
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let robots = fleet_in(&arguments.places)?;
    let options = arguments.test.options(session);
    let names: Vec<String> = robots.iter().map(|(name, _)| name.clone()).collect();
    let work = |place: usize| load(&robots[place].1);
    let found =
        session.watched("% of the robots", |watch| survey(&names, work, !arguments.no_diagnosis, &options, watch))?;
    if session.json() {
        session.print_json(&result::Survey::new(&found, &options))?;
    } else {
        write!(session.out(), "{}", told(&found, if arguments.verbose { usize::MAX } else { MOST_ROWS }))?;
    }
    if found.partial {
        session.message("partial", "stopped before all robots were asked");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let is_odd = found.outliers().next().is_some() || !found.failed.is_empty();
    Ok(if arguments.check && is_odd { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// How far the robots are apart, which stand out, and a row for each of at most so many.
pub fn told(found: &Survey, most: usize) -> String {
    let all = found.rows.len();
    let mut text = hanging("", 0, &sentence(found));
    for (robot, why) in &found.failed {
        text += &hanging("failed", 8, &format!("{robot}: {why}"));
    }
    if !found.among.is_empty() {
        let header = ["among robots", "robots", "mean", "sd between", "its interval", "error of one"];
        let row = |among: &umbmark_core::survey::Among| {
            let digits = among.error.max(among.deviation);
            let number = |value: f64| with_precision_of(value, digits);
            let high = among.deviation_interval.high;
            let high = if high.is_finite() { number(high) } else { "open".to_owned() };
            vec![
                among.number.parameter.to_owned(),
                among.robots.to_string(),
                number(among.mean),
                number(among.deviation),
                format!("{} to {high}", number(among.deviation_interval.low)),
                number(among.error),
            ]
        };
        text += &format!("\n{}\n", table(&header, found.among.iter().map(row)));
    }
    let rows: Vec<_> = found.rows.iter().take(most).collect();
    let parameters: Vec<&str> = found.among.iter().map(|among| among.number.parameter).collect();
    let header = [&["robot", "runs"], &parameters[..], &["E_max,sys [mm]", "verdict", "stands out"]].concat();
    let row = |row: &&umbmark_core::survey::Row| {
        let value = |parameter: &&str| {
            let own = row.numbers.iter().find(|own| own.parameter == *parameter);
            own.map_or("-".to_owned(), |own| with_precision_of(own.value, own.standard_error))
        };
        let out: Vec<String> =
            row.stands_out.iter().map(|(number, p)| format!("{} (p {})", number.parameter, p_text(*p))).collect();
        let verdict = match (row.verdict, row.missing.first()) {
            (None, _) => "-".to_owned(),
            (Some(_), Some(effect)) => format!("missing: {effect}"),
            (Some(verdict), None) => verdict.name().replace('_', " "),
        };
        [row.robot.clone(), row.runs.to_string()]
            .into_iter()
            .chain(parameters.iter().map(value))
            .chain([row.e_max_sys.map_or("-".to_owned(), |e| format!("{:.1}", 1e3 * e)), verdict, out.join(", ")])
            .collect::<Vec<String>>()
    };
    text += &format!("\n{}\n", table(&header, rows.iter().map(row)));
    if all > rows.len() {
        text += &format!("... and {} more\n", all - rows.len());
    }
    text
}

fn sentence(found: &Survey) -> String {
    let robots = umbmark_core::prose::counted(found.rows.len(), "robot");
    let out: Vec<&str> = found.outliers().map(|row| row.robot.as_str()).collect();
    let doubted = found.unexplained().count();
    let diagnosed = found.rows.iter().any(|row| row.verdict.is_some());
    let mut said = vec![match out.as_slice() {
        [] => format!("Of {robots}, none stands out from the others."),
        names => format!(
            "Of {robots}, {} out from the others: {}.",
            if names.len() == 1 { "one stands".into() } else { format!("{} stand", names.len()) },
            names.join(", ")
        ),
    }];
    if diagnosed {
        let by_chance = 100.0 * found.size;
        said.push(format!(
            "The runs of {doubted} are not explained by their numbers; chance alone makes that {by_chance:.0} % of good robots."
        ));
    }
    if !found.failed.is_empty() {
        said.push(format!("Nothing was found of {}.", umbmark_core::prose::counted(found.failed.len(), "robot")));
    }
    said.join(" ")
}
