//! How long each run took.

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Study};
use crate::tone::Tone;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "run_lengths", about: "how long each run took", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let durations: Vec<(String, f64)> = study
        .data
        .runs
        .iter()
        .filter_map(|run| {
            let time = &run.log.as_ref()?.time;
            Some((run.name.clone(), time.last()? - time.first()?))
        })
        .collect();
    if durations.is_empty() {
        return Err(Absent("There are no logs, so that nothing is known of how long runs took.".into()));
    }
    let dots = durations.iter().enumerate().map(|(i, (_, seconds))| [i as f64 + 1.0, *seconds]);
    let panel = Panel {
        title: String::new(),
        x: Axis::of("run, in the order of the data"),
        y: Axis::of("duration [s]"),
        equal: false,
        layers: vec![Layer::new("runs", Tone::Measured, Mark::Dots, dots)],
    };
    let longest = durations.iter().map(|(_, seconds)| *seconds).fold(0.0, f64::max);
    Ok(Figure {
        kind: FIGURE.name,
        title: "How long each run took".into(),
        told: Told {
            shows: "The time from the first to the last sample of each run.".into(),
            good: "All are alike.".into(),
            says: format!("The longest took {longest:.1} s."),
        },
        panels: vec![panel],
        table: Table::new(
            ["run", "duration [s]"],
            durations.iter().map(|(name, seconds)| [name.clone(), format!("{seconds:.1}")]),
        ),
    })
}
