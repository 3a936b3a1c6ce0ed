//! `umbmark conditions`: which numbers of a robot depend on session, floor, load or temperature.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use umbmark_core::conditions::{Asked, Conditions, Estimate, Kind, conditions};
use umbmark_core::result;
use umbmark_core::watch::Watch;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{model_of, p_text};
use crate::prose::hanging;
use crate::table::{table, with_precision_of};

/// Arguments of `conditions`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// A model whose free effects are asked for [default: E_d, E_b and, of tracks, E_s]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    /// Use return poses alone, even if the runs were tracked
    #[arg(long)]
    return_poses: bool,

    /// False-alarm rate: probability that something is said to differ of a robot that is the same everywhere
    #[arg(long, default_value_t = 0.05, value_name = "P", value_parser = crate::numbers::probability)]
    size: f64,

    /// Exit with code 3 if a number depends on a condition
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load_to_test(session)?;
    let model = model_of(arguments.model.as_deref(), &data, session)?;
    let options = umbmark_core::diagnose::Options {
        size: arguments.size,
        ends_only: arguments.return_poses,
        ..umbmark_core::diagnose::Options::default()
    };
    let stop = AtomicBool::new(false);
    let found = session
        .told("% of the runs", |progress| conditions(&data, &model, &options, &Watch::new(&stop, progress)))??;
    if session.json() {
        session.print_json(&result::Conditions::new(&found))?;
    } else {
        for warning in &data.warnings {
            session.message("warning", warning);
        }
        write!(session.out(), "{}", told(&found))?;
    }
    Ok(if arguments.check && found.differs() { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// The sentence, what has to be known of it, and a table for each condition.
pub fn told(found: &Conditions) -> String {
    let mut text = hanging("", 0, &found.sentence());
    found.remarks().iter().for_each(|remark| text += &hanging("note", 6, remark));
    for (place, of) in found.conditions.iter().enumerate() {
        let asked: Vec<&Asked> = found.asked.iter().filter(|asked| asked.condition == place).collect();
        let name = of.condition.names.join(", ");
        let drawn = match &of.condition.kind {
            Kind::Levels(levels) => {
                let runs = |(level, runs): (&String, &usize)| (level.clone(), *runs);
                of_levels(&name, levels.iter().zip(&of.runs).map(runs).collect(), &asked)
            }
            Kind::Amount(_) => of_amount(&name, &asked, found.size),
        };
        text += &format!("\n{drawn}\n");
    }
    text
}

/// A row for each level, with the numbers side by side.
fn of_levels(name: &str, levels: Vec<(String, usize)>, asked: &[&Asked]) -> String {
    let titles: Vec<&str> = asked.iter().map(|asked| asked.number.parameter).collect();
    let header = [&[name, "runs"], &titles[..]].concat();
    let row = |(level, runs): (String, usize)| {
        let value = |asked: &&Asked| {
            let own = asked.levels.iter().find(|at| at.level == level).map(|at| &at.own);
            own.map_or("-".to_owned(), with_half)
        };
        [level.clone(), runs.to_string()].into_iter().chain(asked.iter().map(value)).collect()
    };
    let of_all = |title: &str, value: &dyn Fn(&Asked) -> String| {
        [title.to_owned(), String::new()].into_iter().chain(asked.iter().map(|asked| value(asked))).collect::<Vec<_>>()
    };
    let between = |asked: &Asked| {
        let between = asked.between.as_ref().map(|between| between.deviation);
        between.map_or("-".to_owned(), |deviation| with_precision_of(deviation, asked.seen))
    };
    let rows: Vec<Vec<String>> = levels
        .into_iter()
        .map(row)
        .chain([of_all("sd between", &between), of_all("p", &|asked| p_text(asked.p_adjusted))])
        .collect();
    table(&header, rows)
}

/// A row for each number.
fn of_amount(name: &str, asked: &[&Asked], size: f64) -> String {
    let interval = format!("{:.0} %", 100.0 * (1.0 - size));
    let header = [name, "by each unit", &interval, "p"];
    let row = |asked: &&Asked| {
        let Some(slope) = &asked.slope else { return vec![asked.number.parameter.to_owned()] };
        let half = slope.interval.high - slope.value;
        let number = |value: f64| with_precision_of(value, half);
        let width = format!("± {}", number(half));
        vec![asked.number.parameter.to_owned(), number(slope.value), width, p_text(asked.p_adjusted)]
    };
    table(&header, asked.iter().map(row))
}

fn with_half(own: &Estimate) -> String {
    let half = own.interval.high - own.value;
    format!("{} ± {}", with_precision_of(own.value, half), with_precision_of(half, half))
}
