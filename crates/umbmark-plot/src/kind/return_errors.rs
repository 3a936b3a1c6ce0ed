//! The paper's Fig. 5: where the runs came back to.

use umbmark_core::dataset::{Dataset, ReturnError};
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;
use umbmark_core::score::{CentroidInterval, Cluster, Score};

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told, ellipse};
use crate::study::{Absent, Study};
use crate::tone::Tone;

const MM: f64 = 1e3;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "return_errors",
    about: "return errors, centres of gravity, E_max,sys: the paper's Fig. 5",
    build: figure,
};

fn figure(study: &Study) -> Result<Figure, Absent> {
    let predicted = Direction::BOTH.map(|direction| study.predicted_return(direction));
    Ok(of_score(&study.data, study.score()?, predicted))
}

/// Fig. 5 of scored runs, with the return errors that a model predicts \[cw, ccw\].
pub fn of_score(data: &Dataset, score: &Score, predicted: [Option<ReturnError>; 2]) -> Figure {
    let mut layers = circles(score);
    for (direction, predicted) in Direction::BOTH.into_iter().zip(predicted) {
        for test in [TestKind::Bumps, TestKind::Systematic] {
            layers.extend(cloud(data, test, direction));
        }
        layers.extend(centre(score, direction));
        layers.extend(predicted.map(|at| {
            let said = vec![format!("{} predicted by the model", direction.name())];
            let place = [[MM * at.x, MM * at.y]];
            Layer::new(format!("{} by the model", direction.name()), Tone::Model, Mark::Rings, place)
                .of(direction)
                .saying(said)
        }));
    }
    let (x, y) = (Axis::of("x error [mm]"), Axis::of("y error [mm]"));
    let panel = Panel { title: String::new(), x, y, equal: true, layers };
    Figure {
        kind: "return_errors",
        title: "Return errors".into(),
        told: told(score),
        panels: vec![panel],
        table: table(score),
    }
}

fn of(score: &Score, direction: Direction) -> (Option<Cluster>, Option<CentroidInterval>) {
    let (summary, intervals) = (&score.summary, score.intervals.as_ref());
    match direction {
        Direction::Cw => (summary.cw, intervals.and_then(|i| i.cw)),
        Direction::Ccw => (summary.ccw, intervals.and_then(|i| i.ccw)),
    }
}

/// START, E_max,sys about it, and what scatter alone reaches.
fn circles(score: &Score) -> Vec<Layer> {
    let around = |radius: f64| ellipse(0.0, 0.0, MM * radius, MM * radius, 0.0);
    let mut layers = Vec::new();
    layers.extend(score.noise_band.map(|band| Layer::new("chance alone", Tone::Quiet, Mark::Dashes, around(band))));
    layers
        .extend(score.summary.e_max_sys().map(|e_max| Layer::new("E_max,sys", Tone::Limit, Mark::Line, around(e_max))));
    layers.push(Layer::new("START", Tone::Measured, Mark::Crosses, [[0.0, 0.0]]).saying(vec!["START".into()]));
    layers
}

fn cloud(data: &Dataset, test: TestKind, direction: Direction) -> Option<Layer> {
    let fits = |(_, run): &(usize, &umbmark_core::dataset::Run)| run.test == test && run.direction == Some(direction);
    let runs: Vec<(usize, ReturnError, &str)> = data
        .runs
        .iter()
        .enumerate()
        .filter(fits)
        .filter_map(|(index, run)| Some((index, run.returned?, run.name.as_str())))
        .collect();
    let said = |error: &ReturnError, name: &str| {
        let heading = error.heading.map(|h| format!(", heading {:.2} deg", h.to_degrees())).unwrap_or_default();
        format!("{name}: x {:.1} mm, y {:.1} mm{heading}", MM * error.x, MM * error.y)
    };
    let (name, mark) = match test {
        TestKind::Systematic => (format!("{} runs", direction.name()), Mark::Dots),
        TestKind::Bumps => (format!("{} with bumps", direction.name()), Mark::Rings),
    };
    let places = runs.iter().map(|(_, error, _)| [MM * error.x, MM * error.y]);
    let layer = Layer::new(name, Tone::of(direction), mark, places)
        .of(direction)
        .saying(runs.iter().map(|(_, error, name)| said(error, name)).collect())
        .from_runs(runs.iter().map(|(index, _, _)| *index).collect());
    (!runs.is_empty()).then_some(layer)
}

/// The centre of gravity and where it may truly be.
fn centre(score: &Score, direction: Direction) -> Vec<Layer> {
    let (Some(cluster), interval) = of(score, direction) else { return Vec::new() };
    let tone = Tone::of(direction);
    let said = format!(
        "centre of gravity of {} {} runs: x {:.1} mm, y {:.1} mm",
        cluster.n,
        direction.name(),
        MM * cluster.x,
        MM * cluster.y
    );
    let mut layers = vec![
        Layer::new(format!("{} centre", direction.name()), tone, Mark::Crosses, [[MM * cluster.x, MM * cluster.y]])
            .of(direction)
            .saying(vec![said]),
    ];
    layers.extend(interval.map(|interval| {
        let e = interval.ellipse;
        let line = ellipse(MM * e.x, MM * e.y, MM * e.semi_major, MM * e.semi_minor, e.angle);
        let name = format!("{} centre, {:.0} %", direction.name(), 100.0 * score.level);
        Layer::new(name, tone, Mark::Line, line).of(direction)
    }));
    layers
}

fn told(score: &Score) -> Told {
    let percent = 100.0 * score.level;
    let shows = format!(
        "Each dot is the end of one run, relative to where the odometry says it is. Crosses are the centres of \
         gravity, ellipses where these may truly lie ({percent:.0} %); the circle about START reaches as far as the worse \
         of them, E_max,sys."
    );
    let good = "Both centres lie on START, and the circle is not larger than the dashed one, which chance alone would \
                reach.";
    let says = match (score.summary.e_max_sys(), score.intervals.as_ref().and_then(|i| i.e_max_sys)) {
        (None, _) => {
            "One direction is missing, so there is no E_max,sys: in one direction alone, errors can cancel.".into()
        }
        (Some(e_max), interval) => {
            let interval = interval
                .map(|i| format!(" ({percent:.0} %: {:.0} to {:.0} mm)", MM * i.low, MM * i.high))
                .unwrap_or_default();
            let beside = score.noise_band.map(|band| {
                let judged = if e_max > band { "more than" } else { "not more than" };
                format!(", {judged} the {:.0} mm that chance alone would reach", MM * band)
            });
            format!("E_max,sys is {:.0} mm{interval}{}.", MM * e_max, beside.unwrap_or_default())
        }
    };
    Told { shows, good: good.into(), says }
}

fn table(score: &Score) -> Table {
    let row = |direction: Direction| {
        let (cluster, interval) = of(score, direction);
        let cluster = cluster?;
        let with = |value: f64, i: Option<umbmark_core::stats::Interval>| {
            let half = i.map(|i| format!(" ± {:.1}", 0.5 * MM * (i.high - i.low))).unwrap_or_default();
            format!("{:.1}{half}", MM * value)
        };
        Some([
            direction.name().to_owned(),
            cluster.n.to_string(),
            with(cluster.x, interval.map(|i| i.x)),
            with(cluster.y, interval.map(|i| i.y)),
            format!("{:.1}", MM * cluster.distance()),
            cluster.heading.map_or("–".into(), |h| format!("{:.3}", h.to_degrees())),
        ])
    };
    Table::new(
        ["direction", "runs", "centre x [mm]", "centre y [mm]", "distance [mm]", "heading [deg]"],
        Direction::BOTH.into_iter().filter_map(row),
    )
}
