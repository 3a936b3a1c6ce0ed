//! `umbmark learn`: the whole loop, told as a story.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Experiment, Options, Verdict};
use umbmark_core::effect::Model;
use umbmark_core::evidence::Level;
use umbmark_core::learn::{Crossed, Learnt, Step, learn_from};
use umbmark_core::result;
use umbmark_core::solve::Solution;

use super::diagnose::{experiment_text, in_words};
use crate::Session;
use crate::answer::answer_text;
use crate::data_arguments::DataArguments;
use crate::model_report::{estimates_table, meaning_text, outliers_text, p_text, read_model, write_learnt};
use crate::prose::hanging;
use crate::setup_report::{disturbances_text, faults_text, reasons_text, remains_text, taken_text};
use crate::table::table;
use crate::test_arguments::TestArguments;
use crate::unlisted::{laws_text, missing_text};

/// Arguments of `learn`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// Begin with the effects of this model, beside E_d and E_b (on tracks E_s too), for example with your own formula
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    /// Write the model that was learnt
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Number of the law to add, from the table of laws, if no effect of the catalogue explains the repeating error
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = crate::numbers::whole_in::<u32>(1..=16))]
    law: u32,

    #[command(flatten)]
    test: TestArguments,

    /// Replace a file that exists
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load_to_test(session)?;
    let options = Options { law: arguments.law as usize, ..arguments.test.options(session) };
    let start = arguments.model.as_deref().map(|file| read_model(file, &data, session)).transpose()?;
    let start = match start {
        Some(start) => start,
        None => Model::new(data.nominal_robot()?),
    };
    let learnt = session.watched("% of the steps at most", |watch| learn_from(&data, &start, &options, watch))??;
    if learnt.partial {
        session.message("partial", "stopped before the search for missing effects ended");
    }
    let solution = session.on_threads(|| Solution::of(&data, learnt, &options))??;
    let learnt = &solution.learnt;
    let withheld = learnt.is_in_doubt() && !arguments.force;
    if let Some(file) = arguments.output.as_ref().filter(|_| !withheld) {
        write_learnt(&solution, file, arguments.force)?;
    }
    if session.json() {
        session.print_json(&result::Learnt::new(&solution, &options))?;
    } else {
        for warning in &data.warnings {
            session.message("warning", warning);
        }
        let told = told(&data, &solution, &options, session.on_terminal());
        write!(session.out(), "{told}")?;
    }
    match &arguments.output {
        Some(file) if withheld => anyhow::bail!(
            "{}: was not written, because the model does not explain the runs (see the reasons); --force writes it anyway",
            file.display()
        ),
        Some(file) if !session.json() => writeln!(session.out(), "\nwrote {}", file.display())?,
        _ => {}
    }
    Ok(ExitCode::SUCCESS)
}

/// The steps, what speaks for the model and against it, and the answer that it gives.
pub fn told(data: &Dataset, solution: &Solution, options: &Options, terminal: bool) -> String {
    let answer = answer_text(solution, 1.0 - options.size);
    format!("{}\n{answer}", text(data, &solution.learnt, options, terminal))
}

fn text(data: &Dataset, learnt: &Learnt, options: &Options, terminal: bool) -> String {
    let robot = data.robot.as_ref().map_or("", |robot| robot.name.as_str());
    let mut text = format!("Model learnt for {robot}\n\n");
    let by: Vec<String> = learnt.conditions.iter().map(|own| format!("by {} [mm]", own.names[0])).collect();
    let left = ["added", "p", "error [mm]", "left out [mm]"];
    let header: Vec<&str> = left.into_iter().chain(by.iter().map(String::as_str)).chain(["[deg]", "AICc"]).collect();
    text += &table(&header, learnt.steps.iter().map(|step| row(step, by.len())));
    text += "\n\n";
    let logs = || data.runs.iter().filter_map(|run| run.log.as_ref());
    let of = match learnt.diagnosis.level {
        Level::Ends => "end poses",
        Level::Tracks if logs().all(|log| log.headings_only) => {
            "all poses on the counted way along the measured headings"
        }
        Level::Tracks if logs().all(|log| log.relative) => "all measured steps",
        Level::Tracks => "all measured poses",
    };
    let legend = format!(
        "error: root mean square distance of {of} from the model's, in the fitted runs. left out: cross-validated error, of runs \
         that were used neither to choose effects nor to fit. {}AICc is not used for decisions.",
        by_conditions(learnt)
    );
    text += &hanging("", 0, &legend);
    text += "\n";
    let has_law = learnt.steps.iter().any(|step| step.law.is_some());
    let verdict = match learnt.verdict {
        Verdict::UnlistedEffect if has_law && learnt.diagnosis.dependence.is_none() => BY_A_LAW,
        verdict => in_words(verdict),
    };
    text += &hanging("verdict", 10, verdict);
    let diagnosis = &learnt.diagnosis;
    text += &(faults_text(&diagnosis.setup) + &reasons_text(&diagnosis.reasons) + &taken_text(&diagnosis.taken));
    for own in &learnt.conditions {
        for (effect, level) in &own.only {
            let said =
                format!("{effect} by the runs of {} {level} alone; on those of another it is not known", own.names[0]);
            text += &hanging("told", 10, &said);
        }
    }
    text += &learnt.untested().map_or_else(String::new, |others| hanging("untested", 10, &others));
    for step in learnt.steps.iter().filter(|s| s.class.len() > 1) {
        text += &hanging("class", 10, &format!("{} cannot be distinguished here", step.class.join(", ")));
    }
    let unsure = learnt.steps.iter().rev().find(|s| s.class.len() > 1);
    let tells = |e: &&Experiment| unsure.is_some_and(|s| e.separates.iter().all(|name| s.class.contains(name)));
    if let Some(experiment) = learnt.diagnosis.next_experiments.iter().find(tells) {
        text += &hanging("next", 10, &experiment_text(experiment));
    }
    for law in learnt.steps.iter().filter(|step| step.law.is_some()) {
        let told = diagnosis.next_experiments.iter().find(|experiment| Some(experiment.separates[0]) == law.added);
        text += &told.map_or_else(String::new, |told| hanging("next", 10, &experiment_text(told)));
    }
    text += &remains_text(diagnosis.remains.as_ref());
    text += &disturbances_text(&diagnosis.setup);
    text += &outliers_text(&diagnosis.outliers, &diagnosis.setup);
    for remark in &learnt.remarks {
        text += &hanging("note", 10, remark);
    }
    for step in &learnt.steps {
        text += &step.law.as_deref().map(laws_text).unwrap_or_default();
    }
    text += &missing_text(diagnosis, terminal);
    if !learnt.diagnosis.fitted.is_empty() {
        text += &format!("\n{}\n", estimates_table(&learnt.diagnosis.fitted, 1.0 - options.size));
        text += &meaning_text(&learnt.diagnosis.fitted, &learnt.model);
    }
    text
}

/// The verdict where what was missing was added as a law.
const BY_A_LAW: &str =
    "explained, by a law that the catalogue does not have (added as a formula); no test shows a further effect";

/// What the columns of conditions show, for the legend.
fn by_conditions(learnt: &Learnt) -> String {
    let of = |own: &Crossed| {
        let name = &own.names[0];
        format!("by {name}: the same of the runs of each {name}, by a model fitted to those of the others. ")
    };
    learnt.conditions.iter().map(of).collect()
}

fn row(step: &Step, conditions: usize) -> Vec<String> {
    let others = step.class.len().saturating_sub(1);
    let added = match step.added {
        None => "nominal robot".to_owned(),
        Some(effect) if others > 0 => format!("+ {effect} (or {others} alike)"),
        Some(effect) => format!("+ {effect}"),
    };
    let degrees = |heading: Option<f64>| heading.map_or("-".to_owned(), |h| format!("{:.2}", h.to_degrees()));
    let errors = [&step.error, &step.held_out].into_iter().chain(step.elsewhere.iter().take(conditions));
    let mut row = vec![added, step.p_adjusted.map_or("-".into(), p_text)];
    row.extend(errors.map(|error| format!("{:.1}", 1e3 * error.position)));
    row.push(degrees(step.held_out.heading));
    row.push(step.aicc.map_or("-".into(), |aicc| format!("{aicc:.1}")));
    row
}
