//! `umbmark diagnose`: which class of effects a model is missing.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Diagnosis, Experiment, Identifiability, Level, Options, Suspect, Verdict, Why, diagnose};
use umbmark_core::document;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{
    circle_table, contrasts_table, estimates_table, meaning_text, model_of, outliers_text, p_text, unit_of,
};
use crate::prose::hanging;
use crate::table::{table, with_precision_of};
use crate::test_arguments::TestArguments;
use crate::unlisted::unlisted_text;

/// So many experiments are printed; --json has all.
const EXPERIMENTS: usize = 6;

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// The model to question; its free effects are fitted [default: E_d and E_b, on tracks E_s too]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    #[command(flatten)]
    test: TestArguments,

    /// Exit with code 3 if something is missing
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load()?;
    let model = model_of(arguments.model.as_deref(), &data)?;
    let options = arguments.test.options(session);
    let diagnosis = session.on_threads(|| diagnose(&data, &model, &options))??;
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    if session.json() {
        session.print_json(&document::diagnosis(&diagnosis, &options))?;
    } else {
        let text = text(&data, &diagnosis, &options, session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    let missing = !matches!(diagnosis.verdict, Verdict::Explained | Verdict::NotEnoughData);
    Ok(if arguments.check && missing { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

/// A verdict in a sentence.
pub(super) fn in_words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Explained => "no sign of a further effect",
        Verdict::MissingEffect => "one class of effects is missing",
        Verdict::SeveralMissing => "more than one class of effects is missing",
        Verdict::UnlistedEffect => "something is missing that no single effect of the catalogue explains",
        Verdict::NotEnoughData => "not enough data to tell",
    }
}

fn text(data: &Dataset, diagnosis: &Diagnosis, options: &Options, terminal: bool) -> String {
    let robot = data.robot.as_ref().map_or("", |robot| robot.name.as_str());
    let from = match diagnosis.level {
        Level::Ends => "return poses",
        Level::Tracks => "tracks",
    };
    let mut text = format!("Diagnosis of {robot} from {from}\n\n");
    text += &hanging("verdict", 10, in_words(diagnosis.verdict));
    for suspect in diagnosis.certified() {
        text += &hanging("missing", 10, &suspect.class.join(" or "));
        let said = suspect.meaning(diagnosis.model.robot());
        text += &said.map_or_else(String::new, |said| hanging("", 10, &said));
    }
    text += &outliers_text(&diagnosis.outliers);
    for remark in &diagnosis.remarks {
        text += &hanging("note", 10, remark);
    }
    text += &unlisted_text(diagnosis.dependence.as_ref(), terminal);
    if !diagnosis.fitted.is_empty() {
        text += &format!("\n{}\n", estimates_table(&diagnosis.fitted, 1.0 - options.size));
        text += &meaning_text(&diagnosis.fitted, &diagnosis.model);
    }
    text += &identifiability_text(&diagnosis.identifiability);
    for gof in &diagnosis.goodness_of_fit {
        let freedom = gof.degrees_of_freedom.map(|[a, b]| format!("F({a}, {b}) = ")).unwrap_or_default();
        text += &format!("\nwhole model: {}, {freedom}{:.2}, p = {}\n", gof.name, gof.statistic, p_text(gof.p));
    }
    if !diagnosis.contrasts.is_empty() {
        text += &format!("\n{}\n", contrasts_table(&diagnosis.contrasts));
    }
    if !diagnosis.circle.is_empty() {
        text += &format!("\n{}\n", circle_table(&diagnosis.circle));
    }
    text += &ranking_text(&diagnosis.ranking);
    text += &unseen_text(diagnosis);
    text += &experiments_text(&diagnosis.next_experiments);
    text
}

fn identifiability_text(identifiability: &Identifiability) -> String {
    if identifiability.hidden.is_empty() {
        return String::new();
    }
    let row = |s: &umbmark_core::diagnose::Share| {
        let percent = |value: f64, scale: f64| format!("{:.2}", 0.01 * scale * value);
        vec![s.parameter.to_owned(), percent(s.position, 1e3), percent(s.heading, 1f64.to_degrees())]
    };
    let header = ["1 % of", "moves the end [mm]", "turns it [deg]"];
    let mut text = format!("\n{}\n", table(&header, identifiability.shares.iter().map(row)));
    for hidden in &identifiability.hidden {
        let names: Vec<&str> = hidden.weights.iter().map(|(name, _)| *name).collect();
        let said = match hidden.ratio {
            Some(ratio) => format!("{} does what {ratio:.2} times as much {} does", names[0], names[1]),
            None => format!("{} shows nowhere", names.join(" with ")),
        };
        text += &hanging("hidden", 10, &format!("rank {}: {said}", identifiability.rank));
    }
    text
}

fn ranking_text(ranking: &[Suspect]) -> String {
    if ranking.is_empty() {
        return String::new();
    }
    let row = |(i, s): (usize, &Suspect)| {
        let e = &s.estimate[0];
        let error = with_precision_of(e.standard_error, e.standard_error);
        let unit = unit_of(e.effect, e.parameter);
        vec![
            format!("{}", i + 1),
            format!("{} ± {error}{unit}", with_precision_of(e.value, e.standard_error)),
            format!("{:.1}", s.f),
            p_text(s.p),
            p_text(s.p_adjusted),
            s.p_flips.map_or("-".into(), p_text),
        ]
    };
    let mut text = String::from("\nasked, the likeliest first (p of all: among all that were asked)\n\n");
    text += &table(&["", "size", "F", "p", "p of all", "p of signs"], ranking.iter().enumerate().map(row));
    text += "\n\n";
    for (i, suspect) in ranking.iter().enumerate() {
        let others: Vec<&str> = suspect.class.iter().copied().filter(|name| *name != suspect.best).collect();
        let alike = if others.is_empty() { String::new() } else { format!("; or {}", others.join(", ")) };
        let what = format!("{} of {}{alike}", suspect.estimate[0].parameter, suspect.best);
        text += &hanging(&format!("{}", i + 1), 4, &what);
    }
    text
}

fn unseen_text(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    if !diagnosis.minimum_detectable.is_empty() {
        text += "\nthis test would have shown, in four cases of five\n";
        for d in &diagnosis.minimum_detectable {
            let size = format!("{} of {} above", d.parameter, d.effect);
            text += &format!("  {size:<44} {:.2e}{}\n", d.size, unit_of(d.effect, d.parameter));
        }
    }
    if diagnosis.invisible.is_empty() {
        return text;
    }
    text += "\nit cannot show\n";
    let mut absorbers: Vec<Vec<&str>> = Vec::new();
    for unseen in &diagnosis.invisible {
        if let Why::Absorbed(by) = &unseen.why
            && !absorbers.contains(by)
        {
            absorbers.push(by.clone());
        }
    }
    let named = |why: &dyn Fn(&Why) -> bool| {
        let names = diagnosis.invisible.iter().filter(|u| why(&u.why)).map(|u| u.effect);
        names.collect::<Vec<_>>().join(", ")
    };
    for by in &absorbers {
        let names = named(&|why| matches!(why, Why::Absorbed(own) if own == by));
        text += &hanging("", 2, &format!("what {} does as well: {names}", by.join(" with ")));
    }
    let below = named(&|why| *why == Why::BelowNoise);
    if !below.is_empty() {
        text += &hanging("", 2, &format!("what is below the scatter at its usual size: {below}"));
    }
    text
}

fn experiments_text(experiments: &[Experiment]) -> String {
    if experiments.is_empty() {
        return String::new();
    }
    let mut text = String::from("\nwhat to measure next, the most telling per minute first\n");
    for e in experiments.iter().take(EXPERIMENTS) {
        text += &hanging("", 2, &experiment_text(e));
    }
    if let rest @ 1.. = experiments.len().saturating_sub(EXPERIMENTS) {
        text += &hanging("", 2, &format!("and {rest} more (--json)"));
    }
    text
}

/// An experiment with what it tells, in a line.
pub(super) fn experiment_text(e: &Experiment) -> String {
    let what = format!("tells {} from {}: {:.1} sd in {:.0} min", e.separates[0], e.separates[1], e.sd, e.minutes);
    format!("{}; {what}", e.experiment)
}
