//! A comparison of models on tracks, for people and for machines.

use serde_json::{Map, Value, json};
use umbmark_core::compare::tracks::{Against, By, COVARIATES, Mean, Part, Rate, Rms, TrackComparison, TracksJudged};
use umbmark_core::diagnose::Options;
use umbmark_core::path::Direction;
use umbmark_core::stats::Interval;

use crate::model_report::{finite, p_text};
use crate::prose::hanging;
use crate::residual_strips::{marks, strips};
use crate::table::table;

/// Runs are listed up to this many; --json has all.
const RUNS: usize = 20;

/// The whole comparison as text.
pub fn text(comparison: &TrackComparison, options: &Options, terminal: bool) -> String {
    let [cw, ccw, neither] = comparison.runs;
    let others = if neither > 0 { format!(" + {neither} other") } else { String::new() };
    let (poses, models) = (comparison.poses, comparison.models.len());
    let mut text = format!("{cw} cw + {ccw} ccw{others} tracks, {poses} poses, against {models} model(s)\n\n");
    let row = |m: &TracksJudged| {
        let explains = m.explains(options.size).map_or("-", |explains| if explains { "yes" } else { "no" });
        let [along, end] = [&m.along, &m.end].map(|rms| [mm(rms.position), rms.heading.map_or("-".into(), deg)]);
        let p = m.p.map_or("-".into(), p_text);
        [vec![m.name.clone()], along.to_vec(), end.to_vec(), vec![p, explains.into()]].concat()
    };
    text += &table(
        &["model", "along [mm]", "[deg]", "end [mm]", "[deg]", "p", "explains"],
        comparison.models.iter().map(row),
    );
    text += "\n\n";
    let legend = "along, end: root mean square error of all measured poses, and of the last of each run. p: the smallest of all \
                  tests below, times their number.";
    text += &hanging("", 0, legend);
    for judged in &comparison.models {
        text += &format!("\n{}\n\n", judged.name);
        for sentence in &judged.sentences {
            text += &hanging("", 2, &format!("  {sentence}"));
        }
        text += &parts_text(judged, options.size);
        text += &rates_text(judged, terminal, options.size);
        text += &strips(&judged.residuals, terminal);
    }
    for remark in &comparison.remarks {
        text += &hanging("note", 10, remark);
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
        "\nwhere it is made: mean ± ({} %), sd of single ones, share of the squared error\n\n{:<18} {:>17} {:>17} {:>18} {:>4}\n",
        100.0 * (1.0 - size),
        "",
        "forward [mm]",
        "to the left [mm]",
        "turned left [deg]",
        "%"
    );
    for by in By::ALL {
        let parts: Vec<&Part> = judged.parts.iter().filter(|part| part.by == by).collect();
        let shown = if by == By::Run { RUNS.min(parts.len()) } else { parts.len() };
        for part in &parts[..shown] {
            text += &part_line(part);
        }
        if let rest @ 1.. = parts.len() - shown {
            text += &format!("and {rest} more runs (--json)\n");
        }
        if !parts.is_empty() {
            text += "\n";
        }
    }
    text
}

fn part_line(part: &Part) -> String {
    let direction = part.direction.filter(|_| part.by != By::Run).map_or(String::new(), |d| format!("{} ", d.name()));
    let name: String = format!("{direction}{}", part.name).chars().take(18).collect();
    let scales = [1e3, 1e3, 1f64.to_degrees()];
    let cell = |k: usize| {
        let decimals = if k == 2 { 2 } else { 1 };
        let mean = scales[k] * part.mean[k].value;
        let interval =
            half_width(&part.mean[k]).map_or(String::new(), |half| format!(" ±{:.decimals$}", scales[k] * half));
        let spread = part.spread.map_or(String::new(), |spread| format!("{:.decimals$}", scales[k] * spread[k]));
        format!("{:>11} {spread:>5}", format!("{mean:.decimals$}{interval}"))
    };
    let share = (100.0 * part.share.position).round() + 0.0;
    let line = format!("{name:<18} {} {} {:>18} {share:>4.0}", cell(0), cell(1), cell(2));
    format!("{}\n", line.trim_end())
}

/// Errors in proportion to what was driven, and what they depend on.
fn rates_text(judged: &TracksJudged, terminal: bool, size: f64) -> String {
    if judged.overall.is_empty() {
        return String::new();
    }
    let row = |o: &umbmark_core::compare::tracks::Overall| {
        let (scale, unit) = o.rate.display();
        let half = half_width(&o.mean).map_or("-".into(), |half| format!("{:.3}", scale * half));
        let value = format!("{:.3}", scale * o.mean.value);
        vec![o.rate.name().to_owned(), value, half, unit.to_owned(), o.p.map_or("-".into(), p_text)]
    };
    let mut text = table(&["on the whole", "error", "±", "", "p"], judged.overall.iter().map(row));
    text += "\n\nwhat it depends on: bins of each, and p of no dependence\n\n";
    text += format!("{:<17}", "").as_str();
    for rate in Rate::DEPENDING {
        text += &format!(" {:<14}", if rate == Rate::Turn { "in turns" } else { rate.name() });
    }
    text = format!("{}\n", text.trim_end());
    for covariate in &COVARIATES {
        let of = |rate: Rate| judged.against.iter().find(|a| a.rate == rate && a.covariate.name == covariate.name);
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
    let Some(against) = against.filter(|a| a.p.is_some()) else { return String::new() };
    let half_widths = |bin: &umbmark_core::compare::tracks::Bin| {
        let mean = bin.mean?;
        Some(mean.value / half_width(&mean).filter(|half| *half > 0.0)?)
    };
    let values: Vec<Option<f64>> = against.bins.iter().map(half_widths).collect();
    let p = against.p.map_or(String::new(), |p| if p < 0.001 { "<.001".into() } else { format!("{p:.3}") });
    format!("{:<8} {p}", marks(&values, terminal))
}

/// The whole comparison as a document.
pub fn document(comparison: &TrackComparison, options: &Options) -> Value {
    let [cw, ccw, neither] = comparison.runs;
    json!({
        "observed": "tracks",
        "n_cw": cw,
        "n_ccw": ccw,
        "n_other": neither,
        "poses": comparison.poses,
        "models": comparison.models.iter().map(|judged| model_json(judged, options)).collect::<Vec<_>>(),
        "remarks": comparison.remarks,
        "size": options.size,
        "version": umbmark_core::VERSION,
    })
}

fn model_json(judged: &TracksJudged, options: &Options) -> Value {
    let rms = |rms: &Rms| json!({ "rmse_m": finite(rms.position), "heading_rmse_rad": rms.heading });
    let parts = By::ALL.into_iter().map(|by| {
        let own = judged.parts.iter().filter(|part| part.by == by).map(part_json);
        (by.key().to_owned(), Value::Array(own.collect()))
    });
    let overall = judged.overall.iter().map(|o| {
        let mut told = mean_json(&o.mean);
        told["p"] = json!(o.p);
        (o.rate.key().to_owned(), told)
    });
    json!({
        "name": judged.name,
        "explains": judged.explains(options.size),
        "p": judged.p,
        "tests": judged.tests,
        "along": rms(&judged.along),
        "end": rms(&judged.end),
        "parts": Map::from_iter(parts),
        "overall": Map::from_iter(overall),
        "against": judged.against.iter().map(against_json).collect::<Vec<_>>(),
        "sentences": judged.sentences,
    })
}

fn ends(interval: Option<Interval>) -> Value {
    interval.map_or(Value::Null, |i| json!([finite(i.low), finite(i.high)]))
}

fn mean_json(mean: &Mean) -> Value {
    json!({ "mean": finite(mean.value), "interval": ends(mean.interval), "runs": mean.runs })
}

fn part_json(part: &Part) -> Value {
    let keys = ["forward_m", "sideways_m", "heading_rad"];
    let one = |k: usize| {
        let mut told = mean_json(&part.mean[k]);
        told["sd"] = part.spread.map_or(Value::Null, |spread| finite(spread[k]));
        (keys[k].to_owned(), told)
    };
    let mut told = Map::from_iter((0..3).map(one));
    told.insert("name".into(), json!(part.name));
    told.insert("direction".into(), json!(part.direction.map(Direction::name)));
    told.insert("count".into(), json!(part.count));
    let share = part.share;
    told.insert("share".into(), json!({ "position": share.position, "heading": share.heading, "end": share.end }));
    Value::Object(told)
}

fn against_json(against: &Against) -> Value {
    let bin = |bin: &umbmark_core::compare::tracks::Bin| {
        let mut told = bin.mean.as_ref().map_or(json!({ "mean": null, "interval": null, "runs": 0 }), mean_json);
        told["low"] = json!(bin.span.low);
        told["high"] = finite(bin.span.high);
        told["sense"] = json!(bin.span.sense);
        told["amount"] = json!(bin.amount);
        told
    };
    json!({
        "rate": against.rate.key(),
        "covariate": against.covariate.name,
        "unit": against.covariate.units[usize::from(against.rate.of_turns())],
        "p": against.p,
        "bins": against.bins.iter().map(bin).collect::<Vec<_>>(),
    })
}
