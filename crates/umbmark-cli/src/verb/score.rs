//! `umbmark score`: Eqs. 1 to 6 on measured runs.

use std::io::Write;
use std::process::ExitCode;

use umbmark_core::dataset::Dataset;
use umbmark_core::result;
use umbmark_core::score::{Cluster, Convention, Score, score_dataset};
use umbmark_core::stats::Interval;
use umbmark_plot::kind::of_score;
use umbmark_plot::render::terminal::{Look, plan};

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::level_argument::LevelArgument;
use crate::table::table;

/// Characters of the figure, across and down.
const WIDE: usize = 64;
const HIGH: usize = 24;

/// How Eq. 5 combines both directions.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum ConventionKind {
    /// Mean of both directions: half of Eq. 5, as in Table II of the paper
    Mean,
    /// Sum of both directions: Eq. 5 as printed
    Sum,
}

/// Arguments of `score`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    #[command(flatten)]
    intervals: LevelArgument,

    /// How the extended test combines both directions
    #[arg(long, value_enum, default_value_t = ConventionKind::Mean, value_name = "HOW")]
    convention: ConventionKind,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load(session)?;
    let mut score = score_dataset(&data, arguments.intervals.level)?;
    let noticed = score.setup.notices().len();
    score.warnings.splice(noticed..noticed, data.warnings.iter().cloned());
    let convention = match arguments.convention {
        ConventionKind::Mean => Convention::Mean,
        ConventionKind::Sum => Convention::Sum,
    };
    if session.json() {
        session.print_json(&result::Score::new(&score, convention))?;
        return Ok(ExitCode::SUCCESS);
    }
    for warning in &score.warnings {
        session.message("warning", warning);
    }
    let look = session.look();
    write!(session.out(), "{}", told(Some(&data), &score, convention, look))?;
    Ok(ExitCode::SUCCESS)
}

/// The scores, and, where the runs are known, their return errors drawn.
pub fn told(data: Option<&Dataset>, score: &Score, convention: Convention, look: Look) -> String {
    let mut told = text(score, convention);
    if let Some(data) = data {
        told += "\n";
        let figure = of_score(data, score, [None, None]);
        figure.panels.iter().for_each(|panel| told += &plan(panel, look, WIDE, HIGH));
    }
    told
}

fn text(score: &Score, convention: Convention) -> String {
    let summary = &score.summary;
    let n = |cluster: Option<Cluster>| cluster.map_or(0, |c| c.n);
    let percent = 100.0 * score.level;
    let mut text = format!("UMBmark score of {} cw + {} ccw runs\n\n", n(summary.cw), n(summary.ccw));
    let (from, to) = (format!("{percent} % from"), "to".to_owned());
    text += &table(&["", "value", &from, &to], rows(score, convention));
    text += "\n";
    if let Some(band) = score.noise_band {
        let judged = match summary.e_max_sys() {
            Some(e_max) if e_max <= band => "E_max,sys shows no systematic error",
            _ => "E_max,sys shows a systematic error",
        };
        text += &format!("\n{judged}.\nChance alone stays below {:.1} mm in {percent} % of tests.\n", 1e3 * band);
    }
    text
}

fn rows(score: &Score, convention: Convention) -> Vec<Vec<String>> {
    const MM: f64 = 1e3;
    const DEGREES: f64 = 180.0 / std::f64::consts::PI;
    let row = |name: &str, value: f64, interval: Option<Interval>, factor: f64, decimals: usize| {
        let number = |v: f64| format!("{:.decimals$}", v * factor);
        let end = |v: Option<f64>| v.map_or("-".to_owned(), number);
        vec![name.to_owned(), number(value), end(interval.map(|i| i.low)), end(interval.map(|i| i.high))]
    };
    let (summary, intervals) = (&score.summary, score.intervals.as_ref());
    let mut rows = Vec::new();
    match summary.e_max_sys() {
        Some(e_max) => rows.push(row("E_max,sys [mm]", e_max, intervals.and_then(|i| i.e_max_sys), MM, 1)),
        None => rows.push(["E_max,sys [mm]", "refused", "-", "-"].map(str::to_owned).to_vec()),
    }
    if let (Some(axis), Some(radial)) = (summary.sigma_axis(), summary.sigma_radial()) {
        let interval = intervals.map(|i| i.sigma_axis);
        rows.push(row("sigma, per axis [mm]", axis, interval, MM, 1));
        rows.push(row("sigma, radial [mm]", radial, interval.map(|i| i.scaled(std::f64::consts::SQRT_2)), MM, 1));
    }
    for (name, cluster, interval) in
        [("cw", summary.cw, intervals.and_then(|i| i.cw)), ("ccw", summary.ccw, intervals.and_then(|i| i.ccw))]
    {
        let Some(cluster) = cluster else { continue };
        rows.push(row(&format!("centre of gravity {name}, x [mm]"), cluster.x, interval.map(|i| i.x), MM, 1));
        rows.push(row(&format!("centre of gravity {name}, y [mm]"), cluster.y, interval.map(|i| i.y), MM, 1));
        rows.push(row(&format!("r_c.g. {name} [mm]"), cluster.distance(), None, MM, 1));
        if let Some(heading) = cluster.heading {
            let name = format!("return heading {name} [deg]");
            rows.push(row(&name, heading, interval.and_then(|i| i.heading), DEGREES, 3));
        }
    }
    if let Some(extended) = &score.extended {
        let name = format!("orientation with bumps, {} [deg]", convention.name());
        rows.push(row(&name, extended.orientation(convention), extended.interval(convention), DEGREES, 3));
    }
    rows
}
