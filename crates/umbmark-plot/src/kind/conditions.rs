//! The numbers of the robot on each floor, day or load.

use umbmark_core::conditions::{Asked, AtLevel, Conditions, Kind};

use super::{FigureKind, p_value};
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Study};
use crate::tone::Tone;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "conditions", about: "the robot's numbers on each floor, day or load", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let found = study.conditions()?;
    let panels: Vec<Panel> =
        found.asked.iter().filter(|asked| !asked.levels.is_empty()).map(|asked| panel(found, asked)).collect();
    if panels.is_empty() {
        return Err(Absent(
            "The conditions of these runs are amounts: their slopes are told by `umbmark conditions`.".into(),
        ));
    }
    Ok(Figure {
        kind: "conditions",
        title: "The numbers under each condition".into(),
        told: told(found, study),
        panels,
        table: table(found),
    })
}

/// The values of a number at the levels of a condition, beside the value that would hold for all.
fn panel(found: &Conditions, asked: &Asked) -> Panel {
    let parameter = asked.number.parameter;
    let count = asked.levels.len() as f64;
    let ends = |pick: fn(&AtLevel) -> f64| asked.levels.iter().map(pick).collect::<Vec<f64>>();
    let spans = Mark::Spans(ends(|at| at.own.interval.low), ends(|at| at.own.interval.high));
    let places = asked.levels.iter().enumerate().map(|(place, at)| [at.own.value, place as f64]);
    let said = |at: &AtLevel| {
        let half = at.own.interval.high - at.own.value;
        format!("{}: {} = {:.5} ± {:.5}", at.level, parameter, at.own.value, half)
    };
    let shared = found.numbers.iter().find(|number| number.number == asked.number).map(|number| number.value.value);
    let line = shared.map(|value| Layer::new("", Tone::Quiet, Mark::Dashes, [[value, -0.5], [value, count - 0.5]]));
    let tone = if asked.is_shown(found.size) { Tone::Model } else { Tone::Computed };
    let spans = Layer::new("", tone, spans, places).saying(asked.levels.iter().map(said).collect());
    let of = &found.conditions[asked.condition].condition.names;
    Panel {
        title: format!("{} by {}: p {}", asked.number.key(), of.join(" or "), compared(asked.p_adjusted)),
        x: Axis::of(parameter),
        y: Axis::named(asked.levels.iter().map(|at| at.level.clone()).collect()).falling(),
        equal: false,
        layers: line.into_iter().chain([spans]).collect(),
    }
}

fn compared(p: f64) -> String {
    let p = p_value(p);
    if p.starts_with('<') { p } else { format!("= {p}") }
}

fn told(found: &Conditions, study: &Study) -> Told {
    let percent = 100.0 * study.level();
    Told {
        shows: format!(
            "Each number by the runs of each level, other conditions at their mean, with its {percent:.0} % interval; the dashed line is the value \
             for all runs together."
        ),
        good: "All intervals contain the dashed line: one model holds everywhere.".into(),
        says: found.sentence(),
    }
}

fn table(found: &Conditions) -> Table {
    let name = |asked: &Asked| found.conditions[asked.condition].condition.names.join(" or ");
    let number = |value: f64| format!("{value:.6}");
    let rows = found.asked.iter().flat_map(|asked| {
        let p = p_value(asked.p_adjusted);
        let of_level = |at: &AtLevel| {
            [
                asked.number.key(),
                name(asked),
                at.level.clone(),
                number(at.own.value),
                number(at.own.interval.low),
                number(at.own.interval.high),
                p.clone(),
            ]
        };
        let of_slope = asked.slope.iter().map(|slope| {
            let [low, high] = match found.conditions[asked.condition].condition.kind {
                Kind::Amount(range) => range,
                Kind::Levels(_) => [f64::NAN; 2],
            };
            let range = format!("each unit, {low} to {high}");
            [
                asked.number.key(),
                name(asked),
                range,
                number(slope.value),
                number(slope.interval.low),
                number(slope.interval.high),
                p.clone(),
            ]
        });
        asked.levels.iter().map(of_level).chain(of_slope).collect::<Vec<_>>()
    });
    Table::new(["number", "condition", "level", "value", "from", "to", "p"], rows)
}
