//! `umbmark diagnose`: which class of effects a model is missing.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::{Map, Value, json};
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{
    Detectable, Diagnosis, Experiment, Identifiability, Level, Options, Suspect, Unseen, Verdict, Why, diagnose,
};
use umbmark_core::drive::Robot;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{
    circle_table, contrasts_table, estimates_json, estimates_table, finite, meaning_json, meaning_text, model_json,
    model_of, outliers_json, outliers_text, p_text, square_json, unit_of,
};
use crate::prose::hanging;
use crate::table::{table, with_precision_of};
use crate::test_arguments::TestArguments;
use crate::unlisted::{unlisted_json, unlisted_text};

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
        session.print_json(&document(&diagnosis, &options))?;
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

pub(super) fn document(diagnosis: &Diagnosis, options: &Options) -> Value {
    let level = match diagnosis.level {
        Level::Ends => "end_poses",
        Level::Tracks => "tracks",
    };
    let gof = diagnosis.goodness_of_fit.iter().map(
        |g| json!({ "name": g.name, "statistic": g.statistic, "degrees_of_freedom": g.degrees_of_freedom, "p": g.p }),
    );
    let mut document = json!({
        "verdict": diagnosis.verdict.name(),
        "observed": level,
        "fitted": estimates_json(&diagnosis.fitted, 1.0 - options.size),
        "goodness_of_fit": gof.collect::<Vec<_>>(),
        "ranking": diagnosis.ranking.iter().map(|s| suspect_json(s, diagnosis.model.robot())).collect::<Vec<_>>(),
        "certified": diagnosis.certified,
        "invisible": diagnosis.invisible.iter().map(|u| u.effect).collect::<Vec<_>>(),
        "absorbed": absorbed_json(&diagnosis.invisible),
        "minimum_detectable": detectable_json(&diagnosis.minimum_detectable),
        "minimum_detectable_sizes": diagnosis.minimum_detectable.iter().map(|d| {
            json!({ "effect": d.effect, "parameter": d.parameter, "size": finite(d.size) })
        }).collect::<Vec<_>>(),
        "next_experiments": experiments_json(&diagnosis.next_experiments),
        "identifiability": identifiability_json(&diagnosis.identifiability),
        "unlisted": unlisted_json(diagnosis.dependence.as_ref()),
        "model": model_json(&diagnosis.model),
        "meaning": meaning_json(&diagnosis.fitted, &diagnosis.model),
        "outliers": outliers_json(&diagnosis.outliers),
        "remarks": diagnosis.remarks,
        "size": options.size,
        "draws": options.draws,
        "seed": options.seed,
        "version": umbmark_core::VERSION,
    });
    if let Some(map) = document.as_object_mut() {
        map.extend(square_json(&diagnosis.contrasts, &diagnosis.circle));
    }
    document
}

pub(super) fn experiments_json(experiments: &[Experiment]) -> Value {
    let one = |e: &Experiment| json!({ "separates": e.separates, "experiment": e.experiment, "minutes": e.minutes, "sd": e.sd });
    json!(experiments.iter().map(one).collect::<Vec<_>>())
}

fn suspect_json(suspect: &Suspect, robot: &Robot) -> Value {
    let of = |value: &dyn Fn(&umbmark_core::diagnose::Estimate) -> f64| {
        let pairs = suspect.estimate.iter().map(|e| (e.parameter.to_owned(), finite(value(e))));
        Value::Object(Map::from_iter(pairs))
    };
    json!({
        "class": suspect.class,
        "best": suspect.best,
        "f": suspect.f,
        "degrees_of_freedom": suspect.degrees_of_freedom,
        "p": suspect.p,
        "p_adjusted": suspect.p_adjusted,
        "p_flips": suspect.p_flips,
        "estimate": of(&|e| e.value),
        "standard_error": of(&|e| e.standard_error),
        "expected_drop": suspect.expected_drop,
        "meaning": suspect.meaning(robot),
    })
}

fn absorbed_json(unseen: &[Unseen]) -> Value {
    let pairs = unseen.iter().filter_map(|u| match &u.why {
        Why::Absorbed(by) => Some((u.effect.to_owned(), json!(by))),
        Why::BelowNoise => None,
    });
    Value::Object(Map::from_iter(pairs))
}

/// For each effect, the largest of its sizes' least.
fn detectable_json(detectable: &[Detectable]) -> Value {
    let mut sizes: Map<String, Value> = Map::new();
    for d in detectable {
        let before = sizes.get(d.effect).and_then(Value::as_f64).unwrap_or(0.0);
        sizes.insert(d.effect.to_owned(), finite(d.size.max(before)));
    }
    Value::Object(sizes)
}

fn identifiability_json(identifiability: &Identifiability) -> Value {
    let parameters = identifiability.shares.iter().map(|s| {
        json!({
            "effect": s.effect,
            "parameter": s.parameter,
            "position_m_per_unit": s.position,
            "heading_rad_per_unit": s.heading,
        })
    });
    let hidden = identifiability.hidden.iter().map(|h| {
        let weights = h.weights.iter().map(|(name, w)| ((*name).to_owned(), json!(w)));
        json!({ "weights": Map::from_iter(weights), "ratio": h.ratio })
    });
    json!({
        "parameters": parameters.collect::<Vec<_>>(),
        "rank": identifiability.rank,
        "hidden": hidden.collect::<Vec<_>>(),
    })
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
