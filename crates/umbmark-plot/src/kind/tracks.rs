//! Where the runs went, their error magnified.

use umbmark_core::path::Direction;

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Paths, RunPath, Study};
use crate::tone::Tone;

/// The largest error is drawn no longer than this share of the path's width.
const SHARE: f64 = 0.2;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "tracks",
    about: "measured, computed and modelled path, with the error magnified",
    build: figure,
};

fn figure(study: &Study) -> Result<Figure, Absent> {
    let paths = study.paths()?;
    if paths.runs.is_empty() {
        return Err(Absent("No run has a path.".into()));
    }
    let scale = magnification(paths);
    let mut panels = Vec::new();
    for direction in [Some(Direction::Cw), Some(Direction::Ccw), None] {
        let runs: Vec<&RunPath> = paths.runs.iter().filter(|run| run.direction == direction).collect();
        if !runs.is_empty() {
            panels.push(panel(paths, direction, &runs, scale));
        }
    }
    let (largest, run) = largest(paths);
    let name = &study.data.runs[run].name;
    let computed =
        if paths.recorded { "the path that the robot computed from its ticks" } else { "the commanded path" };
    let times = if scale > 1.0 { format!("{scale:.0} times magnified") } else { "to scale".into() };
    Ok(Figure {
        kind: "tracks",
        title: "Tracks".into(),
        told: Told {
            shows: format!(
                "Measured and modelled paths beside {computed}; distances from it are {times}. The model is {}.",
                study.model_name()
            ),
            good:
                "The modelled path goes through the measured places. For a calibrated robot both lie on the computed \
                   path."
                    .into(),
            says: format!(
                "The largest distance from the computed to the measured place is {:.0} mm, in {name}.",
                1e3 * largest
            ),
        },
        panels,
        table: table(study, paths),
    })
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The largest distance of a measured from a computed place \[m\], and its run.
fn largest(paths: &Paths) -> (f64, usize) {
    let all = paths.runs.iter().flat_map(|run| run.pairs().map(move |(at, from)| (distance(&at, &from), run.run)));
    all.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, paths.runs[0].run))
}

fn magnification(paths: &Paths) -> f64 {
    let places = || paths.runs.iter().flat_map(|run| &run.computed);
    let span = |i: usize| {
        let (low, high) =
            places().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[i]), high.max(p[i])));
        high - low
    };
    let modelled = paths.runs.iter().flat_map(|run| run.computed.iter().zip(&run.modelled));
    let modelled = modelled.map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
    let wanted = SHARE * span(0).max(span(1)) / largest(paths).0.max(modelled).max(1e-9);
    let power = 10f64.powf(wanted.max(1.0).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|m| *m <= wanted).unwrap_or(1.0).clamp(1.0, 1000.0)
}

fn panel(paths: &Paths, direction: Option<Direction>, runs: &[&RunPath], scale: f64) -> Panel {
    let computed = if paths.recorded { "computed" } else { "commanded" };
    let shown =
        |from: &[f64; 2], to: &[f64; 2]| [from[0] + scale * (to[0] - from[0]), from[1] + scale * (to[1] - from[1])];
    let mut layers = Vec::new();
    // What was told is the same for all runs.
    let drawn = if paths.recorded { runs } else { &runs[..1] };
    let own = |run: &RunPath| run.rolled.iter().copied().zip(run.computed.iter().copied()).collect();
    layers.push(lines(computed, Tone::Computed, Mark::Line, drawn, own));
    let pairs = |run: &RunPath| {
        let shown = run.computed.iter().zip(&run.modelled).map(|(a, b)| shown(a, b));
        run.rolled.iter().copied().zip(shown).collect()
    };
    layers.push(lines("modelled", Tone::Model, Mark::Dashes, drawn, pairs));
    let tone = direction.map_or(Tone::Measured, Tone::of);
    let seen = |run: &RunPath| {
        let rolled = run.measured.iter().map(|(_, place)| run.rolled[*place]);
        rolled.zip(run.pairs().map(|(at, from)| shown(&from, &at))).collect()
    };
    for dense in [true, false] {
        let own: Vec<&RunPath> =
            runs.iter().copied().filter(|run| run.dense == dense && !run.measured.is_empty()).collect();
        if own.is_empty() {
            continue;
        }
        let mark = if dense { Mark::Line } else { Mark::Dots };
        let name = direction.map_or("measured".into(), |direction| format!("{} measured", direction.name()));
        layers.push(lines(&name, tone, mark, &own, seen));
    }
    if let Some(direction) = direction {
        layers = layers.into_iter().map(|layer| layer.of(direction)).collect();
    }
    if !paths.recorded {
        for layer in layers.iter_mut().filter(|layer| layer.tone != tone) {
            layer.runs.clear();
            layer.rolled.clear();
        }
    }
    let title = direction.map_or(String::new(), |d| format!("{} runs", d.name()));
    Panel { title, x: Axis::of("x [m]"), y: Axis::of("y [m]"), equal: true, layers }
}

/// One layer of the lines of many runs, with a gap after each; a place comes with how far the wheels had rolled \[m\].
fn lines(
    name: &str,
    tone: Tone,
    mark: Mark,
    runs: &[&RunPath],
    places: impl Fn(&RunPath) -> Vec<(f64, [f64; 2])>,
) -> Layer {
    let (mut all, mut of) = (Vec::new(), Vec::new());
    for run in runs {
        let own = places(run);
        of.extend(std::iter::repeat_n(run.run, own.len() + 1));
        all.extend(own);
        all.push((f64::NAN, [f64::NAN, f64::NAN]));
    }
    let (rolled, all): (Vec<f64>, Vec<[f64; 2]>) = all.into_iter().unzip();
    Layer::new(name, tone, mark, all).along_runs(of, rolled)
}

fn table(study: &Study, paths: &Paths) -> Table {
    let row = |run: &RunPath| {
        let off: Vec<f64> = run.pairs().map(|(at, from)| distance(&at, &from)).collect();
        let (most, end) = (off.iter().copied().fold(0.0, f64::max), off.last());
        [
            study.data.runs[run.run].name.clone(),
            run.measured.len().to_string(),
            format!("{:.1}", 1e3 * most),
            end.map_or("–".into(), |end| format!("{:.1}", 1e3 * end)),
        ]
    };
    Table::new(["run", "places drawn", "largest error [mm]", "error at the end [mm]"], paths.runs.iter().map(row))
}
