//! Errors along each run.

use umbmark_core::compare::tracks::TrackErrors;
use umbmark_core::dataset::{Dataset, Run};
use umbmark_core::path::Direction;

use super::FigureKind;
use super::residuals::{COMPONENTS, models};
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Study};
use crate::thin::thin;
use crate::tone::Tone;

/// Places of one panel of errors along the way.
const PLACES: usize = 6000;
/// Fewer of one run lose its shape.
const OF_RUN: usize = 24;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "residuals_along", about: "errors of the model along each run", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let (nominal, model) = models(study)?;
    let most = (PLACES / model.residuals.len().max(1)).max(OF_RUN);
    let mut lines: [Vec<Layer>; 3] = Default::default();
    for direction in [Some(Direction::Cw), Some(Direction::Ccw), None] {
        let (mut places, mut runs, mut rolled): ([Vec<[f64; 2]>; 3], Vec<usize>, Vec<f64>) = Default::default();
        for run in model.residuals.iter().filter(|run| run.direction == direction) {
            let column = |k: usize| run.errors.iter().map(|error| error[k]).collect::<Vec<f64>>();
            let kept = thin(&[&column(0), &column(1), &column(2)], most);
            let (index, is_whole) = of_run(&study.data, &run.run);
            runs.extend(std::iter::repeat_n(index, kept.len() + 1));
            rolled.extend(kept.iter().map(|i| if is_whole { run.rolled[*i] } else { f64::NAN }));
            rolled.push(f64::NAN);
            for (k, places) in places.iter_mut().enumerate() {
                places.extend(kept.iter().map(|i| [run.rolled[*i], COMPONENTS[k].1 * run.errors[*i][k]]));
                places.push([f64::NAN, f64::NAN]);
            }
        }
        for (lines, places) in lines.iter_mut().zip(places).filter(|(_, places)| !places.is_empty()) {
            let name = direction.map_or("runs".to_owned(), |d| format!("{} runs", d.name()));
            let layer = Layer::new(name, direction.map_or(Tone::Measured, Tone::of), Mark::Line, places);
            lines.push(Layer { direction, ..layer.along_runs(runs.clone(), rolled.clone()) });
        }
    }
    let panel = |(layers, (component, _, unit)): (Vec<Layer>, (&str, f64, &str))| Panel {
        title: component.to_owned(),
        x: Axis::of("distance driven [m]"),
        y: Axis::of(format!("error [{unit}]")),
        equal: false,
        layers,
    };
    let mm = |judged: &TrackErrors| format!("{:.1}", 1e3 * judged.along.position);
    let end = |judged: &TrackErrors| format!("{:.1}", 1e3 * judged.end.position);
    let rows = [nominal, model].map(|judged| [judged.name.clone(), mm(judged), end(judged)]);
    Ok(Figure {
        kind: "residuals_along",
        title: "Residuals along the way".into(),
        told: Told {
            shows: format!(
                "The measured pose relative to that of {}, along each run: forward, to the left, and turned to the left.",
                study.model_name()
            ),
            good: "Lines vary randomly about zero. If all runs deviate in the same way, the model lacks an effect."
                .into(),
            says: format!(
                "The root mean square distance is {} mm along the way, {} mm for the nominal robot.",
                mm(model),
                mm(nominal)
            ),
        },
        panels: lines.into_iter().zip(COMPONENTS).map(panel).collect(),
        table: Table::new(["model", "along the way [mm]", "at the ends [mm]"], rows),
    })
}

/// The index of a run by the name of its residuals, and whether these are of the whole run: a long run is judged in pieces, which are named
/// by it and by their time, and count the way from their own beginning.
fn of_run(data: &Dataset, name: &str) -> (usize, bool) {
    let whole = data.runs.iter().position(|run| run.name == name).map(|index| (index, true));
    let piece = |run: &Run| name.strip_prefix(run.name.as_str()).is_some_and(|rest| rest.starts_with(", "));
    whole.or_else(|| Some((data.runs.iter().position(piece)?, false))).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::effect::TestKind;

    #[test]
    fn residuals_of_a_piece_are_of_its_run_and_have_no_place_in_it() {
        let run = |name: &str| {
            let (name, test) = (name.to_owned(), TestKind::Systematic);
            Run { name, number: 1, direction: None, test, log: None, returned: None }
        };
        let data = Dataset { runs: vec![run("cw_1"), run("cw_10")], ..Dataset::default() };
        assert_eq!(of_run(&data, "cw_10"), (1, true));
        assert_eq!(of_run(&data, "cw_10, 0 to 60 s"), (1, false));
        assert_eq!(of_run(&data, "cw_1, 0 to 60 s"), (0, false));
    }
}
