//! Models and their numbers, for people and for machines.

use std::path::Path;

use anyhow::Context;
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Contrast, OnCircle, first_model};
use umbmark_core::effect::{Model, parameter_of};
use umbmark_core::evidence::Estimate;
use umbmark_core::likelihood::{Noise, Outlier};
use umbmark_core::result::meaning;
use umbmark_core::setup::Setup;
use umbmark_core::solve::Solution;
use umbmark_core::stats::Interval;
use umbmark_io::ModelFile;

use crate::files::Pending;
use crate::prose::hanging;
use crate::session::Session;
use crate::table::{table, with_precision_of};

/// The model of a file, or the one that is fitted first.
pub fn model_of(file: Option<&Path>, data: &Dataset, session: &Session) -> anyhow::Result<Model> {
    file.map_or_else(|| Ok(first_model(data)?), |file| read_model(file, data, session))
}

/// The model of a file for the robot of the data; says what was converted.
pub fn read_model(file: &Path, data: &Dataset, session: &Session) -> anyhow::Result<Model> {
    let read = ModelFile::read(file, Some(data.nominal_robot()?))?;
    if let Some(conversion) = read.conversion {
        session.message("note", &format!("{} {conversion}", file.display()));
    }
    Ok(read.model)
}

/// Writes a `model.toml`, with the noise that was fitted with the model.
pub fn write_model(model: &Model, noise: Option<Noise>, file: &Path, force: bool) -> anyhow::Result<()> {
    let written = ModelFile { noise, ..ModelFile::new(model.clone()) };
    Pending::write_whole(file, force, &written.text()).context("the model was not written")
}

/// Writes the model of an answer, with what speaks against using it.
pub fn write_learnt(solution: &Solution, file: &Path, force: bool) -> anyhow::Result<()> {
    let written = ModelFile::learnt(solution);
    Pending::write_whole(file, force, &written.text()).context("the model was not written")
}

/// The unit of a parameter, with a space before it.
pub fn unit_of(effect: &str, parameter: &str) -> String {
    parameter_of(effect, parameter)
        .map(|own| own.unit)
        .filter(|unit| !unit.is_empty())
        .map(|unit| format!(" {unit}"))
        .unwrap_or_default()
}

/// What was fitted, a row each.
pub fn estimates_table(estimates: &[Estimate], level: f64) -> String {
    let row = |e: &Estimate| {
        let half = e.interval(level).map(|i| 0.5 * (i.high - i.low));
        let uncertainty = half.unwrap_or(1e-5 * e.value.abs().max(1.0));
        let value = with_precision_of(e.value, uncertainty);
        let half = half.map_or("-".to_owned(), |half| with_precision_of(half, half));
        vec![format!("{} of {}", e.parameter, e.effect), format!("{value}{}", unit_of(e.effect, e.parameter)), half]
    };
    table(&["fitted", "value", &format!("± ({} %)", 100.0 * level)], estimates.iter().map(row))
}

/// What the fitted effects mean for the robot, a paragraph each.
pub fn meaning_text(estimates: &[Estimate], model: &Model) -> String {
    let paragraphs: String = meaning(estimates, model).iter().map(|(_, said)| hanging("", 2, said)).collect();
    if paragraphs.is_empty() { paragraphs } else { format!("\nthis means\n{paragraphs}") }
}

/// Disturbed places that are told one by one; --json has all.
const OUTLIERS: usize = 5;

/// Where runs were disturbed by less than what was found before the fit, a paragraph each.
pub fn outliers_text(outliers: &[Outlier], setup: &Setup) -> String {
    let outliers = &outliers[setup.jumps().count().min(outliers.len())..];
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

/// "p = 0.031", with few digits where it is small.
pub fn p_text(p: f64) -> String {
    if p < 0.001 { "<0.001".into() } else { format!("{p:.3}") }
}
