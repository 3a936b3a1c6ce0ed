//! The error falling as effects are added.

use umbmark_core::learn::{Learnt, Step};

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::kind::p_value;
use crate::study::{Absent, Study};
use crate::tone::Tone;

const MM: f64 = 1e3;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "learning", about: "the error after each added effect", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let learnt = study.learnt()?;
    let names = learnt.steps.iter().map(name).collect();
    let stairs = |of: fn(&Step) -> f64| {
        let steps = learnt.steps.iter().enumerate();
        steps.flat_map(move |(i, step)| [[MM * of(step), i as f64 - 0.5], [MM * of(step), i as f64 + 0.5]]).collect()
    };
    let dots = |of: fn(&Step) -> f64| learnt.steps.iter().enumerate().map(move |(i, s)| [MM * of(s), i as f64]);
    let fitted: Vec<[f64; 2]> = stairs(|step| step.error.position);
    let left_out: Vec<[f64; 2]> = stairs(|step| step.held_out.position);
    let said = |of: fn(&Step) -> f64| {
        learnt.steps.iter().map(|step| format!("{}: {:.1} mm", name(step), MM * of(step))).collect()
    };
    let layers = vec![
        Layer::new("", Tone::Quiet, Mark::Dashes, fitted),
        Layer::new("", Tone::Model, Mark::Line, left_out),
        Layer::new("fitted runs", Tone::Computed, Mark::Rings, dots(|s| s.error.position))
            .saying(said(|s| s.error.position)),
        Layer::new("runs left out", Tone::Model, Mark::Dots, dots(|s| s.held_out.position))
            .saying(said(|s| s.held_out.position)),
    ];
    let most = learnt.steps.iter().flat_map(|s| [s.error.position, s.held_out.position]).fold(0.0, f64::max);
    let panel = Panel {
        title: String::new(),
        x: Axis::of("rms error [mm]").from_to(0.0, 1.08 * MM * most.max(1e-6)),
        y: Axis::named(names).falling(),
        equal: false,
        layers,
    };
    Ok(Figure {
        kind: "learning",
        title: "The error after each effect".into(),
        told: told(learnt),
        panels: vec![panel],
        table: table(&learnt.steps),
    })
}

fn name(step: &Step) -> String {
    match (step.added, step.class.len().saturating_sub(1)) {
        (None, _) => "nominal robot".into(),
        (Some(effect), 0) => format!("+ {effect}"),
        (Some(effect), others) => format!("+ {effect} (or {others} alike)"),
    }
}

fn told(learnt: &Learnt) -> Told {
    let first = learnt.steps.first().map_or(0.0, |step| step.held_out.position);
    let last = learnt.steps.last().map_or(0.0, |step| step.held_out.position);
    let added: Vec<&str> = learnt.steps.iter().filter_map(|step| step.added).collect();
    let says = if added.is_empty() {
        format!("Nothing was added; the error is {:.1} mm.", MM * last)
    } else {
        format!(
            "The cross-validated error fell from {:.1} to {:.1} mm with {}.",
            MM * first,
            MM * last,
            added.join(", ")
        )
    };
    Told {
        shows: "The distance of measured poses from those of the model, after each added effect: in the runs \
                that the model was fitted to, and in runs that were used neither to choose effects nor to fit."
            .into(),
        good: "Both fall together and end at the scatter of the runs. A growing gap means that the model learnt noise."
            .into(),
        says,
    }
}

fn table(steps: &[Step]) -> Table {
    let row = |step: &Step| {
        let degrees = |heading: Option<f64>| heading.map_or("–".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        [
            name(step),
            step.p_adjusted.map_or("–".into(), p_value),
            format!("{:.1}", MM * step.error.position),
            format!("{:.1}", MM * step.held_out.position),
            degrees(step.held_out.heading),
        ]
    };
    Table::new(["model", "p", "fitted [mm]", "left out [mm]", "left out [deg]"], steps.iter().map(row))
}
