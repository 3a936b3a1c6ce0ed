//! How simulated tests score, and the measured one among them.

use umbmark_core::diagnose::Verdict;
use umbmark_core::monte_carlo::{Metric, Statistics};

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::scale::round_up;
use crate::study::{Absent, Study};
use crate::tone::Tone;

const MM: f64 = 1e3;
/// About so many bars.
const BARS: f64 = 16.0;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "monte_carlo",
    about: "E_max,sys of simulated tests, compared with the measured one",
    build: figure,
};

fn figure(study: &Study) -> Result<Figure, Absent> {
    let chance = study.chance()?;
    let statistics = chance.ensemble.get(Metric::EMaxSys).filter(|s| s.count() > 0);
    let statistics = statistics.ok_or_else(|| Absent("E_max,sys needs runs in both directions.".into()))?;
    let measured = study.score()?.summary.e_max_sys();
    let below = measured.map(|e_max| statistics.share_below(e_max));
    let mut panel = histogram(statistics);
    let top = panel.layers[0].y.iter().copied().fold(0.0, f64::max);
    panel.layers.extend(measured.map(|e_max| {
        let said = format!("measured: {:.1} mm", MM * e_max);
        Layer::new("measured", Tone::Limit, Mark::Line, [[MM * e_max, 0.0], [MM * e_max, 1.05 * top]])
            .saying(vec![said.clone(), said])
    }));
    let noise = match chance.matched_noise {
        Some(k) => format!("wheel noise of {k:.2e} m^0.5, which gives the measured scatter"),
        None => "the noise of the model".into(),
    };
    Ok(Figure {
        kind: "monte_carlo",
        title: "Simulated tests".into(),
        told: told(statistics, measured, below, &noise, study),
        panels: vec![panel],
        table: table(statistics, measured),
    })
}

fn told(statistics: &Statistics, measured: Option<f64>, below: Option<f64>, noise: &str, study: &Study) -> Told {
    let says = match (measured, below) {
        (Some(e_max), Some(below)) => {
            let is_outside = !(0.025..=0.975).contains(&below);
            let explained = study.diagnosis().is_ok_and(|diagnosis| diagnosis.verdict == Verdict::Explained);
            let judged = match (is_outside, explained) {
                (false, _) => "such a test is usual for the model",
                (true, false) => "fewer than 5 % of tests of the model are so far out",
                (true, true) => {
                    "fewer than 5 % of tests of the model are so far out, though the diagnosis shows no further effect; the \
                     path or the scatter of the simulated tests may differ from that of the runs"
                }
            };
            let of_tests = 100.0 * below;
            format!(
                "The measured E_max,sys, {:.0} mm, is larger than in {of_tests:.0} % of the tests: {judged}.",
                MM * e_max
            )
        }
        _ => "No E_max,sys was measured.".into(),
    };
    Told {
        shows: format!(
            "E_max,sys of {} simulated tests of {}, each with the measured number of runs, with {noise}.",
            statistics.count(),
            study.model_name()
        ),
        good: "The measured value is among the bars, not outside them.".into(),
        says,
    }
}

/// Bars of E_max,sys, in classes of a round width between the extremes.
pub fn histogram(statistics: &Statistics) -> Panel {
    let (low, high) = (MM * statistics.quantile(0.001), MM * statistics.quantile(0.999));
    let width = round_up(((high - low) / BARS).max(1e-3));
    let first = (low / width).floor();
    let classes = ((high / width).ceil() - first).max(1.0) as usize;
    let mut below = 0.0;
    let mut bars = Vec::new();
    let mut said = Vec::new();
    for class in 0..classes {
        let edge = (first + class as f64) * width;
        let up_to = if class + 1 == classes { 1.0 } else { statistics.share_below((edge + width) / MM) };
        let share = (up_to - below).max(0.0);
        below = up_to.max(below);
        bars.push([edge + 0.5 * width, 100.0 * share]);
        let decimals = (-width.log10().floor()).max(0.0) as usize;
        said.push(format!("{edge:.decimals$} to {:.decimals$} mm: {:.1} %", edge + width, 100.0 * share));
    }
    let layer = Layer::new("simulated tests", Tone::Computed, Mark::Bars(width), bars).saying(said);
    Panel {
        title: String::new(),
        x: Axis::of("E_max,sys [mm]"),
        y: Axis::of("share of the tests [%]"),
        equal: false,
        layers: vec![layer],
    }
}

fn table(statistics: &Statistics, measured: Option<f64>) -> Table {
    let quantile =
        |q: f64| [format!("{:.1} % of the tests below", 100.0 * q), format!("{:.1}", MM * statistics.quantile(q))];
    let mut rows: Vec<[String; 2]> = [0.025, 0.25, 0.5, 0.75, 0.975].into_iter().map(quantile).collect();
    rows.extend(measured.map(|e_max| ["measured".into(), format!("{:.1}", MM * e_max)]));
    Table::new(["", "E_max,sys [mm]"], rows)
}
