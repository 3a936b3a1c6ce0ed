//! Models and their numbers, for people and for machines.

use std::path::Path;

use anyhow::Context;
use serde_json::{Map, Value, json};
use umbmark_core::dataset::{Dataset, model_text, read_model};
use umbmark_core::diagnose::{Contrast, Estimate, OnCircle, first_model};
use umbmark_core::effect::{Model, find};
use umbmark_core::likelihood::Outlier;
use umbmark_core::parameter::Parameter;
use umbmark_core::stats::{Interval, student_t_quantile};

use crate::files::Pending;
use crate::prose::hanging;
use crate::table::{table, with_precision_of};

/// The model of a file, or the one that is asked first.
pub fn model_of(file: Option<&Path>, data: &Dataset) -> anyhow::Result<Model> {
    let robot = data.nominal_robot()?;
    match file {
        Some(file) => Ok(read_model(file, robot)?.0),
        None => Ok(first_model(data)?),
    }
}

/// Writes a `model.toml`.
pub fn write_model(model: &Model, file: &Path, force: bool) -> anyhow::Result<()> {
    Pending::write_whole(file, force, &model_text(model)).context("the model was not written")
}

/// As in `model.toml`.
pub fn model_json(model: &Model) -> Value {
    let part = |part: &umbmark_core::effect::Part| {
        let mut effect = Map::from_iter([("name".to_owned(), json!(part.effect.name()))]);
        let number = |(parameter, value): (&Parameter, &f64)| {
            let word = parameter.choices.get(*value as usize);
            (parameter.name.to_owned(), word.map_or(json!(value), |word| json!(word)))
        };
        let mut numbers: Map<String, Value> = part.effect.parameters().iter().zip(&part.values).map(number).collect();
        match part.effect.formula() {
            Some(formula) => {
                effect.insert("acts_on".to_owned(), json!(formula.target().name()));
                effect.insert("formula".to_owned(), json!(formula.text()));
                effect.insert("parameters".to_owned(), Value::Object(numbers));
            }
            None => effect.append(&mut numbers),
        }
        effect.insert("free".to_owned(), json!(part.free));
        Value::Object(effect)
    };
    json!({ "effect": model.parts().iter().map(part).collect::<Vec<_>>() })
}

/// What was fitted, with standard errors and intervals.
pub fn estimates_json(estimates: &[Estimate], level: f64) -> Value {
    let one = |e: &Estimate| {
        json!({
            "effect": e.effect,
            "parameter": e.parameter,
            "value": e.value,
            "standard_error": finite(e.standard_error),
            "interval": half_width(e, level).map(|half| [e.value - half, e.value + half]),
        })
    };
    json!(estimates.iter().map(one).collect::<Vec<_>>())
}

/// A number, or null for what is none.
pub fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn half_width(estimate: &Estimate, level: f64) -> Option<f64> {
    let half = student_t_quantile(0.5 + 0.5 * level, estimate.degrees_of_freedom) * estimate.standard_error;
    half.is_finite().then_some(half)
}

/// The unit of a parameter, with a space before it.
pub fn unit_of(effect: &str, parameter: &str) -> String {
    let unit = find(effect).ok().and_then(|e| e.about.parameters.iter().find(|p| p.name == parameter)).map(|p| p.unit);
    unit.filter(|unit| !unit.is_empty()).map(|unit| format!(" {unit}")).unwrap_or_default()
}

/// What was fitted, a row each.
pub fn estimates_table(estimates: &[Estimate], level: f64) -> String {
    let row = |e: &Estimate| {
        let half = half_width(e, level);
        let uncertainty = half.unwrap_or(1e-5 * e.value.abs().max(1.0));
        let value = with_precision_of(e.value, uncertainty);
        let half = half.map_or("-".to_owned(), |half| with_precision_of(half, half));
        vec![format!("{} of {}", e.parameter, e.effect), format!("{value}{}", unit_of(e.effect, e.parameter)), half]
    };
    table(&["fitted", "value", &format!("± ({} %)", 100.0 * level)], estimates.iter().map(row))
}

/// Each fitted effect with what it means for the robot.
fn meanings(estimates: &[Estimate], model: &Model) -> Vec<(&'static str, String)> {
    let mut said: Vec<(&str, String)> = Vec::new();
    for e in estimates {
        if said.iter().all(|(name, _)| *name != e.effect) {
            said.extend(model.meaning(e.effect).map(|sentence| (e.effect, sentence)));
        }
    }
    said
}

/// What the fitted effects mean for the robot, a paragraph each.
pub fn meaning_text(estimates: &[Estimate], model: &Model) -> String {
    let paragraphs: String = meanings(estimates, model).iter().map(|(_, said)| hanging("", 2, said)).collect();
    if paragraphs.is_empty() { paragraphs } else { format!("\nthat is\n{paragraphs}") }
}

/// The same for machines.
pub fn meaning_json(estimates: &[Estimate], model: &Model) -> Value {
    let pairs = meanings(estimates, model).into_iter().map(|(name, said)| (name.to_owned(), json!(said)));
    Value::Object(Map::from_iter(pairs))
}

/// Disturbed places that are told one by one; --json has all.
const OUTLIERS: usize = 5;

/// Where runs were disturbed, a paragraph each.
pub fn outliers_text(outliers: &[Outlier]) -> String {
    let one = |o: &Outlier| {
        let turned = o.turned.map(|t| format!(" and {:.2} deg", t.abs().to_degrees())).unwrap_or_default();
        let jump =
            format!("a jump of {:.1} mm{turned}, {:.0} standard deviations of the noise", 1e3 * o.moved, o.deviations);
        let said = format!("{} after {:.2} s: {jump}, is left out; the run starts anew there.", o.run, o.time);
        hanging("outlier", 10, &said)
    };
    let mut text: String = outliers.iter().take(OUTLIERS).map(one).collect();
    if let rest @ 1.. = outliers.len().saturating_sub(OUTLIERS) {
        text += &hanging("", 10, &format!("and {rest} more (--json)"));
    }
    text
}

/// The same for machines.
pub fn outliers_json(outliers: &[Outlier]) -> Value {
    let one = |o: &Outlier| {
        json!({
            "run": o.run,
            "time_s": o.time,
            "moved_m": o.moved,
            "turned_rad": o.turned,
            "standard_deviations": finite(o.deviations),
        })
    };
    json!(outliers.iter().map(one).collect::<Vec<_>>())
}

/// Closure contrasts, in mm and degrees.
pub fn contrasts_table(contrasts: &[Contrast]) -> String {
    let row = |c: &Contrast| {
        let (scale, unit) = if c.unit == "m" { (1e3, "mm") } else { (1f64.to_degrees(), "deg") };
        let number = |value: f64| format!("{:.2}", scale * value);
        let zero = if c.interval.contains(0.0) { "zero" } else { "NOT zero" };
        let cells = [number(c.value), unit.into(), number(c.interval.low), number(c.interval.high), zero.into()];
        std::iter::once(c.name.to_owned()).chain(cells).collect()
    };
    table(&["contrast", "value", "", "from", "to", ""], contrasts.iter().map(row))
}

/// End points beside the circle through START.
pub fn circle_table(circle: &[OnCircle]) -> String {
    let row = |c: &OnCircle| {
        let mm = |value: f64| format!("{:.1}", 1e3 * value);
        let turned = c.turned_less_heading.zip(c.turned_interval);
        let pair = |value: f64, i: Interval, scale: f64| {
            format!("{:.2} ± {:.2}", scale * value, scale * 0.5 * (i.high - i.low))
        };
        vec![
            c.direction.name().to_owned(),
            mm(c.distance),
            c.implied.map_or("-".into(), mm),
            pair(c.mean_off, c.off_interval, 1e3),
            turned.map_or("-".into(), |(value, i)| pair(value, i, 1f64.to_degrees())),
        ]
    };
    table(&["circle", "mean [mm]", "by heading [mm]", "off it [mm]", "angle - heading [deg]"], circle.iter().map(row))
}

/// The same for machines.
pub fn square_json(contrasts: &[Contrast], circle: &[OnCircle]) -> [(String, Value); 2] {
    let ends = |i: Interval| json!([i.low, i.high]);
    let contrast = |c: &Contrast| json!({ "name": c.name, "unit": c.unit, "value": c.value, "interval": ends(c.interval), "meaning": c.meaning });
    let on = |c: &OnCircle| {
        json!({
            "direction": c.direction.name(),
            "off_m": c.off,
            "mean_off_m": c.mean_off,
            "mean_off_interval_m": ends(c.off_interval),
            "distance_m": c.distance,
            "distance_by_heading_m": c.implied,
            "angle_less_heading_rad": c.turned_less_heading,
            "angle_less_heading_interval_rad": c.turned_interval.map(ends),
            "explained": c.explained(),
        })
    };
    [
        ("contrasts".into(), json!(contrasts.iter().map(contrast).collect::<Vec<_>>())),
        ("circle".into(), json!(circle.iter().map(on).collect::<Vec<_>>())),
    ]
}

/// "p = 0.031", with few digits where it is small.
pub fn p_text(p: f64) -> String {
    if p < 0.001 { "<0.001".into() } else { format!("{p:.3}") }
}
