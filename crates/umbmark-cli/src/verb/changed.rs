//! `umbmark changed`: what changed of a robot between two tests.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::changed::{Changed, Moved, Of, changed};
use umbmark_core::effect::Model;
use umbmark_core::result;

use crate::Session;
use crate::data_arguments::TopicArguments;
use crate::model_report::{p_text, read_model};
use crate::prose::hanging;
use crate::table::{table, with_precision_of};
use crate::test_arguments::TestArguments;

/// Arguments of `changed`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The first test: a dataset folder, an OptiOdom folder, or one file of either
    #[arg(value_name = "BEFORE")]
    before: PathBuf,

    /// The second test of the same robot
    #[arg(value_name = "AFTER")]
    after: PathBuf,

    /// A model whose effects are fitted to both tests [default: what either shows by itself]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    #[command(flatten)]
    test: TestArguments,

    #[command(flatten)]
    topics: TopicArguments,

    /// Exit with code 3 if something of the robot changed, or if only the test before is explained
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let before = arguments.topics.load_to_test(&arguments.before, session)?;
    let after = arguments.topics.load_to_test(&arguments.after, session)?;
    let options = arguments.test.options(session);
    let start = match &arguments.model {
        Some(file) => read_model(file, &before, session)?,
        None => Model::new(before.nominal_robot()?),
    };
    let found =
        session.watched("% of the steps at most", |watch| changed(&before, &after, &start, &options, watch))??;
    for warning in before.warnings.iter().chain(&after.warnings).filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    if session.json() {
        session.print_json(&result::Changed::new(&found, &options))?;
    } else {
        write!(session.out(), "{}", told(&found))?;
    }
    Ok(if arguments.check && !found.is_as_before() { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// The sentence, and the tables of all numbers.
pub fn told(found: &Changed) -> String {
    let mut text = hanging("", 0, &found.sentence());
    let header = ["", "before", "after", "change", &format!("{:.0} %", 100.0 * (1.0 - found.size)), "p"];
    let title = |name: &'static str| [&[name], &header[1..]].concat();
    text += &format!("\n{}\n", table(&title("the robot"), found.robot.iter().map(row)));
    if !found.reference.is_empty() {
        text += &format!("\n{}\n", table(&title("the reference"), found.reference.iter().map(row)));
    }
    text
}

fn row(moved: &Moved) -> Vec<String> {
    let key = &moved.quantity.key;
    let length = key.ends_with("_m") && !key.ends_with("_per_m") || moved.quantity.of == Of::Scatter;
    let (name, scale) = match length {
        true => (format!("{} [mm]", key.strip_suffix("_m").unwrap_or(key)), 1e3),
        false => (key.clone(), 1.0),
    };
    let half = 0.5 * (moved.interval.high - moved.interval.low);
    let number = |value: f64, error: f64| with_precision_of(scale * value, scale * error);
    let (error, change, interval) = match moved.quantity.of {
        Of::Scatter => {
            let ends = format!("{:.2} to {:.2}", moved.interval.low, moved.interval.high);
            (0.1 * moved.before.value, format!("times {:.2}", moved.change), ends)
        }
        _ => (half, number(moved.change, half), format!("± {}", number(half, half))),
    };
    vec![
        name.replace('_', " "),
        number(moved.before.value, error),
        number(moved.after.value, error),
        change,
        interval,
        p_text(moved.p_adjusted),
    ]
}
