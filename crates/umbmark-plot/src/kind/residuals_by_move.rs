//! The error that each leg and each turn adds.

use umbmark_core::compare::tracks::{By, Part, TrackErrors};

use super::FigureKind;
use super::residuals::{COMPONENTS, models, pair_of_layers, with_half};
use crate::figure::{Axis, Figure, Panel, Table, Told};
use crate::study::{Absent, Study};

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "residuals_by_move", about: "errors that each leg and turn adds", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let (nominal, model) = models(study)?;
    let moves = |judged: &TrackErrors| -> Vec<Part> {
        judged.parts.iter().filter(|part| part.by == By::Move).cloned().collect()
    };
    let (nominal, model) = (moves(nominal), moves(model));
    if model.is_empty() || model.len() != nominal.len() {
        return Err(Absent("The ends of legs and turns were not measured.".into()));
    }
    let name =
        |part: &Part| format!("{}{}", part.direction.map_or(String::new(), |d| format!("{} ", d.name())), part.name);
    let labels: Vec<String> = model.iter().map(name).collect();
    let panel = |(k, (component, scale, unit)): (usize, (&str, f64, &str))| {
        let of = |parts: &[Part]| parts.iter().map(|part| Some(part.mean[k])).collect::<Vec<_>>();
        Panel {
            title: component.to_owned(),
            x: Axis::of(format!("error added there [{unit}]")),
            y: Axis::named(labels.clone()).falling(),
            equal: false,
            layers: pair_of_layers(&labels, &of(&nominal), &of(&model), scale, unit),
        }
    };
    let most = model.iter().max_by(|a, b| a.share.position.total_cmp(&b.share.position));
    let says = most.map_or(String::new(), |part| {
        let share = 100.0 * part.share.position;
        format!("{share:.0} % of the squared error of the model comes from {}, more than from any other.", name(part))
    });
    let rows = model.iter().zip(&nominal).zip(&labels).map(|((model, nominal), label)| {
        let cell = |part: &Part, k: usize| with_half(&part.mean[k], COMPONENTS[k].1);
        [
            label.clone(),
            cell(nominal, 0),
            cell(model, 0),
            cell(nominal, 1),
            cell(model, 1),
            cell(nominal, 2),
            cell(model, 2),
            format!("{:.0}", 100.0 * model.share.position),
        ]
    });
    let header =
        ["move", "forward [mm]", "model", "to the left [mm]", "model", "heading [deg]", "model", "share, model [%]"];
    Ok(Figure {
        kind: "residuals_by_move",
        title: "Residuals by leg and turn".into(),
        told: Told {
            shows: format!(
                "Error added by each leg and turn alone, in the frame of the robot: mean over the runs with \
                 its {:.0} % interval, of the nominal robot and of {}.",
                100.0 * study.level(),
                study.model_name()
            ),
            good: "Those of the model lie on the dashed line at zero. One different leg points to a place; if all legs are alike, the cause is in the robot."
                .into(),
            says,
        },
        panels: COMPONENTS.into_iter().enumerate().map(panel).collect(),
        table: Table::new(header, rows),
    })
}
