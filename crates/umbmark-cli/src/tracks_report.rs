//! A comparison of models on tracks, for people and for machines.

use umbmark_core::compare::tracks::{Against, By, COVARIATES, Mean, Part, Rate, TrackComparison, TracksJudged};
use umbmark_core::diagnose::{Options, Remains};
use umbmark_core::prose::{counted, unsigned_zeros};
use umbmark_core::stats::Interval;

use crate::model_report::p_text;
use crate::prose::{details_text, hanging, shortened};
use crate::residual_strips::{marks, strips};
use crate::setup_report::{disturbances_text, faults_text, taken_text};
use crate::table::table;

/// Runs are listed up to this many; --json has all.
const RUNS: usize = 20;

/// How a comparison is shown.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// On a terminal, which has more characters.
    pub terminal: bool,
    /// With all tables.
    pub verbose: bool,
}

/// The comparison as text: what each model explains, and, where they are wanted, the tables behind that.
pub fn text(comparison: &TrackComparison, options: &Options, look: Look) -> String {
    let Look { terminal, verbose } = look;
    let [cw, ccw, neither] = comparison.runs;
    let others = if neither > 0 { format!(" + {neither} other") } else { String::new() };
    let (poses, models) = (counted(comparison.poses, "pose"), counted(comparison.models.len(), "model"));
    let mut text = format!("Comparison of {models} with {cw} cw + {ccw} ccw{others} tracks, {poses}\n\n");
    let row = |m: &TracksJudged| {
        let explains = m.explains(options.size).map_or("-", |explains| if explains { "yes" } else { "no" });
        let [along, end] =
            [&m.errors.along, &m.errors.end].map(|rms| [mm(rms.position), rms.heading.map_or("-".into(), deg)]);
        let p = m.errors.p.map_or("-".into(), p_text);
        [vec![m.errors.name.clone()], along.to_vec(), end.to_vec(), vec![p, explains.into()]].concat()
    };
    text += &table(
        &["model", "along [mm]", "[deg]", "end [mm]", "[deg]", "p", "explains"],
        comparison.models.iter().map(row),
    );
    text += "\n\n";
    let legend = "along, end: root mean square error of all measured poses, and of the last pose of each run. p: smallest of all tests \
                  of a model that would lower the error of runs left out by 2 % or more, Bonferroni-corrected.";
    text += &hanging("", 0, legend);
    text += &(faults_text(&comparison.setup) + &disturbances_text(&comparison.setup));
    for judged in &comparison.models {
        text += &format!("\n{}\n\n", judged.errors.name);
        text += &taken_text(&judged.errors.taken);
        for sentence in &judged.sentences {
            text += &hanging("", 2, &format!("  {sentence}"));
        }
        for sentence in judged.remains.iter().flat_map(Remains::sentences) {
            text += &hanging("", 2, &format!("  {sentence}"));
        }
        if verbose {
            text += &parts_text(judged, options.size);
            text += &rates_text(judged, terminal, options.size);
            text += &strips(&judged.errors.residuals, terminal);
        }
    }
    for remark in &comparison.remarks {
        text += &hanging("note", 10, remark);
    }
    if !verbose {
        text += &details_text("where the error is made, what it depends on, and how it grows along the way");
    }
    text
}

fn mm(metres: f64) -> String {
    format!("{:.1}", 1e3 * metres)
}

fn deg(radians: f64) -> String {
    format!("{:.2}", radians.to_degrees())
}

fn half_width(mean: &Mean) -> Option<f64> {
    mean.interval.map(|Interval { low, high }| 0.5 * (high - low))
}

/// Where the error is made, a line for each part of the way.
fn parts_text(judged: &TracksJudged, size: f64) -> String {
    let mut text = format!(
        "\nwhere the error is made: mean ± ({} %), std dev, share of the squared error\n\n{:<18} {:>17} {:>17} {:>18} {:>4}\n",
        100.0 * (1.0 - size),
        "",
        "forward [mm]",
        "to the left [mm]",
        "turned left [deg]",
        "%"
    );
    for by in By::ALL {
        let parts: Vec<&Part> = judged.errors.parts.iter().filter(|part| part.by == by).collect();
        let shown = if by == By::Run { RUNS.min(parts.len()) } else { parts.len() };
        for part in &parts[..shown] {
            text += &part_line(part);
        }
        if let rest @ 1.. = parts.len() - shown {
            text += &format!("and {} (--json)\n", counted(rest, "more run"));
        }
        if !parts.is_empty() {
            text += "\n";
        }
    }
    if judged.errors.parts.iter().any(|part| shown_share(part) < 0.0) {
        text += &hanging("", 0, NEGATIVE_SHARES);
        text += "\n";
    }
    text
}

const NEGATIVE_SHARES: &str =
    "Shares add up to 100 %. A negative one: the error made there undoes some of the error made elsewhere.";

/// The share of a part in whole per cent, as it is shown.
fn shown_share(part: &Part) -> f64 {
    (100.0 * part.share.position).round() + 0.0
}

fn part_line(part: &Part) -> String {
    let direction = part.direction.filter(|_| part.by != By::Run).map_or(String::new(), |d| format!("{} ", d.name()));
    let name = shortened(&format!("{direction}{}", part.name), 18);
    let scales = [1e3, 1e3, 1f64.to_degrees()];
    let cell = |k: usize| {
        let mean = scales[k] * part.mean[k].value;
        // Large errors have a digit less, so that the table keeps its columns.
        let (decimals, large) = if k == 2 { (2, 100.0) } else { (1, 1000.0) };
        let decimals = if mean.abs() < large { decimals } else { decimals - 1 };
        let interval =
            half_width(&part.mean[k]).map_or(String::new(), |half| format!(" ±{:.decimals$}", scales[k] * half));
        let spread = part.spread.map_or(String::new(), |spread| format!("{:.decimals$}", scales[k] * spread[k]));
        format!("{:>11} {spread:>5}", unsigned_zeros(&format!("{mean:.decimals$}{interval}")))
    };
    let share = shown_share(part);
    let line = format!("{name:<18} {} {} {:>18} {share:>4.0}", cell(0), cell(1), cell(2));
    format!("{}\n", line.trim_end())
}

/// Errors in proportion to what was driven, and what they depend on.
fn rates_text(judged: &TracksJudged, terminal: bool, size: f64) -> String {
    if judged.errors.overall.is_empty() {
        return String::new();
    }
    let row = |o: &umbmark_core::compare::tracks::Overall| {
        let (scale, unit) = o.rate.display();
        let half = half_width(&o.mean).map_or("-".into(), |half| format!("{:.3}", scale * half));
        let value = format!("{:.3}", scale * o.mean.value);
        vec![o.rate.name().to_owned(), value, half, unit.to_owned(), o.test.map_or("-".into(), |test| p_text(test.p))]
    };
    let mut text = table(&["over all", "error", "±", "", "p"], judged.errors.overall.iter().map(row));
    text += "\n\nwhat the error depends on: bins of each variable, and p of no dependence\n\n";
    text += format!("{:<17}", "").as_str();
    for rate in Rate::DEPENDING {
        text += &format!(" {:<14}", if rate == Rate::Turn { "in turns" } else { rate.name() });
    }
    text = format!("{}\n", text.trim_end());
    for covariate in &COVARIATES {
        let of =
            |rate: Rate| judged.errors.against.iter().find(|a| a.rate == rate && a.covariate.name == covariate.name);
        let cells: String =
            Rate::DEPENDING.into_iter().map(|rate| format!(" {:<14}", cell(of(rate), terminal))).collect();
        if !cells.trim().is_empty() {
            text += format!("{:<17}{cells}", covariate.name).trim_end();
            text += "\n";
        }
    }
    let marks = if terminal {
        "▄ no error within the interval; ▅▆▇ farther or to the left by once, twice, four times its half-width, ▃▂▁ the opposite"
    } else {
        ". no error within the interval; + farther or to the left, ^ by four times its half-width; - and v the opposite"
    };
    text + "\n" + &hanging("", 0, &format!("{marks} ({} %).", 100.0 * (1.0 - size)))
}

fn cell(against: Option<&Against>, terminal: bool) -> String {
    let Some((against, p)) = against.and_then(|a| Some((a, a.test?.p))) else { return String::new() };
    let half_widths = |bin: &umbmark_core::compare::tracks::Bin| {
        let mean = bin.mean?;
        Some(mean.value / half_width(&mean).filter(|half| *half > 0.0)?)
    };
    let values: Vec<Option<f64>> = against.bins.iter().map(half_widths).collect();
    let p = if p < 0.001 { "<.001".into() } else { format!("{p:.3}") };
    format!("{:<8} {p}", marks(&values, terminal))
}
