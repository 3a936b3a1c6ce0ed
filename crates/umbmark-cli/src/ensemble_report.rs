//! What is said of an ensemble: for people, and as a document.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use umbmark_core::monte_carlo::{Ensemble, Metric, Statistics};
use umbmark_plot::figure::Mark;

use crate::table::{table, with_precision_of};
use crate::terminal::histogram;

/// The quantiles that a document tells.
const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// What a study is, in words and as part of a document; it goes into checkpoints, so that what is merged from them can be
/// described.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Description {
    /// Lines above the table.
    pub heading: Vec<String>,
    /// A line below the table.
    pub theory: String,
    /// Seed of the study.
    pub seed: u64,
    /// What the document tells beside the metrics.
    pub document: Map<String, Value>,
    /// The row of Table I that it is of, its E_max,sys and its sigma \[m\].
    #[serde(default)]
    pub published: Option<(String, f64, f64)>,
}

/// An ensemble and what is to be said of it.
#[derive(Debug)]
pub struct Report<'a> {
    /// What the study is.
    pub description: &'a Description,
    /// What was found.
    pub ensemble: &'a Ensemble,
    /// Whether trials that were asked for are not done.
    pub partial: bool,
    /// How long it took \[s\], and for how many trials, where that is known.
    pub took: Option<(f64, u64)>,
}

impl Report<'_> {
    fn trials_per_s(&self) -> Option<f64> {
        self.took.map(|(seconds, trials)| trials as f64 / seconds.max(1e-9))
    }

    /// One document.
    pub fn json(&self) -> Value {
        let metric = |(metric, s): (Metric, &Statistics)| {
            let quantiles: Map<String, Value> =
                QUANTILES.iter().map(|q| (q.to_string(), json!(s.quantile(*q)))).collect();
            let value = json!({
                "mean": s.mean(), "std_dev": s.std_dev(), "std_error": s.std_error(),
                "min": s.min(), "max": s.max(), "quantiles": quantiles,
            });
            (metric.name().to_owned(), value)
        };
        let metrics: Map<String, Value> = self.ensemble.statistics().map(metric).collect();
        let mut document = Map::from_iter([
            ("n".to_owned(), json!(self.ensemble.trials())),
            ("seed".to_owned(), json!(self.description.seed)),
            ("partial".to_owned(), json!(self.partial)),
            ("metrics".to_owned(), Value::Object(metrics)),
            ("trials_per_s".to_owned(), json!(self.trials_per_s())),
        ]);
        document.extend(self.description.document.clone());
        Value::Object(document)
    }

    /// A table and a histogram, in characters beyond ASCII where they are shown.
    pub fn text(&self, unicode: bool) -> String {
        let mut text = format!("Monte Carlo of UMBmark: {} trials of ", self.ensemble.trials());
        text += &self.description.heading.join("\n");
        text += "\n\n";
        text += &self.table();
        text += "\n\n";
        text += &self.description.theory;
        text += &self.published();
        if let Some(e_max) = self.ensemble.get(Metric::EMaxSys) {
            text += "E_max,sys over the trials\n";
            text += &distribution_of(e_max, unicode);
        }
        let speed = self.trials_per_s().map(|speed| format!(", {speed:.0} trials/s")).unwrap_or_default();
        let partial = if self.partial { ", PARTIAL: not all trials are done" } else { "" };
        let (seed, version) = (self.description.seed, umbmark_core::VERSION);
        text + &format!("\nseed {seed}{speed}, umbmark {version}{partial}\n")
    }

    /// Where the paper's numbers lie among those of the trials.
    fn published(&self) -> String {
        let Some((row, e_max_sys, sigma)) = &self.description.published else { return String::new() };
        let place = |metric: Metric, value: f64| {
            let above = self.ensemble.get(metric).map_or(f64::NAN, |s| 100.0 * s.share_below(value));
            format!("{:.0} mm (above {above:.0} % of the trials)", value * 1e3)
        };
        let (e_max_sys, sigma) = (place(Metric::EMaxSys, *e_max_sys), place(Metric::Sigma, *sigma));
        format!("Table I, {row}: E_max,sys {e_max_sys}, sigma {sigma}\n\n")
    }

    fn table(&self) -> String {
        let rows = self.ensemble.statistics().map(|(metric, s)| {
            let (unit, factor) = unit(metric);
            let cell = |value: f64| with_precision_of(value * factor, s.std_error() * factor);
            let mut row = vec![format!("{} [{unit}]", title(metric)), cell(s.mean()), cell(s.std_error())];
            row.push(cell(s.std_dev()));
            row.extend([0.05, 0.5, 0.95].map(|q| cell(s.quantile(q))));
            row
        });
        table(&["metric", "mean", "std error", "std dev", "5 %", "50 %", "95 %"], rows)
    }
}

/// The unit that people read a metric in, and how many of it are one of SI.
pub fn unit(metric: Metric) -> (&'static str, f64) {
    if metric.is_angle() { ("deg", 180.0 / std::f64::consts::PI) } else { ("mm", 1e3) }
}

/// What people call a metric.
pub fn title(metric: Metric) -> &'static str {
    match metric {
        Metric::EMaxSys => "E_max,sys",
        Metric::Sigma => "sigma (per axis)",
        Metric::CentroidCwX => "centroid cw, x",
        Metric::CentroidCwY => "centroid cw, y",
        Metric::CentroidCcwX => "centroid ccw, x",
        Metric::CentroidCcwY => "centroid ccw, y",
        Metric::ReturnHeadingCw => "return heading cw",
        Metric::ReturnHeadingCcw => "return heading ccw",
        Metric::NonsysOrientation => "orientation, bumps",
    }
}

/// A histogram of lengths in mm.
fn distribution_of(statistics: &Statistics, unicode: bool) -> String {
    let panel = umbmark_plot::kind::histogram(statistics);
    let bars = panel.layers.iter().filter_map(|layer| match layer.mark {
        Mark::Bars(width) => Some((layer, width)),
        _ => None,
    });
    let classes: Vec<(f64, f64)> = bars
        .flat_map(|(layer, width)| layer.x.iter().zip(&layer.y).map(move |(x, y)| (x - 0.5 * width, 0.01 * y)))
        .collect();
    histogram(&classes, "mm", 40, unicode)
}
